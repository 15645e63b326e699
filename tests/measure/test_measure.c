// Energy, momenta, hash and penetration of handmade snapshots.
#include <stdlib.h>
#include <string.h>

#include "measure/measure.h"
#include "random.h"

#include "../check.h"

enum { MANY = 300 };

static ob_passport passports[MANY];
static ob_motion motions[MANY];

static ob_snapshot snapshot(uint32_t count)
{
	memset(passports, 0, sizeof passports);
	memset(motions, 0, sizeof motions);
	for (uint32_t i = 0; i < count; i++) {
		passports[i] = (ob_passport){ .id = i,
					      .flags = OB_OBJECT_PRESENT,
					      .shape = OB_SHAPE_SPHERE,
					      .size = { .5, 0, 0 },
					      .mass = 2,
					      .inertia = { .2, .2, .2 } };
		motions[i].q = ob_quat_identity();
	}
	return (ob_snapshot){ .count = count, .passport = passports, .motion = motions };
}

static void test_energy(void)
{
	ob_snapshot s = snapshot(3);
	ob_vec3 g = ob_v3(0, 0, -10);
	motions[0].p = ob_v3(1, 2, 3);
	motions[0].v = ob_v3(0, 3, 4);
	CHECK_NEAR(ob_measure_energy(&s, g), 2 * 25 / 2. + 2 * 10 * 3, 1e-12);
	// body x lies along world y: it turns about its own axis with moment .7
	passports[1].inertia = ob_v3(.7, .1, .2);
	motions[1].q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, M_PI / 2));
	motions[1].w = ob_v3(0, 2, 0);
	CHECK_NEAR(ob_measure_energy(&s, g), 25 + 60 + .5 * .7 * 4, 1e-12);
	passports[2] = (ob_passport){ .id = 2, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC };
	motions[2].p.z = 1e6;
	CHECK_NEAR(ob_measure_energy(&s, g), 25 + 60 + .5 * .7 * 4, 1e-12);
	passports[0].force = ob_v3(4, 0, -1); // its work from the origin: 4 * 1 - 1 * 3
	CHECK_NEAR(ob_measure_energy(&s, g), 25 + 60 + .5 * .7 * 4 - 1, 1e-12);
	passports[0].flags = 0; // absent
	CHECK_NEAR(ob_measure_energy(&s, g), .5 * .7 * 4, 1e-12);
}

static void test_momenta(void)
{
	ob_snapshot s = snapshot(2);
	motions[0].v = ob_v3(1, -2, 3);
	motions[0].p = ob_v3(0, 0, 2);
	motions[1].v = ob_v3(0, 2, 0);
	ob_vec3 p = ob_measure_momentum(&s);
	CHECK_NEAR(p.x, 2, 0);
	CHECK_NEAR(p.y, 0, 0);
	CHECK_NEAR(p.z, 6, 0);
	passports[1].inertia = ob_v3(.7, .1, .2);
	motions[1].q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, M_PI / 2));
	motions[1].w = ob_v3(3, 2, 0);
	ob_vec3 l = ob_measure_angular_momentum(&s); // (0,0,2) x 2 (1,-2,3) = (8, 4, 0)
	CHECK_NEAR(l.x, 8 + .1 * 3, 1e-15);
	CHECK_NEAR(l.y, 4 + .7 * 2, 1e-15);
	CHECK_NEAR(l.z, 0, 1e-15);
}

// A motion published a second ago counts at its present state; a sleeping one at its published state.
static void test_state_is_of_the_snapshot(void)
{
	ob_snapshot s = snapshot(2);
	s.time = 1;
	motions[0].p = ob_v3(0, 0, 100);
	motions[0].v = ob_v3(2, 0, 0);
	motions[0].a = ob_v3(0, 0, -10);
	motions[1] = motions[0];
	motions[1].flags = OB_MOTION_ASLEEP;
	ob_state flying = ob_snapshot_state(&s, 0), asleep = ob_snapshot_state(&s, 1);
	CHECK_NEAR(flying.pose.p.x, 2, 1e-15);
	CHECK_NEAR(flying.pose.p.z, 95, 1e-13);
	CHECK_NEAR(flying.v.z, -10, 1e-15);
	CHECK_NEAR(asleep.pose.p.z, 100, 0);
	passports[1].flags = 0;
	CHECK_NEAR(ob_measure_energy(&s, ob_v3(0, 0, -10)), 2 * 10 * 100 + 4, 1e-11); // energy at its start
}

static void test_hash(void)
{
	ob_snapshot s = snapshot(3);
	uint64_t first = ob_measure_hash(&s);
	CHECK(first == ob_measure_hash(&s));
	motions[1].w.z = -0.;
	CHECK(first != ob_measure_hash(&s)); // hashes bits, not values
	motions[1].w.z = 0;
	motions[2].q.z = nextafter(0, 1);
	CHECK(first != ob_measure_hash(&s));
	motions[2].q.z = 0;
	passports[2].friction = .3;
	motions[2].rest_time = 1;
	CHECK(first == ob_measure_hash(&s)); // not part of the state
	passports[2].flags = 0;
	uint64_t two = ob_measure_hash(&s);
	CHECK(two != first);
	passports[2].flags = passports[1].flags;
	passports[1].flags = 0;
	CHECK(ob_measure_hash(&s) != two); // another id remains
	s.count = 0;
	CHECK(ob_measure_hash(&s) == 0xcbf29ce484222325u); // FNV's offset: nothing hashed
}

static void test_penetration_by_hand(void)
{
	ob_snapshot s = snapshot(5);
	passports[0] = (ob_passport){ .id = 0, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE };
	passports[1] = (ob_passport){
		.id = 1, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_BOX, .size = { 5, 5, 1 }
	}; // in the plane, but static as well
	motions[2].p = ob_v3(20, 0, .49);
	motions[3].p = ob_v3(0, 0, 1.47);
	motions[4].p = ob_v3(.96, 0, 1.7);
	ob_penetration out;
	ob_measure_penetration(&s, &out);
	CHECK(out.pairs == 3); // 2 in the plane, 3 in the box, 3 and 4
	double upper = 1 - hypot(.96, .23);
	CHECK_NEAR(out.max_m, .03, 1e-12);
	CHECK(out.worst_a == 1 && out.worst_b == 3);
	CHECK_NEAR(out.mean_m, (.01 + .03 + upper) / 3, 1e-12);
	double each[5] = { [2] = .5 };
	CHECK(ob_measure_depths(&s, each, &out, NULL, NULL, NULL) && out.pairs == 3);
	CHECK(each[2] == .5 && each[1] == out.max_m && each[3] == out.max_m); // the deeper one stays
	CHECK_NEAR(each[0], .01, 1e-12);
	CHECK_NEAR(each[4], upper, 1e-12);
	s.count = 0;
	ob_measure_penetration(&s, &out);
	CHECK(out.pairs == 0 && out.max_m == 0 && out.mean_m == 0);
}

// The sweep finds the same pairs as a test of all pairs.
static void test_penetration_of_many(void)
{
	ob_snapshot s = snapshot(MANY);
	uint64_t seed = 99;
	static ob_solid solid[MANY];
	static const ob_shape shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	for (int i = 0; i < MANY; i++) {
		ob_quat q = { random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1),
			      1 };
		solid[i] = random_solid(&seed, shapes[i % 4], 4);
		motions[i].p = solid[i].p;
		motions[i].q = ob_quat_normalize(q);
		solid[i].r = ob_quat_matrix(motions[i].q);
		passports[i].shape = solid[i].shape;
		passports[i].size = solid[i].size;
	}
	double worst = 0, sum = 0;
	size_t pairs = 0;
	for (int i = 0; i < MANY; i++) {
		for (int j = 0; j < i; j++) {
			double depth = ob_depth(&solid[i], &solid[j]);
			pairs += depth > 0;
			sum += fmax(depth, 0);
			worst = fmax(worst, depth);
		}
	}
	ob_penetration out;
	ob_measure_penetration(&s, &out);
	CHECK(pairs > MANY / 2);
	CHECK(out.pairs == pairs);
	CHECK_NEAR(out.max_m, worst, 1e-9);
	CHECK_NEAR(out.mean_m * (double)pairs, sum, 1e-6);
}

static bool stop_now(void *context)
{
	++*(int *)context;
	return true;
}

// Crowds: it reports excess, and obeys a request to stop; a field as large, with few overlaps, is measured.
static void test_penetration_of_crowds(void)
{
	enum { CROWD = 12000 };
	ob_snapshot s = { .count = CROWD };
	s.passport = calloc(CROWD, sizeof *s.passport);
	s.motion = calloc(CROWD, sizeof *s.motion);
	for (uint32_t i = 0; i < CROWD; i++) {
		s.passport[i] =
			(ob_passport){ .id = i, .flags = OB_OBJECT_PRESENT, .mass = 1, .shape = OB_SHAPE_SPHERE };
		s.passport[i].size.x = .5;
		s.motion[i] = (ob_motion){ .q = ob_quat_identity(), .valid_until = INFINITY };
		s.motion[i].p = ob_v3(1.5 * (i % 100), 1.5 * (i / 100), 0);
	}
	snprintf(s.passport[7].name, OB_NAME_MAX, "seven");
	s.motion[7].p.x += .6; // .9 from the next
	ob_penetration out;
	ob_error e = { "" };
	int asked = 0;
	CHECK(ob_measure_penetration_unless(&s, &out, NULL, NULL, &e));
	CHECK(out.pairs == 1 && out.worst_a == 7 && out.worst_b == 8);
	CHECK_NEAR(out.max_m, .1, 1e-12);
	for (uint32_t i = 0; i < CROWD; i++)
		s.motion[i].p = ob_v3(1e-6 * i, 0, 0);
	s.motion[7].p = ob_v3(0, 0, 5);
	CHECK(!ob_measure_penetration_unless(&s, &out, NULL, NULL, &e) && isnan(out.max_m) && isnan(out.mean_m));
	CHECK(strstr(e.text, "step 0") && strstr(e.text, "alone overlaps") && !strstr(e.text, "seven"));
	CHECK(!ob_measure_penetration_unless(&s, &out, stop_now, &asked, &e) && asked == 1);
	CHECK(strstr(e.text, "interrupted"));
	free(s.passport);
	free(s.motion);
}

// Separation of contacts that carry an impulse: spheres of .5 m a distance apart, a pair counted once, penetration as
// none.
static void test_separation(void)
{
	ob_snapshot s = snapshot(3);
	ob_separation apart;
	motions[1].p.x = 1.25;
	motions[2].p.y = .9;
	ob_measure_separation(&s, &apart, NULL, NULL);
	CHECK(apart.pairs == 0 && apart.max_m == 0 && apart.mean_m == 0);
	ob_contact_point point[] = { { .a = 0, .b = 1 },
				     { .a = 0, .b = 1, .impulse = 1 },
				     { .a = 0, .b = 2, .impulse = 1 },
				     { .a = 0, .b = 7, .impulse = 1 },
				     { .a = 1, .b = 2 } };
	s.contact = point;
	s.contacts = 5;
	ob_measure_separation(&s, &apart, NULL, NULL);
	CHECK(apart.pairs == 2); // the fourth refers to an absent object, the last has no impulse
	CHECK_NEAR(apart.max_m, .25, 1e-12);
	CHECK_NEAR(apart.mean_m, .125, 1e-12);
}

// More contacts of cylinders than can be measured: it reports that, and obeys a request to stop.
static void test_separation_of_crowds(void)
{
	enum { CROWD = 400000 };
	ob_snapshot s = snapshot(2);
	ob_separation apart;
	int asked = 0;
	passports[0].shape = passports[1].shape = OB_SHAPE_CYLINDER;
	passports[0].size = passports[1].size = ob_v3(.5, .5, 0);
	motions[1].p = ob_v3(3, 0, 0);
	s.contact = calloc(CROWD, sizeof *s.contact);
	s.contacts = CROWD;
	for (uint32_t i = 0; i < CROWD; i++)
		s.contact[i] = (ob_contact_point){ .a = i % 2, .b = 1 - i % 2, .impulse = 1 };
	ob_measure_separation(&s, &apart, stop_now, &asked);
	CHECK(asked == 1 && isnan(apart.max_m) && isnan(apart.mean_m));
	ob_measure_separation(&s, &apart, NULL, NULL);
	CHECK(apart.pairs == 0 && isnan(apart.max_m) && isnan(apart.mean_m));
	free(s.contact);
}

int main(void)
{
	test_energy();
	test_momenta();
	test_state_is_of_the_snapshot();
	test_hash();
	test_penetration_by_hand();
	test_penetration_of_many();
	test_penetration_of_crowds();
	test_separation();
	test_separation_of_crowds();
	return check_end();
}
