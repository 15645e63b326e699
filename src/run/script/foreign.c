// FMUs as simulators of objects, seen by a worker: one step of some objects, in place of a script's calls.
#include "script/foreign.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#include "motion/flight.h"
#include "scene/object_limits.h"
#include "script/runner.h"

_Static_assert(OB_FMU_MARK == OB_SCRIPT_FOREIGN, "the host knows FMUs by it");

enum { LOOK_AGAIN_MS = 100, KILLS = 10 }; // KILLS: attempts of a turn whose process others kill

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

void ob_script_open_foreign(ob_script_runner *r)
{
	const ob_script_directory *d = r->data->script_text;
	for (uint32_t i = 0, n = 0; i < r->scene.scripts; i++)
		if (ob_script_is_foreign(d, i + 1)) {
			r->foreign[i].desk = ob_desk_of(r->u, r->worker, n++);
			if (!ob_fmu_model_read((const char *)d + d->text[i].offset, d->text[i].size,
					       &r->foreign[i].model, &r->interpreter[i].broken))
				continue;
			if (!r->foreign[i].desk.slip)
				ob_fail(&r->interpreter[i].broken, "it has no process");
		}
}

static void fill(const ob_script_runner *r, const ob_script_turn *turn, const ob_script_cell *c, ob_fmu_turn *t)
{
	const ob_fmu_model *m = &r->foreign[turn->script - 1].model;
	double q[OB_FMU_FORCE];
	t->length = r->settings->step_length;
	t->time = (double)r->step * t->length;
	t->first = !(turn->flags & OB_SCRIPT_STARTED);
	t->state_bytes = c->state_bytes;
	memcpy(t->state, c->state, c->state_bytes);
	observe(r, turn->object, t->time, q);
	for (int i = 0; i < m->inputs; i++)
		t->input[i] = q[m->input[i].quantity < OB_FMU_FORCE ? m->input[i].quantity : 0];
}

// ---- the process

typedef struct attempt {
	uint32_t done; // turns that are good
	bool left; // the run was stopped meanwhile; nothing counts
	bool loading; // it has not loaded the library
	bool killed; // by others
	ob_error why; // failure of the next turn; empty: none
} attempt;

static void describe_end(const ob_desk_end *end, attempt *a)
{
	const char *when = a->loading ? " while its library was loaded" : "";
	const int status = end->status;
	a->killed = !end->error && !end->hung && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
	if (end->error)
		ob_fail(&a->why, "its process does not start: %s", strerror(end->error));
	else if (end->hung)
		ob_fail(&a->why, "it did not return within the run's patience%s", when);
	else if (WIFSIGNALED(status))
		ob_fail(&a->why, "its process was ended by SIG%s (%s)%s%s", sigabbrev_np(WTERMSIG(status)),
			strsignal(WTERMSIG(status)), when,
			WTERMSIG(status) == SIGSYS ? ": it starts no process, and sends no signal to others" : "");
	else
		ob_fail(&a->why, "it ended its process with exit code %d%s", WEXITSTATUS(status), when);
}

// Marks the object whose turn runs at the desk.
static void show(const ob_script_runner *r, const ob_desk *d, ob_script_turn *const *t, uint32_t n)
{
	const uint32_t done = ob_desk_done(d);
	ob_worker_set_object(r->u, r->worker, t[done < n ? done : n - 1]->object);
}

// Runs the turns in the process at the desk; fresh: in a new one.
static attempt try_turns(const ob_script_runner *r, const ob_desk *d, ob_script_turn *const *t,
			 ob_script_cell *const *c, uint32_t n, bool fresh)
{
	attempt a = { .done = 0 };
	ob_desk_end end;
	ob_desk_state state;
	ob_foreign_data *data = ob_desk_data(d);
	const uint32_t number = fresh ? ob_desk_call(d) : ob_desk_number(d);
	while (fresh && !ob_desk_is_here(d, number, LOOK_AGAIN_MS))
		if (ob_gate_stopped(r->u))
			return (attempt){ .left = true };
	data->turns = n;
	for (uint32_t i = 0; i < n; i++)
		fill(r, t[i], c[i], &data->turn[i]);
	ob_desk_ask(d, n);
	do
		show(r, d, t, n);
	while ((state = ob_desk_wait(d, number, LOOK_AGAIN_MS, &end)) == OB_DESK_WAITS && !ob_gate_stopped(r->u));
	a.left = state == OB_DESK_WAITS;
	a.done = ob_desk_done(d) < n ? ob_desk_done(d) : n;
	a.loading = data->loaded != number;
	if (state == OB_DESK_ENDED)
		describe_end(&end, &a);
	else
		ob_fail(&a.why, "%.*s", OB_SCRIPT_ERROR_BYTES - 1, data->why);
	return a;
}

// Runs some of the turns, the first at least unless it fails. Returns their number and, if not all, why the next fails.
static attempt run_turns(ob_script_runner *r, ob_script_turn *const *t, ob_script_cell *const *c, uint32_t n)
{
	ob_interpreter *p = &r->interpreter[t[0]->script - 1];
	ob_foreign *f = &r->foreign[t[0]->script - 1];
	attempt a = { .why = p->broken };
	if (*p->broken.text)
		return a;
	bool fresh = f->spoilt || !ob_desk_is_ready(&f->desk);
	for (int kills = 0;; fresh = true) {
		a = try_turns(r, &f->desk, t, c, n, fresh);
		f->spoilt = a.done < n;
		kills += a.killed;
		if (a.left || a.done > 0 || (fresh && (!a.killed || kills == KILLS)))
			break;
	}
	if (a.loading && !a.left)
		p->broken = a.why; // for all objects
	return a;
}

// ---- results

static bool finish(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c, const ob_fmu_turn *done, ob_error *e)
{
	if (done->state_bytes > sizeof c->state)
		return ob_fail(e, "its state is damaged");
	if (!apply(r, t->object, &r->foreign[t->script - 1].model, done->output, e))
		return false;
	c->state_bytes = done->state_bytes;
	memcpy(c->state, done->state, done->state_bytes);
	return true;
}

// Ends a turn. result: its data; NULL: it has failed, for e.
static void end_turn(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c, const ob_fmu_turn *result, ob_error *e)
{
	const bool leaves = t->flags & OB_SCRIPT_LEAVING;
	ob_script_begin_turn(r, t, c);
	if (result && finish(r, t, c, result, e)) {
		t->flags |= OB_SCRIPT_STARTED | OB_SCRIPT_EACH_STEP;
		t->flags &= ~(uint32_t)(OB_SCRIPT_MAIL | OB_SCRIPT_TOUCHED | OB_SCRIPT_BROKE);
		if (leaves)
			ob_script_leave(r);
	} else {
		ob_error named;
		ob_fail(&named, "%s: %s", r->data->script_text->text[t->script - 1].name, e->text);
		ob_script_stop_turn(r, t, &named);
	}
	c->inbox_bytes = c->touches = 0;
	r->turn = NULL;
}

void ob_script_run_foreign(ob_script_runner *r, ob_script_turn *const *t, ob_script_cell *const *c, uint32_t n)
{
	r->step = ob_step_count(r->u);
	for (uint32_t at = 0; at < n;) {
		attempt a = run_turns(r, t + at, c + at, n - at);
		if (a.left)
			return;
		const ob_foreign_data *data = ob_desk_data(&r->foreign[t[at]->script - 1].desk);
		for (uint32_t i = 0; i < a.done; i++) {
			const ob_fmu_turn result = data->turn[i]; // a copy: the process may go on writing
			end_turn(r, t[at + i], c[at + i], &result, &a.why);
		}
		at += a.done;
		if (a.done == 0) {
			end_turn(r, t[at], c[at], NULL, &a.why);
			at++;
		}
	}
}

// ---- foreign process

// The process of an FMU.

_Noreturn void ob_script_serve_foreign(const ob_desk *d, uint32_t number, const void *model, size_t size,
				       ob_foreign_confine *confine, void *with)
{
	ob_foreign_data *data = ob_desk_data(d);
	ob_error e = { "" };
	uint32_t question = ob_desk_seen(d);
	ob_fmu *f = ob_fmu_open(model, size, &e);
	const bool loaded = f && confine(with, &e);
	if (loaded)
		data->loaded = number;
	for (;;) {
		uint32_t done = 0;
		question = ob_desk_next(d, question);
		while (loaded && done < data->turns && done < OB_SCRIPT_BATCH && ob_fmu_run(f, &data->turn[done], &e))
			ob_desk_set_done(d, ++done);
		snprintf(data->why, sizeof data->why, "%.*s", (int)sizeof data->why - 1, e.text);
		ob_desk_answer(d, question);
	}
}
