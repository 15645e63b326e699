#include "serve/foxglove.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "record/foxglove.h"

enum { MOST = 1024, SETS_MOST = 16 }; // subscriptions; parameters that are set at once
enum { SAMPLES_MOST = 64 }; // samples that a look sends of a sensor; a camera sends its newest picture
enum { DATA = 1, TIME = 2 }; // first byte

typedef struct subscription {
	uint32_t id, channel;
} subscription;

typedef struct set {
	char name[OB_NAME_MAX];
	double value;
} set;

struct ob_foxglove {
	const ob_scene *scene;
	ob_client *client;
	void (*send)(ob_client *c, ob_message *m);
	// the message that is read
	struct lejp_ctx parser;
	char op[24], id[64];
	subscription pair[MOST], now_pair;
	uint32_t gone[MOST], pairs, gones;
	set sets[SETS_MOST], now_set;
	uint32_t set_count, taken;
	bool broken; // the rest of it is not read
	// what the client has
	subscription subscribed[MOST];
	uint32_t subscriptions;
	ob_foxglove_view view;
	ob_snapshot now;
	uint64_t *last; // [sensors]: number of the last sample sent
	double *value, time[SAMPLES_MOST];
	uint64_t number[SAMPLES_MOST], clock; // ns: the last time sent
	ob_bytes bytes;
};

// ---- greeting

static void put_base64(ob_message *m, const ob_bytes *b)
{
	static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t i = 0; i < b->size; i += 3) {
		uint32_t three = 0;
		for (size_t k = 0; k < 3; k++)
			three = three << 8 | (i + k < b->size ? (unsigned char)b->bytes[i + k] : 0);
		char four[4];
		for (int k = 0; k < 4; k++)
			four[k] = i + (size_t)k > b->size ? '=' : digit[three >> (18 - 6 * k) & 63];
		ob_message_put(m, four, sizeof four);
	}
}

static void greet(ob_foxglove *f, const char *version)
{
	ob_message *info = ob_message_new(true), *channels = ob_message_new(true);
	ob_bytes schemas = { 0 };
	ob_channel c;
	ob_foxglove_describe(&schemas);
	if (info && channels) {
		ob_message_print(
			info,
			"{\"op\":\"serverInfo\",\"name\":\"obsim %s\",\"capabilities\":[\"time\",\"parameters\"],"
			"\"supportedEncodings\":[],\"metadata\":{}}",
			version);
		ob_message_print(channels, "{\"op\":\"advertise\",\"channels\":[");
		for (uint32_t i = 0; ob_channel_get(f->scene->sensor, f->scene->sensors, i, &c); i++) {
			ob_message_print(channels, "%s{\"id\":%u,\"topic\":", i ? "," : "", i);
			ob_message_put_json(channels, c.topic);
			ob_message_print(channels,
					 ",\"encoding\":\"protobuf\",\"schemaName\":\"%s\",\"schemaEncoding\":"
					 "\"protobuf\",\"schema\":\"",
					 c.schema);
			put_base64(channels, &schemas);
			ob_message_print(channels, "\"}");
		}
		ob_message_print(channels, "]}");
	}
	free(schemas.bytes);
	f->send(f->client, info);
	f->send(f->client, channels);
}

ob_foxglove *ob_foxglove_create(const ob_scene *scene, const char *version, ob_client *c,
				void (*send)(ob_client *c, ob_message *m))
{
	ob_foxglove *f = calloc(1, sizeof *f);
	size_t values = 1;
	for (uint32_t i = 0; i < scene->sensors; i++) {
		const ob_sensor_passport *s = &scene->sensor[i];
		const size_t needed = (size_t)s->width * (s->kind == OB_SENSOR_CAMERA ? 1 : SAMPLES_MOST);
		values = needed > values ? needed : values;
	}
	if (f) {
		f->scene = scene, f->client = c, f->send = send;
		f->last = calloc(scene->sensors + 1, sizeof *f->last);
		f->value = calloc(values, sizeof *f->value);
	}
	if (f && f->last && f->value) {
		greet(f, version);
		return f;
	}
	ob_foxglove_destroy(f);
	return NULL;
}

void ob_foxglove_destroy(ob_foxglove *f)
{
	if (!f)
		return;
	ob_snapshot_finish(&f->now);
	ob_foxglove_view_finish(&f->view);
	free(f->last);
	free(f->value);
	free(f->bytes.bytes);
	free(f);
}

// ---- reading

static bool is(const struct lejp_ctx *c, const char *path)
{
	return strcmp(c->path, path) == 0;
}

static void take_number(ob_foxglove *f, const struct lejp_ctx *c)
{
	const uint32_t n = (uint32_t)strtoul(c->buf, NULL, 10);
	if (is(c, "subscriptions[].id"))
		f->now_pair.id = n;
	else if (is(c, "subscriptions[].channelId"))
		f->now_pair.channel = n;
	else if (is(c, "subscriptionIds[]") && f->gones < MOST)
		f->gone[f->gones++] = n;
	else if (is(c, "parameters[].value"))
		f->now_set.value = strtod(c->buf, NULL);
}

static signed char take(struct lejp_ctx *c, char reason)
{
	ob_foxglove *f = c->user;
	if (reason == LEJPCB_VAL_NUM_INT || reason == LEJPCB_VAL_NUM_FLOAT) {
		take_number(f, c);
	} else if (reason == LEJPCB_VAL_STR_END) {
		char *to = is(c, "op")                  ? f->op
			   : is(c, "id")                ? f->id
			   : is(c, "parameters[].name") ? f->now_set.name
							: NULL;
		const size_t room = to == f->op ? sizeof f->op : to == f->id ? sizeof f->id : sizeof f->now_set.name;
		if (to && c->npos < room) {
			memcpy(to, c->buf, c->npos);
			to[c->npos] = 0;
		}
	} else if (reason == LEJPCB_OBJECT_END && is(c, "subscriptions[]") && f->now_pair.channel != UINT32_MAX &&
		   f->pairs < MOST) { // the path stays the same behind a list
		f->pair[f->pairs++] = f->now_pair;
		f->now_pair.channel = UINT32_MAX;
	} else if (reason == LEJPCB_OBJECT_END && is(c, "parameters[]") && *f->now_set.name &&
		   f->set_count < SETS_MOST) {
		f->sets[f->set_count++] = f->now_set;
		f->now_set = (set){ .value = NAN };
	}
	return 0;
}

// ---- wishes of the client

void ob_foxglove_complain(ob_foxglove *f, const char *what)
{
	ob_message *m = ob_message_new(true);
	if (!m)
		return;
	ob_message_print(m, "{\"op\":\"status\",\"level\":1,\"message\":");
	ob_message_put_json(m, what);
	ob_message_print(m, "}");
	f->send(f->client, m);
}

static void send_parameters(ob_foxglove *f)
{
	ob_message *m = ob_message_new(true);
	if (!m)
		return;
	ob_message_print(m, "{\"op\":\"parameterValues\",\"parameters\":[");
	for (uint32_t i = 0; i < f->scene->params; i++) {
		ob_message_print(m, i ? ",{\"name\":" : "{\"name\":");
		ob_message_put_json(m, f->scene->param[i].name);
		ob_message_print(m, ",\"value\":%.17g}", f->scene->param[i].value);
	}
	ob_message_print(m, "]");
	if (*f->id) {
		ob_message_print(m, ",\"id\":");
		ob_message_put_json(m, f->id);
	}
	ob_message_print(m, "}");
	f->send(f->client, m);
}

static void unsubscribe(ob_foxglove *f, uint32_t id)
{
	for (uint32_t i = 0; i < f->subscriptions; i++)
		if (f->subscribed[i].id == id)
			f->subscribed[i--] = f->subscribed[--f->subscriptions];
}

// The next look sends the whole of a channel.
static void subscribe(ob_foxglove *f, const subscription *s)
{
	ob_channel c;
	if (!ob_channel_get(f->scene->sensor, f->scene->sensors, s->channel, &c) || f->subscriptions == MOST) {
		ob_foxglove_complain(f, "there is no such channel, or there are too many subscriptions");
		return;
	}
	unsubscribe(f, s->id);
	f->subscribed[f->subscriptions++] = *s;
	if (s->channel <= OB_CHANNEL_POSES)
		ob_foxglove_view_finish(&f->view), f->view = (ob_foxglove_view){ 0 };
	else
		f->last[c.sensor] = 0;
}

static void carry_out(ob_foxglove *f)
{
	if (strcmp(f->op, "subscribe") == 0)
		for (uint32_t i = 0; i < f->pairs; i++)
			subscribe(f, &f->pair[i]);
	else if (strcmp(f->op, "unsubscribe") == 0)
		for (uint32_t i = 0; i < f->gones; i++)
			unsubscribe(f, f->gone[i]);
	else if (strcmp(f->op, "getParameters") == 0)
		send_parameters(f);
	if (strcmp(f->op, "setParameters") != 0)
		f->set_count = 0;
}

// Takes the next parameter that is to be set as a request.
static bool take_set(ob_foxglove *f, ob_request *request)
{
	if (f->taken == f->set_count)
		return false;
	const set *s = &f->sets[f->taken++];
	*request = (ob_request){ .kind = OB_REQUEST_SET };
	snprintf((char *)request->values, sizeof request->values, "%s=%.17g", s->name, s->value);
	request->bytes = (uint32_t)strlen((const char *)request->values) + 1;
	return true;
}

bool ob_foxglove_read(ob_foxglove *f, const char *bytes, size_t size, bool begins, bool ends, ob_request *request)
{
	if (size == 0)
		return take_set(f, request);
	if (begins) {
		f->op[0] = f->id[0] = 0;
		f->pairs = f->gones = f->set_count = f->taken = 0;
		f->now_set = (set){ .value = NAN };
		f->now_pair.channel = UINT32_MAX;
		f->broken = false;
		lejp_construct(&f->parser, take, f, NULL, 0);
	}
	const int left = f->broken ? 0 : lejp_parse(&f->parser, (const unsigned char *)bytes, (int)size);
	if (left < 0 && left != LEJP_CONTINUE) {
		ob_foxglove_complain(f, "this is no JSON");
		f->broken = true;
	}
	if (ends) {
		lejp_destruct(&f->parser);
		if (!f->broken)
			carry_out(f);
	}
	return ends && take_set(f, request);
}

// ---- sending

// Sends the bytes that have been written as the message of a subscription, of time ns.
static void send_data(ob_foxglove *f, const subscription *s, uint64_t ns)
{
	ob_message *m = ob_message_new(false);
	if (m) {
		ob_message_put_u8(m, DATA);
		ob_message_put_u32(m, s->id);
		ob_message_put(m, &ns, sizeof ns);
		ob_message_put(m, f->bytes.bytes, f->bytes.size);
		m->failed |= f->bytes.failed;
	}
	f->bytes.size = 0;
	f->send(f->client, m);
}

static void send_states(ob_foxglove *f, uint64_t ns)
{
	for (uint32_t i = 0; i < f->subscriptions; i++) {
		const subscription *s = &f->subscribed[i];
		if ((s->channel == OB_CHANNEL_SCENE && ob_foxglove_scene(&f->bytes, &f->view, f->scene, &f->now, ns)) ||
		    (s->channel == OB_CHANNEL_POSES && ob_foxglove_poses(&f->bytes, &f->view, f->scene, &f->now, ns)))
			send_data(f, s, ns);
	}
}

// Sends the new samples of a sensor on all its channels.
static void send_samples(ob_foxglove *f, const ob_universe *u, uint32_t sensor)
{
	const ob_sensor_passport *p = &f->scene->sensor[sensor];
	ob_channel c;
	const size_t n = ob_universe_get_samples(u, sensor, f->last[sensor], f->number, f->time, f->value,
						 p->kind == OB_SENSOR_CAMERA ? 1 : SAMPLES_MOST);
	for (uint32_t i = 0; i < f->subscriptions; i++) {
		const subscription *s = &f->subscribed[i];
		if (s->channel <= OB_CHANNEL_POSES ||
		    !ob_channel_get(f->scene->sensor, f->scene->sensors, s->channel, &c) || c.sensor != sensor)
			continue;
		for (size_t k = 0; k < n; k++) {
			const uint64_t ns = (uint64_t)llround(1e9 * f->time[k]);
			ob_foxglove_sample(&f->bytes, &c, p, ns, f->value + k * p->width);
			send_data(f, s, ns);
		}
	}
	if (n)
		f->last[sensor] = f->number[n - 1];
}

static bool has_state_channel(const ob_foxglove *f)
{
	for (uint32_t i = 0; i < f->subscriptions; i++)
		if (f->subscribed[i].channel <= OB_CHANNEL_POSES)
			return true;
	return false;
}

void ob_foxglove_look(ob_foxglove *f, const ob_universe *u)
{
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	const uint64_t ns = (uint64_t)llround(1e9 * info.time);
	if (f->client->queue.count)
		return;
	if (ns != f->clock) {
		ob_message *m = ob_message_new(false);
		if (m) {
			ob_message_put_u8(m, TIME);
			ob_message_put(m, &ns, sizeof ns);
		}
		f->send(f->client, m);
		f->clock = ns;
	}
	ob_error e;
	if (has_state_channel(f) && ob_snapshot_take(&f->now, u, 0, &e) && ob_foxglove_view_fit(&f->view, &f->now))
		send_states(f, ns);
	for (uint32_t i = 0; i < f->scene->sensors; i++)
		send_samples(f, u, i);
}
