// The reader's side: attaching, and taking nothing on trust. Offsets come from the validated private copy of the
// header; ids, counts and floating-point numbers are checked as they are read.
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "table/layout.h"
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

ob_universe *ob_universe_attach(const char *name, ob_error *e)
{
	char path[OB_SEGMENT_PATH_MAX];
	ob_universe *u = calloc(1, sizeof *u);
	uint64_t bytes = 0;
	if (!u) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	int fd = ob_segment_path(path, name) ? shm_open(path, O_RDONLY | O_CLOEXEC, 0) : -1;
	if (fd < 0)
		ob_fail(e, "no universe \"%.60s\" on this machine", name);
	else if (!ob_segment_peek(path, &u->header, &bytes))
		ob_fail(e, "/dev/shm%s is not a complete universe table", path);
	else if (check_header(&u->header, bytes, name, e)) {
		void *base = mmap(NULL, u->header.bytes, PROT_READ, MAP_SHARED | MAP_NORESERVE, fd, 0);
		close(fd);
		if (base != MAP_FAILED) {
			ob_layout_bind(u, base);
			return u;
		}
		ob_fail(e, "cannot map universe \"%s\": %s", name, strerror(errno));
		free(u);
		return NULL;
	}
	if (fd >= 0)
		close(fd);
	free(u);
	return NULL;
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

void ob_universe_get_info(const ob_universe *u, ob_universe_info *out)
{
	const ob_header *h = &u->header;
	const ob_control *c = u->control;
	*out = (ob_universe_info){
		.host_pid = h->host_pid,
		.capacity = h->sizes.capacity,
		.workers = h->sizes.workers,
		.gravity = h->run.gravity,
		.step_length = h->run.step_length,
		.step = ob_step_count(u),
		.state = (ob_universe_state)least(read32(&c->state), OB_UNIVERSE_FAILED),
		.objects = least(read32(&c->objects), h->sizes.capacity),
		.awake = least(read32(&c->awake), h->sizes.capacity),
		.pairs = least(read32(&c->pairs), h->sizes.pairs_max),
		.islands = least(read32(&c->islands), h->sizes.capacity),
	};
	out->time = (double)out->step * out->step_length;
	memcpy(out->name, h->name, sizeof out->name);
	memcpy(out->isolation, h->isolation, sizeof out->isolation);
	strcpy(out->arch, h->run.monolith ? "monolith" : "obs");
}

bool ob_universe_get_worker(const ob_universe *u, uint32_t worker, ob_worker_info *out)
{
	if (worker >= u->header.sizes.workers)
		return false;
	const ob_worker_cell *w = u->worker + worker;
	out->pid = __atomic_load_n(&w->pid, __ATOMIC_ACQUIRE);
	out->tid = __atomic_load_n(&w->tid, __ATOMIC_RELAXED);
	out->cpu = __atomic_load_n(&w->cpu, __ATOMIC_RELAXED);
	out->objects = least(read32(&w->objects), u->header.sizes.capacity);
	out->cpu_ns = __atomic_load_n(&w->cpu_ns, __ATOMIC_RELAXED);
	return true;
}

static bool finite3(ob_vec3 v)
{
	return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool passport_makes_sense(const ob_passport *p, uint32_t id)
{
	return p->id == id && p->shape <= OB_SHAPE_CYLINDER && finite3(p->size) && finite3(p->inertia) &&
	       finite3(p->force) && isfinite(p->mass) && p->mass >= 0 && isfinite(p->friction) &&
	       isfinite(p->restitution) && memchr(p->name, 0, sizeof p->name);
}

bool ob_universe_get_passport(const ob_universe *u, uint32_t id, ob_passport *out)
{
	if (id >= least(ob_universe_ids(u), u->header.sizes.capacity))
		return false;
	return ob_passport_read(u, id, out) && (out->flags & OB_OBJECT_PRESENT) && passport_makes_sense(out, id);
}

static bool motion_makes_sense(const ob_motion *m)
{
	double norm = m->q.w * m->q.w + m->q.x * m->q.x + m->q.y * m->q.y + m->q.z * m->q.z;
	return isfinite(m->t0) && !isnan(m->valid_until) && finite3(m->p) && finite3(m->v) && finite3(m->w) &&
	       finite3(m->a) && norm > .9 && norm < 1.1;
}

bool ob_universe_get_motion(const ob_universe *u, uint32_t id, ob_motion *out)
{
	if (id >= least(ob_universe_ids(u), u->header.sizes.capacity))
		return false;
	return (read32(&ob_passport_of(u, id)->flags) & OB_OBJECT_PRESENT) && ob_slot_read(u->slot + id, out) &&
	       motion_makes_sense(out);
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
