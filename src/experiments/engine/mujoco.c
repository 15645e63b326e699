// MuJoCo, set up as its documentation advises for bodies that rest on each other:
// - elliptic friction cones, the Newton solver with a tolerance far below the default, and impratio 10, its recipe
//   against slip ("Modeling", Preventing slip). Its noslip iterations could remove the remaining slip; it advises
//   them only if the other measures are not enough.
// - Contacts are springs. Their solref is as stiff as it advises: a time constant of two time steps, critically damped;
//   solimp is the default.
// - Semi-implicit Euler at about 2 ms, the default of both: eight substeps of a frame at 60 Hz. "mujoco-rk4" has its
//   integrator of Runge and Kutta, of order 4 where there are no contacts.
// - Friction of a pair is the larger of the two bodies' in MuJoCo. Pairs with another sqrt(mu_a mu_b), or with
// different
//   restitutions, are declared one by one, which it allows for some ten thousand.
// - It has no restitution. A pair with e > 0 gets a spring that gives back e of the speed: natural frequency 1 / (two
//   time steps), damping ratio -ln e / sqrt(pi^2 + ln^2 e). This is exact for one contact between free bodies, and the
//   bodies sink into each other for about six time steps.
// - It has no sleeping, and rolling friction is not requested (condim 3).
//
// The model is made as MJCF text in memory (mjcf.h).
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "engine/world.h"
#include "engine/mjcf.h"
#include "engine/engines.h"

struct ob_engine {
	mjModel *model;
	mjData *data;
	struct object {
		int body; // in the model
		ob_vec3 force; // N
		ob_state now; // constant for static ones
	} * object; // [objects]
	uint32_t *tree; // [objects], ob_joint_tree
	uint32_t substeps, objects;
};

// MuJoCo's own handlers write a log into the working folder, and the one for errors ends the program. Instead, an error
// inside try_* returns to it with the message. mjData that was in use can only be freed.
static _Thread_local jmp_buf *rescue;
static _Thread_local char complaint[200];

static void note_error(const char *text)
{
	snprintf(complaint, sizeof complaint, "%s", text);
	if (rescue)
		longjmp(*rescue, 1);
	fprintf(stderr, "MuJoCo: %s\n", text);
	abort();
}

static void ignore_warning(const char *text)
{
	(void)text; // mjData counts the relevant ones
}

static bool try_model(ob_engine *p, const char *name, const mjVFS *files, ob_error *e)
{
	jmp_buf back;
	char why[200] = "";
	rescue = &back;
	if (setjmp(back) == 0)
		p->model = mj_loadXML(name, files, why, sizeof why);
	else
		snprintf(why, sizeof why, "%s", complaint);
	if (p->model && setjmp(back) == 0)
		p->data = mj_makeData(p->model);
	rescue = NULL;
	return p->data || ob_fail(e, "MuJoCo: %s", p->model ? complaint : why);
}

static bool try_step(ob_engine *p, ob_error *e)
{
	jmp_buf back;
	rescue = &back;
	bool done = setjmp(back) == 0;
	if (done)
		mj_step(p->model, p->data);
	rescue = NULL;
	return done || ob_fail(e, "MuJoCo: %s", complaint);
}

// ---- the model

// Adds the text to the files in memory.
static bool add_file(mjVFS *files, uint32_t number, const struct ob_mjcf_file *file)
{
	char name[16];
	ob_mjcf_name(number, name);
	if (mj_makeEmptyFileVFS(files, name, (int)file->length))
		return false;
	memcpy(files->filedata[files->nfile - 1], file->text, file->length);
	return true;
}

static bool load(ob_engine *p, ob_mjcf *m, ob_error *e)
{
	char first[16];
	mjVFS *files = malloc(sizeof *files);
	bool done = files || ob_fail(e, "MuJoCo: no memory");
	if (files)
		mj_defaultVFS(files);
	if (done && !ob_mjcf_write(m))
		done = ob_fail(e,
			       "MuJoCo: no room for %u bodies, or more than %d pairs with a friction or restitution of "
			       "their own",
			       p->objects, OB_MJCF_PAIRS);
	for (uint32_t i = 0; i < m->files; i++) {
		if (done && !add_file(files, i, &m->file[i]))
			done = ob_fail(e, "MuJoCo: no memory");
		free(m->file[i].text);
	}
	ob_mjcf_name(0, first);
	done = done && try_model(p, first, files, e);
	if (files)
		mj_deleteVFS(files);
	free(files);
	return done;
}

// ---- the engine

static void destroy(ob_engine *p)
{
	if (!p)
		return;
	if (p->data)
		mj_deleteData(p->data);
	if (p->model)
		mj_deleteModel(p->model);
	free(p->object);
	free(p->tree);
	free(p);
}

static void get_vector(const double *v, ob_vec3 *out)
{
	*out = ob_v3(v[0], v[1], v[2]);
}

static void read_states(ob_engine *p)
{
	mj_kinematics(p->model, p->data);
	mj_comPos(p->model, p->data);
	mj_comVel(p->model, p->data);
	for (uint32_t id = 0; id < p->objects; id++) {
		const int body = p->object[id].body;
		const double *q = &p->data->xquat[4 * body];
		ob_state *s = &p->object[id].now;
		double v[6]; // angular, linear
		if (p->model->body_weldid[body] == 0)
			continue;
		mj_objectVelocity(p->model, p->data, mjOBJ_BODY, body, v, 0);
		get_vector(&p->data->xpos[3 * body], &s->pose.p);
		s->pose.q = ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] });
		get_vector(v, &s->w);
		get_vector(v + 3, &s->v);
	}
}

// Sets the velocities of a body's coordinates. Those of a ball, and the turn of a free body, are in the body's frame.
static void put(ob_engine *p, uint32_t id, const ob_world *w)
{
	const int body = p->object[id].body;
	const ob_state *s = &w->state[id];
	const ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_state parent = { .pose.q = ob_quat_identity() };
	if (p->tree[id] != OB_JOINT_WORLD) {
		const uint32_t other = ob_joint_other(&w->joint[p->tree[id]], id);
		parent = other == OB_JOINT_WORLD ? parent : w->state[other];
	}
	const ob_vec3 turn = ob_sub(s->w, parent.w), back = ob_rotate_back(&r, turn);
	const ob_vec3 shift = ob_sub(ob_sub(s->v, parent.v), ob_cross(parent.w, ob_sub(s->pose.p, parent.pose.p)));
	for (int i = 0; i < p->model->body_jntnum[body]; i++) {
		const int joint = p->model->body_jntadr[body] + i;
		double *v = &p->data->qvel[p->model->jnt_dofadr[joint]];
		ob_vec3 axis;
		get_vector(&p->data->xaxis[3 * joint], &axis);
		switch (p->model->jnt_type[joint]) {
		case mjJNT_FREE:
			memcpy(v, (double[]){ s->v.x, s->v.y, s->v.z, back.x, back.y, back.z }, 6 * sizeof *v);
			break;
		case mjJNT_BALL:
			memcpy(v, (double[]){ back.x, back.y, back.z }, 3 * sizeof *v);
			break;
		case mjJNT_SLIDE:
			*v = ob_dot(axis, shift);
			break;
		default:
			*v = ob_dot(axis, turn);
		}
	}
}

// A motor that holds a rate with a greatest force: it takes half of what is missing in a step.
static void set_motor(ob_engine *p, const ob_joint_axis *a, const char *name, double h)
{
	const int i = mj_name2id(p->model, mjOBJ_ACTUATOR, name);
	if (i < 0)
		return;
	const int at = p->model->actuator_trnid[2 * i];
	p->data->ctrl[i] = a->target;
	if (a->motor != OB_MOTOR_RATE)
		return;
	const double response = p->model->actuator_trntype[i] == mjTRN_TENDON
					? p->model->tendon_invweight0[at]
					: p->model->dof_invweight0[p->model->jnt_dofadr[at]];
	p->model->actuator_gainprm[i * mjNGAIN] = .5 / (h * response);
	p->model->actuator_biasprm[i * mjNBIAS + 2] = -.5 / (h * response);
}

static void set_motors(ob_engine *p, const ob_world *w, double h)
{
	char name[32];
	for (uint32_t i = 0; i < w->joints; i++) {
		snprintf(name, sizeof name, "%u", i);
		set_motor(p, &w->joint[i].axis, name, h);
		snprintf(name, sizeof name, "%u.2", i);
		set_motor(p, &w->joint[i].second, name, h);
	}
}

static void set_up(ob_engine *p, const ob_world *w, double h)
{
	char name[16];
	for (uint32_t id = 0; id < w->objects; id++) {
		snprintf(name, sizeof name, "%u", id);
		p->object[id] =
			(struct object){ mj_name2id(p->model, mjOBJ_BODY, name), w->passport[id].force, w->state[id] };
	}
	mj_kinematics(p->model, p->data);
	for (uint32_t id = 0; id < w->objects; id++)
		put(p, id, w);
	set_motors(p, w, h);
}

// variant: 1: Runge and Kutta's integrator
static ob_engine *create(const ob_world *w, const ob_run_settings *s, uint32_t variant, ob_error *e)
{
	if (!(s->step_length > 0) || !s->substeps || !s->iterations) {
		ob_fail(e, "%u substeps of a step of %g s with %u iterations: MuJoCo must be told what to do",
			s->substeps, s->step_length, s->iterations);
		return NULL;
	}
	if (w->hulls > 0) {
		ob_fail(e, "there are hulls, which MuJoCo is not given here");
		return NULL;
	}
	mju_user_error = note_error;
	mju_user_warning = ignore_warning;
	ob_engine *p = calloc(1, sizeof *p);
	if (p) {
		*p = (ob_engine){ .substeps = s->substeps, .objects = w->objects };
		p->object = calloc(w->objects + 1, sizeof *p->object);
		p->tree = calloc(w->objects + 1, sizeof *p->tree);
	}
	if (!p || !p->object || !p->tree || !ob_joint_tree(w, p->tree)) {
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
	} else {
		ob_mjcf m = { .world = w,
			      .tree = p->tree,
			      .step = s->step_length / s->substeps,
			      .iterations = s->iterations,
			      .integrator = variant ? "RK4" : "Euler" };
		if (load(p, &m, e)) {
			set_up(p, w, m.step);
			return p;
		}
	}
	destroy(p);
	return NULL;
}

// MuJoCo continues when its lists are full, and resets when it has become unstable.
static bool sound(const ob_engine *p, ob_error *e)
{
	static const struct {
		int warning;
		const char *text;
	} wrong[] = {
		{ mjWARN_CONTACTFULL, "no room for more contacts" },
		{ mjWARN_CNSTRFULL, "no room for more constraints" },
		{ mjWARN_BADQPOS, "became unstable" },
		{ mjWARN_BADQVEL, "became unstable" },
		{ mjWARN_BADQACC, "became unstable" },
		{ mjWARN_INERTIA, "inertia is singular" },
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		if (p->data->warning[wrong[i].warning].number)
			return ob_fail(e, "MuJoCo: %s", wrong[i].text);
	return true;
}

static bool step(ob_engine *p, ob_error *e)
{
	for (uint32_t id = 0; id < p->objects; id++)
		memcpy(&p->data->xfrc_applied[6 * p->object[id].body], &p->object[id].force, 3 * sizeof(double));
	for (uint32_t k = 0; k < p->substeps; k++)
		if (!try_step(p, e) || !sound(p, e))
			return false;
	read_states(p);
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	for (uint32_t id = 0; id < p->objects; id++)
		state[id] = p->object[id].now;
}

OB_PART(ob_engine_part) = { OB_PART_HEAD(ob_engine_part), .create = create, .step = step, .get = get,
			    .destroy = destroy };
