// Concurrent scripts: the result is the same whichever workers run them. Their reads of each other, messages,
// creations, removals and contacts share the universe here, for the thread sanitizer (tests/run/test_scripts.py tests
// each call).
#include <string.h>

#include "base/hash.h"
#include "check.h"
#include "host/host.h"
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

typedef struct outcome {
	uint64_t hash, scripts_state;
	uint32_t objects;
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
		CHECK(!(x->script_turn[i].flags & OB_SCRIPT_STOPPED));
		o->scripts_state = ob_hash_on(o->scripts_state, &x->script_turn[i], sizeof *x->script_turn);
		o->scripts_state = ob_hash_on(o->scripts_state, c->state, c->state_bytes);
		o->scripts_state = ob_hash_on(o->scripts_state, c->inbox, c->inbox_bytes);
		o->scripts_state = ob_hash_on(o->scripts_state, c->random, sizeof c->random);
		o->greeted |= c->inbox_bytes > 0;
	}
}

static outcome run(ob_isolation isolation, uint32_t workers)
{
	const ob_run_settings unset = ob_run_settings_unset();
	ob_error e = { "" };
	ob_universe_info info;
	ob_snapshot snapshot = { 0 };
	outcome o = { 0 };
	ob_scene *s = ob_scene_load_text("birds.lua", text, sizeof text - 1, NULL, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, &unset, &e));
	const ob_host_config c = { .isolation = isolation, .workers = workers, .run = s->run };
	ob_host *h = ob_host_start(s, &c, &e);
	CHECK(h);
	ob_host_go(h, STEPS);
	CHECK(ob_host_wait(h, &e));
	ob_universe_get_info(ob_host_universe(h), &info);
	CHECK(ob_snapshot_take(&snapshot, ob_host_universe(h), 0, &e));
	o.hash = ob_measure_hash(&snapshot);
	o.objects = info.objects;
	look_at_cells(ob_host_universe(h), &o);
	ob_snapshot_finish(&snapshot);
	ob_host_stop(h);
	ob_scene_free(s);
	if (e.text[0])
		fprintf(stderr, "%s\n", e.text);
	return o;
}

static void same(const outcome *found, const outcome *expected)
{
	CHECK(found->hash == expected->hash && found->scripts_state == expected->scripts_state &&
	      found->objects == expected->objects);
}

int main(void)
{
	const outcome expected = run(OB_ISOLATION_THREAD, 1);
	printf("%u objects, hash %016llx\n", expected.objects, (unsigned long long)expected.hash);
	CHECK(expected.objects > 1 + BIRDS && expected.greeted);
	static const uint32_t workers[] = { 2, 3, 8, 0 }; // 0: one for each object
	for (size_t i = 0; i < sizeof workers / sizeof *workers; i++) {
		const outcome threads = run(OB_ISOLATION_THREAD, workers[i]);
		same(&threads, &expected);
	}
	const outcome processes = run(OB_ISOLATION_PROCESS, 3);
	same(&processes, &expected);
	return check_end();
}
