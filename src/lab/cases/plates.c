// Thin plates and discs that slide and spin at once. Each element of the surface has friction of its own: sliding slows
// the spinning, spinning slows the sliding, and both end together.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/plate.h"
#include "shape/shape.h"
#include "world/world.h"

enum { RATIOS = 7 };
static const double ratio[RATIOS] = { .05, .2, .5, 1, 2, 5, 20 }; // speed over the rim's
static const double mu = .25, speed = 2, thin = 1e-3; // m/s: both speeds together; m: half the thickness
static const double attitude = .3, heading = 1.1; // rad

// Body 1 + k RATIOS + i is plate k with ratio i; 4 m from its neighbours.
static ob_vec3 place(int k, int i)
{
	return ob_v3(4 * (i - RATIOS / 2), 4 * (k - 1), thin);
}

static void start(ob_world_body b, int i, double radius)
{
	double v = speed * ratio[i] / hypot(1, ratio[i]), rim = speed / hypot(1, ratio[i]);
	b.state->v = ob_v3(v * cos(heading), v * sin(heading), 0);
	b.state->w = ob_v3(0, 0, (i % 2 ? -rim : rim) / radius);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, attitude));
}

// variant: true if it is a box
static void build_floor(ob_world *w, const double *variant)
{
	if (variant[0] > 0)
		ob_world_box(w, 0, ob_v3(20, 20, .5), ob_v3(0, 0, -.5));
	else
		ob_world_ground(w);
}

enum { PLATES = 3 };
static const double half_side[PLATES][2] = { { .4, .4 }, { .4, .2 }, { .5, .05 } }; // m

static void build_plates(ob_world *w, uint32_t run, const double *variant)
{
	build_floor(w, variant);
	for (int k = 0; k < PLATES; k++) {
		const double *half = half_side[k];
		for (int i = 0; i < RATIOS; i++)
			start(ob_world_box(w, 1, ob_v3(half[0], half[1], thin), place(k, i)), i,
			      hypot(half[0], half[1]));
	}
	ob_world_material(w, mu, 0);
}

static const double radius = .4; // m

static void build_discs(ob_world *w, uint32_t run, const double *variant)
{
	build_floor(w, variant);
	for (int i = 0; i < RATIOS; i++)
		start(ob_world_cylinder(w, 1, radius, thin, place(0, i)), i, radius);
	ob_world_material(w, mu, 0);
}

static double turned_from(const ob_case_run_state *t, uint32_t id)
{
	ob_quat a = t->world->state[id].pose.q, b = ob_look_at(t, id).pose.q;
	return 2 * remainder(atan2(b.z, b.w) - atan2(a.z, a.w), M_PI);
}

// Errors of one body's displacement and turn, relative to its own.
static void compare(const ob_case_run_state *t, uint32_t id, double *way, double *turn)
{
	const ob_passport *p = &t->world->passport[id];
	const ob_state *s = &t->world->state[id];
	ob_reference_plate plate = { ob_shape_is(p->shape, OB_RIMMED), p->size.x, p->size.y, mu, ob_look_gravity(t) };
	ob_reference_plate_state from = { .angle = attitude, .vx = s->v.x, .vy = s->v.y, .w = s->w.z };
	ob_reference_plate_state exact = ob_reference_plate_slide(&plate, from, t->time);
	ob_vec3 moved = ob_look_moved(t, id);
	double went = hypot(exact.x, exact.y), by = exact.angle - attitude;
	ob_look_keep(way, hypot(moved.x - exact.x, moved.y - exact.y) / went);
	ob_look_keep(turn, fabs(remainder(turned_from(t, id) - by, 2 * M_PI) / by));
}

static void judge_plates(ob_case_run_state *t)
{
	for (uint32_t id = 1; id < t->world->objects; id++) {
		uint32_t k = (id - 1) / RATIOS;
		compare(t, id, &t->figure[2 * k], &t->figure[2 * k + 1]);
	}
	if (!ob_look_fail_below(t) && ob_look_farthest(t) < .1)
		t->failed = "nothing moved";
}

#define SURFACE "friction of each element of the surface (Goyal, Ruina and Papadopoulos 1991)"
#define FARKAS "friction of each element of the surface (Farkas et al. 2003)"
// clang-format off
#define PLATE_FIGURE \
	{ { "error of the way, square", "1", .01, SURFACE }, { "error of the turn, square", "1", .01, SURFACE }, \
	  { "error of the way, 1 : 2", "1", .01, SURFACE }, { "error of the turn, 1 : 2", "1", .01, SURFACE }, \
	  { "error of the way, bar", "1", .01, SURFACE }, { "error of the turn, bar", "1", .01, SURFACE } }
#define DISC_FIGURE \
	{ { "error of the way", "1", .01, FARKAS }, { "error of the turn", "1", .01, FARKAS } }
// clang-format on
#define PLATE_CASE .row = 27, .duration = 2, .judge = judge_plates

const ob_case ob_case_plates_plane = {
	.name = "plates-plane",
	.title = "Plates slide and spin on a plane",
	.setup = "Thin plates, a square, one of 1 : 2 and a bar of 1 : 10, slide and spin until they stop: v over that "
		 "of the rim from .05 to 20; friction .25.",
	.figures = 6,
	.figure = PLATE_FIGURE,
	.build = build_plates,
	PLATE_CASE,
};

const ob_case ob_case_plates_box = {
	.name = "plates-box",
	.title = "Plates slide and spin on a box",
	.setup = "As before, on the upper face of a fixed box.",
	.figures = 6,
	.figure = PLATE_FIGURE,
	.build = build_plates,
	.variant = { true },
	PLATE_CASE,
};

const ob_case ob_case_discs_plane = {
	.name = "discs-plane",
	.title = "Discs slide and spin on a plane",
	.setup = "Thin cylinders slide and spin until they stop: v over that of the rim from .05 to 20; friction .25.",
	.figures = 2,
	.figure = DISC_FIGURE,
	.build = build_discs,
	PLATE_CASE,
};

const ob_case ob_case_discs_box = {
	.name = "discs-box",
	.title = "Discs slide and spin on a box",
	.setup = "As before, on the upper face of a fixed box.",
	.figures = 2,
	.figure = DISC_FIGURE,
	.build = build_discs,
	.variant = { true },
	PLATE_CASE,
};
