// Engines whose libraries are loaded when one of them is created.
#include <stdlib.h>
#include <string.h>

#include "engine/engines.h"
#include "engine/world.h"

#define BULLET "libbullet3.24"
#define MUJOCO "libmujoco2.2.2"

struct ob_engine {
	const ob_engine_part *part;
	ob_engine *inner; // of the part
};

static ob_engine *create(const char *name, const char *package, const ob_world *w, const ob_run_settings *s,
			 uint32_t variant, ob_error *e)
{
	const ob_engine_part *part = ob_part_load(name, sizeof *part, OB_PART_PROGRAM, package, e);
	if (!part)
		return NULL;
	ob_engine *p = malloc(sizeof *p);
	if (!p) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	*p = (ob_engine){ part, part->create(w, s, variant, e) };
	if (p->inner)
		return p;
	free(p);
	return NULL;
}

static bool step(ob_engine *p, ob_error *e)
{
	return p->part->step(p->inner, e);
}

static void get(const ob_engine *p, ob_state *state)
{
	p->part->get(p->inner, state);
}

static void destroy(ob_engine *p)
{
	if (p)
		p->part->destroy(p->inner);
	free(p);
}

static bool is_driven(const ob_joint_passport *j)
{
	return j->flags & OB_JOINT_DRIVEN;
}

#ifdef OB_BULLET_VERSION
static ob_engine *create_bullet(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	if (s->step_length > 0 && s->substeps && s->iterations)
		return create("bullet", BULLET, w, s, 0, e);
	ob_fail(e, "%u substeps of a step of %g s with %u iterations: Bullet must be told what to do", s->substeps,
		s->step_length, s->iterations);
	return NULL;
}

// Its constraint of six degrees of freedom has for each axis limits, a spring with a damper, and a motor that holds a rate.
static bool bullet_takes_axis(const ob_joint_passport *j, const ob_joint_axis *a, ob_error *e)
{
	if (a->armature > 0)
		return ob_fail(e, "its joints have no rotors: %s", j->name);
	if (a->friction > 0 && a->motor == OB_MOTOR_RATE)
		return ob_fail(e, "an axis has a motor or friction: %s", j->name);
	if (a->motor == OB_MOTOR_VALUE)
		return ob_fail(e, "no motor pulls to a value: %s", j->name);
	return true;
}

static bool bullet_takes(const ob_world *w, ob_error *e)
{
	for (uint32_t i = 0; i < w->joints; i++) {
		const ob_joint_passport *j = &w->joint[i];
		if (j->kind == OB_JOINT_DISTANCE)
			return ob_fail(e, "it has no joint such as %s", j->name);
		if (!ob_engine_joint_lasts(j, e))
			return false;
		if (j->kind == OB_JOINT_BALL && is_driven(j))
			return ob_fail(e, "nothing acts on the turns of a ball: %s", j->name);
		if (is_driven(j) && !(bullet_takes_axis(j, &j->axis, e) && bullet_takes_axis(j, &j->second, e)))
			return false;
	}
	return true;
}

static bool check_bullet(ob_error *e)
{
	return ob_part_check("bullet", BULLET, e);
}

const ob_engine_kind ob_engine_bullet = {
	.name = "bullet",
	.title = "Bullet, " OB_BULLET_PRECISION " precision",
	.version = OB_BULLET_VERSION,
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1, .iterations = 10 },
	.iteration_choice = { 5, 10, 20, 50, 100, 200, 500 },
	.check = check_bullet,
	.create = create_bullet,
	.step = step,
	.get = get,
	.destroy = destroy,
	.drives = OB_WORLD_DRIVES_BODIES,
	.hulls = true,
	.takes_joints = bullet_takes,
};
#endif

#ifdef OB_MUJOCO_VERSION
static ob_engine *create_mujoco(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create("mujoco", MUJOCO, w, s, 0, e);
}

static ob_engine *create_mujoco_rk4(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create("mujoco", MUJOCO, w, s, 1, e);
}

static bool check_mujoco(ob_error *e)
{
	return ob_part_check("mujoco", MUJOCO, e);
}

static bool closes(const ob_joint_passport *j, ob_error *e)
{
	if (j->kind == OB_JOINT_SLIDER || j->kind == OB_JOINT_UNIVERSAL)
		return ob_fail(e, "no slider or universal closes a loop: %s", j->name);
	return !(j->flags & OB_JOINT_DRIVEN) || ob_fail(e, "nothing acts where a loop is closed: %s", j->name);
}

static bool mujoco_takes(const ob_world *w, ob_error *e)
{
	uint32_t *tree = calloc(w->objects + 1, sizeof *tree);
	bool fine = (tree && ob_joint_tree(w, tree)) || ob_fail(e, "no memory");
	for (uint32_t i = 0; i < w->joints && fine; i++) {
		const ob_joint_passport *j = &w->joint[i];
		const bool apart = j->kind == OB_JOINT_DISTANCE || j->kind == OB_JOINT_APART;
		bool held = apart;
		for (int side = 0; side < 2; side++)
			held |= j->object[side] != OB_JOINT_WORLD && tree[j->object[side]] == i;
		fine = ob_engine_joint_lasts(j, e) && (held || closes(j, e));
		if (fine && j->kind == OB_JOINT_DISTANCE && is_driven(j) && j->axis.armature > 0)
			fine = ob_fail(e, "tendons have no rotors: %s", j->name);
	}
	free(tree);
	return fine;
}

// Its defaults: steps of about 2 ms, at most 100 iterations.
#define MUJOCO_KIND \
	.version = OB_MUJOCO_VERSION, .usual = { .step_length = 1. / 60, .substeps = 8, .iterations = 100 }, \
	.iteration_choice = { 1, 2, 5, 10, 20, 50, 100 }, .check = check_mujoco, .step = step, .get = get, \
	.destroy = destroy, .takes_joints = mujoco_takes

const ob_engine_kind ob_engine_mujoco = {
	.name = "mujoco",
	.title = "MuJoCo",
	.create = create_mujoco,
	MUJOCO_KIND,
};

const ob_engine_kind ob_engine_mujoco_rk4 = {
	.name = "mujoco-rk4",
	.title = "MuJoCo, Runge and Kutta",
	.create = create_mujoco_rk4,
	MUJOCO_KIND,
};
#endif

// ---- kinds

const ob_engine_kind *const ob_engine_kinds[] = {
	&ob_engine_obsim,
	&ob_engine_obsim_jacobi,
	&ob_engine_obsim_ode,
	&ob_engine_obsim_ghost,
	&ob_engine_obsim_lag,
	&ob_engine_free_own,
	&ob_engine_free_own_processes,
	&ob_engine_free_heavy,
	&ob_engine_free_ode,
	&ob_engine_ode_quick,
	&ob_engine_ode_advised,
	&ob_engine_ode_world,
#ifdef OB_BULLET_VERSION
	&ob_engine_bullet,
#endif
#ifdef OB_MUJOCO_VERSION
	&ob_engine_mujoco,
	&ob_engine_mujoco_rk4,
#endif
	NULL,
};

const ob_engine_kind *ob_engine_find(const char *name)
{
	for (const ob_engine_kind *const *k = ob_engine_kinds; *k; k++)
		if (strcmp((*k)->name, name) == 0)
			return *k;
	return NULL;
}
