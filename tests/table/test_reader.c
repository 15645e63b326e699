// Reading a damaged table: a reader may refuse, it may never crash or return nonsense. Also contact points.
#include "../check.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/utf8.h"
#include "table/layout.h"

enum { OBJECTS = 20 };

static char name[OB_NAME_MAX];

static ob_universe *create_filled(void)
{
	ob_error e;
	ob_universe_setup setup = { .name = name, .capacity = OBJECTS, .workers = 2, .isolation = "thread" };
	ob_universe *u = ob_universe_create(&setup, &e);
	for (uint32_t i = 0; u && i < OBJECTS; i++) {
		ob_passport p = { .id = i, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_BOX, .mass = 1 };
		ob_motion m = { .p = { i, 0, 1 }, .q = { 1, 0, 0, 0 } };
		ob_write_passport(u, i, &p);
		ob_publish_motion(u, i, &m);
	}
	return u;
}

static void test_nonsense(void)
{
	ob_universe *u = create_filled();
	ob_motion good = { .q = { 1, 0, 0, 0 } }, m;
	double *field[] = { &m.t0, &m.valid_until, &m.p.x, &m.q.w, &m.q.z, &m.v.y, &m.w.z, &m.a.x };
	for (size_t i = 0; i < sizeof field / sizeof *field; i++) {
		m = good;
		*field[i] = NAN;
		ob_publish_motion(u, 3, &m);
		CHECK(!ob_universe_get_motion(u, 3, &m));
	}
	m = good;
	m.q.w = 2;
	ob_publish_motion(u, 3, &m);
	CHECK(!ob_universe_get_motion(u, 3, &m));
	ob_publish_motion(u, 3, &good);
	CHECK(ob_universe_get_motion(u, 3, &m));
	float *claimed = ob_universe_step_data(u)->bounds[3], bounds[6];
	memcpy(claimed, (float[6]){ -INFINITY, 0, 1, INFINITY, 0, 2 }, sizeof bounds);
	CHECK(ob_universe_get_bounds(u, 3, bounds) && memcmp(bounds, claimed, sizeof bounds) == 0);
	claimed[1] = NAN;
	CHECK(!ob_universe_get_bounds(u, 3, bounds));
	claimed[1] = 1;
	CHECK(!ob_universe_get_bounds(u, 3, bounds) && !ob_universe_get_bounds(u, OBJECTS, bounds));
	ob_passport p = { .id = 4, .flags = OB_OBJECT_PRESENT, .shape = 77 };
	ob_write_passport(u, 3, &p); // another's id, an unknown shape
	CHECK(!ob_universe_get_passport(u, 3, &p));
	ob_universe_destroy(u, true);
}

static void touch(ob_universe *u, uint32_t index, uint32_t a, uint32_t b, uint64_t stamp)
{
	ob_step_data *x = ob_universe_step_data(u);
	x->pair[index] = (ob_pair_key){ .a = a, .b = b, .record = index, .active = 1 };
	ob_pair_record *r = x->record + index;
	ob_pair_state *s = &r->version[(stamp - 1) & 1];
	*s = (ob_pair_state){ .normal = { 0, 0, 1 }, .points = 2, .impulse = { 1, 2 } };
	s->arm_a[0] = ob_v3(.5, 0, -1);
	s->arm_a[1] = ob_v3(-.5, 0, -1);
	r->stamp[(stamp - 1) & 1] = stamp;
	x->count->pairs = index + 1;
}

static void test_contacts(void)
{
	ob_universe *u = create_filled();
	for (int i = 0; i < 5; i++)
		ob_step_complete(u, 0, 0, 0);
	touch(u, 0, 2, 5, 5 + 1); // from the last step
	touch(u, 1, 3, 6, 4 + 1); // out of date: no longer solved
	ob_contact_point c[8];
	CHECK(ob_universe_get_contacts(u, c, 8) == 2);
	CHECK(c[1].a == 2 && c[1].b == 5 && c[1].impulse == 2 && c[1].position.x == 1.5 && c[1].position.z == 0);
	CHECK(ob_universe_get_contacts(u, c, 1) == 2);
	ob_motion asleep = { .flags = OB_MOTION_ASLEEP, .q = { 1, 0, 0, 0 } };
	ob_publish_motion(u, 3, &asleep);
	CHECK(ob_universe_get_contacts(u, c, 8) == 2);
	ob_publish_motion(u, 6, &asleep);
	CHECK(ob_universe_get_contacts(u, c, 8) == 4); // both sleep: their last contact state still holds
	ob_step_data *x = ob_universe_step_data(u);
	x->record[0].version[5 & 1].arm_a[0].x = NAN;
	CHECK(ob_universe_get_contacts(u, c, 8) == 3);
	x->record[0].version[5 & 1].points = 1000;
	CHECK(ob_universe_get_contacts(u, c, 8) <= 2 + OB_PAIR_POINTS);
	x->pair[1].record = UINT32_MAX;
	x->pair[0].b = UINT32_MAX;
	x->count->pairs = UINT32_MAX;
	CHECK(ob_universe_get_contacts(u, c, 8) == 0);
	ob_universe_destroy(u, true);
}

static void read_everything(const ob_universe *r)
{
	ob_universe_info info;
	ob_worker_info w;
	ob_contact_point c[16];
	ob_motion m;
	ob_passport p;
	ob_universe_get_info(r, &info);
	CHECK(info.objects <= OBJECTS && info.state <= OB_UNIVERSE_FAILED && memchr(info.name, 0, sizeof info.name));
	ob_universe_get_contacts(r, c, 16);
	for (uint32_t i = 0; i < OBJECTS + 2; i++) {
		ob_universe_get_worker(r, i, &w);
		if (ob_universe_get_motion(r, i, &m) && !(isfinite(m.p.x) && isfinite(m.q.w)))
			CHECK(!"nonsense was handed on");
		if (ob_universe_get_passport(r, i, &p) && p.shape > OB_SHAPE_CYLINDER)
			CHECK(!"nonsense was handed on");
		char plain[OB_NAME_MAX];
		if (ob_universe_get_passport(r, i, &p)) {
			memcpy(plain, p.name, sizeof plain);
			ob_utf8_make_plain(plain);
			CHECK(strcmp(plain, p.name) == 0);
		}
	}
}

// Writes random bytes at random places, before and after a reader has attached.
static void test_damage(void)
{
	ob_error e;
	srand(1);
	for (int round = 0; round < 200; round++) {
		ob_universe *u = create_filled();
		ob_universe *before = ob_universe_attach(name, &e);
		CHECK(u && before);
		if (!u || !before)
			return;
		size_t start = round % 2 ? OB_LAYOUT_PAGE : 0; // with and without the header
		size_t end = u->header.area[OB_AREA_REQUERY];
		for (int i = 0; i < 3000; i++)
			u->base[start + (size_t)rand() % (end - start)] = (char)(rand() % 3 ? rand() : -1);
		for (size_t i = 0; i < sizeof *u->step_data.count; i++)
			((char *)u->step_data.count)[i] = (char)rand();
		for (size_t i = 0; i < 1000 * sizeof(ob_pair_key); i++)
			((char *)u->step_data.pair)[i] = (char)(rand() % 2 ? 0 : rand());
		read_everything(before);
		ob_universe *after = ob_universe_attach(name, &e);
		if (after)
			read_everything(after);
		ob_universe_detach(after);
		ob_universe_detach(before);
		ob_universe_destroy(u, true);
	}
}

// Files that are no tables.
static void test_strangers(void)
{
	ob_error e;
	char path[64], text[5000] = "not a universe";
	snprintf(path, sizeof path, "/obsim.%s", name);
	size_t lengths[] = { 0, 14, sizeof text };
	for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
		int fd = shm_open(path, O_CREAT | O_RDWR, 0600);
		CHECK(fd >= 0 && write(fd, text, lengths[i]) == (ssize_t)lengths[i]);
		close(fd);
		CHECK(!ob_universe_attach(name, &e) && strstr(e.text, name));
		shm_unlink(path);
	}
	ob_universe *u = create_filled();
	((ob_header *)u->base)->version++;
	CHECK(!ob_universe_attach(name, &e) && strstr(e.text, "layout"));
	((ob_header *)u->base)->version--;
	int fd = shm_open(path, O_RDWR, 0);
	ob_universe_destroy(u, false);
	CHECK(ftruncate(fd, OB_LAYOUT_PAGE) == 0); // shorter than its header says
	close(fd);
	CHECK(!ob_universe_attach(name, &e));
	shm_unlink(path);
}

// A universe truncated between two reads: a reader detects it, reads nothing more of it, and survives.
static void test_cut_short(void)
{
	ob_error e;
	ob_universe_info info;
	ob_worker_info w;
	ob_passport p;
	ob_motion m;
	ob_contact_point c[4];
	float bounds[6];
	for (int pages = 0; pages < 3; pages++) {
		ob_universe *u = create_filled(), *r = ob_universe_attach(name, &e);
		CHECK(r);
		ob_universe_get_info(r, &info);
		CHECK(info.state != OB_UNIVERSE_LOST && ob_universe_get_motion(r, 0, &m));
		CHECK(ftruncate(u->fd, pages * OB_LAYOUT_PAGE) == 0);
		ob_universe_get_info(r, &info);
		CHECK(info.state == OB_UNIVERSE_LOST && strcmp(info.name, name) == 0 && info.objects == 0);
		CHECK(!ob_universe_get_motion(r, 0, &m) && !ob_universe_get_passport(r, 0, &p));
		CHECK(!ob_universe_get_bounds(r, 0, bounds) && !ob_universe_get_worker(r, 0, &w));
		CHECK(ob_universe_get_contacts(r, c, 4) == 0);
		CHECK(ftruncate(u->fd, (off_t)u->header.bytes) == 0); // the removed part does not come back
		ob_universe_get_info(r, &info);
		CHECK(info.state == OB_UNIVERSE_LOST);
		ob_universe_detach(r);
		ob_universe_destroy(u, true);
	}
}

int main(void)
{
	snprintf(name, sizeof name, "test-reader-%d", (int)getpid());
	test_nonsense();
	test_contacts();
	test_damage();
	test_strangers();
	test_cut_short();
	return check_end();
}
