// Cases of joints, and a ragdoll in free space: turned, mirrored, from a frame that moves, and with bodies and joints in the
// other order, each moves as it did.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "engine/engines.h"
#include "lab/scene.h"
#include "world/builders.h"

enum { MOST = 128 }; // bodies

typedef struct relation {
	const char *name;
	ob_quat turn; // about the vertical
	ob_vec3 shift, boost; // m, m/s
	bool mirrored; // in y = 0, before it is turned
	bool reordered;
} relation;

static const relation relations[] = {
	{ .name = "turned", .turn = { .w = .8, .z = .6 }, .shift = { 3, -2, 0 } },
	{ .name = "mirrored", .turn = { .w = 1 }, .mirrored = true },
	{ .name = "reordered", .turn = { .w = 1 }, .reordered = true },
	{ .name = "boosted", .turn = { .w = 1 }, .boost = { 2, 1, 0 } }, // of free bodies alone
};

static ob_vec3 seen(const relation *x, ob_vec3 v)
{
	const ob_mat3 r = ob_quat_matrix(x->turn);
	return ob_rotate(&r, x->mirrored ? ob_v3(v.x, -v.y, v.z) : v);
}

static ob_quat mirrored(const relation *x, ob_quat q)
{
	return x->mirrored ? (ob_quat){ q.w, -q.x, q.y, -q.z } : q;
}

static ob_pose seen_pose(const relation *x, ob_pose p)
{
	return (ob_pose){ ob_add(seen(x, p.p), x->shift), ob_quat_mul(x->turn, mirrored(x, p.q)) };
}

static ob_state seen_state(const relation *x, ob_state s, double time)
{
	const double sign = x->mirrored ? -1 : 1;
	ob_state out = { seen_pose(x, s.pose), ob_add(seen(x, s.v), x->boost), ob_scale(seen(x, s.w), sign) };
	out.pose.p = ob_madd(out.pose.p, time, x->boost);
	return out;
}

// Turns about an axis change their sign in a mirror.
static void mirror_axis(ob_joint_axis *a)
{
	const double low = a->low;
	a->low = -a->high, a->high = -low;
	a->rest = -a->rest, a->target = -a->target;
}

// ---- a case as a relation sees it

static uint32_t place_of[MOST]; // of each body of the original

static void see_joint(ob_joint_passport *j, const relation *x)
{
	for (int side = 0; side < 2; side++) {
		ob_pose *f = &j->frame[side];
		if (j->object[side] == OB_JOINT_WORLD)
			*f = seen_pose(x, *f);
		else if (x->mirrored)
			*f = (ob_pose){ ob_v3(f->p.x, -f->p.y, f->p.z), mirrored(x, f->q) };
	}
	if (x->mirrored && (j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_UNIVERSAL))
		mirror_axis(&j->axis);
}

static void reverse_order(ob_world *w)
{
	ob_passport passport[MOST];
	ob_state state[MOST];
	memcpy(passport, w->passport, w->objects * sizeof *passport);
	memcpy(state, w->state, w->objects * sizeof *state);
	for (uint32_t i = 0; i < w->objects; i++) {
		place_of[i] = w->objects - 1 - i;
		w->passport[place_of[i]] = passport[i];
		w->passport[place_of[i]].id = place_of[i];
		w->state[place_of[i]] = state[i];
	}
	for (uint32_t i = 0; i < w->joints; i++)
		for (int side = 0; side < 2; side++)
			if (w->joint[i].object[side] != OB_JOINT_WORLD)
				w->joint[i].object[side] = place_of[w->joint[i].object[side]];
	for (uint32_t i = 0; 2 * i + 1 < w->joints; i++) {
		const ob_joint_passport kept = w->joint[i];
		w->joint[i] = w->joint[w->joints - 1 - i];
		w->joint[w->joints - 1 - i] = kept;
	}
}

static void see_world(ob_world *w, const relation *x)
{
	CHECK(w->objects <= MOST);
	for (uint32_t i = 0; i < w->objects; i++) {
		place_of[i] = i;
		w->state[i] = seen_state(x, w->state[i], 0);
		if (!(w->passport[i].mass > 0))
			w->state[i].v = ob_v3(0, 0, 0);
	}
	for (uint32_t i = 0; i < w->joints; i++)
		see_joint(&w->joint[i], x);
	if (x->reordered)
		reverse_order(w);
}

// Runs the world, as it is seen, for so long (s).
static void run(ob_world *w, const relation *x, double duration, ob_state ended[MOST])
{
	const ob_engine_kind *k = &ob_engine_obsim;
	ob_error e;
	ob_run_settings settings = k->usual;
	ob_state state[MOST];
	settings.step_length = ob_case_step;
	see_world(w, x);
	ob_engine *engine = k->create(w, &settings, &e);
	CHECK(engine);
	for (int frames = (int)lround(duration / ob_case_step); frames > 0; frames--)
		CHECK(k->step(engine, &e));
	k->get(engine, state);
	k->destroy(engine);
	memset(ended, 0, MOST * sizeof *ended);
	for (uint32_t i = 0; i < w->objects; i++)
		ended[i] = state[place_of[i]];
	ob_world_finish(w);
}

// ---- a ragdoll that tumbles in free space

static ob_world floating(void)
{
	ob_world w = { 0 };
	ob_world_ragdoll(&w, ob_v3(0, 0, 0), .5);
	for (uint32_t i = 0; i < w.objects; i++) {
		w.state[i].w = ob_v3(.5, -.3, 1), w.state[i].v = ob_cross(w.state[i].w, w.state[i].pose.p);
		w.passport[i].flags |= 1u << OB_OBJECT_PASSES; // its limbs pass through each other
	}
	w.state[1].w = ob_v3(2, 1, 3); // the head turns faster
	return w;
}

// World of a case; NULL: the ragdoll.
static ob_world make_world(const char *name)
{
	ob_world w;
	ob_error e;
	if (!name)
		return floating();
	ob_scene *scene = ob_lab_scene_load(ob_case_find(name), 0, &w, &e);
	CHECK(scene);
	ob_scene_free(scene);
	return w;
}

static void compare(const char *name, const relation *x, double duration, double most)
{
	static const relation plain = { .turn = { .w = 1 } };
	ob_state before[MOST], ended[MOST];
	double off = 0, moved = 0;
	ob_world w = make_world(name);
	run(&w, &plain, duration, before);
	w = make_world(name);
	run(&w, x, duration, ended);
	for (uint32_t i = 0; i < MOST; i++) {
		const ob_state expected = seen_state(x, before[i], duration);
		if (ob_norm2(before[i].v) == 0 && ob_norm2(before[i].w) == 0)
			continue; // stands still, or there is none
		off = fmax(off, ob_norm(ob_sub(expected.pose.p, ended[i].pose.p)));
		moved = fmax(moved, ob_norm(before[i].v));
	}
	printf("%s, %s: %.3g m off after %g s\n", name ? name : "floating ragdoll", x->name, off, duration);
	CHECK(off <= most);
	CHECK(moved > 1e-4);
}

int main(void)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	// The bridge carries a box: contacts and joints are solved by turns, one after the other, within the tolerance of 1 mm.
	const struct {
		const char *name;
		double duration, most;
	} each[] = { { "pendulum-90", 3, 1e-11 },  { "double-pendulum", 2, 1e-9 }, { "spherical-pendulum", 3, 1e-11 },
		     { "top", 1, 1e-9 },           { "four-bar", 3, 1e-9 },        { "slider-crank", 3, 1e-11 },
		     { "furuta", 3, 1e-9 },        { "bricard", 1, 1e-11 },        { "breaking-door", 3, 1e-6 },
		     { "plank-bridge", .5, 2e-4 }, { "ragdoll", .5, 1e-9 },        { "car", 1, 1e-6 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++)
		for (int k = 0; k < 3; k++)
			compare(each[i].name, &relations[k], each[i].duration, each[i].most);
	for (int k = 0; k < 4; k++)
		compare(NULL, &relations[k], 1, 1e-9);
	return check_end();
}
