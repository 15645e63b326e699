#include "record/mcap.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "shape/shape.h"

enum { HEADER = 1, FOOTER = 2, SCHEMA = 3, CHANNEL = 4, MESSAGE = 5, DATA_END = 15 }; // record types of MCAP
enum { SCENE = 1, POSES = 2 }; // ids of schemas, and of channels
static const char magic[8] = { (char)0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n' };
static const double plane_size = 200; // m, of a plane as it is shown

// A record under construction. Its memory is kept for the next.
typedef struct text {
	char *bytes;
	size_t size, room;
	bool failed; // no memory
} text;

typedef struct writer {
	FILE *file;
	const ob_scene *scene;
	text record, json;
	uint32_t numbers[3]; // messages so far, by channel
	uint64_t now; // ns
	uint32_t ids;
	ob_passport *shown; // [ids], as the last scene had them
	ob_pose *placed; // [ids], as the last poses had them
} writer;

// ---- bytes

static void put(text *t, const void *bytes, size_t n)
{
	if (t->size + n > t->room) {
		const size_t room = 2 * (t->size + n);
		if (!OB_GROW(t->bytes, room)) {
			t->failed = true;
			return;
		}
		t->room = room;
	}
	memcpy(t->bytes + t->size, bytes, n);
	t->size += n;
}

static void print(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void print(text *t, const char *format, ...)
{
	char some[512];
	va_list values;
	va_start(values, format);
	const int n = vsnprintf(some, sizeof some, format, values);
	va_end(values);
	put(t, some, n < 0 ? 0 : (size_t)n < sizeof some ? (size_t)n : sizeof some - 1);
}

// Numbers are little-endian, as this machine's.
static void put_number(text *t, uint64_t value, size_t bytes)
{
	put(t, &value, bytes);
}

static void put_string(text *t, const char *s, size_t n)
{
	put_number(t, n, 4);
	put(t, s, n);
}

static void write_record(writer *w, int type)
{
	const unsigned char opcode = (unsigned char)type;
	const uint64_t size = w->record.size;
	fwrite(&opcode, 1, 1, w->file);
	fwrite(&size, sizeof size, 1, w->file);
	fwrite(w->record.bytes, 1, w->record.size, w->file);
	w->record.size = 0;
}

static void write_message(writer *w, int channel)
{
	text *m = &w->record;
	put_number(m, (uint64_t)channel, 2);
	put_number(m, w->numbers[channel]++, 4);
	put_number(m, w->now, 8);
	put_number(m, w->now, 8);
	put(m, w->json.bytes, w->json.size);
	write_record(w, MESSAGE);
	w->json.size = 0;
}

// ---- head and end

static void write_channel(writer *w, int number, const char *schema, const char *topic)
{
	static const char any[] = "{\"type\":\"object\"}"; // readers know Foxglove's schemas by their names
	text *m = &w->record;
	put_number(m, (uint64_t)number, 2);
	put_string(m, schema, strlen(schema));
	put_string(m, "jsonschema", 10);
	put_string(m, any, sizeof any - 1);
	write_record(w, SCHEMA);
	put_number(m, (uint64_t)number, 2);
	put_number(m, (uint64_t)number, 2);
	put_string(m, topic, strlen(topic));
	put_string(m, "json", 4);
	put_number(m, 0, 4); // no metadata
	write_record(w, CHANNEL);
}

static void write_head(writer *w, const char *version)
{
	char library[64];
	const int n = snprintf(library, sizeof library, "obsim %s", version);
	fwrite(magic, 1, sizeof magic, w->file);
	put_string(&w->record, "", 0);
	put_string(&w->record, library, (size_t)n < sizeof library ? (size_t)n : sizeof library - 1);
	write_record(w, HEADER);
	write_channel(w, SCENE, "foxglove.SceneUpdate", "/scene");
	write_channel(w, POSES, "foxglove.FrameTransforms", "/poses");
}

static void write_end(writer *w)
{
	put_number(&w->record, 0, 4); // no checksum
	write_record(w, DATA_END);
	put_number(&w->record, 0, 8); // no summary
	put_number(&w->record, 0, 8);
	put_number(&w->record, 0, 4);
	write_record(w, FOOTER);
	fwrite(magic, 1, sizeof magic, w->file);
}

// ---- JSON

static void print_time(text *t, uint64_t ns)
{
	print(t, "{\"sec\":%llu,\"nsec\":%llu}", (unsigned long long)(ns / 1000000000),
	      (unsigned long long)(ns % 1000000000));
}

static void print_name(text *t, const char *name)
{
	put(t, "\"", 1);
	for (size_t i = 0; i < OB_NAME_MAX && name[i]; i++) {
		if (name[i] == '"' || name[i] == '\\')
			put(t, "\\", 1);
		put(t, &name[i], 1);
	}
	put(t, "\"", 1);
}

static void print_pose(text *t, double z)
{
	print(t,
	      "\"pose\":{\"position\":{\"x\":0,\"y\":0,\"z\":%.9g},\"orientation\":{\"x\":0,\"y\":0,\"z\":0,\"w\":1}}",
	      z);
}

static void print_size(text *t, double x, double y, double z)
{
	print(t, ",\"size\":{\"x\":%.9g,\"y\":%.9g,\"z\":%.9g}", x, y, z);
}

// sRGB of a linear value (IEC 61966-2-1)
static double displayed(double c)
{
	return c <= .0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - .055;
}

static void print_colour(text *t, const float c[4])
{
	print(t, ",\"color\":{\"r\":%.4g,\"g\":%.4g,\"b\":%.4g,\"a\":%.4g}", displayed(c[0]), displayed(c[1]),
	      displayed(c[2]), c[3]);
}

static void print_cube(text *t, ob_vec3 half, double z, const float c[4])
{
	print(t, "\"cubes\":[{");
	print_pose(t, z);
	print_size(t, 2 * half.x, 2 * half.y, 2 * half.z);
	print_colour(t, c);
	print(t, "}],\"spheres\":[],\"cylinders\":[],\"triangles\":[]");
}

// A ball, a cylinder, or both along z: the sum of a segment, a disc and a ball.
static void print_round(text *t, const ob_outline *o, const float c[4])
{
	const double radius = o->rim + o->ball;
	print(t, "\"cubes\":[],\"spheres\":[");
	for (int end = -1; end <= (o->half.z > 0 ? 1 : -1) && o->ball > 0; end += 2) {
		print(t, end > 0 ? ",{" : "{");
		print_pose(t, end * o->half.z);
		print_size(t, 2 * o->ball, 2 * o->ball, 2 * o->ball);
		print_colour(t, c);
		print(t, "}");
	}
	print(t, "],\"cylinders\":[");
	if (o->half.z > 0) {
		print(t, "{");
		print_pose(t, 0);
		print_size(t, 2 * radius, 2 * radius, 2 * o->half.z);
		print(t, ",\"bottom_scale\":1,\"top_scale\":1");
		print_colour(t, c);
		print(t, "}");
	}
	print(t, "],\"triangles\":[]");
}

static void print_point(text *t, bool first, double x, double y, double z)
{
	print(t, "%s{\"x\":%.9g,\"y\":%.9g,\"z\":%.9g}", first ? "" : ",", x, y, z);
}

static void print_hull(text *t, const ob_hull *h, const float c[4])
{
	print(t, "{");
	print_pose(t, 0);
	print(t, ",\"points\":[");
	for (uint32_t i = 0; i < h->corners; i++)
		print_point(t, i == 0, h->corner[i].x, h->corner[i].y, h->corner[i].z);
	print(t, "],\"indices\":[");
	bool first = true;
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f] + 2u; k < h->first[f + 1]; k++, first = false)
			print(t, "%s%u,%u,%u", first ? "" : ",", h->loop[h->first[f]], h->loop[k - 1], h->loop[k]);
	print(t, "],\"colors\":[]");
	print_colour(t, c);
	print(t, "}");
}

// Terrain, by its look: a record has no other triangles of it.
static void print_mesh(text *t, const ob_mesh *m, const float c[4])
{
	print(t, "\"cubes\":[],\"spheres\":[],\"cylinders\":[],\"triangles\":[{");
	print_pose(t, 0);
	print(t, ",\"points\":[");
	for (uint32_t i = 0; i < m->vertices; i++) {
		const float *p = m->vertex[i].position;
		print_point(t, i == 0, (double)p[0], (double)p[1], (double)p[2]);
	}
	print(t, "],\"indices\":[");
	for (uint32_t i = 0; i < m->indices; i++)
		print(t, "%s%u", i ? "," : "", m->index[i]);
	print(t, "],\"colors\":[]");
	print_colour(t, c);
	print(t, "}]");
}

static void print_body(text *t, const writer *w, const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	ob_outline o;
	if (ob_snapshot_hull(s, id)) {
		const uint32_t parts = ob_snapshot_parts(s, id);
		print(t, "\"cubes\":[],\"spheres\":[],\"cylinders\":[],\"triangles\":[");
		for (uint32_t i = parts > 0; i <= parts; i++) {
			print(t, i > 1 ? "," : "");
			print_hull(t, ob_snapshot_part(s, id, i), p->colour);
		}
		print(t, "]");
	} else if (ob_shape_is(p->shape, OB_SURFACED) && p->mesh && p->mesh <= w->scene->meshes) {
		print_mesh(t, &w->scene->mesh[p->mesh - 1], p->colour);
	} else if (ob_shape_outline(p->shape, p->size, &o)) {
		if (o.rim == 0 && o.ball == 0)
			print_cube(t, o.half, 0, p->colour);
		else
			print_round(t, &o, p->colour);
	} else {
		const double thin = .005;
		print_cube(t, ob_v3(.5 * plane_size, .5 * plane_size, thin), -thin, p->colour);
	}
}

static void print_entity(text *t, const writer *w, const ob_snapshot *s, uint32_t id)
{
	print(t, "{\"timestamp\":");
	print_time(t, w->now);
	print(t,
	      ",\"frame_id\":\"object/%u\",\"id\":\"%u\",\"lifetime\":{\"sec\":0,\"nsec\":0},\"frame_locked\":true,"
	      "\"metadata\":[{\"key\":\"name\",\"value\":",
	      id, id);
	print_name(t, s->passport[id].name);
	print(t, "}],\"arrows\":[],\"lines\":[],\"texts\":[],\"models\":[],");
	print_body(t, w, s, id);
	print(t, "}");
}

// ---- states

static bool grow(writer *w, uint32_t ids)
{
	if (ids <= w->ids)
		return true;
	if (!OB_GROW_CLEARED(w->shown, w->ids, ids) || !OB_GROW_CLEARED(w->placed, w->ids, ids))
		return false;
	w->ids = ids;
	return true;
}

static bool is_present(const ob_passport *p)
{
	return p->flags & OB_OBJECT_PRESENT;
}

// Writes how objects look that have come or changed, and which have gone.
static void write_scene(writer *w, const ob_snapshot *s)
{
	static const ob_passport none;
	text *t = &w->json;
	bool first = true, news = false;
	print(t, "{\"deletions\":[");
	for (uint32_t id = 0; id < w->ids; id++) {
		const ob_passport *now = id < s->count ? &s->passport[id] : &none;
		if (!is_present(&w->shown[id]) || (is_present(now) && now->generation == w->shown[id].generation))
			continue;
		print(t, "%s{\"timestamp\":", first ? "" : ",");
		print_time(t, w->now);
		print(t, ",\"type\":0,\"id\":\"%u\"}", id);
		w->shown[id] = none;
		first = false, news = true;
	}
	print(t, "],\"entities\":[");
	first = true;
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_passport *now = &s->passport[id];
		if (!is_present(now) || memcmp(now, &w->shown[id], sizeof *now) == 0)
			continue;
		print(t, first ? "" : ",");
		print_entity(t, w, s, id);
		w->shown[id] = *now;
		w->placed[id] = (ob_pose){ .q = { 0 } }; // its place is written, too
		first = false, news = true;
	}
	print(t, "]}");
	if (news)
		write_message(w, SCENE);
	t->size = 0;
}

// Writes where objects are that have moved.
static void write_poses(writer *w, const ob_snapshot *s)
{
	text *t = &w->json;
	bool first = true;
	print(t, "{\"transforms\":[");
	for (uint32_t id = 0; id < s->count; id++) {
		if (!is_present(&s->passport[id]))
			continue;
		const ob_pose at = ob_snapshot_state(s, id).pose;
		if (memcmp(&at, &w->placed[id], sizeof at) == 0)
			continue;
		print(t, "%s{\"timestamp\":", first ? "" : ",");
		print_time(t, w->now);
		print(t,
		      ",\"parent_frame_id\":\"world\",\"child_frame_id\":\"object/%u\",\"translation\":"
		      "{\"x\":%.9g,\"y\":%.9g,\"z\":%.9g},\"rotation\":{\"x\":%.9g,\"y\":%.9g,\"z\":%.9g,\"w\":%.9g}}",
		      id, at.p.x, at.p.y, at.p.z, at.q.x, at.q.y, at.q.z, at.q.w);
		w->placed[id] = at;
		first = false;
	}
	print(t, "]}");
	if (!first)
		write_message(w, POSES);
	t->size = 0;
}

static bool write_states(writer *w, ob_recording *r, const char *record, double seconds, ob_error *e)
{
	const double until = ob_clock_process_cpu() + seconds;
	bool ended = false;
	while (ob_recording_next(r, &ended, e)) {
		const ob_snapshot *s = ob_recording_state(r);
		w->now = (uint64_t)llround(1e9 * s->time);
		if (!grow(w, s->count))
			return ob_fail(e, "%s: out of memory", record);
		write_scene(w, s);
		write_poses(w, s);
		if (w->record.failed || w->json.failed)
			return ob_fail(e, "%s: out of memory", record);
		if (ob_clock_process_cpu() > until)
			return ob_fail(e, "%s: it takes more than %g s of CPU to write it: --patience %g allows more",
				       record, seconds, 4 * seconds);
		if (ferror(w->file))
			return true; // close tells why
	}
	return ended;
}

bool ob_mcap_write(ob_recording *r, const char *record, const char *path, double seconds, ob_error *e)
{
	writer w = { .file = fopen(path, "wbe"), .scene = &ob_recording_get_info(r)->scene };
	if (!w.file)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	write_head(&w, ob_recording_get_info(r)->version);
	const bool fine = write_states(&w, r, record, seconds, e);
	write_end(&w);
	errno = 0;
	const bool broken = ferror(w.file) != 0;
	const bool whole = fclose(w.file) == 0 && !broken;
	free(w.record.bytes);
	free(w.json.bytes);
	free(w.shown);
	free(w.placed);
	return fine && (whole || ob_fail(e, "%s: %s", path, errno ? strerror(errno) : "not all of it was written"));
}
