// Cases of joints, and a ragdoll in free space: turned, mirrored, from a frame that moves, and with bodies and joints in the
// other order, each moves as it did.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "engine/engines.h"
#include "lab/case.h"
#include "lab/look.h"
#include "world/world.h"

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

static const ob_case *original;
static const relation *as;
static uint32_t place_of[MOST]; // of each body of the original
static ob_state ended[MOST];

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

static void build_seen(ob_world *w, uint32_t run)
{
	ob_scene *scene;
	ob_error e;
	CHECK(ob_case_build(original, run, w, &scene, &e));
	ob_scene_free(scene);
	CHECK(w->objects <= MOST);
	for (uint32_t i = 0; i < w->objects; i++) {
		place_of[i] = i;
		w->state[i] = seen_state(as, w->state[i], 0);
		if (!(w->passport[i].mass > 0))
			w->state[i].v = ob_v3(0, 0, 0);
	}
	for (uint32_t i = 0; i < w->joints; i++)
		see_joint(&w->joint[i], as);
	if (as->reordered)
		reverse_order(w);
}

static void observe_end(ob_case_run_state *t)
{
	for (uint32_t i = 0; i < t->world->objects; i++)
		ended[i] = ob_look_at(t, place_of[i]);
}

static void accept(ob_case_run_state *t) {}

// Runs the case, as it is seen, for so long (s).
static void run(const ob_case *c, const relation *x, double duration)
{
	ob_case seen_case = *c;
	ob_case_result out;
	ob_error e;
	original = c, as = x;
	seen_case.text = NULL, seen_case.build = build_seen, seen_case.observe = observe_end, seen_case.judge = accept;
	seen_case.duration = duration, seen_case.runs = 1;
	if (!ob_case_run(&seen_case, &ob_engine_obsim, &ob_engine_obsim.usual, &out, &e)) {
		fprintf(stderr, "%s: %s\n", c->name, e.text);
		CHECK(false);
	}
}

static void compare(const ob_case *c, const relation *x, double duration, double most)
{
	static const relation plain = { .turn = { .w = 1 } };
	ob_state before[MOST];
	double off = 0, moved = 0;
	run(c, &plain, duration);
	memcpy(before, ended, sizeof before);
	run(c, x, duration);
	for (uint32_t i = 0; i < MOST; i++) {
		const ob_state expected = seen_state(x, before[i], duration);
		if (ob_norm2(before[i].v) == 0 && ob_norm2(before[i].w) == 0)
			continue; // stands still, or there is none
		off = fmax(off, ob_norm(ob_sub(expected.pose.p, ended[i].pose.p)));
		moved = fmax(moved, ob_norm(before[i].v));
	}
	printf("%s, %s: %.3g m off after %g s\n", c->name, x->name, off, duration);
	CHECK(off <= most);
	CHECK(moved > 1e-4);
	memset(ended, 0, sizeof ended);
}

// ---- a ragdoll that tumbles in free space

static void build_floating(ob_world *w, uint32_t run)
{
	ob_world_ragdoll(w, ob_v3(0, 0, 0), .5);
	w->gravity = ob_v3(0, 0, 0);
	for (uint32_t i = 0; i < w->objects; i++) {
		w->state[i].w = ob_v3(.5, -.3, 1), w->state[i].v = ob_cross(w->state[i].w, w->state[i].pose.p);
		w->passport[i].flags |= 1u << OB_OBJECT_PASSES; // its limbs pass through each other
	}
	w->state[1].w = ob_v3(2, 1, 3); // the head turns faster
}

static const ob_case floating = { .name = "floating ragdoll", .build = build_floating };

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
			compare(ob_case_find(each[i].name), &relations[k], each[i].duration, each[i].most);
	for (int k = 0; k < 4; k++)
		compare(&floating, &relations[k], 1, 1e-9);
	return check_end();
}
