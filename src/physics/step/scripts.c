#include "step/scripts.h"

#include <math.h>
#include <string.h>

#include "baseline/ode_baseline.h"
#include "exchange/results.h"
#include "schedule/calendar.h"
#include "motion/deviation.h"
#include "schedule/pair_checks.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/publish.h"
#include "step/pairs.h"
#include "step/profile.h"

// ---- scripts that run

static bool pauses_after(const ob_script_counts *count)
{
	return count->pause_for > 0 && count->pause_for == ob_scripts_ran_for(count);
}

bool ob_scripts_had_run(const ob_universe *u)
{
	const ob_script_counts *count = ob_universe_step_data(u)->script_counts;
	return count && ob_scripts_ran_for(count) == ob_step_count(u) + 1;
}

void ob_scripts_forget(ob_universe *u)
{
	ob_script_counts *count = ob_universe_step_data(u)->script_counts;
	if (count)
		ob_scripts_set_ran_for(count, (uint32_t)ob_step_count(u));
}

bool ob_scripts_due(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_script_counts *count = data->script_counts;
	const uint64_t step = ob_step_count(u);
	if (!count || ob_scripts_had_run(u))
		return false;
	ob_scripts_set_ran_for(count, (uint32_t)step + 1);
	count->due = count->requests = 0;
	for (uint32_t i = 0; i < count->cells && i < data->script_cells; i++)
		if (ob_script_is_due(&data->script_turn[i], step))
			data->script_due[count->due++] = i;
	return count->due > 0 || pauses_after(count);
}

// Cells whose scripts run in one call: one, or some with the same foreign code.
typedef struct batch {
	uint32_t n, task[OB_SCRIPT_BATCH], cell[OB_SCRIPT_BATCH];
} batch;

static uint64_t call(ob_sim *s, const batch *b)
{
	const ob_step_data *data = s->data;
	ob_script_turn *turn[OB_SCRIPT_BATCH];
	ob_script_cell *cell[OB_SCRIPT_BATCH];
	const bool copies = ob_universe_contained(s->u);
	for (uint32_t i = 0; i < b->n; i++) {
		turn[i] = copies ? &s->scripts.turn[i] : &data->script_turn[b->cell[i]];
		cell[i] = copies ? &s->scripts.cell[i] : &data->script_cell[b->cell[i]];
		if (copies) {
			*turn[i] = data->script_turn[b->cell[i]];
			*cell[i] = data->script_cell[b->cell[i]];
		}
	}
	const uint64_t instructions = s->scripts.run(s->scripts.runner, turn, cell, b->n);
	for (uint32_t i = 0; i < b->n && copies; i++)
		ob_hand_over_script(s->u, b->cell[i], turn[i], cell[i]);
	return instructions;
}

static void run(ob_sim *s, batch *b)
{
	enum { INSTRUCTIONS_PER_WORK = 4 };
	if (b->n == 0)
		return;
	ob_worker_set_object(s->u, s->worker, s->data->script_turn[b->cell[0]].object);
	const uint64_t instructions = call(s, b);
	for (uint32_t i = 0; i < b->n; i++) {
		ob_budget_begin_share(s, s->data->script_turn[b->cell[i]].object);
		ob_budget_note(&s->solver, instructions / INSTRUCTIONS_PER_WORK);
		ob_budget_spent(&s->solver);
		if (!s->settings->one_per_object)
			ob_profile_task_done(s, b->task[i]);
	}
	b->n = 0;
}

// Script that may run in one call with others; 0: runs alone.
static uint32_t shared_script(const ob_step_data *data, uint32_t cell)
{
	const uint32_t script = data->script_turn[cell].script;
	return ob_script_is_foreign(data->script_text, script) ? script : 0;
}

// Cells in a batch at most: so that each worker gets several.
static uint32_t largest_batch(const ob_sim *s)
{
	enum { BATCHES = 4 };
	const uint32_t n = s->data->script_counts->due / (BATCHES * ob_universe_simulators(s->u));
	return n < 1 ? 1 : n < OB_SCRIPT_BATCH ? n : OB_SCRIPT_BATCH;
}

void ob_scripts_run(ob_sim *s)
{
	const ob_step_data *data = s->data;
	batch b = { .n = 0 };
	uint32_t i;
	if (s->settings->one_per_object) {
		b = (batch){ .n = 1, .cell = { data->script_of[s->worker] - 1 } };
		run(s, &b);
		return;
	}
	const uint32_t most = largest_batch(s);
	while (ob_task_claim(s->u, &i) && (s->settings->freezes || ob_step_failed(s->u, NULL) == OB_STEP_OK)) {
		const uint32_t cell = data->script_due[i], script = shared_script(data, cell);
		if (b.n == most || (b.n && (!script || script != shared_script(data, b.cell[0]))))
			run(s, &b);
		b.task[b.n] = i;
		b.cell[b.n++] = cell;
	}
	run(s, &b);
}

bool ob_sim_awaits_requests(const ob_universe *u)
{
	return ob_scripts_have_requests(u);
}

bool ob_scripts_have_requests(const ob_universe *u)
{
	const ob_script_counts *count = ob_universe_step_data(u)->script_counts;
	return count && (count->requests > 0 || pauses_after(count));
}

void ob_sim_pause_after_scripts(ob_universe *u, bool wanted)
{
	ob_script_counts *count = ob_universe_step_data(u)->script_counts;
	if (count)
		count->pause_for = wanted ? (uint32_t)ob_step_count(u) + 1 : 0;
}

// ---- requests

static bool moves(const ob_step_data *data, uint32_t id)
{
	return ob_schedule_is_dynamic(&data->schedule[id]);
}

void ob_sim_kick(ob_universe *u, uint32_t id, ob_vec3 push, ob_vec3 twist)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_run_settings *run = ob_universe_settings(u);
	const ob_passport *pass = ob_passport_of(u, id);
	const uint64_t step = ob_step_count(u);
	ob_motion m = *ob_newest_motion(u, id);
	const bool supported = ob_norm2(m.a) == 0;
	const ob_state now = ob_state_now(u, id, &m, step);
	m.path = ob_path_now(&m, step);
	m.t0 = m.valid_until = (double)step * run->step_length;
	m.p = now.pose.p, m.q = now.pose.q, m.v = now.v, m.w = now.w;
	if (ob_norm2(push) > 0)
		m.v = ob_madd(m.v, 1 / pass->mass, push);
	if (ob_norm2(twist) > 0) {
		const ob_mat3 r = ob_quat_matrix(m.q);
		const ob_vec3 l = ob_rotate_back(&r, twist);
		m.w = ob_add(m.w,
			     ob_rotate(&r, ob_v3(l.x / pass->inertia.x, l.y / pass->inertia.y, l.z / pass->inertia.z)));
	}
	m.a = supported ? ob_v3(0, 0, 0) : ob_external_acceleration(run, pass);
	ob_deviation_put(&m, ob_deviation_at(&m, step, run->step_length));
	m.step = (uint32_t)step;
	m.flags = 0;
	m.rest_time = 0;
	const double reach = ob_step_reach(run, pass, m.q, m.v, m.w);
	m.reach = (float)reach;
	ob_schedule *schedule = &data->schedule[id];
	*schedule = (ob_schedule){ ob_schedule_path(schedule, step), (float)reach, OB_SCHEDULE_AWAKE, m.step, m.step };
	ob_calendar_enter_due(u, id);
	ob_pairs_look(u, id);
	ob_fat_aabb_update(u, id, &(ob_state){ { m.p, m.q }, m.v, m.w }, reach, 0);
	ob_publish_motion(u, id, &m);
}

// Carries out a script's changes of its object. true: its motion changes.
static bool change_object(ob_sim *s, uint32_t id, ob_script_cell *c)
{
	ob_universe *u = s->u;
	const ob_step_data *data = s->data;
	const bool body = moves(data, id);
	ob_passport p = *ob_passport_of(u, id);
	bool other = false;
	if (body && c->asks & OB_SCRIPT_ASKS_FORCE) {
		other |= !ob_equal(p.force, c->force);
		p.force = c->force;
	}
	if (c->asks & OB_SCRIPT_ASKS_COLOUR) {
		memcpy(p.colour, c->colour, sizeof p.colour);
		p.flags &= ~(uint32_t)OB_OBJECT_MESH_COLOUR;
	}
	if (memcmp(&p, ob_passport_of(u, id), sizeof p) != 0)
		ob_write_passport(u, id, &p);
	if (body && c->asks & OB_SCRIPT_ASKS_TORQUE) {
		other |= !ob_equal(c->torque, c->next_torque);
		c->torque = c->next_torque;
	}
	const ob_vec3 none = { 0 };
	const bool pushed = body && c->asks & OB_SCRIPT_ASKS_PUSH;
	if (s->baseline && pushed) // it follows forces and torques by itself
		ob_ode_baseline_kick(s->baseline, id, c->push, c->twist);
	else if (!s->baseline && (other || pushed))
		ob_sim_kick(u, id, pushed ? c->push : none, pushed ? c->twist : none);
	return other || pushed;
}

static void deliver(ob_step_data *data, const ob_script_turn *from, const ob_script_post *post)
{
	const uint32_t cell = post->object < data->objects_max ? data->script_of[post->object] : 0;
	if (!cell)
		return;
	ob_script_turn *to = &data->script_turn[cell - 1];
	ob_script_cell *c = &data->script_cell[cell - 1];
	if (to->generation != post->generation || to->flags & OB_SCRIPT_STOPPED)
		return;
	const uint32_t bytes = (uint32_t)sizeof *post + post->bytes;
	if (c->inbox_bytes + bytes > OB_SCRIPT_INBOX_BYTES) {
		data->script_counts->lost++;
		return;
	}
	ob_script_post mail = *post;
	mail.object = from->object, mail.generation = from->generation;
	memcpy(c->inbox + c->inbox_bytes, &mail, sizeof mail);
	memcpy(c->inbox + c->inbox_bytes + sizeof mail, post + 1, post->bytes);
	c->inbox_bytes += bytes;
	to->flags |= OB_SCRIPT_MAIL;
}

// Removes an object. One that has a script of its own receives a message first, and is removed a step later.
static void remove_object(ob_step_data *data, const ob_script_turn *from, ob_script_post *post)
{
	const uint32_t cell = post->object < data->objects_max ? data->script_of[post->object] : 0;
	ob_script_turn *to = cell ? &data->script_turn[cell - 1] : NULL;
	if (to && to != from && to->generation == post->generation && !(to->flags & OB_SCRIPT_STOPPED)) {
		to->flags |= OB_SCRIPT_LEAVING;
		post->kind = OB_REQUEST_MESSAGE, post->bytes = 0, post->generation = 0; // it has no receiver
		return;
	}
	data->script_counts->requests++;
}

// Sets the target of a motor. true: that wakes its objects.
static bool set_motor(const ob_sim *s, const ob_script_post *post)
{
	ob_script_motor m;
	bool wakes = false;
	if (post->used < sizeof m)
		return false;
	memcpy(&m, post + 1, sizeof m);
	if (m.joint >= ob_joints_end(s->data) || !isfinite(m.target))
		return false;
	ob_joint_passport *j = &s->data->joint[m.joint];
	if (j->axis.target != m.target && !s->baseline)
		wakes = ob_sim_wake_joined(s->u, j);
	j->axis.target = m.target;
	return wakes;
}

// Carries out the posts in a cell's outbox, which are aligned to 8 bytes. true: they wake objects.
static bool post_all(const ob_sim *s, const ob_script_turn *from, ob_script_cell *c)
{
	ob_step_data *data = s->data;
	bool wakes = false;
	for (uint32_t at = 0; at + sizeof(ob_script_post) <= c->outbox_bytes;) {
		ob_script_post *post = (ob_script_post *)(void *)(c->outbox + at);
		at += (uint32_t)sizeof *post + post->bytes;
		if (post->kind == OB_REQUEST_MESSAGE)
			deliver(data, from, post);
		else if (post->kind == OB_REQUEST_REMOVE)
			remove_object(data, from, post);
		else if (post->kind == OB_REQUEST_MOTOR)
			wakes |= set_motor(s, post);
		else
			data->script_counts->requests++;
	}
	return wakes;
}

bool ob_scripts_carry_out(ob_sim *s)
{
	ob_step_data *data = s->data;
	ob_script_counts *count = data->script_counts;
	bool other = false;
	count->calls += count->due;
	for (uint32_t i = 0; i < count->due; i++) {
		const uint32_t cell = data->script_due[i];
		ob_script_turn *turn = &data->script_turn[cell];
		ob_script_cell *c = &data->script_cell[cell];
		if (c->asks & ~(uint32_t)(OB_SCRIPT_ASKS_POST | OB_SCRIPT_ASKS_ERROR))
			other |= change_object(s, turn->object, c);
		if (c->asks & OB_SCRIPT_ASKS_POST)
			other |= post_all(s, turn, c);
		count->failed += (c->asks & OB_SCRIPT_ASKS_ERROR) != 0;
		count->stopped += c->asks & OB_SCRIPT_ASKS_ERROR && turn->flags & OB_SCRIPT_STOPPED;
		c->asks = 0;
	}
	return other;
}
