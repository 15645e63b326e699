#include "serve/film.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "serve/content.h"
#include "serve/facts.h"
#include "serve/feed.h"

enum { ANEW_AT_LEAST = 1 << 16, ANEW_AFTER = 4 }; // bytes; times the size of a whole state
static const double simulators_interval = .25; // s, simulated, between two looks at who simulates each object
static const size_t bytes_max = 256u << 20; // of messages: a page needs three times as much while it is made

// ---- a recording as a source: "of" is the recording

static uint64_t recorded_number(const void *of)
{
	return ob_recording_population(of);
}

static size_t recorded_list(const void *of, ob_roster_entry *out, size_t max)
{
	const ob_snapshot *s = ob_recording_state(of);
	size_t n = 0;
	for (uint32_t id = 0; id < s->count; id++) {
		if (!(s->passport[id].flags & OB_OBJECT_PRESENT))
			continue;
		if (n < max)
			out[n] = (ob_roster_entry){ .id = id, .generation = s->passport[id].generation };
		n++;
	}
	return n;
}

static bool is_present(const ob_snapshot *s, uint32_t id)
{
	return id < s->count && s->passport[id].flags & OB_OBJECT_PRESENT;
}

static bool recorded_passport(const void *of, uint32_t id, ob_passport *out)
{
	const ob_snapshot *s = ob_recording_state(of);
	if (is_present(s, id))
		*out = s->passport[id];
	return is_present(s, id);
}

// Version of the look. A record has no versions, so it is made of the values that can change: frozen or not, the
// colour's channels, to 2^-20, and its source, the object or its mesh.
static uint64_t recorded_passport_version(const void *of, uint32_t id)
{
	const ob_snapshot *s = ob_recording_state(of);
	uint64_t version = is_present(s, id) && s->passport[id].flags & OB_OBJECT_FROZEN;
	for (int i = 0; i < 3 && is_present(s, id); i++)
		version = version << 21 | (uint64_t)lrintf(0x1p20f * fminf(fmaxf(s->passport[id].colour[i], 0), 1));
	const bool by_mesh = is_present(s, id) && s->passport[id].flags & OB_OBJECT_MESH_COLOUR;
	return by_mesh ? ~version : version;
}

static bool recorded_motion(const void *of, uint32_t id, ob_motion *out)
{
	const ob_snapshot *s = ob_recording_state(of);
	if (is_present(s, id))
		*out = s->motion[id];
	return is_present(s, id);
}

static bool recorded_hull(const void *of, uint32_t hull, ob_hull *out)
{
	const ob_snapshot *s = ob_recording_state(of);
	const ob_hull *h = hull < s->hulls ? s->hull[hull] : NULL;
	if (h)
		*out = *h;
	return h != NULL;
}

static uint32_t recorded_joints(const void *of)
{
	return ob_recording_state(of)->joints;
}

static bool recorded_joint(const void *of, uint32_t joint, ob_joint_passport *out)
{
	const ob_snapshot *s = ob_recording_state(of);
	*out = s->joint[joint];
	return ob_snapshot_has_joint(s, joint);
}

static double recorded_time(const void *of)
{
	return ob_recording_state(of)->time;
}

// ---- the film

typedef struct film {
	ob_recording *recording;
	ob_feed *feed;
	ob_message *messages; // with their lengths
	ob_message *objects, *events; // elements of JSON arrays
	ob_passport *passport; // [ids]: in the last state
	uint32_t ids;
	size_t since; // bytes since the last whole state
	size_t whole; // bytes of that state
	ob_message *simulators, *joints; // last ones written; NULL: none since the last whole state
	double simulators_at; // s: when the next are due
	bool *broke; // [numbers]: the joint had broken in the last state
	uint32_t numbers;
	double seconds, until; // CPU time that it may take; of the process, when it has
} film;

static void put(ob_message *to, const ob_message *m)
{
	ob_message_put_u32(to, (uint32_t)m->size);
	ob_message_put(to, m->bytes, m->size);
}

// kind: 1 an object comes, -1 it goes; 0 a joint of it breaks.
static void note_event(film *f, double time, int kind, uint32_t id, const char *name)
{
	ob_message_print(f->events, "%s[%.9g,%d,%u,", f->events->size ? "," : "", time, kind, id);
	ob_message_put_json(f->events, name);
	ob_message_print(f->events, "]");
}

// Notes objects added and removed in this state, for the time bar and for the details of picked ones.
static bool note_population(film *f)
{
	const ob_snapshot *s = ob_recording_state(f->recording);
	const double begin = ob_recording_get_info(f->recording)->begin;
	if (s->count > f->ids) {
		if (!OB_GROW_CLEARED(f->passport, f->ids, s->count))
			return false;
		f->ids = s->count;
	}
	for (uint32_t id = 0; id < f->ids; id++) {
		const ob_passport *now = &s->passport[id];
		ob_passport *was = &f->passport[id];
		bool there = now->flags & OB_OBJECT_PRESENT, before = was->flags & OB_OBJECT_PRESENT;
		bool same = there && before && now->generation == was->generation;
		if (before && !same && s->time > begin)
			note_event(f, s->time, -1, id, was->name);
		if (there && !same && s->time > begin)
			note_event(f, s->time, 1, id, now->name);
		if (there && !same)
			ob_message_print(f->objects, "%s[%u,%u,%.9g,%.9g,%.9g]", f->objects->size ? "," : "", id,
					 now->generation, now->mass, now->friction, now->restitution);
		*was = *now;
	}
	return !f->objects->failed && !f->events->failed;
}

// Notes joints that break in this state, for the time bar.
static bool note_breaks(film *f)
{
	const ob_snapshot *s = ob_recording_state(f->recording);
	if (s->joints > f->numbers) {
		if (!OB_GROW_CLEARED(f->broke, f->numbers, s->joints))
			return false;
		f->numbers = s->joints;
	}
	for (uint32_t i = 0; i < s->joints; i++) {
		const bool broke = ob_snapshot_has_joint(s, i) && s->joint[i].flags & OB_JOINT_BROKEN;
		if (broke && !f->broke[i])
			note_event(f, s->time, 0, s->joint[i].object[0], s->joint[i].name);
		f->broke[i] = broke;
	}
	return !f->events->failed;
}

// Writes a message beside the motions if it is not as the last one of its kind, and keeps it in its place.
static bool write_aside(film *f, ob_message *m, ob_message **last)
{
	enum { AFTER_HEAD = 16 };
	if (!m)
		return false;
	if (!*last || m->size != (*last)->size ||
	    memcmp(m->bytes + AFTER_HEAD, (*last)->bytes + AFTER_HEAD, m->size - AFTER_HEAD) != 0) {
		put(f->messages, m);
		f->since += m->size;
	}
	ob_message_release(*last);
	*last = m;
	return true;
}

// Writes who simulates each object, if that has changed.
static bool write_simulators(film *f)
{
	const double time = ob_recording_state(f->recording)->time;
	if (f->simulators && time < f->simulators_at)
		return true;
	f->simulators_at = time + simulators_interval;
	return write_aside(f, ob_feed_simulators(f->feed), &f->simulators);
}

static bool write_joints(film *f)
{
	return ob_recording_state(f->recording)->joints == 0 || write_aside(f, ob_feed_joints(f->feed), &f->joints);
}

static bool write_state(film *f)
{
	static const ob_pace_state pace = { .rate = 1 };
	ob_message *m = ob_feed_next(f->feed, &pace);
	if (!m)
		return false; // there is always news: the time
	put(f->messages, m);
	f->since += m->size;
	f->whole = f->whole ? f->whole : m->size; // the first is a whole state
	ob_message_release(m);
	if (f->since <= ANEW_AFTER * f->whole + ANEW_AT_LEAST)
		return write_simulators(f) && write_joints(f);
	m = ob_feed_whole(f->feed, &pace);
	if (!m)
		return false;
	put(f->messages, m);
	f->since = 0;
	f->whole = m->size;
	ob_message_release(m);
	ob_message_release(f->simulators);
	ob_message_release(f->joints);
	f->simulators = f->joints = NULL;
	return write_simulators(f) && write_joints(f);
}

static bool has_time(const film *f, const char *path, ob_error *e)
{
	return ob_clock_process_cpu() < f->until || ob_fail(e,
							    "%s: it takes more than %g s of CPU to show it in a "
							    "browser: --patience %g (serve: --set patience=%g) "
							    "allows more, or record fewer steps or objects",
							    path, f->seconds, 4 * f->seconds, 4 * f->seconds);
}

static bool write_states(film *f, const char *path, ob_error *e)
{
	uint64_t population = UINT64_MAX;
	bool ended = false;
	while (ob_recording_next(f->recording, &ended, e)) {
		bool changed = ob_recording_population(f->recording) != population;
		population = ob_recording_population(f->recording);
		if ((changed && !note_population(f)) || !note_breaks(f) || !write_state(f) || f->messages->failed)
			return ob_fail(e, "%s: no memory to show it", path);
		if (!has_time(f, path, e))
			return false;
		if (f->messages->size + 2 * (f->objects->size + f->events->size) > bytes_max)
			return ob_fail(e,
				       "%s: it is too long to be shown in a browser, which would need more than %zu "
				       "MiB for it; record fewer steps, or fewer objects",
				       path, bytes_max >> 20);
	}
	return ended;
}

static void put_text(ob_message *m, const char *name, const char *text)
{
	ob_message_print(m, ",\"%s\":", name);
	ob_message_put_json(m, text);
}

static bool put_meshes(const ob_scene *s, ob_message *out)
{
	bool ok = true;
	for (uint32_t i = 0; i < s->meshes && ok; i++) {
		ob_message *mesh = ob_feed_mesh(&s->mesh[i], i + 1);
		ok = mesh;
		if (mesh)
			put(out, mesh);
		ob_message_release(mesh);
	}
	return ok;
}

// Writes the head: both JSON messages, and constant data.
static bool put_head(const film *f, ob_message *out)
{
	const ob_recording_info *i = ob_recording_get_info(f->recording);
	ob_universe_info universe = { .workers = i->workers,
				      .gravity = i->scene.run.gravity,
				      .step_length = i->scene.run.step_length };
	const ob_server_config config = { .look_only = true, .scene = &i->scene, .version = i->commit };
	snprintf(universe.name, sizeof universe.name, "%s", i->universe);
	snprintf(universe.isolation, sizeof universe.isolation, "%s", i->isolation);
	ob_message *welcome = ob_facts_welcome(&config, OB_ROLE_WATCH, &universe, false, NULL),
		   *about = ob_message_new(true);
	if (welcome && about) {
		put(out, welcome);
		ob_message_print(about, "{\"film\":{\"begin\":%.17g,\"end\":%.17g,\"interval\":%.17g,\"seed\":\"%llu\"",
				 i->begin, i->end, i->interval, (unsigned long long)i->scene.seed);
		put_text(about, "created", i->created);
		put_text(about, "version", i->version);
		put_text(about, "commit", i->commit);
		ob_message_print(about, ",\"objects\":[");
		ob_message_put(about, f->objects->bytes, f->objects->size);
		ob_message_print(about, "],\"events\":[");
		ob_message_put(about, f->events->bytes, f->events->size);
		ob_message_print(about, "]}}");
		put(out, about);
	}
	bool ok = welcome && about && put_meshes(&i->scene, out) && !welcome->failed && !about->failed && !out->failed;
	ob_message_release(welcome);
	ob_message_release(about);
	return ok;
}

// Compresses some bytes with deflate, and adds the result to out. false: no memory.
static bool deflate_some(z_stream *z, const unsigned char *bytes, size_t size, bool last, ob_message *out)
{
	unsigned char buffer[1 << 15];
	do {
		z->next_in = (unsigned char *)bytes;
		z->avail_in = size < UINT_MAX ? (unsigned)size : UINT_MAX;
		bytes += z->avail_in;
		size -= z->avail_in;
		do {
			z->next_out = buffer;
			z->avail_out = sizeof buffer;
			if (deflate(z, last && size == 0 ? Z_FINISH : Z_NO_FLUSH) == Z_STREAM_ERROR)
				return false;
			ob_message_put(out, buffer, sizeof buffer - z->avail_out);
		} while (z->avail_out == 0);
	} while (size > 0);
	return !out->failed;
}

// NULL and e: no memory, or no time.
static ob_message *pack(const film *f, const char *path, ob_error *e)
{
	enum { GZIP = 16, PIECE = 4 << 20 };
	z_stream z = { .zalloc = NULL };
	ob_message *head = ob_message_new(false), *out = ob_message_new(false);
	bool begun = head && out && put_head(f, head) &&
		     deflateInit2(&z, 6, Z_DEFLATED, MAX_WBITS + GZIP, 8, Z_DEFAULT_STRATEGY) == Z_OK;
	bool ok = begun && deflate_some(&z, head->bytes, head->size, false, out), in_time = true;
	for (size_t at = 0, n; ok && at < f->messages->size && (in_time = has_time(f, path, e)); at += n) {
		const size_t left = f->messages->size - at;
		n = left < PIECE ? left : PIECE;
		ok = deflate_some(&z, f->messages->bytes + at, n, n == left, out);
	}
	if (begun)
		deflateEnd(&z);
	ob_message_release(head);
	ok = ok && in_time;
	if (!ok && in_time)
		ob_fail(e, "%s: no memory to show it", path);
	if (ok)
		return out;
	ob_message_release(out);
	return NULL;
}

ob_message *ob_film_make(ob_recording *r, const char *path, double seconds, ob_error *e)
{
	const ob_feed_source source = { .of = r,
					.number = recorded_number,
					.list = recorded_list,
					.passport = recorded_passport,
					.passport_version = recorded_passport_version,
					.motion = recorded_motion,
					.hull = recorded_hull,
					.joints = recorded_joints,
					.joint = recorded_joint,
					.time = recorded_time,
					.step_length = ob_recording_get_info(r)->scene.run.step_length };
	film f = { .recording = r,
		   .seconds = seconds,
		   .until = ob_clock_process_cpu() + seconds,
		   .feed = ob_feed_create_of(&source),
		   .messages = ob_message_new(false),
		   .objects = ob_message_new(true),
		   .events = ob_message_new(true) };
	ob_message *out = NULL;
	if (!f.feed || !f.messages || !f.objects || !f.events)
		ob_fail(e, "%s: no memory to show it", path);
	else if (write_states(&f, path, e))
		out = pack(&f, path, e);
	ob_feed_destroy(f.feed);
	ob_message_release(f.messages);
	ob_message_release(f.simulators);
	ob_message_release(f.joints);
	ob_message_release(f.objects);
	ob_message_release(f.events);
	free(f.passport);
	free(f.broke);
	return out;
}

// ---- packed page

// Parts of index.html that are replaced
enum { MARK_RECORDING, MARK_ICON, MARK_STYLE, MARK_SCRIPT, MARKS };
static const char *const marks[MARKS] = {
	"<meta name=\"recording\" content=\"\">\n",
	"<link rel=\"icon\" href=\"icon.svg\" type=\"image/svg+xml\">\n",
	"<link rel=\"stylesheet\" href=\"style.css\">\n",
	"<script type=\"module\" src=\"main.js\"></script>\n",
};

static void put_string(ob_message *to, const char *text)
{
	ob_message_put(to, text, strlen(text));
}

static void put_content(ob_message *to, const char *before, const char *path, const char *after)
{
	const ob_content *c = ob_content_find(path);
	assert(c);
	put_string(to, before);
	ob_message_put(to, c->bytes, c->size);
	put_string(to, after);
}

// Offset of the mark in the page, which must have it.
static size_t find(const ob_content *page, const char *mark)
{
	const unsigned char *at = memmem(page->bytes, page->size, mark, strlen(mark));
	assert(at);
	return (size_t)(at - page->bytes);
}

// Appends base64 (RFC 4648, 4).
static void put_base64(ob_message *to, const unsigned char *bytes, size_t size)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t i = 0; i < size; i += 3) {
		size_t n = size - i < 3 ? size - i : 3;
		unsigned three = (unsigned)bytes[i] << 16 | (n > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
				 (n > 2 ? bytes[i + 2] : 0);
		char four[4];
		for (unsigned k = 0; k < 4; k++)
			four[k] = k <= n ? digits[three >> (18 - 6 * k) & 63] : '=';
		ob_message_put(to, four, sizeof four);
	}
}

static ob_message *whole_or_none(ob_message *m)
{
	if (m && !m->failed)
		return m;
	ob_message_release(m);
	return NULL;
}

ob_message *ob_film_page_served(void)
{
	const ob_content *page = ob_content_find("/index.html");
	size_t at = find(page, marks[MARK_RECORDING]), end = at + strlen(marks[MARK_RECORDING]);
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_put(m, page->bytes, at);
	put_string(m, "<meta name=\"recording\" content=\"recording\">\n");
	ob_message_put(m, page->bytes + end, page->size - end);
	return whole_or_none(m);
}

// Adds the packed as an element that packed.js finds by its id.
static void put_recording(ob_message *m, const ob_message *packed)
{
	put_string(m, "<meta name=\"recording\" content=\"#recording\">\n");
	put_string(m, "<script type=\"text/plain\" id=\"recording\">");
	if (packed)
		put_base64(m, packed->bytes, packed->size);
	put_string(m, "</script>\n");
}

ob_message *ob_film_page_whole(const ob_message *packed)
{
	const ob_content *page = ob_content_find("/index.html");
	ob_message *m = ob_message_new(true);
	size_t from = 0;
	if (!m)
		return NULL;
	for (int i = 0; i < MARKS; i++) { // in the order of the page
		size_t at = find(page, marks[i]);
		assert(at >= from);
		ob_message_put(m, page->bytes + from, at - from);
		from = at + strlen(marks[i]);
		if (i == MARK_RECORDING)
			put_recording(m, packed);
		else if (i == MARK_STYLE)
			put_content(m, "<style>\n", "/style.css", "</style>\n");
		else if (i == MARK_SCRIPT)
			put_content(m, "<script type=\"module\">\n", "/main.js", "</script>\n");
	}
	ob_message_put(m, page->bytes + from, page->size - from);
	return whole_or_none(m);
}
