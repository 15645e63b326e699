// Creation, readers, stale segments, and damaged tables.
#include "../check.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "table/layout.h"

static char name[OB_NAME_MAX], file[64];

static ob_universe *create(uint32_t capacity)
{
	ob_error e = { "" };
	ob_universe_setup setup = { .name = name, .capacity = capacity, .workers = 3, .isolation = "thread" };
	setup.run = (ob_run_settings){ .gravity = { 0, 0, -9.81 }, .step_length = .01, .substeps = 4 };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u)
		fprintf(stderr, "%s\n", e.text);
	CHECK(u);
	return u;
}

static ob_motion motion_at(double x)
{
	return (ob_motion){ .valid_until = INFINITY, .p = { x, 2, 3 }, .q = { 1, 0, 0, 0 } };
}

static void put(ob_universe *u, uint32_t id, double x)
{
	ob_passport p = { .id = id, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_BOX, .size = { 1, 1, 1 }, .mass = 2 };
	ob_motion m = motion_at(x);
	ob_write_passport(u, id, &p);
	ob_publish_motion(u, id, &m);
}

static void test_reading(void)
{
	ob_error e;
	ob_universe *u = create(100);
	put(u, 0, 1);
	put(u, 7, 5);
	ob_universe *r = ob_universe_attach(name, &e);
	CHECK(r);
	if (!u || !r)
		return;
	ob_universe_set_state(u, OB_UNIVERSE_RUNNING);
	ob_step_complete(u, 2, 1, 2);
	ob_universe_info info;
	ob_universe_get_info(r, &info);
	CHECK(strcmp(info.name, name) == 0 && strcmp(info.isolation, "thread") == 0 && strcmp(info.arch, "obs") == 0);
	CHECK(info.capacity == 100 && info.workers == 3 && info.objects == 2 && info.host_pid == getpid());
	CHECK(info.state == OB_UNIVERSE_RUNNING && info.step == 1 && info.time == .01 && info.gravity.z == -9.81);
	CHECK(info.awake == 2 && info.pairs == 1 && info.islands == 2 && ob_universe_ids(r) == 8);
	ob_motion m;
	ob_passport p;
	CHECK(ob_universe_get_motion(r, 7, &m) && m.p.x == 5);
	CHECK(ob_universe_get_passport(r, 7, &p) && p.mass == 2);
	CHECK(!ob_universe_get_motion(r, 3, &m) && !ob_universe_get_motion(r, 8, &m));
	CHECK(!ob_universe_get_motion(r, UINT32_MAX, &m) && !ob_universe_get_passport(r, 3, &p));
	for (int i = 0; i < 9; i++) {
		m = motion_at(i);
		ob_publish_motion(u, 7, &m);
		CHECK(ob_newest_motion(u, 7)->p.x == i);
		CHECK(ob_universe_get_motion(r, 7, &m) && m.p.x == i);
	}
	p = (ob_passport){ .id = 7 };
	ob_write_passport(u, 7, &p); // the object is gone
	CHECK(!ob_universe_get_motion(r, 7, &m) && !ob_universe_get_passport(r, 7, &p));
	ob_universe_get_info(r, &info);
	CHECK(info.objects == 1);
	ob_universe_detach(r);
	ob_universe_destroy(u, true);
	CHECK(access(file, F_OK) != 0);
	CHECK(!ob_universe_attach(name, &e) && strstr(e.text, name));
}

static void test_workers(void)
{
	ob_universe *u = create(10);
	ob_worker_info w;
	CHECK(ob_universe_get_worker(u, 2, &w) && w.cpu == -1 && !ob_universe_get_worker(u, 3, &w));
	ob_worker_announce(u, 2, 10, 11, 1);
	ob_worker_set_objects(u, 2, 5);
	ob_worker_set_cpu(u, 2, 99);
	CHECK(ob_universe_get_worker(u, 2, &w) && w.pid == 10 && w.tid == 11 && w.cpu == 1);
	CHECK(w.objects == 5 && w.cpu_ns == 99);
	ob_universe_destroy(u, true);
}

static void test_names(void)
{
	ob_error e;
	ob_universe *u = create(10);
	ob_universe_setup twin = { .name = name, .capacity = 10, .workers = 1, .isolation = "thread" };
	CHECK(!ob_universe_create(&twin, &e) && strstr(e.text, name)); // taken
	CHECK(access(file, F_OK) == 0); // and left alone
	const char *bad[] = { "", "a/b", "..//x", "a b", "0123456789012345678901234567890123456789012345678" };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		twin.name = bad[i];
		CHECK(!ob_universe_create(&twin, &e) && !ob_universe_attach(bad[i], &e));
	}
	twin = (ob_universe_setup){ .name = "none", .capacity = 0, .workers = 1, .isolation = "thread" };
	CHECK(!ob_universe_create(&twin, &e));
	twin.capacity = 1 << 24; // 40 GB: refused, unless this machine has them
	ob_universe *huge = ob_universe_create(&twin, &e);
	CHECK(huge || strstr(e.text, "/dev/shm"));
	ob_universe_destroy(huge, true);
	CHECK(access("/dev/shm/obsim.none", F_OK) != 0);
	twin.capacity = 10;
	twin.workers = 0;
	CHECK(!ob_universe_create(&twin, &e));
	char names[64][OB_NAME_MAX];
	size_t n = ob_universe_list(names, 64), seen = 0;
	for (size_t i = 0; i < n && i < 64; i++)
		seen += strcmp(names[i], name) == 0;
	CHECK(seen == 1 && ob_universe_list(NULL, 0) >= 1);
	ob_universe_destroy(u, true);
}

// A host that dies without cleaning up leaves its segment; the next creation, by any name, removes it.
static void test_stale(void)
{
	ob_error e;
	pid_t pid = fork();
	if (pid == 0)
		_exit(create(10) == NULL || access(file, F_OK) != 0);
	int status;
	waitpid(pid, &status, 0);
	CHECK(status == 0); // the file may be gone already, if another program made a universe just now
	char names[64][OB_NAME_MAX];
	size_t n = ob_universe_list(names, 64);
	for (size_t i = 0; i < n && i < 64; i++)
		CHECK(strcmp(names[i], name) != 0);
	ob_universe_setup other = { .capacity = 10, .workers = 1, .isolation = "thread" };
	ob_universe *u = ob_universe_create(&other, &e);
	CHECK(u && access(file, F_OK) != 0);
	char own[OB_NAME_MAX];
	snprintf(own, sizeof own, "obsim-%d", (int)getpid());
	CHECK(u && strcmp(ob_universe_name(u), own) == 0);
	ob_universe_destroy(u, true);
}

// Capacity costs address space, not memory: 100,000 objects, none of them present.
static void test_sparse(void)
{
	ob_universe *u = create(100000);
	struct stat s = { 0 };
	CHECK(stat(file, &s) == 0);
	CHECK(s.st_size > 1000000000 && s.st_blocks * 512 < 1 << 20);
	ob_step_data *x = u ? ob_universe_step_data(u) : NULL;
	CHECK(x && x->objects_max == 100000 && x->pairs_max == 12800000 && x->buckets == 262144);
	if (x) { // the far ends are there, and apart
		x->record[x->pairs_max - 1].stamp[1] = 1;
		x->neighbour_id[x->neighbours_max - 1] = 2;
		x->scratch[4 * x->objects_max - 1] = 3;
		x->chunk[x->objects_max] = 5;
		CHECK(x->record[x->pairs_max - 1].stamp[1] == 1 && x->neighbour_id[x->neighbours_max - 1] == 2);
		CHECK(x->scratch[4 * x->objects_max - 1] == 3);
	}
	ob_universe_destroy(u, true);
}

// A child forked after creation publishes through the same handle.
static void test_fork(void)
{
	ob_universe *u = create(10);
	put(u, 1, 1);
	pid_t pid = fork();
	if (pid == 0) {
		ob_motion m = motion_at(42);
		ob_publish_motion(u, 1, &m);
		_exit(0);
	}
	waitpid(pid, NULL, 0);
	ob_motion m;
	CHECK(ob_universe_get_motion(u, 1, &m) && m.p.x == 42);
	ob_universe_destroy(u, true);
}

int main(void)
{
	snprintf(name, sizeof name, "test-universe-%d", (int)getpid());
	snprintf(file, sizeof file, "/dev/shm/obsim.%s", name);
	test_reading();
	test_workers();
	test_names();
	test_stale();
	test_sparse();
	test_fork();
	return check_end();
}
