// A universe, made and ended by its owner.
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include "table/desk.h"
#include "table/layout.h"
#include "table/pages.h"
#include "table/segment.h"

// Checks free space before the start: a full memory file system would end the run with SIGBUS in the middle of a step.
static bool check_room(int fd, uint64_t needed, ob_error *e)
{
	struct statvfs s;
	if (fstatvfs(fd, &s) != 0 || s.f_blocks == 0) // 0 = no limit
		return true;
	uint64_t room = (uint64_t)s.f_bavail * s.f_frsize;
	if (room >= needed)
		return true;
	return ob_fail(e,
		       "/dev/shm has %" PRIu64 " MiB free, this universe needs about %" PRIu64
		       ": enlarge it (mount -o remount,size=..., docker run --shm-size=...) or take fewer objects",
		       room >> 20, (needed >> 20) + 1);
}

static void fill_header(ob_header *h, const ob_universe_setup *setup, const char *name)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	ob_layout_plan(h, &(ob_layout_plan_of){
				  setup->capacity, setup->workers, setup->hulls, setup->traced,
				  setup->harden & 1 << OB_HARDEN_OUTBOX, setup->script_cells, setup->script_bytes,
				  setup->history,
				  setup->free && setup->free->coupling == OB_COUPLING_GROUP ? OB_GROUP_CONTACTS : 0,
				  setup->joints, setup->terrains ? (uint32_t)setup->terrains->bytes : 0, setup->sensors,
				  setup->sensor_values });
	h->version = OB_LAYOUT_VERSION;
	h->host_pid = getpid();
	h->created = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
	snprintf(h->name, sizeof h->name, "%s", name);
	snprintf(h->isolation, sizeof h->isolation, "%s", setup->isolation);
	h->run = setup->run;
	h->harden = setup->harden;
	h->checked = setup->checked;
}

// Initialises the segment before other processes can find it.
static bool fill(ob_universe *u, const ob_universe_setup *setup, ob_error *e)
{
	uint32_t workers = u->header.sizes.workers;
	if (!ob_pages_take_first(u))
		return ob_fail(e, "/dev/shm is full: no room for a universe of %u workers", workers);
	ob_gate_prepare(u->gate, workers);
	for (uint32_t i = 0; i < workers; i++)
		u->worker[i].cpu = -1;
	if (!ob_pages_take(u, OB_AREA_SCRIPT_TEXT, 0, u->header.sizes.script_bytes))
		return ob_fail(e, "/dev/shm is full: no room for the scene's scripts");
	if (setup->script_bytes)
		memcpy(u->base + u->header.area[OB_AREA_SCRIPT_TEXT], setup->script_text, setup->script_bytes);
	if (!ob_pages_take(u, OB_AREA_TERRAIN, 0, u->header.sizes.terrain_bytes))
		return ob_fail(e, "/dev/shm is full: no room for the scene's terrain");
	if (setup->terrains)
		memcpy(u->base + u->header.area[OB_AREA_TERRAIN], setup->terrains, setup->terrains->bytes);
	if (setup->history)
		u->free.control->settings = *setup->free;
	memcpy(u->base, &u->header, sizeof u->header);
	return true;
}

static bool map_new(ob_universe *u, ob_error *e)
{
	uint64_t bytes = u->header.bytes;
	if (u->fd >= 0 && !check_room(u->fd, ob_layout_likely_bytes(&u->header), e))
		return false;
	if (u->fd >= 0 && ftruncate(u->fd, (off_t)bytes) != 0)
		return ob_fail(e, "cannot give shared memory %" PRIu64 " bytes: %s", bytes, strerror(errno));
	void *base = mmap(NULL, bytes, PROT_READ | PROT_WRITE,
			  (u->fd < 0 ? MAP_PRIVATE | MAP_ANONYMOUS : MAP_SHARED) | MAP_NORESERVE, u->fd, 0);
	if (base == MAP_FAILED)
		return ob_fail(e, "cannot map %" PRIu64 " bytes of shared memory: %s", bytes, strerror(errno));
	ob_layout_bind(u, base);
	u->taken = calloc(bytes / OB_LAYOUT_PAGE / 64 + 1, sizeof *u->taken);
	u->used = ob_pages_create_used();
	if (!u->taken || !u->used)
		return ob_fail(e, "out of memory");
	return true;
}

ob_universe *ob_universe_create(const ob_universe_setup *setup, ob_error *e)
{
	char own[OB_NAME_MAX];
	snprintf(own, sizeof own, "obsim-%d", (int)getpid());
	const char *name = setup->name ? setup->name : own;
	const bool shared = !setup->unshared;
	if (shared)
		ob_segment_remove_stale();
	ob_universe *u = calloc(1, sizeof *u);
	if (!u) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	fill_header(&u->header, setup, name);
	u->header.magic = OB_LAYOUT_MAGIC;
	if (!ob_layout_valid(&u->header, u->header.bytes)) {
		ob_fail(e, "no universe has %u objects and %u workers", setup->capacity, setup->workers);
		free(u);
		return NULL;
	}
	u->rank = setup->rank;
	u->ranks = setup->ranks ? setup->ranks : 1;
	u->shares_contacts = setup->shares_contacts;
	u->unshared = setup->unshared;
	u->fd = shared ? ob_segment_create(e) : -1;
	const uint32_t foreign = setup->script_bytes ? ob_script_count_foreign(setup->script_text, UINT32_MAX) : 0;
	if ((!shared || u->fd >= 0) && map_new(u, e) && fill(u, setup, e) && ob_desks_create(u, foreign, e) &&
	    (!shared || ob_segment_publish(u->fd, name, e))) {
		if (shared)
			ob_pages_track(u);
		return u;
	}
	ob_universe_destroy(u, false);
	return NULL;
}

void ob_universe_destroy(ob_universe *u, bool unlink)
{
	if (!u)
		return;
	if (unlink)
		ob_universe_unlink(u);
	ob_pages_forget(u);
	ob_desks_destroy(u);
	if (u->base)
		munmap(u->base, u->header.bytes);
	if (u->fd >= 0)
		close(u->fd);
	free(u->taken);
	ob_pages_destroy_used(u->used);
	free(u);
}

void ob_universe_unlink(const ob_universe *u)
{
	ob_segment_unlink(u->fd, u->header.name);
}

int ob_universe_fd(const ob_universe *u)
{
	return u->fd;
}

void ob_universe_move_fd(ob_universe *u, int fd)
{
	u->fd = fd;
}
