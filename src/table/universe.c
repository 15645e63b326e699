#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include "table/layout.h"
#include "table/segment.h"

static int open_new(const char *path, const char *name, ob_error *e)
{
	int fd = shm_open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (fd < 0 && errno == EEXIST)
		ob_fail(e, "universe \"%s\" already runs on this machine; give this one another name", name);
	else if (fd < 0)
		ob_fail(e, "cannot create shared memory /dev/shm%s: %s", path, strerror(errno));
	return fd;
}

// A full memory file system would end the run with SIGBUS in the middle of a step: better not to begin.
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

static void *map_new(int fd, const ob_header *h, ob_error *e)
{
	uint64_t bytes = h->bytes;
	if (!check_room(fd, ob_layout_likely_bytes(h), e))
		return NULL;
	if (ftruncate(fd, (off_t)bytes) != 0) {
		ob_fail(e, "cannot give shared memory %" PRIu64 " bytes: %s", bytes, strerror(errno));
		return NULL;
	}
	void *base = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, fd, 0);
	if (base != MAP_FAILED)
		return base;
	ob_fail(e, "cannot map %" PRIu64 " bytes of shared memory: %s", bytes, strerror(errno));
	return NULL;
}

static void fill_header(ob_header *h, const ob_universe_setup *setup, const char *name)
{
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	ob_layout_plan(h, setup->capacity, setup->workers, setup->traced);
	h->version = OB_LAYOUT_VERSION;
	h->host_pid = getpid();
	h->host_start = ob_segment_process_start(h->host_pid);
	h->created = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
	snprintf(h->name, sizeof h->name, "%s", name);
	snprintf(h->isolation, sizeof h->isolation, "%s", setup->isolation);
	h->run = setup->run;
}

ob_universe *ob_universe_create(const ob_universe_setup *setup, ob_error *e)
{
	char own[OB_NAME_MAX], path[OB_SEGMENT_PATH_MAX];
	snprintf(own, sizeof own, "obsim-%d", (int)getpid());
	const char *name = setup->name ? setup->name : own;
	if (!ob_segment_path(path, name)) {
		ob_fail(e, "\"%.60s\" cannot be a universe's name: 1 to %d of A-Z a-z 0-9 . _ -", name,
			OB_NAME_MAX - 1);
		return NULL;
	}
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
	int fd = open_new(path, name, e);
	void *base = fd < 0 ? NULL : map_new(fd, &u->header, e);
	if (fd >= 0)
		close(fd);
	if (!base) {
		if (fd >= 0)
			shm_unlink(path);
		free(u);
		return NULL;
	}
	ob_layout_bind(u, base);
	ob_gate_prepare(u->gate, setup->workers);
	for (uint32_t i = 0; i < setup->workers; i++)
		u->worker[i].cpu = -1;
	ob_header *shared = base;
	memcpy((char *)shared + sizeof shared->magic, (char *)&u->header + sizeof shared->magic,
	       sizeof *shared - sizeof shared->magic);
	__atomic_store_n(&shared->magic, OB_LAYOUT_MAGIC, __ATOMIC_RELEASE); // from now on readers may attach
	return u;
}

void ob_universe_destroy(ob_universe *u, bool unlink)
{
	if (!u)
		return;
	if (unlink)
		ob_universe_unlink(u->header.name);
	munmap(u->base, u->header.bytes);
	free(u);
}

void ob_universe_unlink(const char *name)
{
	// shm_unlink is not among the functions that POSIX lets a signal handler call; unlink is
	static const char folder[] = "/dev/shm/obsim.";
	char path[sizeof folder + OB_NAME_MAX];
	size_t n = strnlen(name, OB_NAME_MAX - 1);
	memcpy(path, folder, sizeof folder - 1);
	memcpy(path + sizeof folder - 1, name, n);
	path[sizeof folder - 1 + n] = 0;
	unlink(path);
}

const ob_run_settings *ob_universe_settings(const ob_universe *u)
{
	return &u->header.run;
}
uint32_t ob_universe_capacity(const ob_universe *u)
{
	return u->header.sizes.capacity;
}
uint32_t ob_universe_workers(const ob_universe *u)
{
	return u->header.sizes.workers;
}
const char *ob_universe_name(const ob_universe *u)
{
	return u->header.name;
}
ob_step_data *ob_universe_step_data(const ob_universe *u)
{
	return (ob_step_data *)&u->step_data;
}

void ob_universe_set_state(ob_universe *u, ob_universe_state s)
{
	__atomic_store_n(&u->control->state, s, __ATOMIC_RELEASE);
}

uint32_t ob_universe_ids(const ob_universe *u)
{
	return __atomic_load_n(&u->control->ids, __ATOMIC_ACQUIRE);
}
