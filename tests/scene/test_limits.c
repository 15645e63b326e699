// Limits of objects: a value at a limit is accepted, the next beyond it is refused in a line with the property, the
// value and both limits; by the check that all entrances share, and by a scene, with its line.
#include <stdlib.h>

#include "check.h"
#include "scene/object_limits.h"
#include "text.h"

static ob_object_def ball(void)
{
	return (ob_object_def){ .passport = { .shape = OB_SHAPE_SPHERE,
					      .size = { .1, 0, 0 },
					      .mass = 1,
					      .friction = .5,
					      .name = "ball" },
				.state = { .pose = { .q = ob_quat_identity() } },
				.dies = INFINITY };
}

static bool accepts(const ob_object_def *d, const char *property)
{
	ob_error e = { "" };
	const bool fine = ob_object_def_check(d, &e);
	if (!fine)
		CHECK(strncmp(e.text, property, strlen(property)) == 0 && strstr(e.text, ": expected from ") &&
		      strstr(e.text, ", got "));
	return fine;
}

// "value" lies in "d", and may be from "least" to "most".
static void check_range(ob_object_def *d, double *value, double least, double most, const char *property)
{
	const double kept = *value;
	const double good[] = { least, most, nextafter(least, most), nextafter(most, least) };
	const double bad[] = { nextafter(least, -INFINITY), nextafter(most, INFINITY), -INFINITY, INFINITY, NAN };
	for (int i = 0; i < 4; i++) {
		*value = good[i];
		CHECK(accepts(d, property));
	}
	for (int i = 0; i < 5; i++) {
		*value = bad[i];
		CHECK(!accepts(d, property));
	}
	*value = kept;
}

static void check_lengths(void)
{
	ob_object_def d = ball();
	double *const x[] = { &d.passport.size.x, &d.passport.size.y, &d.passport.size.z };
	check_range(&d, x[0], OB_LENGTH_LEAST, OB_LENGTH_MOST, "size");
	d.passport.flags = OB_OBJECT_STATIC; // as thin as one likes
	d.passport.size = ob_v3(1, 1, 1);
	d.passport.shape = OB_SHAPE_BOX;
	for (int i = 0; i < 3; i++)
		check_range(&d, x[i], OB_LENGTH_LEAST / 2, OB_LENGTH_MOST / 2, "size");
	for (uint32_t shape = OB_SHAPE_CAPSULE; shape <= OB_SHAPE_CYLINDER; shape++) {
		d.passport.shape = shape;
		check_range(&d, x[0], OB_LENGTH_LEAST, OB_LENGTH_MOST, "size");
		check_range(&d, x[1], OB_LENGTH_LEAST / 2, OB_LENGTH_MOST / 2, "size");
	}
	d = ball();
	d.passport.shape = OB_SHAPE_BOX;
	d.passport.size = ob_v3(1, .125 * OB_SLENDERNESS_MOST, 1);
	check_range(&d, x[0], .125, OB_SLENDERNESS_MOST, "size");
}

static void check_others(void)
{
	ob_object_def d = ball();
	ob_passport *p = &d.passport;
	ob_state *s = &d.state;
	check_range(&d, &p->mass, OB_MASS_LEAST, OB_MASS_MOST, "mass");
	check_range(&d, &p->friction, 0, OB_FRICTION_MOST, "friction");
	check_range(&d, &p->restitution, 0, 1, "restitution");
	check_range(&d, &p->force.y, -OB_ACCELERATION_MOST, OB_ACCELERATION_MOST, "force");
	check_range(&d, &s->pose.p.x, -OB_PLACE_MOST, OB_PLACE_MOST, "at");
	check_range(&d, &s->v.z, -OB_SPEED_MOST, OB_SPEED_MOST, "velocity");
	check_range(&d, &s->w.y, -OB_SPIN_MOST, OB_SPIN_MOST, "spin");
	p->size.x = 1000;
	check_range(&d, &s->w.y, -OB_SPEED_MOST / 1000, OB_SPEED_MOST / 1000, "spin");
	p->flags = OB_OBJECT_KINEMATIC;
	check_range(&d, &p->surface_velocity.x, -OB_SPEED_MOST, OB_SPEED_MOST, "surface_velocity");
	for (int i = 0; i < 4; i++) {
		const float bad[] = { -.1f, 1.1f, NAN, INFINITY };
		for (int k = 0; k < 4; k++) {
			p->colour[i] = bad[k];
			CHECK(!accepts(&d, "colour"));
		}
		p->colour[i] = 1;
	}
}

// What acts on an object is bounded by its mass and its least principal moment.
static void check_actions(void)
{
	ob_passport p = { .mass = 1e-6, .inertia = { 1e-3, 2e-9, 1 } };
	CHECK_NEAR(ob_force_most(&p), 1, 1e-12);
	CHECK_NEAR(ob_torque_most(&p), 2e-3, 1e-15);
	p = (ob_passport){ .flags = OB_OBJECT_STATIC };
	CHECK(ob_force_most(&p) == OB_FORCE_MOST && ob_torque_most(&p) == OB_FORCE_MOST);
}

static void check_scenes(void)
{
	static const struct {
		const char *text, *saying;
	} bad[] = {
		{ "sphere { radius = 1e-160, mass = 1 }",
		  ":1: sphere.radius: expected a number from 1e-06 to 1000000" },
		{ "sphere { radius = 1e300, mass = 1 }", "sphere.radius" },
		{ "box { size = { 1, 1, 1e-160 }, mass = 1 }", ":1: box.size: expected three numbers" },
		{ "box { size = { 1e6, 1e6, 1 }, mass = 1 }", ":1: box.size: expected from 1 to 10000 times as long" },
		{ "sphere { radius = 1e-6 }", ":1: sphere.mass: expected from 1e-12 to 1e+12 kg, got 4.18" },
		{ "sphere { radius = 1e6 }", ":1: sphere.mass: expected from 1e-12 to 1e+12 kg, got 4.18" },
		{ "\nhull { points = { {0,0,0}, {1e-160,0,0}, {0,1e-160,0}, {0,0,1e-160} }, mass = 1 }", ":2: hull." },
		{ "hull { points = { {0,0,0}, {1e-9,0,0}, {0,1e-9,0}, {0,0,1e-9} }, mass = 1 }",
		  ":1: hull.size: expected" },
		{ "hull { points = { {-1e6,-1e6,-1e6}, {1e6,0,0}, {0,1e6,0}, {0,0,1e6} }, mass = 1 }",
		  ":1: hull.size" },
		{ "sphere { radius = 1, mass = 1e-12, force = { 1, 0, 0 } }",
		  ":1: sphere.force: expected from -1e-06 to 1e-06 N" },
		{ "sphere { radius = 1e3, mass = 1, spin = { 0, 1e3, 0 } }",
		  ":1: sphere.spin: expected from 0 to 100000 m/s" },
		{ "sphere { radius = 1, kind = 'kinematic', path = { kind = 'sine', amplitude = { 1e6, 0, 0 }, "
		  "frequency = 1e4 } }",
		  ":1: sphere.path: expected from 0 to 100000 m/s" },
		{ "sphere { radius = 1, kind = 'kinematic', path = { kind = 'spline', points = { {0, 0, 0, 0}, {1, "
		  "5e6, 0, 0} } } }",
		  ":1: sphere.path: expected from 0 to 100000 m/s, got 5000000 m/s" },
		{ "sphere { radius = 1, mass = 1, varying_force = { kind = 'pulse', force = { 0, 2e6, 0 }, to = 1 } }",
		  ":1: sphere.varying_force: expected from -1000000 to 1000000 N, got 2000000 N" },
		{ "scene { step = 1e-300 }", ":1: scene.step: expected a number from 1e-09 to 10" },
	};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		ob_error e = { "" };
		ob_scene *s = load_text(bad[i].text, &e);
		if (s || !strstr(e.text, bad[i].saying))
			fprintf(stderr, "%s\n%s\n", bad[i].text, e.text);
		CHECK(!s && strstr(e.text, bad[i].saying));
		ob_scene_free(s);
	}
	ob_scene *s = load_good(
		"sphere { radius = 1e-6, mass = 1e-12, at = { 1e7, -1e7, 0 }, velocity = { 1e5, 0, 0 } }"
		"capsule { radius = 1e6, length = 1e-6, mass = 1e12 }"
		"box { size = { 1e6, 100, 100 }, mass = 1e-12 } box { size = { 1e6, 1e6, 1e-6 }, static = true }");
	CHECK(s);
	ob_scene_free(s);
}

int main(void)
{
	check_lengths();
	check_others();
	check_actions();
	check_scenes();
	return check_end();
}
