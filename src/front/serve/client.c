#include "serve/client.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/shape.h"

enum { CHUNK = 32768 }; // bytes written at once

static ob_message *first(const ob_client_queue *q)
{
	return q->waiting[q->head % OB_CLIENT_QUEUE];
}

static void drop_last(ob_client_queue *q)
{
	ob_message *m = q->waiting[(q->head + --q->count) % OB_CLIENT_QUEUE];
	q->bytes -= m->size;
	ob_message_release(m);
}

bool ob_client_queue_put(ob_client_queue *q, ob_message *m)
{
	// a message above the limit is accepted into an empty queue
	if (q->count == OB_CLIENT_QUEUE || (q->count > 0 && q->bytes + m->size > OB_CLIENT_BYTES)) {
		while (q->count > (q->sent > 0)) // half a message cannot be taken back
			drop_last(q);
		return false;
	}
	ob_message_hold(m);
	q->waiting[(q->head + q->count++) % OB_CLIENT_QUEUE] = m;
	q->bytes += m->size;
	return true;
}

void ob_client_queue_clear(ob_client_queue *q)
{
	while (q->count > 0)
		drop_last(q);
	q->sent = 0;
}

bool ob_client_write(ob_client *v)
{
	ob_client_queue *q = &v->queue;
	unsigned char buffer[LWS_PRE + CHUNK];
	while (q->count > 0 && !lws_send_pipe_choked(v->wsi)) {
		ob_message *m = first(q);
		size_t n = m->size - q->sent < CHUNK ? m->size - q->sent : CHUNK;
		bool begins = q->sent == 0, ends = q->sent + n == m->size;
		// a copy, for the library writes its own header before the bytes, which other viewers still need
		memcpy(buffer + LWS_PRE, m->bytes + q->sent, n);
		enum lws_write_protocol kind = m->text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY;
		if (lws_write(v->wsi, buffer + LWS_PRE, n,
			      (enum lws_write_protocol)lws_write_ws_flags(kind, begins, ends)) < (int)n)
			return false;
		q->sent += n;
		if (!ends)
			continue;
		q->sent = 0;
		q->head = (q->head + 1) % OB_CLIENT_QUEUE;
		q->count--;
		q->bytes -= m->size;
		ob_message_release(m);
	}
	if (q->count > 0)
		lws_callback_on_writable(v->wsi);
	return true;
}

bool ob_allowance_take(ob_allowance *a, double now, double rate)
{
	a->left += (now - a->at) * rate;
	a->left = a->left < rate ? a->left : rate;
	a->at = now;
	if (a->left < 1)
		return false;
	a->left--;
	return true;
}

// ---- avatar

static const double golden_angle = 2.39996323; // rad: a spiral of places, each away from all before
enum { PLACES = 200 };

// True if no bounds of an object reach into this ball, but for ground.
static bool is_free(const ob_universe *u, ob_vec3 p, double radius)
{
	const double at[3] = { p.x, p.y, p.z };
	ob_passport pass;
	float bounds[6];
	for (uint32_t i = 0; i < ob_universe_capacity(u); i++) {
		bool reaches = ob_universe_get_bounds(u, i, bounds) && ob_universe_get_passport(u, i, &pass) &&
			       !ob_shape_is((ob_shape)pass.shape, OB_UNBOUNDED);
		for (int k = 0; k < 3 && reaches; k++)
			reaches = bounds[k] < at[k] + radius && bounds[k + 3] > at[k] - radius;
		if (reaches)
			return false;
	}
	return true;
}

void ob_avatar_ask(ob_host *h, const ob_scene *scene, const ob_client *c)
{
	ob_error e;
	if (!scene->avatar || c->role < OB_ROLE_TAKE_PART)
		return;
	const ob_passport *pass = &scene->avatar->passport;
	const double radius = .9 * ob_shape_radius((ob_shape)pass->shape, pass->size);
	ob_request r = { .kind = OB_REQUEST_AVATAR, .origin = c->number };
	// begins elsewhere for each viewer: those who come at once do not see each other's objects yet
	for (uint32_t i = 0; i < PLACES; i++) {
		const double k = i + c->number % 8, away = radius * sqrt(k), angle = golden_angle * k;
		r.state.pose.p = ob_add(scene->avatar->state.pose.p, ob_v3(away * cos(angle), away * sin(angle), 0));
		if (is_free(ob_host_universe(h), r.state.pose.p, radius))
			break;
	}
	ob_host_ask(h, &r, &e);
}

static ob_client *find_client(ob_client *clients, uint32_t number)
{
	while (clients && clients->number != number)
		clients = clients->next;
	return clients;
}

void ob_avatars_update(ob_host *h, const ob_scene *scene, ob_client *clients, void (*found)(ob_client *c))
{
	const size_t n = scene->avatar ? ob_roster_copy(ob_host_roster(h), NULL, 0) : 0;
	ob_roster_entry *entries = n ? malloc(n * sizeof *entries) : NULL;
	const size_t copied = entries ? ob_roster_copy(ob_host_roster(h), entries, n) : 0;
	if (!entries)
		return;
	for (ob_client *c = clients; c; c = c->next)
		c->missing = true;
	for (size_t i = 0; i < copied && i < n; i++) {
		const ob_roster_entry *entry = &entries[i];
		ob_client *c = ob_is_avatar(entry) ? find_client(clients, entry->origin) : NULL;
		if (c && c->missing) {
			c->missing = false;
			if (c->avatar == entry->id && c->generation == entry->generation)
				continue;
			c->avatar = entry->id, c->generation = entry->generation;
			found(c);
		} else if (ob_is_avatar(entry)) {
			ob_host_request_remove(h, entry->id, entry->generation);
		}
	}
	free(entries);
	for (ob_client *c = clients; c; c = c->next)
		if (c->missing)
			ob_avatar_ask(h, scene, c);
}
