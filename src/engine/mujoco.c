// MuJoCo, set up as its documentation advises for bodies that rest on each other:
// - elliptic friction cones, the Newton solver with a tolerance far below the default, and impratio 10, its recipe
//   against slip ("Modeling", Preventing slip). Its noslip iterations could remove the remaining slip; it advises
//   them only if the other measures are not enough.
// - Contacts are springs. Their solref is as stiff as it advises: a time constant of two time steps, critically damped;
//   solimp is the default.
// - Semi-implicit Euler at about 2 ms, the default of both: eight substeps of a frame at 60 Hz.
// - Friction of a pair is the larger of the two bodies' in MuJoCo. Pairs with another sqrt(mu_a mu_b), or with
// different
//   restitutions, are declared one by one, which it allows for some ten thousand.
// - It has no restitution. A pair with e > 0 gets a spring that gives back e of the speed: natural frequency 1 / (two
//   time steps), damping ratio -ln e / sqrt(pi^2 + ln^2 e). This is exact for one contact between free bodies, and the
//   bodies sink into each other for about six time steps.
// - It has no sleeping, and rolling friction is not requested (condim 3).
//
// The model is made as MJCF text in memory. Each object is a body with the index id + 1, and a joint if it moves.
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "engine/part.h"
#include "shape/shape.h"

enum {
	CONTACTS_PER_BODY = 12, // average limit: memory for their rows grows with the square of the bodies
	CONTACTS_LEAST = 200,
	DECLARED_MOST = 10000, // pairs
};

struct ob_engine {
	mjModel *model;
	mjData *data;
	ob_state *start; // [objects], constant for static ones
	ob_vec3 *force; // [objects], N
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

static bool try_model(ob_engine *p, const mjVFS *files, ob_error *e)
{
	jmp_buf back;
	char why[200] = "";
	rescue = &back;
	if (setjmp(back) == 0)
		p->model = mj_loadXML("world.xml", files, why, sizeof why);
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

static bool moves(const ob_passport *o)
{
	return !(o->flags & OB_OBJECT_STATIC) && o->mass > 0;
}

// Writes the time constant and the damping ratio of a pair's spring, or -stiffness and -damping, the only form for a
// spring without damping.
static void write_solref(FILE *f, double e, double h)
{
	double frequency = 1 / (2 * h), ratio = 1;
	if (e > 0)
		ratio = -log(fmin(e, 1)) / hypot(M_PI, log(fmin(e, 1)));
	if (e > 0)
		fprintf(f, " solref=\"%.17g %.17g\"", -frequency * frequency, -2 * ratio * frequency);
	else
		fprintf(f, " solref=\"%.17g 1\"", 1 / frequency);
}

static void write_geom(FILE *f, const ob_passport *o, double h)
{
	static const char *const type[OB_SHAPE_KINDS] = {
		[OB_SHAPE_SPHERE] = "sphere",   [OB_SHAPE_BOX] = "box",           [OB_SHAPE_PLANE] = "plane",
		[OB_SHAPE_CAPSULE] = "capsule", [OB_SHAPE_CYLINDER] = "cylinder",
	};
	ob_vec3 size = o->shape == OB_SHAPE_PLANE ? ob_v3(0, 0, 1) : o->size;
	if (!type[o->shape])
		return;
	fprintf(f, "<geom name=\"%u\" type=\"%s\" size=\"%.17g %.17g %.17g\" friction=\"%.17g 0 0\"", o->id,
		type[o->shape], size.x, size.y, size.z, o->friction);
	write_solref(f, o->restitution, h);
	fputs("/>", f);
}

static void write_body(FILE *f, const ob_passport *o, const ob_state *s, double h)
{
	const ob_vec3 *p = &s->pose.p, *i = &o->inertia;
	const ob_quat *q = &s->pose.q;
	fprintf(f, "<body name=\"%u\" pos=\"%.17g %.17g %.17g\" quat=\"%.17g %.17g %.17g %.17g\">", o->id, p->x, p->y,
		p->z, q->w, q->x, q->y, q->z);
	if (moves(o))
		fprintf(f, "<freejoint/><inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/>",
			o->mass, i->x, i->y, i->z);
	write_geom(f, o, h);
	fputs("</body>\n", f);
}

static bool usual_pair(const ob_passport *a, const ob_passport *b)
{
	return a->friction == b->friction && a->restitution == b->restitution;
}

// Writes the pairs for which MuJoCo would combine another friction or restitution; returns false if they are too many.
// Its automatic contacts between the two bodies are excluded, or they would touch twice.
static bool write_pairs(FILE *f, const ob_world *w, double h)
{
	uint32_t declared = 0;
	fputs("<contact>\n", f);
	for (uint32_t i = 0; i < w->objects; i++) {
		for (uint32_t j = 0; j < i; j++) {
			const ob_passport *a = &w->passport[i], *b = &w->passport[j];
			if ((!moves(a) && !moves(b)) || !a->shape || !b->shape || usual_pair(a, b))
				continue;
			if (++declared > DECLARED_MOST)
				return false;
			double mu = sqrt(a->friction * b->friction);
			fprintf(f, "<pair geom1=\"%u\" geom2=\"%u\" condim=\"3\" friction=\"%.17g %.17g 0 0 0\"", j, i,
				mu, mu);
			write_solref(f, fmax(a->restitution, b->restitution), h);
			fprintf(f, "/><exclude body1=\"%u\" body2=\"%u\"/>\n", j, i);
		}
	}
	fputs("</contact>\n", f);
	return true;
}

static bool write_world(FILE *f, const ob_world *w, const ob_run_settings *s)
{
	double h = s->step_length / s->substeps;
	uint32_t contacts = CONTACTS_LEAST + CONTACTS_PER_BODY * w->objects;
	fprintf(f,
		"<mujoco><compiler angle=\"radian\"/>\n"
		"<option timestep=\"%.17g\" gravity=\"%.17g %.17g %.17g\" cone=\"elliptic\" impratio=\"10\" "
		"solver=\"Newton\" iterations=\"%u\" tolerance=\"1e-12\"/>\n"
		"<size nconmax=\"%u\" njmax=\"%u\"/>\n<worldbody>\n",
		h, w->gravity.x, w->gravity.y, w->gravity.z, s->iterations, contacts, 3 * contacts);
	for (uint32_t id = 0; id < w->objects; id++)
		write_body(f, &w->passport[id], &w->state[id], h);
	fputs("</worldbody>\n", f);
	bool all = write_pairs(f, w, h);
	fputs("</mujoco>\n", f);
	return all;
}

static bool load(ob_engine *p, const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	char *text = NULL;
	size_t length = 0;
	FILE *f = open_memstream(&text, &length);
	mjVFS *files = malloc(sizeof *files);
	bool done = f && files;
	if (!done)
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
	if (done && !write_world(f, w, s))
		done = ob_fail(e, "MuJoCo: more than %d pairs with a friction or restitution of their own",
			       DECLARED_MOST);
	if (f && fclose(f) && done)
		done = ob_fail(e, "no memory for a world of %u bodies", w->objects);
	if (done) {
		mj_defaultVFS(files);
		done = !mj_makeEmptyFileVFS(files, "world.xml", (int)length) || ob_fail(e, "MuJoCo: no memory");
	}
	if (done) {
		memcpy(files->filedata[0], text, length);
		done = try_model(p, files, e);
		mj_deleteVFS(files);
	}
	free(files);
	free(text);
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
	free(p->start);
	free(p->force);
	free(p);
}

// A free joint's first three velocities are in the world frame, the other three in the body frame.
static void put(ob_engine *p, uint32_t id, const ob_passport *o, const ob_state *s)
{
	p->start[id] = *s;
	p->force[id] = o->force;
	if (!moves(o))
		return;
	double *v = &p->data->qvel[p->model->body_dofadr[id + 1]];
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_vec3 spin = ob_rotate_back(&r, s->w);
	memcpy(v, (double[]){ s->v.x, s->v.y, s->v.z, spin.x, spin.y, spin.z }, 6 * sizeof *v);
}

static ob_engine *create(const ob_world *w, const ob_run_settings *s, ob_error *e)
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
		p->start = calloc(w->objects + 1, sizeof *p->start);
		p->force = calloc(w->objects + 1, sizeof *p->force);
	}
	if (!p || !p->start || !p->force) {
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
	} else if (load(p, w, s, e)) {
		for (uint32_t id = 0; id < w->objects; id++)
			put(p, id, &w->passport[id], &w->state[id]);
		return p;
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
		memcpy(&p->data->xfrc_applied[6 * (id + 1)], &p->force[id], 3 * sizeof(double));
	for (uint32_t k = 0; k < p->substeps; k++)
		if (!try_step(p, e) || !sound(p, e))
			return false;
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	for (uint32_t id = 0; id < p->objects; id++) {
		state[id] = p->start[id];
		int joint = p->model->body_jntadr[id + 1];
		if (joint < 0)
			continue;
		const double *x = &p->data->qpos[p->model->jnt_qposadr[joint]];
		const double *v = &p->data->qvel[p->model->jnt_dofadr[joint]];
		state[id].pose.p = ob_v3(x[0], x[1], x[2]);
		state[id].pose.q = ob_quat_normalize((ob_quat){ x[3], x[4], x[5], x[6] });
		ob_mat3 r = ob_quat_matrix(state[id].pose.q);
		state[id].v = ob_v3(v[0], v[1], v[2]);
		state[id].w = ob_rotate(&r, ob_v3(v[3], v[4], v[5]));
	}
}

OB_PART(ob_engine_part) = { OB_PART_HEAD(ob_engine_part), .create = create, .step = step, .get = get,
			    .destroy = destroy };
