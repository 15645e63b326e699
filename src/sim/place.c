// Objects come and go, by the host, while the universe stands still.
#include <string.h>

#include "contact/batch.h"
#include "sim/index.h"
#include "sim/pairs.h"
#include "sim/perceive.h"
#include "sim/pull.h"
#include "sim/sim.h"

void ob_sim_place(ob_universe *u, uint32_t id, const ob_state *state)
{
	ob_exchange *ex = ob_universe_exchange(u);
	const ob_run_settings *run = ob_universe_settings(u);
	const ob_passport *p = ob_passport_of(u, id);
	bool fixed = p->flags & OB_OBJECT_STATIC;
	double h = run->step_length / run->substeps;
	ob_motion m = { .t0 = ob_step_count(u) * run->step_length,
			.valid_until = INFINITY,
			.p = state->pose.p,
			.q = ob_quat_normalize(state->pose.q),
			.v = state->v,
			.w = state->w,
			.substep = h,
			.step = (uint32_t)ob_step_count(u),
			.island = id };
	if (fixed)
		m.v = m.w = ob_v3(0, 0, 0);
	else
		m.a = ob_pull(run, p), m.dv = ob_scale(m.a, h), m.flags = OB_MOTION_FREE;
	double reach = fixed ? 0 : ob_step_reach(run, p, m.v, m.w);
	ob_claim_bounds_anew(u, id, p->shape, p->size, (ob_pose){ m.p, m.q }, reach);
	memcpy(m.bounds, ex->bounds[id], sizeof m.bounds);
	ex->brief[id] = (ob_brief){ 0, (float)reach, fixed ? OB_BRIEF_STATIC : OB_BRIEF_AWAKE };
	ex->result_island[id] = UINT32_MAX;
	ob_publish_motion(u, id, &m);
}

// Takes the impulses of a pair out of what object "id" predicts for its next substep, and wakes it.
static void let_go(ob_universe *u, uint32_t id, const ob_pair_state *p, bool is_a)
{
	const ob_passport *pass = ob_passport_of(u, id);
	ob_motion m = *ob_newest_motion(u, id);
	ob_vec3 t1, t2, impulse, torque = { 0, 0, 0 }, centre = { 0, 0, 0 };
	const ob_vec3 *arm = is_a ? p->arm_a : p->arm_b;
	double sign = is_a ? -1 : 1, sum = 0;
	ob_tangents(p->normal, &t1, &t2);
	for (uint32_t j = 0; j < p->points; j++) {
		sum += p->impulse[j];
		torque = ob_madd(torque, p->impulse[j], ob_cross(arm[j], p->normal));
		centre = ob_madd(centre, 1. / p->points, arm[j]);
	}
	ob_vec3 friction = ob_madd(ob_scale(t1, p->impulse[4]), p->impulse[5], t2);
	impulse = ob_madd(friction, sum, p->normal);
	torque = ob_madd(ob_add(torque, ob_cross(centre, friction)), p->impulse[6], p->normal);
	ob_mat3 r = ob_quat_matrix(m.q);
	ob_vec3 body = ob_rotate_back(&r, torque), i = pass->inertia;
	m.dv = ob_madd(m.dv, sign / pass->mass, impulse);
	m.dw = ob_madd(m.dw, sign, ob_rotate(&r, ob_v3(body.x / i.x, body.y / i.y, body.z / i.z)));
	m.flags &= ~(uint32_t)OB_MOTION_ASLEEP;
	m.quiet = 0;
	ob_publish_motion(u, id, &m);
	ob_brief *brief = &ob_universe_exchange(u)->brief[id];
	brief->state = OB_BRIEF_AWAKE;
	brief->reach = (float)ob_step_reach(ob_universe_settings(u), pass, m.v, m.w);
}

void ob_sim_remove(ob_universe *u, uint32_t id)
{
	ob_exchange *ex = ob_universe_exchange(u);
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		uint32_t other = k->a == id ? k->b : k->a;
		if ((k->a != id && k->b != id) || !k->active || ex->brief[other].state < OB_BRIEF_AWAKE)
			continue;
		let_go(u, other, ob_pair_newest(&ex->record[k->record]), k->a == other);
	}
	ob_pairs_drop(u, id);
	ob_index_remove(u, id);
	ex->brief[id] = (ob_brief){ 0, 0, OB_BRIEF_ABSENT };
	ob_passport none = *ob_passport_of(u, id);
	none.flags = 0;
	ob_write_passport(u, id, &none);
}
