// An object belongs to the connection that has created it, whether the run goes on, is resumed from a file, or is put back. An
// object of a program's command belongs to none in a file. Viewers hold what they hold, also when the run is put back.
#include "asking.h"
#include "check.h"

#include "checkpoint/saved_run.h"
#include "host/host_state.h"

static const char text[] = "scene { duration = 2, step = .01 }\nground {}\n"
			   "script('a', 'function on_start() self:wake(9) end')\n"
			   "box { size = { .3, .2, .4 }, at = { 0, 0, .4 } }\n"
			   "sphere { name = 'guest', avatar = true, radius = .2, at = { 2, 0, .4 }, script = 'a' }\n";
enum { BOX = 1, AVATAR, OWN, OF_PROGRAM, OBJECTS, VISITOR = 7 };

static const uint32_t origin[OBJECTS] = { [AVATAR] = VISITOR, [OWN] = VISITOR };

static ob_host *start(const ob_scene *s, const ob_run_settings *run, ob_isolation isolation, const ob_saved_host *from)
{
	ob_error e = { "" };
	const ob_host_config c = {
		.isolation = isolation, .workers = 2, .run = *run, .spare = 9, .returns = true, .from = from
	};
	ob_host *h = ob_host_start(s, &c, &e);
	CHECK(h);
	return h;
}

static void go(ob_host *h, uint64_t steps)
{
	ob_error e = { "" };
	ob_host_go(h, ob_step_count(h->u) + steps);
	CHECK(ob_host_wait(h, &e));
}

static ob_request ball_of(uint32_t who, double x)
{
	ob_request r = { .kind = OB_REQUEST_ADD, .origin = who, .def.dies = INFINITY };
	r.def.passport = (ob_passport){ .shape = OB_SHAPE_SPHERE, .size = { .x = .1 }, .mass = 1 };
	r.def.state.pose = (ob_pose){ ob_v3(x, 1, .1), ob_quat_identity() };
	return r;
}

static void check_owners(const ob_host *h, const uint32_t expected[OBJECTS])
{
	ob_roster_entry entry;
	for (uint32_t id = 0; id < OBJECTS; id++) {
		CHECK(ob_roster_find(ob_host_roster(h), id, &entry));
		CHECK(entry.origin == expected[id] && ob_is_avatar(&entry) == (id == AVATAR));
	}
}

// Pulls that act, of anyone.
static uint32_t pulls_of(ob_host *h)
{
	ob_saved_host saved = { 0 };
	CHECK(ob_host_count_saved(h, &saved));
	return saved.population.pulls;
}

// leaves: the visitor lets go before the run is put back.
static void put_back(ob_host *h, bool leaves)
{
	ask(h, (ob_request){ .kind = OB_REQUEST_KEEP });
	CHECK(!ob_host_operate(h));
	go(h, 3);
	ask(h, (ob_request){ .kind = OB_REQUEST_REMOVE, .id = OWN });
	if (leaves)
		ask(h, (ob_request){ .kind = OB_REQUEST_RELEASE, .id = UINT32_MAX, .origin = VISITOR });
	go(h, 3);
	ask(h, (ob_request){ .kind = OB_REQUEST_RETURN });
	CHECK(ob_host_operate(h));
}

int main(void)
{
	const uint32_t before[OBJECTS] = { [AVATAR] = VISITOR, [OWN] = VISITOR, [OF_PROGRAM] = OB_ORIGIN_PROGRAM + 1 };
	ob_error e = { "" };
	ob_checkpoint_file f = { 0 }, copy = { 0 };
	ob_saved_run r = { .scene = "visitors.lua", .text = text, .text_size = sizeof text - 1, .duration = 2 }, opened;
	ob_scene *s = ob_scene_load_text(r.scene, text, sizeof text - 1, &r.options, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, NULL, &e));
	r.settings = s->run;
	ob_host *h = start(s, &r.settings, OB_ISOLATION_THREAD, NULL);
	go(h, 1);
	ask(h, (ob_request){ .kind = OB_REQUEST_AVATAR, .origin = VISITOR, .state.pose.p = { 0, 3, .3 } });
	ask(h, ball_of(VISITOR, 1));
	ask(h, ball_of(OB_ORIGIN_PROGRAM + 1, 2));
	go(h, 1);
	const ob_request drag = { .kind = OB_REQUEST_DRAG, .id = BOX, .frequency = 3, .origin = VISITOR };
	ask(h, drag);
	ask(h, (ob_request){ .kind = OB_REQUEST_PUSH, .id = BOX, .force = { 9, 0, 0 }, .origin = OB_ORIGIN_PROGRAM });
	go(h, 1);
	check_owners(h, before);
	CHECK(pulls_of(h) == 2);
	CHECK(ob_saved_run_make(&r, &f, h, "test", &e));
	ob_checkpoint_seal(&f);
	for (uint32_t leaves = 0; leaves < 2; leaves++) {
		put_back(h, leaves);
		check_owners(h, before);
		CHECK(pulls_of(h) == 2 - leaves); // the program's, and the visitor's
	}
	ob_host_stop(h);
	for (int i = 0; i < 2; i++) {
		CHECK(ob_saved_run_parse(&opened, &copy, f.bytes, f.size, "file", &e));
		h = start(s, &opened.settings, (ob_isolation)i, &opened.host);
		check_owners(h, origin);
		CHECK(pulls_of(h) == 2);
		put_back(h, true);
		check_owners(h, origin);
		CHECK(pulls_of(h) == 1);
		ob_host_stop(h);
		ob_saved_run_close(&opened, &copy);
	}
	ob_checkpoint_finish(&f);
	ob_scene_free(s);
	return check_end();
}
