#include "hand.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "ode/ode_body.h"
#include "step/sim.h"

// Every second universe has a grid of boxes.
static bool grid;

hand *hand_create(ob_free_settings f, ob_vec3 gravity)
{
	return hand_create_for(HAND_OBJECTS, f, gravity);
}

hand *hand_create_for(uint32_t objects, ob_free_settings f, ob_vec3 gravity)
{
	ob_error e;
	hand *h = calloc(1, sizeof *h);
	grid = !grid;
	f.objects = objects;
	f.coupling = OB_COUPLING_OWN;
	f.pace = INFINITY;
	ob_universe_setup setup = { .capacity = objects, .workers = 1, .isolation = "thread", .free = &f };
	setup.run = ob_run_settings_default();
	setup.run.gravity = gravity;
	setup.run.tolerance = 0;
	setup.run.substeps = 1;
	f.rate_most = ob_max(f.rate_most, f.update_rate);
	setup.history = ob_free_plan_depth(&f, setup.run.step_length, objects);
	ob_ode_init();
	for (uint32_t i = 0; i < HAND_MOST; i++)
		h->sim[i].id = i;
	h->scratch.all = h->sim;
	h->scratch.sims = HAND_MOST;
	h->u = ob_universe_create(&setup, &e);
	if (!h->u || !ob_universe_reserve(h->u, objects, &e) || !ob_free_scratch_begin(&h->scratch, h->u) ||
	    !ob_free_boxes_begin(&h->scratch.boxes, h->u, grid)) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	return h;
}

void hand_destroy(hand *h)
{
	for (uint32_t i = 0; i < h->objects; i++)
		ob_free_sim_finish(&h->sim[i]);
	ob_free_boxes_finish(&h->scratch.boxes);
	ob_free_scratch_finish(&h->scratch);
	ob_universe_destroy(h->u, true);
	free(h);
}

static ob_vec3 inertia_of(ob_shape shape, ob_vec3 s, double mass)
{
	if (shape == OB_SHAPE_SPHERE)
		return ob_v3(.4 * mass * s.x * s.x, .4 * mass * s.x * s.x, .4 * mass * s.x * s.x);
	return ob_scale(ob_v3(s.y * s.y + s.z * s.z, s.x * s.x + s.z * s.z, s.x * s.x + s.y * s.y), mass / 3);
}

uint32_t hand_add(hand *h, ob_shape shape, ob_vec3 size, double mass, ob_vec3 at, ob_vec3 velocity, double restitution)
{
	const uint32_t id = h->objects++;
	ob_passport p = { .id = id,
			  .generation = 1,
			  .flags = OB_OBJECT_PRESENT | (mass > 0 ? 0 : OB_OBJECT_STATIC),
			  .shape = (uint8_t)shape,
			  .size = size,
			  .mass = mass,
			  .inertia = mass > 0 ? inertia_of(shape, size, mass) : ob_v3(0, 0, 0),
			  .friction = .5,
			  .restitution = restitution };
	ob_write_passport(h->u, id, &p);
	ob_sim_place(h->u, id, &(ob_state){ { at, ob_quat_identity() }, velocity, { 0, 0, 0 } });
	return id;
}

void hand_remove(hand *h, uint32_t id)
{
	ob_passport p;
	if (!ob_universe_get_passport(h->u, id, &p))
		return;
	p.flags = 0;
	ob_write_passport(h->u, id, &p);
	h->sim[id].present = false;
}

void hand_until(hand *h, uint64_t step)
{
	ob_free_enter_objects(h->u);
	for (uint32_t id = 0; id < h->objects; id++)
		if (!h->sim[id].present && !ob_free_sim_begin(&h->sim[id], h->u, id))
			exit(1);
	ob_free_run_until(h->u, step);
}

static bool at_boundary(hand *h, uint32_t id)
{
	ob_free_sim_look(&h->sim[id], h->u);
	return !h->sim[id].present || h->sim[id].failed || h->sim[id].time >= ob_free_until(h->u) * h->scratch.boundary;
}

bool hand_is_there(hand *h)
{
	for (uint32_t id = 0; id < h->objects; id++)
		if (!at_boundary(h, id))
			return false;
	return true;
}

bool hand_step(hand *h, uint32_t id)
{
	return !at_boundary(h, id) && ob_free_lag_allows(&h->sim[id], &h->scratch) &&
	       ob_free_sim_step(&h->sim[id], &h->scratch);
}

static void begin_anew(hand *h, uint32_t id)
{
	if (!ob_free_sim_begin(&h->sim[id], h->u, id))
		exit(1);
}

// Ends all stops. false: there were none.
static bool end_stops(hand *h, uint64_t stopped[HAND_MOST], uint64_t turn, uint64_t *random)
{
	bool some = false;
	for (uint32_t id = 0; id < h->objects; id++) {
		if (stopped[id] <= turn)
			continue;
		some = true;
		stopped[id] = 0;
		if (ob_splitmix(random) % 2)
			begin_anew(h, id);
	}
	return some;
}

bool hand_run_with_stops(hand *h, uint64_t *random, double kills, double stops)
{
	enum { LONGEST = 4000 };
	uint64_t stopped[HAND_MOST] = { 0 }; // until a turn
	for (uint64_t turn = 0; !hand_is_there(h); turn++) {
		uint32_t tried = 0, id = (uint32_t)(ob_splitmix(random) % h->objects);
		while (tried++ < h->objects && (stopped[id] > turn || !hand_step(h, id)))
			id = (id + 1) % h->objects;
		if (tried > h->objects && !end_stops(h, stopped, turn, random))
			return false;
		if (tried > h->objects)
			continue;
		if (ob_splitmix_real(random) < kills)
			begin_anew(h, id);
		if (stops > 0 && ob_splitmix_real(random) < stops)
			stopped[id] = turn + ob_splitmix(random) % LONGEST;
	}
	return true;
}

bool hand_run(hand *h, uint64_t *random, double kills)
{
	return hand_run_with_stops(h, random, kills, 0);
}

bool hand_run_in_order(hand *h)
{
	while (!hand_is_there(h)) {
		uint32_t first = HAND_MOST;
		for (uint32_t id = 0; id < h->objects; id++)
			if (!at_boundary(h, id) && (first == HAND_MOST || h->sim[id].time < h->sim[first].time))
				first = id;
		if (!hand_step(h, first))
			return false;
	}
	return true;
}
