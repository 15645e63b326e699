// FMUs as simulators of objects: one step of one object, in place of a script's calls.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion/flight.h"
#include "scene/object_limits.h"
#include "script/runner.h"

_Static_assert(OB_FMU_MARK == OB_SCRIPT_FOREIGN, "the host knows FMUs by it");

enum { STEP_INSTRUCTIONS = 1000 }; // a step of an FMU counts as so many of a script; it cannot be measured in them

void ob_script_open_foreign(ob_script_runner *r)
{
	const ob_script_directory *d = r->data->script_text;
	for (uint32_t i = 0; i < r->scene.scripts; i++)
		if (ob_script_is_foreign(d, i + 1))
			r->fmu[i] = ob_fmu_open((const char *)d + d->text[i].offset, d->text[i].size,
						&r->interpreter[i].broken);
}

// Values of all quantities of the object (ob_fmu_quantity), before the step.
static void observe(const ob_script_runner *r, uint32_t id, double time, double q[OB_FMU_FORCE])
{
	const ob_passport *p = ob_passport_of(r->u, id);
	const ob_state s = ob_published_at(ob_newest_motion(r->u, id), p, time);
	const double all[OB_FMU_FORCE] = {
		s.pose.p.x, s.pose.p.y, s.pose.p.z, s.v.x,      s.v.y,      s.v.z,   s.w.x, s.w.y,
		s.w.z,      s.pose.q.w, s.pose.q.x, s.pose.q.y, s.pose.q.z, p->mass, time,
	};
	memcpy(q, all, sizeof all);
}

// Makes outputs the force and the torque that act from now on.
static bool apply(const ob_script_runner *r, uint32_t id, const ob_fmu_model *m, const double *output, ob_error *e)
{
	ob_script_cell *c = r->cell;
	const ob_passport *p = ob_passport_of(r->u, id);
	double q[6] = { c->force.x, c->force.y, c->force.z, c->next_torque.x, c->next_torque.y, c->next_torque.z };
	for (int i = 0; i < m->outputs; i++) {
		const uint32_t which = m->output[i].quantity - OB_FMU_FORCE;
		const double most = which < 3 ? ob_force_most(p) : ob_torque_most(p);
		if (which >= 6 || !(fabs(output[i]) <= most))
			return ob_fail(e, "%s of %g, expected a number up to %g", which < 3 ? "a force" : "a torque",
				       output[i], most);
		q[which] = output[i];
		c->asks |= which < 3 ? OB_SCRIPT_ASKS_FORCE : OB_SCRIPT_ASKS_TORQUE;
	}
	c->force = ob_v3(q[0], q[1], q[2]);
	c->next_torque = ob_v3(q[3], q[4], q[5]);
	return true;
}

static bool step(ob_script_runner *r, const ob_script_turn *turn, ob_error *e)
{
	ob_script_cell *c = r->cell;
	ob_fmu *f = r->fmu[turn->script - 1];
	double q[OB_FMU_FORCE], input[OB_FMU_INPUTS_MAX], output[OB_FMU_OUTPUTS_MAX] = { 0 };
	if (!f) {
		*e = r->interpreter[turn->script - 1].broken;
		return false;
	}
	const ob_fmu_model *m = ob_fmu_model_of(f);
	const double length = r->settings->step_length;
	ob_fmu_turn t = { .time = (double)r->step * length,
			  .length = length,
			  .input = input,
			  .output = output,
			  .state = c->state,
			  .state_bytes = c->state_bytes,
			  .room = OB_SCRIPT_STATE_BYTES,
			  .first = !(turn->flags & OB_SCRIPT_STARTED) };
	observe(r, turn->object, t.time, q);
	for (int i = 0; i < m->inputs; i++)
		input[i] = q[m->input[i].quantity < OB_FMU_FORCE ? m->input[i].quantity : 0];
	if (!ob_fmu_run(f, &t, e) || !apply(r, turn->object, m, output, e))
		return false;
	c->state_bytes = t.state_bytes;
	return true;
}

uint64_t ob_script_run_foreign(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c)
{
	ob_error e = { "" };
	const bool leaves = t->flags & OB_SCRIPT_LEAVING;
	ob_script_begin_turn(r, t, c);
	if (step(r, t, &e)) {
		t->flags |= OB_SCRIPT_STARTED | OB_SCRIPT_EACH_STEP;
		t->flags &= ~(uint32_t)(OB_SCRIPT_MAIL | OB_SCRIPT_TOUCHED | OB_SCRIPT_BROKE);
		if (leaves)
			ob_script_leave(r);
	} else {
		ob_error named;
		ob_fail(&named, "%s: %s", r->data->script_text->text[t->script - 1].name, e.text);
		ob_script_stop_turn(r, t, &named);
	}
	c->inbox_bytes = c->touches = 0;
	r->turn = NULL;
	return STEP_INSTRUCTIONS;
}
