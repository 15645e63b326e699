// The reader's side: attaching, and reading. No data in the table is trusted: offsets come from the validated private
// copy of the header; ids, counts and floating-point numbers are checked as they are read.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/utf8.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "table/futex.h"
#include "table/layout.h"
#include "table/pages.h"
#include "table/segment.h"

static bool check_header(const ob_header *h, uint64_t bytes, const char *name, ob_error *e)
{
	if (ob_layout_valid(h, bytes))
		return true;
	if (h->magic == OB_LAYOUT_MAGIC && h->version != OB_LAYOUT_VERSION)
		return ob_fail(
			e, "universe \"%s\" has table layout %u, this program reads %d: use the same obsim for both",
			name, h->version, OB_LAYOUT_VERSION);
	return ob_fail(e, "/dev/shm/obsim.%s is not a complete universe table", name);
}

static bool map_segment(ob_universe *u, const char *name, ob_error *e)
{
	uint64_t bytes;
	if (!ob_segment_peek(u->fd, &u->header, &bytes))
		return ob_fail(e, "/dev/shm/obsim.%s is not a complete universe table", name);
	if (!check_header(&u->header, bytes, name, e))
		return false;
	void *base = mmap(NULL, u->header.bytes, PROT_READ, MAP_SHARED | MAP_NORESERVE, u->fd, 0);
	if (base == MAP_FAILED)
		return ob_fail(e, "cannot map universe \"%s\": %s", name, strerror(errno));
	ob_layout_bind(u, base);
	ob_pages_track(u);
	return true;
}

ob_universe *ob_universe_attach(const char *name, ob_error *e)
{
	ob_universe *u = calloc(1, sizeof *u);
	if (!u) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	errno = 0;
	u->fd = ob_segment_open(name);
	if (u->fd >= 0        ? map_segment(u, name, e)
	    : errno == EACCES ? ob_fail(e, "universe \"%.60s\" belongs to another user", name)
			      : ob_fail(e, "no universe \"%.60s\" on this machine", name)) {
		ob_segment_read(u->fd);
		return u;
	}
	ob_universe_destroy(u, false);
	return NULL;
}

bool ob_universe_is_hosted(const ob_universe *u)
{
	return ob_segment_is_owned(u->fd);
}

void ob_universe_detach(ob_universe *u)
{
	ob_universe_destroy(u, false);
}

static uint32_t read32(const void *word)
{
	return __atomic_load_n((const uint32_t *)word, __ATOMIC_RELAXED);
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

// True if an attached universe's segment was found truncated. Functions below do not touch it then.
static bool is_lost(const ob_universe *u)
{
	return __atomic_load_n(&u->lost, __ATOMIC_RELAXED);
}

static bool look_for_loss(const ob_universe *u)
{
	struct stat s;
	const bool attached = !u->taken;
	if (attached && !is_lost(u) && (fstat(u->fd, &s) != 0 || (uint64_t)s.st_size < u->header.bytes))
		__atomic_store_n(&((ob_universe *)u)->lost, true, __ATOMIC_RELAXED);
	return is_lost(u);
}

void ob_universe_get_info(const ob_universe *u, ob_universe_info *out)
{
	static const ob_control nothing;
	const ob_header *h = &u->header;
	const bool lost = look_for_loss(u);
	const ob_control *c = lost ? &nothing : u->control;
	*out = (ob_universe_info){
		.host_pid = h->host_pid,
		.capacity = h->sizes.capacity,
		.workers = h->sizes.workers,
		.gravity = h->run.gravity,
		.step_length = h->run.step_length,
		.step = lost ? 0 : ob_step_count(u),
		.state = lost ? OB_UNIVERSE_LOST : (ob_universe_state)least(read32(&c->state), OB_UNIVERSE_FAILED),
		.objects = least(read32(&c->objects), h->sizes.capacity),
		.awake = least(read32(&c->awake), h->sizes.capacity),
		.pairs = least(read32(&c->pairs), h->sizes.pairs_max),
		.islands = least(read32(&c->islands), h->sizes.capacity),
		.deaths = read32(&c->deaths),
		.frozen = read32(&c->frozen),
		.hulls = least(read32(&c->hulls), h->sizes.hulls),
		.created = h->created,
	};
	for (size_t i = 0; i + 1 < sizeof out->last_death; i++)
		out->last_death[i] = __atomic_load_n(&c->last_death[i], __ATOMIC_RELAXED);
	ob_utf8_make_plain(out->last_death);
	out->time = (double)out->step * out->step_length;
	memcpy(out->name, h->name, sizeof out->name);
	memcpy(out->isolation, h->isolation, sizeof out->isolation);
	ob_utf8_make_plain(out->name);
	ob_utf8_make_plain(out->isolation);
	strcpy(out->arch, h->run.monolith ? "monolith" : "obs");
}

static int64_t monotonic_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

// The host's word moves when the universe pauses, and wakes all that wait for it. A reader cannot tell one pause from the
// next by the word, and steps on the way move no word: hence it looks every millisecond, too.
bool ob_universe_wait(const ob_universe *u, uint64_t step, double timeout)
{
	enum { LOOK_NS = 1000000, LOOKS_PER_STATE = 64 };
	const int64_t end = monotonic_ns() + (int64_t)(fmin(timeout, 1e9) * 1e9);
	ob_universe_info info;
	for (unsigned look = 0;; look++) {
		const uint32_t seen = is_lost(u) ? 0 : __atomic_load_n(&u->gate->host_turn, __ATOMIC_ACQUIRE);
		if (!is_lost(u) && ob_step_count(u) >= step)
			return true;
		const int64_t now = monotonic_ns(), until = now + LOOK_NS < end ? now + LOOK_NS : end;
		if (now >= end)
			return false;
		if (look % LOOKS_PER_STATE == 0) {
			ob_universe_get_info(u, &info);
			if (info.state > OB_UNIVERSE_RUNNING || !ob_universe_is_hosted(u))
				return !is_lost(u) && ob_step_count(u) >= step;
		}
		ob_futex_wait(&u->gate->host_turn, seen, FUTEX_BITSET_MATCH_ANY,
			      &(struct timespec){ until / 1000000000, until % 1000000000 });
	}
}

bool ob_universe_get_worker(const ob_universe *u, uint32_t worker, ob_worker_info *out)
{
	if (is_lost(u) || worker >= u->header.sizes.workers)
		return false;
	const ob_worker_cell *w = u->worker + worker;
	out->pid = __atomic_load_n(&w->pid, __ATOMIC_ACQUIRE);
	out->tid = __atomic_load_n(&w->tid, __ATOMIC_RELAXED);
	out->cpu = __atomic_load_n(&w->cpu, __ATOMIC_RELAXED);
	out->objects = least(read32(&w->objects), u->header.sizes.capacity);
	out->cpu_ns = __atomic_load_n(&w->cpu_ns, __ATOMIC_RELAXED);
	return true;
}

bool ob_universe_get_home(const ob_universe *u, uint32_t id, uint32_t *worker)
{
	ob_passport p;
	if (!ob_universe_get_passport(u, id, &p) ||
	    p.flags & (OB_OBJECT_STATIC | OB_OBJECT_KINEMATIC | OB_OBJECT_FROZEN))
		return false;
	*worker = u->header.run.monolith ? 0 : u->header.run.one_per_object ? id : read32(&u->step_data.home[id]) - 1;
	return *worker < u->header.sizes.workers;
}

bool ob_universe_get_own_time(const ob_universe *u, uint32_t id, double *time)
{
	if (is_lost(u) || !ob_free_settings_of(u) || id >= u->header.sizes.capacity ||
	    ob_free_kind_of(u, id, NULL) != OB_FREE_SIMULATED)
		return false;
	*time = ob_free_time(u, id);
	return isfinite(*time);
}

// Copies plain data word by word: at least each word is whole.
static void copy_words(void *to, const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		((ob_word *)to)[i] = __atomic_load_n((const ob_word *)from + i, __ATOMIC_RELAXED);
}

bool ob_passport_makes_sense(const ob_passport *p, uint32_t id)
{
	return p->id == id && p->shape < OB_SHAPE_KINDS && ob_is_finite(p->size) && ob_is_finite(p->inertia) &&
	       ob_is_finite(p->force) && isfinite(p->mass) && p->mass >= 0 && isfinite(p->friction) &&
	       isfinite(p->restitution) && memchr(p->name, 0, sizeof p->name);
}

bool ob_universe_get_passport(const ob_universe *u, uint32_t id, ob_passport *out)
{
	ob_passport p;
	if (is_lost(u) || id >= least(ob_universe_ids(u), u->header.sizes.capacity))
		return false;
	if (!ob_passport_read(u, id, &p) || !(p.flags & OB_OBJECT_PRESENT) || !ob_passport_makes_sense(&p, id) ||
	    (ob_shape_is(p.shape, OB_HULLED) && p.hull >= u->header.sizes.hulls))
		return false;
	*out = p; // never implausible data: a snapshot treats it as present
	ob_utf8_make_plain(out->name); // so that no name can act as a terminal command
	return true;
}

uint64_t ob_universe_get_passport_version(const ob_universe *u, uint32_t id)
{
	if (is_lost(u) || id >= least(ob_universe_ids(u), u->header.sizes.capacity))
		return 0;
	return __atomic_load_n(&u->passport[id].version, __ATOMIC_ACQUIRE);
}

// Hulls are written before any body properties refer to them, and never again: an inconsistent copy comes from damage,
// and is rejected.
bool ob_universe_get_hull(const ob_universe *u, uint32_t hull, ob_hull *out)
{
	if (hull >= u->header.sizes.hulls)
		return false;
	copy_words(out, &u->hull[hull], sizeof *out);
	return ob_hull_makes_sense(out);
}

size_t ob_universe_get_terrains(const ob_universe *u, void *to, size_t room)
{
	const size_t bytes = u->header.sizes.terrain_bytes, copied = bytes < room ? bytes : room;
	if (copied)
		memcpy(to, u->terrains, copied);
	return bytes;
}

bool ob_motion_makes_sense(const ob_motion *m)
{
	double norm = m->q.w * m->q.w + m->q.x * m->q.x + m->q.y * m->q.y + m->q.z * m->q.z;
	return isfinite(m->t0) && !isnan(m->valid_until) && ob_is_finite(m->p) && ob_is_finite(m->v) &&
	       ob_is_finite(m->w) && ob_is_finite(m->a) && norm > .9 && norm < 1.1 &&
	       (!(m->flags & OB_MOTION_SWINGS) || (m->frequency > 0 && isfinite(m->frequency)));
}

static bool read_motion(const ob_universe *u, uint32_t id, ob_motion *out)
{
	return (read32(&ob_passport_of(u, id)->flags) & OB_OBJECT_PRESENT) && ob_slot_read(u->slot + id, out) &&
	       ob_motion_makes_sense(out);
}

bool ob_universe_get_motion(const ob_universe *u, uint32_t id, ob_motion *out)
{
	return !is_lost(u) && id < least(ob_universe_ids(u), u->header.sizes.capacity) && read_motion(u, id, out);
}

static void put3(double *array, size_t row, ob_vec3 v)
{
	array[3 * row] = v.x, array[3 * row + 1] = v.y, array[3 * row + 2] = v.z;
}

static void put_turn(const ob_state_arrays *out, size_t row, ob_quat q, ob_vec3 w)
{
	if (out->angular_velocity)
		put3(out->angular_velocity, row, w);
	if (out->attitude)
		memcpy(&out->attitude[4 * row], (double[4]){ q.w, q.x, q.y, q.z }, 4 * sizeof(double));
}

static void put_turns(const ob_state_arrays *out, ob_turns *t)
{
	ob_quat q[OB_TURNS];
	ob_vec3 w[OB_TURNS];
	const int n = ob_turns_find(t, q, w);
	for (int i = 0; i < n; i++)
		put_turn(out, t->row[i], q[i], w[i]);
}

// The attitude at time t, as ob_rotate_free has it: now, or with others.
static void turn(const ob_state_arrays *out, size_t row, const ob_passport *p, const ob_motion *m, double t,
		 ob_turns *all)
{
	if (!(t > m->t0) || ob_norm2(m->w) == 0)
		put_turn(out, row, m->q, m->w);
	else if (ob_turns_add(all, row, m, p, t))
		put_turns(out, all);
}

static bool read_body(const ob_universe *u, uint32_t id, ob_passport *out)
{
	return ob_passport_read_body(u, id, out) && out->id == id && out->flags & OB_OBJECT_PRESENT &&
	       ob_is_finite(out->inertia);
}

size_t ob_universe_get_states(const ob_universe *u, const ob_state_arrays *out, size_t max)
{
	ob_universe_info info;
	ob_passport p;
	ob_motion m;
	ob_turns all;
	size_t n = 0;
	const bool turns = out->attitude || out->angular_velocity, body = turns || out->generation;
	ob_universe_get_info(u, &info);
	const uint32_t ids = info.state == OB_UNIVERSE_LOST ? 0 : least(ob_universe_ids(u), info.capacity);
	all.n = 0;
	for (uint32_t id = 0; id < ids; id++) {
		if (!read_motion(u, id, &m) || (body && !read_body(u, id, &p)))
			continue;
		const double t = fmax(info.time, m.t0);
		const size_t row = n++;
		if (row >= max)
			continue;
		if (out->id)
			out->id[row] = id;
		if (out->generation)
			out->generation[row] = p.generation;
		if (out->position)
			put3(out->position, row, ob_centre_at(&m, t));
		if (out->velocity)
			put3(out->velocity, row, ob_velocity_at(&m, t));
		if (turns)
			turn(out, row, &p, &m, t, &all);
	}
	put_turns(out, &all);
	return n;
}

bool ob_universe_get_bounds(const ob_universe *u, uint32_t id, float bounds[6])
{
	ob_passport p;
	bool sense = ob_universe_get_passport(u, id, &p);
	for (int i = 0; i < 6 && sense; i++)
		__atomic_load(&u->step_data.bounds[id][i], &bounds[i], __ATOMIC_RELAXED);
	for (int i = 0; i < 3 && sense; i++)
		sense = bounds[i] <= bounds[i + 3]; // false for NaN
	return sense;
}

// ---- contact points, from the pair records of the last completed step
//
// While the universe runs, a worker may rewrite the list of pairs at the same time: every value is checked, and a copy
// overtaken by the next step is read again. While the universe is paused, the result is exact.

enum { CONTACT_TRIES = 4 };

// Version that holds after "step": with that stamp, or, if both objects sleep, the newest stamp before it.
static bool newest_version(const ob_universe *u, const ob_pair_key *key, uint64_t step, ob_pair_state *out)
{
	const ob_pair_record *r = u->step_data.record + key->record;
	_Alignas(ob_word) uint32_t stamp[2];
	copy_words(stamp, r->stamp, sizeof stamp);
	unsigned newest = stamp[1] == step + 1;
	if (stamp[newest] != step + 1) {
		ob_motion a, b;
		if (!ob_universe_get_motion(u, key->a, &a) || !ob_universe_get_motion(u, key->b, &b))
			return false;
		ob_passport pa, pb;
		bool rest_a = a.flags & OB_MOTION_RESTS ||
			      (ob_universe_get_passport(u, key->a, &pa) && pa.flags & OB_OBJECT_STATIC);
		bool rest_b = b.flags & OB_MOTION_RESTS ||
			      (ob_universe_get_passport(u, key->b, &pb) && pb.flags & OB_OBJECT_STATIC);
		newest = stamp[1] > stamp[0];
		if (!rest_a || !rest_b || stamp[newest] == 0 || stamp[newest] > step + 1)
			return false;
	}
	copy_words(out, &r->version[newest], sizeof *out);
	return true;
}

static bool point_makes_sense(const ob_contact_point *c)
{
	double n2 = ob_norm2(c->normal);
	return ob_is_finite(c->position) && n2 > .9 && n2 < 1.1 && isfinite(c->impulse);
}

// Copies of all touching pairs, sorted by ids: their places depend on the run, and change after a restart from a file.
// The caller frees; NULL: none, or out of memory.
static ob_pair_key *touching_pairs(const ob_step_data *x, size_t *n)
{
	const uint32_t end = __atomic_load_n(&x->count->pairs, __ATOMIC_RELAXED);
	ob_pair_key *out = NULL;
	size_t room = 0;
	*n = 0;
	for (uint32_t i = 0; i < end && i < x->pairs_max; i++) {
		ob_pair_key key;
		copy_words(&key, x->pair + i, sizeof key);
		if (!key.active || key.a >= key.b || key.b >= x->objects_max || key.record >= x->pairs_max)
			continue;
		if (!OB_MAKE_ROOM(out, *n, room))
			break;
		out[(*n)++] = key;
	}
	if (*n)
		qsort(out, *n, sizeof *out, ob_pairs_by_ids);
	return out;
}

static size_t collect_points(const ob_universe *u, uint64_t step, ob_contact_point *out, size_t max)
{
	size_t pairs, n = 0;
	ob_pair_key *pair = touching_pairs(&u->step_data, &pairs);
	for (size_t i = 0; i < pairs; i++) {
		const ob_pair_key *key = &pair[i];
		ob_pair_state state;
		ob_motion a;
		if (!newest_version(u, key, step, &state) || !ob_universe_get_motion(u, key->a, &a))
			continue;
		for (uint32_t k = 0; k < state.points && k < OB_PAIR_POINTS; k++) {
			ob_contact_point c = { key->a, key->b, ob_add(a.p, state.arm_a[k]), state.normal,
					       state.impulse[k] };
			if (!point_makes_sense(&c))
				continue;
			if (n < max)
				out[n] = c;
			n++;
		}
	}
	free(pair);
	return n;
}

size_t ob_universe_get_contacts(const ob_universe *u, ob_contact_point *out, size_t max)
{
	size_t n = 0;
	for (int i = 0; i < CONTACT_TRIES && !is_lost(u); i++) {
		uint64_t step = ob_step_count(u);
		n = collect_points(u, step, out, max);
		if (ob_step_count(u) == step)
			break;
	}
	return n;
}
