// Islands with joints that come to rest, and what wakes them.
#include <stdlib.h>

#include "check.h"
#include "elementary/elementary.h"
#include "little_universe.h"

static const ob_quat z_axis = { 1, 0, 0, 0 }, y_axis = { M_SQRT1_2, -M_SQRT1_2, 0, 0 };

static little_scene *sleepy_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	s->run.tolerance = .001;
	s->checked = true;
	return s;
}

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.joint);
	free(s);
}

static bool all_asleep(const little_universe *l)
{
	for (uint32_t i = 0; i < l->now.count; i++)
		if (l->now.passport[i].flags == OB_OBJECT_PRESENT && !little_asleep(l, i))
			return false;
	return true;
}

static ob_joint_axis *drive(ob_joint_passport *j)
{
	j->flags |= OB_JOINT_DRIVEN;
	return &j->axis;
}

// Largest speed (m/s) of a centre or an edge half a metre from it.
static double fastest(const little_universe *l)
{
	double most = 0;
	for (uint32_t i = 0; i < l->now.count; i++) {
		const ob_state x = little_state(l, i);
		if (l->now.passport[i].mass > 0)
			most = fmax(most, ob_norm(x.v) + .5 * ob_norm(x.w));
	}
	return most;
}

// Vertical impulse (N s) that contacts with the object gave to what lies on it in the last substep.
static double carried_by(const little_universe *l, uint32_t id)
{
	enum { MOST_POINTS = 4096 };
	static ob_contact_point point[MOST_POINTS];
	const size_t n = ob_universe_get_contacts(l->u, point, MOST_POINTS);
	double sum = 0;
	for (size_t i = 0; i < n; i++)
		if (point[i].a == id || point[i].b == id)
			sum += point[i].impulse * fabs(point[i].normal.z);
	return sum;
}

static double weight_of(const little_scene *s)
{
	double mass = 0;
	for (uint32_t i = 0; i < s->world.objects; i++)
		mass += s->world.passport[i].mass;
	return mass * s->world.gravity.z;
}

// ---- what stands

typedef enum structure { FLAG_LIES, FLAG_IS_FIXED, LEAF_HANGS, TABLE, TABLES, CHAIN, STRUCTURES } structure;

static const char *const structure_names[STRUCTURES] = { "flag that lies", "flag that is fixed", "leaf that hangs",
							 "table",          "two tables",         "chain" };

static void add_table(ob_world *w, double z)
{
	const uint32_t top = w->objects;
	ob_world_box(w, 10, ob_v3(.6, .4, .02), ob_v3(0, 0, z + .72));
	for (int k = 0; k < 4; k++) {
		const ob_vec3 p = ob_v3(k & 1 ? .5 : -.5, k & 2 ? .3 : -.3, z + .35);
		ob_world_box(w, 1.5, ob_v3(.03, .03, .35), p);
		ob_world_join(w, OB_JOINT_FIXED, top + 1 + k, top, (ob_pose){ { p.x, p.y, z + .7 }, z_axis });
	}
}

static void build(ob_world *w, structure what, int n)
{
	if (what <= LEAF_HANGS) {
		const uint32_t flag = w->objects + (uint32_t)n, top = flag - 1;
		ob_world_stack(w, n, ob_v3(0, 0, 0), 7);
		if (what == LEAF_HANGS) {
			ob_world_box(w, 1, ob_v3(.05, .05, .2), ob_v3(.6, 0, n - .5));
			ob_world_join(w, OB_JOINT_HINGE, flag, top, (ob_pose){ { .6, 0, n - .3 }, y_axis });
			return;
		}
		ob_world_box(w, 1, ob_v3(.05, .05, .05), ob_v3(0, 0, n + .05));
		if (what == FLAG_IS_FIXED)
			ob_world_join(w, OB_JOINT_FIXED, flag, top, (ob_pose){ { 0, 0, n }, z_axis });
		return;
	}
	for (int k = 0; k < n; k++) {
		if (what != CHAIN) {
			add_table(w, .74 * k);
			continue;
		}
		ob_world_box(w, .5, ob_v3(.1, .05, .05), ob_v3(.25 * k, 0, .05));
		if (k)
			ob_world_join(w, OB_JOINT_BALL, w->objects - 1, w->objects - 2,
				      (ob_pose){ { .25 * k - .125, 0, .05 }, z_axis });
	}
}

// Structures with joints stand as those without: still, in equilibrium or asleep, and the ground carries their weight.
static void test_stands(structure what, int n, bool sleeping)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	s->run.sleeping = sleeping;
	build(&s->world, what, n);
	const uint32_t ground = s->world.objects;
	ob_world_ground(&s->world);
	ob_world_material(&s->world, .5, 0);
	little_open(&l, s);
	little_run(&l, 0);
	const double energy = little_energy(&l);
	little_run_to(&l, 2);
	const double speed = fastest(&l), share = carried_by(&l, ground) / (fabs(weight_of(s)) * s->run.step_length),
		     carried = share * (share > .5 ? 1 : s->run.substeps) - 1; // equilibrium takes one substep
	double aside = 0;
	bool rest = true;
	for (uint32_t i = 0; i < ground; i++) {
		const ob_vec3 way = ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p);
		aside = fmax(aside, hypot(way.x, way.y));
		rest &= l.now.motion[i].flags & OB_MOTION_RESTS ? true : false;
	}
	printf("%s, %d: %.3g m/s, %.3g m aside, weight off by %.3g\n", structure_names[what], n, speed, aside, carried);
	CHECK(rest);
	CHECK(speed <= 1e-6);
	CHECK(aside <= 1e-4);
	CHECK(fabs(carried) <= 1e-6);
	CHECK(little_energy(&l) <= energy * (1 + 1e-9));
	finish(&l, s);
}

// A joint whose other end goes, or whose motor has another target, ends the equilibrium of what it held.
static void test_equilibrium_ends(void)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	s->run.sleeping = false;
	ob_world_box(&s->world, 0, ob_v3(.1, .1, .1), ob_v3(0, 0, 2)); // a frame that is taken away
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.7, 0, 2));
	ob_world_join(&s->world, OB_JOINT_FIXED, 1, 0, (ob_pose){ { .1, 0, 2 }, z_axis });
	little_open(&l, s);
	little_run_to(&l, 1);
	CHECK(l.now.motion[1].flags & OB_MOTION_EQUILIBRIUM);
	little_take_away(&l, 0);
	little_run(&l, 30);
	CHECK_NEAR(little_state(&l, 1).pose.p.z, 2 - .5 * 9.81 * .25, 1e-6);
	finish(&l, s);
}

// A pendulum that turns back, or hardly swings, is in no equilibrium.
static void test_swings(double angle)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	s->run.sleeping = false;
	ob_world_sphere(&s->world, 1, .1, ob_v3(sin(angle), 0, 3 - cos(angle)));
	ob_world_join(&s->world, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 3 }, y_axis });
	little_open(&l, s);
	double least = 1;
	for (double t = 0; t < 20; t += .1) {
		little_run_to(&l, t);
		CHECK(!(l.now.motion[0].flags & OB_MOTION_RESTS));
		least = fmin(least, little_state(&l, 0).pose.p.x);
	}
	CHECK(least < -.9 * sin(angle));
	finish(&l, s);
}

// ---- a ragdoll

// Ragdolls that fall come to rest and sleep, none of their joints apart or beyond its limit; a ball that hits one wakes it.
static void test_ragdoll(double height, double lean)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_ragdoll(&s->world, ob_v3(0, 0, height), lean);
	ob_world_ground(&s->world);
	little_open(&l, s);
	double asleep = 0;
	for (double t = 1; t <= 12 && !asleep; t += .5) {
		little_run_to(&l, t);
		asleep = all_asleep(&l) ? t : 0;
	}
	const double energy = little_energy(&l);
	double apart = 0;
	for (uint32_t i = 0; i < s->world.joints; i++) {
		const ob_joint_passport *j = &s->world.joint[i];
		ob_vec3 at[2];
		for (int side = 0; side < 2; side++) {
			const ob_pose p = little_state(&l, j->object[side]).pose;
			const ob_mat3 r = ob_quat_matrix(p.q);
			at[side] = ob_add(p.p, ob_rotate(&r, j->frame[side].p));
		}
		double value, rate;
		CHECK(ob_universe_get_joint_value(l.u, i, &value, &rate));
		CHECK(value < j->axis.high + 1e-6 && value > j->axis.low - 1e-6 && rate == 0);
		apart = fmax(apart, ob_norm(ob_sub(at[0], at[1])));
	}
	printf("ragdoll from %g m, %g rad: asleep at %g s, %.3g m apart, %.3g m deep\n", height, lean, asleep, apart,
	       little_penetration(&l).max_m);
	CHECK(asleep > 0);
	CHECK(apart < 1e-10);
	CHECK(little_penetration(&l).max_m < 1e-3);
	little_run(&l, 60);
	CHECK(all_asleep(&l) && little_energy(&l) == energy);
	finish(&l, s);
}

// A load of a joint that sleeps is the last one. A push at one end wakes all, and so does an object that comes down on it.
static void test_waking(void)
{
	enum { LINKS = 4 };
	little_scene *s = sleepy_scene();
	little_universe l;
	for (uint32_t i = 0; i < LINKS; i++) {
		ob_world_capsule(&s->world, 1, .05, .2, ob_v3(0, 0, 3 - .5 * i));
		ob_joint_axis *a = drive(ob_world_join(&s->world, OB_JOINT_HINGE, i, i ? i - 1 : OB_JOINT_WORLD,
						       (ob_pose){ { 0, 0, 3.25 - .5 * i }, y_axis }));
		a->damping = 1, a->friction = .05;
	}
	ob_world_sphere(&s->world, .2, .1, ob_v3(4, 0, 1.5)).state->v = ob_v3(-2, 0, 9.81); // hits the last link at 2 s
	ob_world_material(&s->world, .5, 0);
	little_open(&l, s);
	little_run_to(&l, 1.5);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(little_asleep(&l, i));
	ob_joint_load load;
	CHECK(ob_universe_get_joint_load(l.u, 1, &load));
	CHECK_NEAR(load.force.z, 3 * 9.81, 1e-6);
	double moved = 0;
	for (double t = 1.8; t < 3; t += .1) {
		little_run_to(&l, t);
		moved = fmax(moved, ob_norm(little_state(&l, 0).w));
	}
	printf("hit chain: the first link turns by up to %.3g rad/s\n", moved);
	CHECK(moved > .01);
	little_run_to(&l, 20);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(little_asleep(&l, i));
	ob_sim_push(l.u, LINKS - 1, ob_v3(5, 0, 0), true);
	little_run(&l, 30);
	for (uint32_t i = 0; i < LINKS; i++)
		CHECK(!little_asleep(&l, i));
	CHECK(ob_norm(little_state(&l, 0).w) > .01);
	finish(&l, s);
}

// A door that friction holds half open sleeps; a constant motor against its stop, too; without what holds them they fall.
static void test_held(void)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.5, 0, 2));
	drive(ob_world_join(&s->world, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 2 }, y_axis }))->friction =
		12;
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.5, 3, 2));
	ob_joint_axis *a =
		drive(ob_world_join(&s->world, OB_JOINT_HINGE, 1, OB_JOINT_WORLD, (ob_pose){ { 0, 3, 2 }, y_axis }));
	a->motor = OB_MOTOR_RATE, a->target = -1, a->most = 30, a->low = -.3;
	const uint32_t post = s->world.objects; // a frame that is taken away
	ob_world_box(&s->world, 0, ob_v3(.1, .1, .1), ob_v3(0, 6, 2));
	ob_world_box(&s->world, 2, ob_v3(.5, .05, .05), ob_v3(.7, 6, 2));
	ob_world_join(&s->world, OB_JOINT_FIXED, post + 1, post, (ob_pose){ { .1, 6, 2 }, z_axis });
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(all_asleep(&l));
	CHECK_NEAR(little_state(&l, 0).pose.p.z, 2, 1e-12);
	CHECK_NEAR(little_state(&l, 1).pose.p.z, 2 + .5 * sin(.3), 1e-9);
	CHECK_NEAR(little_state(&l, post + 1).pose.p.z, 2, 1e-12);
	little_take_away(&l, post);
	little_run(&l, 30);
	CHECK_NEAR(little_state(&l, post + 1).pose.p.z, 2 - .5 * 9.81 * .25, 1e-6);
	CHECK(little_asleep(&l, 0) && little_asleep(&l, 1));
	finish(&l, s);
}

// A body does not sleep while a joint ties it to one that moves.
static void test_carried(void)
{
	little_scene *s = sleepy_scene();
	little_universe l;
	ob_world_body b = ob_world_box(&s->world, 0, ob_v3(.1, .1, .1), ob_v3(0, 0, 2));
	b.passport->flags = (b.passport->flags & ~(uint32_t)OB_OBJECT_STATIC) | OB_OBJECT_KINEMATIC;
	b.state->v = ob_v3(0, .01, 0);
	ob_world_box(&s->world, 2, ob_v3(.3, .1, .1), ob_v3(.5, 0, 2));
	ob_world_join(&s->world, OB_JOINT_FIXED, 1, 0, (ob_pose){ { .2, 0, 2 }, z_axis });
	little_open(&l, s);
	little_run_to(&l, 3);
	CHECK(!little_asleep(&l, 1));
	CHECK_NEAR(little_state(&l, 1).pose.p.y, .03, 1e-9);
	finish(&l, s);
}

int main(void)
{
	static const int heights[] = { 5, 20, 50, 60 };
	for (size_t i = 0; i < sizeof heights / sizeof *heights; i++)
		for (structure what = FLAG_LIES; what <= LEAF_HANGS; what++)
			test_stands(what, heights[i], i % 2);
	for (int sleeping = 0; sleeping < 2; sleeping++) {
		test_stands(TABLE, 1, sleeping);
		test_stands(TABLES, 2, sleeping);
		test_stands(CHAIN, 12, sleeping);
	}
	test_equilibrium_ends();
	test_swings(1e-4);
	test_swings(.01);
	test_ragdoll(.8, .8);
	test_ragdoll(.8, 1.2);
	test_ragdoll(2.2, 2.8);
	test_waking();
	test_held();
	test_carried();
	return check_end();
}
