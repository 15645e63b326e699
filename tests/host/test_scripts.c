// Concurrent scripts: the result is the same whichever workers run them. Their reads of each other, messages,
// creations, removals and contacts share the universe here, for the thread sanitizer (tests/run/test_scripts.py tests
// each call). Objects that cannot be solved are frozen in the same place of every run, and requests that came while
// scripts had theirs carried out are repeated there after a death.
#include <signal.h>
#include <string.h>

#include "base/hash.h"
#include "check.h"
#include "host/host_state.h"
#include "measure/measure.h"

enum { STEPS = 60, BIRDS = 24 };

static const char text[] =
	"scene { step = 1/60, substeps = 2, iterations = 4, room = 40 }\n"
	"script('bird', [[\n"
	"function on_start() self.state.heard = 0 self:wake(.1 + random(0, .2)) end\n"
	"function on_step(dt)\n"
	"  local others = near(2)\n"
	"  if #others > 0 then\n"
	"    local o = others[1 + #others // 2]\n"
	"    local x, y, z = o:position() local mx, my, mz = self:position()\n"
	"    self:force(3 * (x - mx), 3 * (y - my), 12 + z - mz)\n"
	"    send(o, self.state.heard, self)\n"
	"  end\n"
	"end\n"
	"function on_message(from, n, whom)\n"
	"  self.state.heard = n + 1\n"
	"  if whom:exists() then self:colour { 1 / (2 + whom:id()), .5, .5 } end\n"
	"end\n"
	"function on_contact(other, impulse, point) self:push(0, 0, .2 * self:mass()) send(other, 0, self) end\n"
	"function on_wake()\n"
	"  local x, y, z = self:position()\n"
	"  if ray(x, y, z, 0, 0, -1) then sphere { radius = .05, at = { x, y, z + .5 }, script = 'drop' } end\n"
	"  self:wake(.3)\n"
	"end]])\n"
	"script('drop', [[\n"
	"function on_start() self:wake(.1) end\n"
	"function on_wake() self:remove() end\n"
	"function on_stop() for _, o in ipairs(near(3)) do send(o, -1, self) end end]])\n"
	"ground {}\n"
	"for i = 1, 24 do\n"
	"  sphere { radius = .15, at = { .5 * (i % 4), .5 * (i // 4), .3 + .1 * (i % 3) }, script = 'bird', density = "
	"300 }\n"
	"end\n";

// Whatever moves freely diverges at once: a drop is frozen in the step in which it has come, with its greeting sent. The
// lift has requests in every step.
static const char wild[] =
	"scene { step = 1/60, room = 40 }\n"
	"script('lift', [[\n"
	"function on_start() self.state.heard = 0 self.state.steps = 0 end\n"
	"function on_message(from) self.state.heard = self.state.heard + 1 end\n"
	"function on_step(dt)\n"
	"  local n = self.state.steps + 1\n"
	"  self.state.steps = n\n"
	"  self:set_velocity(n % 7, 0, 0)\n"
	"  if n % 10 == 5 then local x = self:position() sphere { radius = .1, at = { x, 0, -.59 }, script = 'drop' } "
	"end\n"
	"end]])\n"
	"script('drop', [[function on_step() send(find('lift'), 1) end]])\n"
	"box { name = 'lift', kind = 'kinematic', size = { 1, 1, 1 }, at = { 0, 0, 0 }, script = 'lift' }\n";

typedef struct outcome {
	uint64_t hash, scripts_state;
	uint32_t objects, frozen;
	bool greeted; // a bird has received a message
} outcome;

// Adds the state that scripts keep, which is in no hash of a universe.
static void look_at_cells(const ob_universe *u, outcome *o)
{
	const ob_step_data *x = ob_universe_step_data(u);
	o->scripts_state = OB_HASH_BEGIN;
	for (uint32_t i = 0; i < x->script_cells; i++) {
		const ob_script_cell *c = &x->script_cell[i];
		if (!x->script_turn[i].script)
			continue;
		CHECK(!(x->script_turn[i].flags & OB_SCRIPT_STOPPED) ||
		      ob_passport_of(u, x->script_turn[i].object)->flags & OB_OBJECT_FROZEN);
		o->scripts_state = ob_hash_on(o->scripts_state, &x->script_turn[i], sizeof *x->script_turn);
		o->scripts_state = ob_hash_on(o->scripts_state, c->state, c->state_bytes);
		o->scripts_state = ob_hash_on(o->scripts_state, c->inbox, c->inbox_bytes);
		o->scripts_state = ob_hash_on(o->scripts_state, c->random, sizeof c->random);
		o->greeted |= c->inbox_bytes > 0;
	}
}

static ob_host *start(const char *lua, ob_host_config c, ob_scene **s)
{
	ob_error e = { "" };
	*s = ob_scene_load_text("scene.lua", lua, strlen(lua), NULL, &e);
	const bool fine = *s && ob_run_settings_resolve(&(*s)->run, NULL, &e);
	c.run = fine ? (*s)->run : ob_run_settings_default();
	c.run.gravity.z *= lua == wild ? 1e20 : 1; // more than a scene may have
	ob_host *h = fine ? ob_host_start(*s, &c, &e) : NULL;
	if (!h)
		fprintf(stderr, "%s\n", e.text);
	CHECK(h);
	return h;
}

static void go(ob_host *h, uint64_t step)
{
	ob_error e;
	ob_host_go(h, step);
	CHECK(ob_host_wait(h, &e));
}

static outcome look(ob_host *h)
{
	ob_universe_info info;
	ob_host_times times;
	ob_snapshot snapshot = { 0 };
	outcome o = { 0 };
	ob_error e;
	ob_universe_get_info(ob_host_universe(h), &info);
	CHECK(ob_snapshot_take(&snapshot, ob_host_universe(h), 0, &e));
	o.hash = ob_measure_hash(&snapshot);
	o.objects = info.objects;
	ob_host_get_times(h, &times);
	o.frozen = times.frozen;
	look_at_cells(ob_host_universe(h), &o);
	ob_snapshot_finish(&snapshot);
	return o;
}

static outcome run(const char *lua, ob_isolation isolation, uint32_t workers)
{
	ob_scene *s;
	ob_host *h = start(
		lua, (ob_host_config){ .isolation = isolation, .workers = workers, .on_death = OB_ON_DEATH_KEEP }, &s);
	go(h, STEPS);
	const outcome o = look(h);
	ob_host_stop(h);
	ob_scene_free(s);
	return o;
}

static void same(const outcome *found, const outcome *expected)
{
	CHECK(found->hash == expected->hash && found->scripts_state == expected->scripts_state &&
	      found->objects == expected->objects && found->frozen == expected->frozen);
}

static outcome compare_ways(const char *lua)
{
	const outcome expected = run(lua, OB_ISOLATION_THREAD, 1);
	printf("%u objects, %u frozen, hash %016llx\n", expected.objects, expected.frozen,
	       (unsigned long long)expected.hash);
	static const uint32_t workers[] = { 2, 3, 8, 0 }; // 0: one for each object
	for (size_t i = 0; i < sizeof workers / sizeof *workers; i++) {
		const outcome threads = run(lua, OB_ISOLATION_THREAD, workers[i]);
		same(&threads, &expected);
	}
	const outcome processes = run(lua, OB_ISOLATION_PROCESS, 3);
	same(&processes, &expected);
	return expected;
}

// A guest comes in the pause after the scripts of a step; later a simulator is killed, or none.
static outcome visit(bool killed)
{
	ob_scene *s;
	ob_error e;
	ob_worker_info info;
	ob_host_config c = { .isolation = OB_ISOLATION_PROCESS, .workers = 1, .spare = 8 };
	ob_object_def guest = { .dies = INFINITY };
	ob_host *h = start(wild, c, &s);
	guest.passport.shape = OB_SHAPE_SPHERE;
	guest.passport.size.x = .1;
	guest.passport.flags = OB_OBJECT_STATIC;
	guest.state.pose = (ob_pose){ .p = ob_v3(0, 9, 0), .q = ob_quat_identity() };
	go(h, 1);
	h->restart.cost = 1e9; // no checkpoint from now on
	ob_host_go(h, 3);
	CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = guest }, &e) && ob_host_wait(h, &e));
	if (killed && ob_universe_get_worker(ob_host_universe(h), 0, &info))
		kill(info.pid, SIGKILL);
	while (killed && !h->restart.requested)
		nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL);
	go(h, 4);
	const outcome o = look(h);
	CHECK(h->restart.deaths == killed);
	ob_host_stop(h);
	ob_scene_free(s);
	return o;
}

int main(void)
{
	const outcome birds = compare_ways(text);
	CHECK(birds.objects > 1 + BIRDS && birds.greeted && birds.frozen == 0);
	const outcome drops = compare_ways(wild);
	CHECK(drops.objects == 1 + STEPS / 10 && drops.frozen >= STEPS / 10 - 1);
	const outcome undisturbed = visit(false), repeated = visit(true);
	CHECK(undisturbed.objects == 2);
	same(&repeated, &undisturbed);
	return check_end();
}
