#include "serve/feed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "base/allocate.h"
#include "measure/colouring.h"
#include "shape/shape.h"

static const double tolerated = 1. / 256; // of the radius
static const double unseen = .25 / 60; // s: also the share of the motion of a moving object
static const double v_unit = 1e-3, w_unit = 2e-3; // m/s, rad/s: units of 16-bit velocities

enum { REMOVED_AT = 16, CREATED_AT = 20, MOTIONS_AT = 24, COUNT_AT = 4 }; // offsets of counts in messages

// State of an object as sent to viewers
typedef struct known {
	uint32_t id, generation;
	bool announced, sent; // announced: the object was sent; sent: its motion was
	bool fixed, froze; // froze: not yet taken
	double radius; // m
	ob_passport passport;
	uint64_t passport_version; // read before the passport
	ob_feed_kind kind;
	ob_motion motion; // last one sent
	double seen_t0; // s, of the last one examined
	uint32_t seen_step; // step of its publication: a flight that begins within the step may replace it
} known;

struct ob_feed {
	const ob_universe *u; // NULL: another source
	const ob_roster *roster;
	ob_feed_source source;
	uint64_t roster_number; // of the last one sent
	known *object; // ascending by id
	size_t objects;
	ob_roster_entry *entry;
	size_t entry_room;
	ob_contact_point *contact;
	size_t contact_room;
	double time; // s, simulated: last one sent
	ob_pace_state pace; // last one sent
	uint32_t froze; // objects that were frozen, not yet taken
	bool lost; // memory ran out, and viewers may lack something: the whole state is sent again
};

// ---- a universe as a source: "of" is the feed

static uint64_t universe_number(const void *of)
{
	return ob_roster_number(((const ob_feed *)of)->roster);
}

static size_t universe_list(const void *of, ob_roster_entry *out, size_t max)
{
	return ob_roster_copy(((const ob_feed *)of)->roster, out, max);
}

static bool universe_passport(const void *of, uint32_t id, ob_passport *out)
{
	return ob_universe_get_passport(((const ob_feed *)of)->u, id, out);
}

static uint64_t universe_passport_version(const void *of, uint32_t id)
{
	return ob_universe_get_passport_version(((const ob_feed *)of)->u, id);
}

static bool universe_motion(const void *of, uint32_t id, ob_motion *out)
{
	return ob_universe_get_motion(((const ob_feed *)of)->u, id, out);
}

static bool universe_hull(const void *of, uint32_t hull, ob_hull *out)
{
	return ob_universe_get_hull(((const ob_feed *)of)->u, hull, out);
}

static uint32_t universe_joints(const void *of)
{
	return ob_universe_joints(((const ob_feed *)of)->u);
}

static bool universe_joint(const void *of, uint32_t joint, ob_joint_passport *out)
{
	return ob_universe_get_joint(((const ob_feed *)of)->u, joint, out);
}

static double universe_time(const void *of)
{
	ob_universe_info info;
	ob_universe_get_info(((const ob_feed *)of)->u, &info);
	return info.time;
}

ob_feed *ob_feed_create_of(const ob_feed_source *source)
{
	ob_feed *f = calloc(1, sizeof *f);
	if (f)
		*f = (ob_feed){ .source = *source, .lost = true };
	return f;
}

ob_feed *ob_feed_create(const ob_universe *u, const ob_roster *r)
{
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	ob_feed *f = ob_feed_create_of(&(ob_feed_source){ .number = universe_number,
							  .list = universe_list,
							  .passport = universe_passport,
							  .passport_version = universe_passport_version,
							  .motion = universe_motion,
							  .hull = universe_hull,
							  .joints = universe_joints,
							  .joint = universe_joint,
							  .time = universe_time,
							  .step_length = info.step_length,
							  .unseen = unseen });
	if (!f)
		return NULL;
	f->u = u;
	f->roster = r;
	f->source.of = f;
	return f;
}

void ob_feed_destroy(ob_feed *f)
{
	if (!f)
		return;
	free(f->object);
	free(f->entry);
	free(f->contact);
	free(f);
}

// ---- motions

static ob_feed_kind kind_of(const known *k, const ob_motion *m, double step_length)
{
	if (k->fixed || m->flags & OB_MOTION_RESTS)
		return OB_FEED_STANDS;
	if (m->flags & OB_MOTION_SWINGS)
		return OB_FEED_SWINGS;
	return m->valid_until - m->t0 > 1.001 * step_length ? OB_FEED_FREE : OB_FEED_TURNS;
}

// Deviation (m): largest distance of a point of the object from viewers' prediction, at the beginning of its motion m.
static double off(const known *k, const ob_motion *m)
{
	const ob_motion *sent = &k->motion;
	double s = m->t0 - sent->t0;
	ob_vec3 p = ob_madd(ob_madd(sent->p, s, sent->v), .5 * s * s, sent->a);
	ob_quat q = ob_quat_turn(sent->q, ob_scale(sent->w, s));
	ob_quat turn = ob_quat_mul(m->q, ob_quat_conjugate(q));
	return ob_norm(ob_sub(m->p, p)) + 2 * k->radius * ob_norm(ob_v3(turn.x, turn.y, turn.z));
}

static bool is_news(const ob_feed *f, const known *k, const ob_motion *m, ob_feed_kind kind)
{
	if (!k->sent || kind != k->kind || kind >= OB_FEED_FREE)
		return true;
	if (kind == OB_FEED_STANDS)
		return memcmp(&m->p, &k->motion.p, sizeof m->p) != 0 || memcmp(&m->q, &k->motion.q, sizeof m->q) != 0;
	return off(k, m) > tolerated * k->radius + f->source.unseen * ob_norm(m->v);
}

static void put_vec3(ob_message *out, ob_vec3 v)
{
	ob_message_put_f32(out, v.x);
	ob_message_put_f32(out, v.y);
	ob_message_put_f32(out, v.z);
}

static bool fits(ob_vec3 v, double one)
{
	return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z))) <= 32767 * one;
}

static ob_vec3 rounded(ob_vec3 v, double one)
{
	return ob_v3(one * rint(v.x / one), one * rint(v.y / one), one * rint(v.z / one));
}

static bool is_wide(const known *k)
{
	return k->kind >= OB_FEED_FREE || !fits(k->motion.v, v_unit) || !fits(k->motion.w, w_unit);
}

// Stores the motion as sent: viewers extrapolate from rounded velocities, and so does the feed.
static void know(known *k, const ob_motion *m, ob_feed_kind kind)
{
	k->sent = true;
	k->kind = kind;
	k->motion = *m;
	if (!is_wide(k)) {
		k->motion.v = rounded(m->v, v_unit);
		k->motion.w = rounded(m->w, w_unit);
	}
}

static void put_i16(ob_message *out, double value)
{
	ob_message_put(out, &(int16_t){ (int16_t)lrint(value) }, 2);
}

static void put_short_vec3(ob_message *out, ob_vec3 v, double one)
{
	put_i16(out, v.x / one);
	put_i16(out, v.y / one);
	put_i16(out, v.z / one);
}

// Groups of 7 bits, low first
static void put_number(ob_message *out, uint32_t n)
{
	for (; n > 127; n >>= 7)
		ob_message_put_u8(out, n | 128);
	ob_message_put_u8(out, n);
}

// before: the id of the previous motion in the message; UINT32_MAX: none
static void put_motion(ob_message *out, const known *k, double time, uint32_t *before)
{
	const ob_motion *m = &k->motion;
	const double q[4] = { m->q.w, m->q.x, m->q.y, m->q.z };
	bool moves = k->kind != OB_FEED_STANDS, wide = moves && is_wide(k), begun = moves && m->t0 != time;
	bool accelerated = moves && ob_norm2(m->a) > 0;
	put_number(out, k->id - *before);
	*before = k->id;
	ob_message_put_u8(out, k->kind | (wide ? OB_FEED_WIDE : 0) | (accelerated ? OB_FEED_ACCELERATED : 0) |
				       (begun ? OB_FEED_BEGUN : 0));
	put_vec3(out, m->p);
	for (int i = 0; i < 4; i++)
		put_i16(out, 32767 * q[i]);
	if (begun)
		ob_message_put_f32(out, time - m->t0);
	if (accelerated)
		put_vec3(out, m->a);
	if (k->kind == OB_FEED_SWINGS)
		ob_message_put(out, &m->frequency, sizeof m->frequency);
	if (wide) {
		put_vec3(out, m->v);
		put_vec3(out, m->w);
	} else if (moves) {
		put_short_vec3(out, m->v, v_unit);
		put_short_vec3(out, m->w, w_unit);
	}
}

// ---- objects

// Returns the number of its parts.
static uint32_t put_hull(ob_message *out, const ob_feed_source *source, uint32_t number)
{
	ob_hull h;
	if (!source->hull(source->of, number, &h)) // corrupted by a faulty simulator
		h.corners = h.faces = h.parts = 0;
	ob_message_put_u8(out, h.corners);
	ob_message_put_u8(out, h.faces);
	ob_message_put_u8(out, h.parts);
	ob_message_put(out, &(uint16_t){ (uint16_t)number }, 2);
	for (uint32_t i = 0; i < h.corners; i++)
		put_vec3(out, h.corner[i]);
	for (uint32_t f = 0; f < h.faces; f++) {
		ob_message_put_u8(out, h.first[f + 1] - h.first[f]);
		ob_message_put(out, h.loop + h.first[f], h.first[f + 1] - h.first[f]);
	}
	return h.parts;
}

static void put_object(ob_message *out, const ob_feed_source *source, const known *k)
{
	const ob_passport *p = &k->passport;
	size_t name = strnlen(p->name, OB_NAME_MAX);
	ob_message_put_u32(out, k->id);
	ob_message_put_u32(out, k->generation);
	ob_message_put_u8(out, p->shape);
	const unsigned flags =
		(k->fixed ? OB_FEED_STATIC : 0) | (p->flags & OB_OBJECT_FROZEN ? OB_FEED_FROZEN : 0) |
		(p->mesh ? OB_FEED_LOOKS : 0) | (p->flags & OB_OBJECT_MESH_COLOUR ? OB_FEED_MESH_COLOUR : 0) |
		(p->flags & OB_OBJECT_MESH_SURFACE ? OB_FEED_MESH_SURFACE : 0) |
		(p->flags & OB_OBJECT_SENSOR ? OB_FEED_SENSOR : 0) |
		(p->flags & OB_OBJECT_HIDDEN ? OB_FEED_HIDDEN : 0) | OB_FEED_PATTERN * (unsigned)ob_passport_pattern(p);
	ob_message_put(out, &(uint16_t){ (uint16_t)flags }, 2);
	ob_message_put_u8(out, (unsigned)name);
	ob_message_put_u8(out, (unsigned)lroundf(15 * fminf(fmaxf(p->roughness, 0), 1)) |
				       16 * (unsigned)lroundf(15 * fminf(fmaxf(p->metal, 0), 1)));
	put_vec3(out, p->size);
	put_vec3(out, p->inertia);
	for (int i = 0; i < 3; i++)
		ob_message_put_f32(out, p->colour[i]);
	if (ob_shape_is(p->shape, OB_HULLED))
		for (uint32_t i = 1, parts = put_hull(out, source, p->hull); i <= parts; i++)
			put_hull(out, source, p->hull + i);
	if (p->mesh)
		ob_message_put_u8(out, p->mesh);
	ob_message_put(out, p->name, name);
}

static bool read_roster(ob_feed *f, size_t *entries)
{
	for (;;) {
		*entries = f->source.list(f->source.of, f->entry, f->entry_room);
		if (*entries <= f->entry_room)
			return true;
		if (!OB_RESERVE(f->entry, *entries, f->entry_room))
			return false;
	}
}

// Sends removed, then created objects, and their number; the list then equals the roster. false: out of memory.
static bool write_roster(ob_feed *f, ob_message *out, uint32_t *created)
{
	size_t entries, kept = 0;
	uint32_t removed = 0;
	if (!read_roster(f, &entries))
		return false;
	known *now = calloc(entries + 1, sizeof *now);
	if (!now)
		return false;
	for (size_t i = 0, at = 0; i < f->objects || at < entries;) {
		const known *old = i < f->objects ? &f->object[i] : NULL;
		const ob_roster_entry *entry = at < entries ? &f->entry[at] : NULL;
		if (old && entry && old->id == entry->id && old->generation == entry->generation) {
			now[kept++] = *old;
			i++;
			at++;
		} else if (old && (!entry || old->id <= entry->id)) {
			ob_message_put_u32(out, old->id);
			removed++;
			i++;
		} else {
			known fresh = { .id = entry->id,
					.generation = entry->generation,
					.passport_version = f->source.passport_version(f->source.of, entry->id) };
			at++;
			// it may have been removed since the roster was read: the next roster shows it
			if (!f->source.passport(f->source.of, fresh.id, &fresh.passport) ||
			    fresh.passport.generation != fresh.generation)
				continue;
			fresh.fixed = fresh.passport.flags & OB_OBJECT_STATIC;
			fresh.froze = fresh.passport.flags & OB_OBJECT_FROZEN; // since a checkpoint before its creation
			f->froze += fresh.froze;
			fresh.radius = ob_shape_radius((ob_shape)fresh.passport.shape, fresh.passport.size);
			now[kept++] = fresh;
			++*created;
		}
	}
	for (size_t i = 0; i < kept; i++) {
		if (!now[i].announced)
			put_object(out, &f->source, &now[i]);
		now[i].announced = true;
	}
	free(f->object);
	f->object = now;
	f->objects = kept;
	ob_message_set_u32(out, REMOVED_AT, removed);
	return true;
}

static bool looks_alike(const ob_passport *a, const ob_passport *b)
{
	return memcmp(a->colour, b->colour, sizeof a->colour) == 0 && a->roughness == b->roughness &&
	       a->metal == b->metal && a->flags == b->flags;
}

// Sends objects whose look has changed, in the form of new ones; returns their number.
static uint32_t write_looks(ob_feed *f, ob_message *out)
{
	uint32_t sent = 0;
	for (size_t i = 0; i < f->objects; i++) {
		known *k = &f->object[i];
		const uint64_t version = f->source.passport_version(f->source.of, k->id);
		ob_passport now;
		if (version == k->passport_version || !f->source.passport(f->source.of, k->id, &now) ||
		    now.generation != k->generation)
			continue;
		k->passport_version = version;
		if (looks_alike(&now, &k->passport))
			continue;
		k->passport = now;
		if ((now.flags & OB_OBJECT_STATIC) != 0 && !k->fixed) { // it was frozen: its pose is sent again
			k->fixed = true;
			k->sent = false;
			k->froze = true;
			f->froze++;
		}
		put_object(out, &f->source, k);
		sent++;
	}
	return sent;
}

bool ob_feed_take_frozen(ob_feed *f, size_t *at, uint32_t *id)
{
	while (f->froze > 0 && *at < f->objects) {
		known *k = &f->object[(*at)++];
		if (!k->froze)
			continue;
		k->froze = false;
		f->froze--;
		*id = k->id;
		return true;
	}
	f->froze = 0; // the rest has been removed
	return false;
}

// ---- messages

static ob_message *begin(const ob_pace_state *pace, double time, bool anew)
{
	ob_message *out = ob_message_new(false);
	if (!out)
		return NULL;
	ob_message_put_u8(out, OB_FEED_MOTIONS);
	ob_message_put_u8(out, (anew ? OB_FEED_VOID : 0) | (pace->paused ? OB_FEED_PAUSED : 0));
	ob_message_put(out, &(uint16_t){ 0 }, 2);
	ob_message_put_f32(out, pace->rate);
	ob_message_put_f64(out, time);
	for (int i = 0; i < 3; i++)
		ob_message_put_u32(out, 0);
	return out;
}

static ob_message *whole_or_none(ob_message *out)
{
	if (!out->failed)
		return out;
	ob_message_release(out);
	return NULL;
}

static uint32_t write_motions(ob_feed *f, ob_message *out, double time)
{
	uint32_t sent = 0, before = UINT32_MAX;
	for (size_t i = 0; i < f->objects; i++) {
		known *k = &f->object[i];
		ob_motion m;
		if ((k->fixed && k->sent) || !f->source.motion(f->source.of, k->id, &m) ||
		    (k->sent && m.t0 == k->seen_t0 && m.step == k->seen_step))
			continue;
		ob_feed_kind kind = kind_of(k, &m, f->source.step_length);
		k->seen_t0 = m.t0;
		k->seen_step = m.step;
		if (!is_news(f, k, &m, kind))
			continue;
		know(k, &m, kind);
		put_motion(out, k, time, &before);
		sent++;
	}
	return sent;
}

ob_message *ob_feed_next(ob_feed *f, const ob_pace_state *pace)
{
	uint64_t number = f->source.number(f->source.of); // before the roster, which may be newer
	double time = f->source.time(f->source.of);
	bool anew = f->lost;
	ob_message *out = begin(pace, time, anew);
	if (!out)
		return NULL;
	if (anew)
		f->objects = 0;
	bool news = anew || number != f->roster_number || time != f->time || pace->paused != f->pace.paused ||
		    pace->rate != f->pace.rate;
	uint32_t objects = 0;
	if ((anew || number != f->roster_number) && !write_roster(f, out, &objects))
		out->failed = true;
	objects += write_looks(f, out);
	uint32_t motions = write_motions(f, out, time);
	ob_message_set_u32(out, CREATED_AT, objects);
	ob_message_set_u32(out, MOTIONS_AT, motions);
	f->lost = out->failed;
	f->roster_number = number;
	f->time = time;
	f->pace = *pace;
	if (news || objects > 0 || motions > 0)
		return whole_or_none(out);
	ob_message_release(out);
	return NULL;
}

ob_message *ob_feed_whole(ob_feed *f, const ob_pace_state *pace)
{
	ob_message *out = begin(pace, f->time, true);
	uint32_t motions = 0, before = UINT32_MAX;
	if (!out)
		return NULL;
	for (size_t i = 0; i < f->objects; i++)
		put_object(out, &f->source, &f->object[i]);
	for (size_t i = 0; i < f->objects; i++) {
		if (!f->object[i].sent)
			continue;
		put_motion(out, &f->object[i], f->time, &before);
		motions++;
	}
	ob_message_set_u32(out, CREATED_AT, (uint32_t)f->objects);
	ob_message_set_u32(out, MOTIONS_AT, motions);
	return whole_or_none(out);
}

// Begins a message beside the motions, with a count to be set.
static ob_message *begin_aside(const ob_feed *f, unsigned first_byte, unsigned flags)
{
	ob_message *out = ob_message_new(false);
	if (!out)
		return NULL;
	ob_message_put_u8(out, first_byte);
	ob_message_put_u8(out, flags);
	ob_message_put(out, &(uint16_t){ 0 }, 2);
	ob_message_put_u32(out, 0);
	ob_message_put_f64(out, f->time);
	return out;
}

ob_message *ob_feed_contacts(ob_feed *f)
{
	size_t n = 0;
	while (f->u && (n = ob_universe_get_contacts(f->u, f->contact, f->contact_room)) > f->contact_room)
		if (!OB_RESERVE(f->contact, n, f->contact_room))
			return NULL;
	ob_message *out = begin_aside(f, OB_FEED_CONTACTS, 0);
	if (!out)
		return NULL;
	ob_message_set_u32(out, COUNT_AT, (uint32_t)n);
	for (size_t i = 0; i < n; i++) {
		put_vec3(out, f->contact[i].position);
		put_vec3(out, f->contact[i].normal);
		ob_message_put_f32(out, f->contact[i].impulse);
	}
	return whole_or_none(out);
}

// Own time, s; NaN: none, as in lockstep.
static double own_time_of(const ob_feed *f, uint32_t id)
{
	double time;
	return f->u && ob_universe_get_own_time(f->u, id, &time) ? time : NAN;
}

static bool runs_free(const ob_feed *f)
{
	size_t i = 0;
	while (i < f->objects && isnan(own_time_of(f, f->object[i].id)))
		i++;
	return i < f->objects;
}

ob_message *ob_feed_simulators(ob_feed *f)
{
	uint32_t sent = 0, before = UINT32_MAX;
	const bool free_run = runs_free(f);
	ob_message *out = begin_aside(f, OB_FEED_SIMULATORS, free_run ? OB_FEED_FREE_RUN : 0);
	if (!out)
		return NULL;
	for (size_t i = 0; i < f->objects; i++) {
		const known *k = &f->object[i];
		uint32_t home;
		ob_motion m;
		if (k->passport.flags & OB_OBJECT_PRESCRIBED || !f->source.motion(f->source.of, k->id, &m))
			continue;
		const bool housed = f->u && ob_universe_get_home(f->u, k->id, &home), rests = m.flags & OB_MOTION_RESTS;
		put_number(out, k->id - before);
		put_number(out, housed ? 1 + home : 0);
		put_number(out, m.flags & OB_MOTION_SWINGS ? k->id : m.island);
		put_number(out, rests ? 0 : m.substeps);
		ob_message_put_u8(out, ob_rest_of(&m));
		if (free_run)
			ob_message_put_f32(out, own_time_of(f, k->id) - f->time);
		before = k->id;
		sent++;
	}
	ob_message_set_u32(out, COUNT_AT, sent);
	return whole_or_none(out);
}

ob_message *ob_feed_joints(ob_feed *f)
{
	const uint32_t joints = f->source.joints(f->source.of);
	uint32_t sent = 0;
	ob_message *out = begin_aside(f, OB_FEED_JOINTS, 0);
	for (uint32_t i = 0; out && i < joints; i++) {
		ob_joint_passport j;
		if (!f->source.joint(f->source.of, i, &j) || j.flags & OB_JOINT_BROKEN)
			continue;
		ob_message_put_u8(out, j.kind);
		ob_message_put_u32(out, j.object[0]);
		ob_message_put_u32(out, j.object[1]);
		for (int side = 0; side < 2; side++) {
			const ob_mat3 axes = ob_quat_matrix(j.frame[side].q);
			put_vec3(out, j.frame[side].p);
			put_vec3(out, ob_column(&axes, 2));
		}
		sent++;
	}
	if (!out)
		return NULL;
	ob_message_set_u32(out, COUNT_AT, sent);
	return whole_or_none(out);
}

ob_message *ob_feed_mesh(const ob_mesh *m, uint32_t number)
{
	ob_message *out = ob_message_new(false);
	if (!out)
		return NULL;
	ob_message_put_u8(out, OB_FEED_MESH);
	ob_message_put_u8(out, number);
	ob_message_put_u8(out, m->parts);
	ob_message_put_u8(out, m->images);
	ob_message_put_u32(out, m->vertices);
	ob_message_put_u32(out, m->indices);
	ob_message_put(out, m->vertex, m->vertices * sizeof *m->vertex);
	ob_message_put(out, m->index, m->indices * sizeof *m->index);
	ob_message_put(out, m->part, m->parts * sizeof *m->part);
	for (uint32_t i = 0; i < m->images; i++) {
		const ob_mesh_image *image = &m->image[i];
		ob_message_put_u32(out, image->width);
		ob_message_put_u32(out, image->height);
		ob_message_put(out, image->rgba, 4 * (size_t)image->width * image->height);
	}
	return whole_or_none(out);
}
