// Objects come and go, by the host, while the universe stands still.
#include <string.h>

#include "contact/batch.h"
#include "sim/broadphase.h"
#include "sim/publish.h"
#include "sim/sim.h"
#include "table/trace.h"

// No flight has an impact computed on a plane that is new: all are solved in the next step.
static void end_flights(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (data->schedule[id].state != OB_SCHEDULE_AWAKE)
			continue;
		ob_motion m = *ob_newest_motion(u, id);
		m.flags &= ~(uint32_t)OB_MOTION_FREE;
		ob_publish_motion(u, id, &m);
		data->schedule[id].due = (uint32_t)ob_step_count(u);
	}
}

void ob_sim_place(ob_universe *u, uint32_t id, const ob_state *state)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_run_settings *run = ob_universe_settings(u);
	const ob_passport *p = ob_passport_of(u, id);
	bool fixed = p->flags & OB_OBJECT_STATIC;
	ob_motion m = { .t0 = ob_step_count(u) * run->step_length,
			.valid_until = fixed ? INFINITY : (double)ob_step_count(u) * run->step_length,
			.p = state->pose.p,
			.q = ob_quat_normalize(state->pose.q),
			.v = state->v,
			.w = state->w,
			.step = (uint32_t)ob_step_count(u),
			.island = id };
	if (fixed)
		m.v = m.w = ob_v3(0, 0, 0);
	else
		m.a = ob_external_acceleration(run, p), m.flags = OB_MOTION_FREE;
	double reach = fixed ? 0 : ob_step_reach(run, p, m.q, m.v, m.w);
	ob_fat_aabb_renew(u, id, &(ob_state){ { m.p, m.q }, m.v, m.w }, reach);
	uint32_t kind = !fixed                       ? OB_SCHEDULE_AWAKE
			: p->shape == OB_SHAPE_PLANE ? OB_SCHEDULE_PLANE
						     : OB_SCHEDULE_STATIC;
	data->schedule[id] = (ob_schedule){ 0, (float)reach, kind, m.step, fixed ? UINT32_MAX : m.step };
	data->result_island[id] = UINT32_MAX;
	ob_publish_motion(u, id, &m);
	if (kind == OB_SCHEDULE_PLANE)
		end_flights(u);
	if (ob_universe_traced(u))
		ob_trace_birth(u, id);
}

// Objects whose query is pending are put in before it is made.
void ob_sim_restore(ob_universe *u)
{
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (ob_universe_step_data(u)->schedule[id].state == OB_SCHEDULE_ABSENT)
			continue;
		if (!ob_broadphase_query_pending(u, id))
			ob_index_put(u, id);
		if (ob_universe_traced(u))
			ob_trace_birth(u, id);
	}
}

static void wake_object(ob_universe *u, uint32_t id)
{
	const ob_passport *pass = ob_passport_of(u, id);
	ob_motion m = *ob_newest_motion(u, id);
	uint32_t flags = m.flags;
	m.flags &= ~(uint32_t)(OB_MOTION_RESTS | OB_MOTION_STEADY);
	m.rest_time = 0;
	ob_publish_motion(u, id, &m);
	if (ob_universe_traced(u))
		ob_trace_moves(u, ob_trace_host(u), id, flags, m.flags);
	ob_schedule *schedule = &ob_universe_step_data(u)->schedule[id];
	uint32_t steps = (uint32_t)ob_step_count(u);
	double reach = ob_step_reach(ob_universe_settings(u), pass, m.q, m.v, m.w);
	*schedule = (ob_schedule){ ob_schedule_path(schedule, steps), (float)reach, OB_SCHEDULE_AWAKE, steps, steps };
}

bool ob_sim_freeze(ob_universe *u, uint32_t id)
{
	ob_passport p = *ob_passport_of(u, id);
	if (!(p.flags & OB_OBJECT_PRESENT) || p.flags & OB_OBJECT_STATIC)
		return false;
	const ob_state now = ob_state_now(u, id, ob_newest_motion(u, id), ob_step_count(u));
	ob_sim_remove(u, id);
	p.flags |= OB_OBJECT_STATIC | OB_OBJECT_FROZEN;
	p.mass = 0;
	p.inertia = ob_v3(0, 0, 0);
	ob_write_passport(u, id, &p);
	ob_sim_place(u, id, &now);
	return true;
}

uint32_t ob_sim_failed_objects(const ob_universe *u, uint32_t object, uint32_t *ids, uint32_t most)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (object >= data->objects_max)
		return 0;
	const uint32_t place = data->result_island[object];
	const bool solved = ob_gate_phase(u) == OB_PHASE_ISLANDS || ob_step_failed(u, NULL) == OB_STEP_OVERWORKED;
	const ob_island *is = solved && place < data->objects_max ? &data->island[place] : NULL;
	if (!is || is->members > data->objects_max || is->first_member > data->objects_max - is->members) {
		ids[0] = object;
		return 1;
	}
	for (uint32_t i = 0; i < is->members && i < most; i++)
		ids[i] = data->member[is->first_member + i];
	return is->members;
}

void ob_sim_remove(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; i < ob_pairs_count(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		uint32_t other = k->a == id ? k->b : k->a;
		if ((k->a != id && k->b != id) || !k->active || other >= data->objects_max ||
		    data->schedule[other].state < OB_SCHEDULE_AWAKE)
			continue;
		wake_object(u, other);
	}
	ob_pairs_drop(u, id);
	ob_index_remove(u, id);
	data->schedule[id] = (ob_schedule){ .state = OB_SCHEDULE_ABSENT };
	if (ob_universe_traced(u))
		ob_trace_death(u, id, ob_newest_motion(u, id)->flags);
	ob_passport none = *ob_passport_of(u, id);
	none.flags = 0;
	ob_write_passport(u, id, &none);
}
