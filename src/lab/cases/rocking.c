// Rocking blocks and cylinders: on one edge or point of the rim until upright, then on the opposite one.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/pivot.h"
#include "world/world.h"

static const double height = .5, depth = .3, rough = 2; // m: half height and half depth; friction: they do not slip
enum { MEMORY_TILT, MEMORY_RATE, MEMORY_HITS, MEMORY_FRAME, MEMORY_QUARTER, MEMORY_RATIO };

// Tilts by half of the toppling angle about y, on the edge or rim towards +x.
static void tilt(ob_world_body b, double half, double x)
{
	double angle = .5 * atan2(half, height);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	b.state->pose.p = ob_v3(x, 0, half * sin(angle) + height * cos(angle));
}

enum { BLOCKS = 3, CYLINDERS = 2 };
static const double slenderness[BLOCKS] = { 2, 4, 10 };

static void build_blocks(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	for (int i = 0; i < BLOCKS; i++) {
		double half = height / slenderness[i];
		tilt(ob_world_box(w, 1000 * half * depth * height, ob_v3(half, depth, height), ob_v3(0, 0, 0)), half,
		     10 * i);
	}
	ob_world_material(w, rough, 0);
}

static void build_cylinders(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	for (int i = 0; i < CYLINDERS; i++) {
		double half = height / slenderness[i];
		tilt(ob_world_cylinder(w, 1000 * half * half, half, height, ob_v3(0, 0, 0)), half, 10 * i);
	}
	ob_world_material(w, rough, 0);
}

static ob_reference_rocker rocker_of(const ob_case_run_state *t, uint32_t id)
{
	const ob_passport *p = &t->world->passport[id];
	return (ob_reference_rocker){ p->size.x, height, p->inertia.y / p->mass, ob_look_gravity(t) };
}

static double tilt_of(ob_quat q)
{
	ob_mat3 r = ob_quat_matrix(q);
	return atan2(r.m[0][2], r.m[2][2]);
}

// Rate, squared, at the impact without loss of energy.
static double rate_of_hit(const ob_reference_rocker *r, const ob_state *s)
{
	double arm = r->half * r->half + r->height * r->height;
	return (ob_norm2(s->v) + r->moment * ob_norm2(s->w) + 2 * r->g * (s->pose.p.z - r->height)) / (r->moment + arm);
}

// Errors of the quarter period and of the ratio at the first hits; error of the energy until the first.
static void observe_rocker(ob_case_run_state *t, uint32_t id, int hits, double *quarter, double *ratio, double *loss)
{
	ob_reference_rocker r = rocker_of(t, id);
	ob_state s = ob_look_at(t, id);
	double *memory = &t->body_memory[8 * id], angle = tilt_of(s.pose.q), before = memory[MEMORY_TILT];
	double rate = rate_of_hit(&r, &s), start = rate_of_hit(&r, &t->world->state[id]);
	bool hit = t->frame && (angle < 0) != (before < 0);
	if (hit && memory[MEMORY_HITS] == 0) {
		double exact = ob_reference_rocker_time(&r, .5 * atan2(r.half, r.height), 0);
		*quarter = fabs(memory[MEMORY_QUARTER] / exact - 1);
	}
	if (hit && memory[MEMORY_HITS] < hits)
		ob_look_keep(ratio, fabs(sqrt(rate / memory[MEMORY_RATE]) / ob_reference_rocker_ratio(&r) - 1));
	memory[MEMORY_HITS] += hit;
	if (memory[MEMORY_HITS] == 0) {
		memory[MEMORY_QUARTER] = t->time + ob_reference_rocker_time(&r, angle, s.w.y);
		ob_look_keep(loss, fabs(rate / start - 1));
	}
	memory[MEMORY_TILT] = angle;
	memory[MEMORY_RATE] = rate;
}

static void judge_rockers(ob_case_run_state *t)
{
	for (uint32_t id = 1; id < t->world->objects; id++)
		if (t->body_memory[8 * id + MEMORY_HITS] < 1)
			t->failed = "never hit";
	ob_look_fail_below(t);
}

static void observe_blocks(ob_case_run_state *t)
{
	for (uint32_t i = 0; i < BLOCKS; i++)
		observe_rocker(t, 1 + i, 3, &t->figure[i], &t->figure[BLOCKS + i], &t->figure[2 * BLOCKS]);
}

static void observe_cylinders(ob_case_run_state *t)
{
	for (uint32_t i = 0; i < CYLINDERS; i++)
		observe_rocker(t, 1 + i, 1, &t->figure[i], &t->figure[CYLINDERS + i], &t->figure[2 * CYLINDERS]);
}

#define QUARTER "angle'' = -g R / (moment + R^2) sin(alpha - angle) (Housner 1963)"
#define RATIO "moment of momentum about the new pivot (Housner 1963)"
#define LOSS "none before it hits"

const ob_case ob_case_rocking_blocks = {
	.row = 31,
	.name = "rocking-blocks",
	.slow = true,
	.title = "Rocking blocks",
	.setup = "Blocks of 1 m, 2, 4 and 10 times as high as wide, start at rest on an edge, tilted by half of the "
		 "angle "
		 "at which they would topple, and hit three times; friction 2, no restitution.",
	.duration = 2.5,
	.figures = 2 * BLOCKS + 1,
	.figure = { { "error of a quarter period, 2 : 1", "1", 5e-4, QUARTER },
		    { "error of a quarter period, 4 : 1", "1", 5e-4, QUARTER },
		    { "error of a quarter period, 10 : 1", "1", 5e-4, QUARTER },
		    { "error of the ratio at a hit, 2 : 1", "1", 2e-3, RATIO },
		    { "error of the ratio at a hit, 4 : 1", "1", 2e-3, RATIO },
		    { "error of the ratio at a hit, 10 : 1", "1", 2e-3, RATIO },
		    { "error of energy before the first hit", "1", NAN, LOSS } },
	.build = build_blocks,
	.observe = observe_blocks,
	.judge = judge_rockers,
};

const ob_case ob_case_rocking_cylinders = {
	.row = 31,
	.name = "rocking-cylinders",
	.slow = true,
	.title = "Rocking cylinders",
	.setup = "Cylinders of 1 m, 2 and 4 times as high as wide, start at rest on their rim as the blocks, and hit "
		 "once.",
	.duration = .6,
	.figures = 2 * CYLINDERS + 1,
	.figure = { { "error of a quarter period, 2 : 1", "1", 5e-4, QUARTER },
		    { "error of a quarter period, 4 : 1", "1", 5e-4, QUARTER },
		    { "error of the ratio at the hit, 2 : 1", "1", 2e-3, RATIO },
		    { "error of the ratio at the hit, 4 : 1", "1", 2e-3, RATIO },
		    { "error of energy before the hit", "1", NAN, LOSS } },
	.build = build_cylinders,
	.observe = observe_cylinders,
	.judge = judge_rockers,
};

// ---- a disk rolling on its rim, its centre at rest

static const double radius = .5, half_thick = .025, lean = 10 * M_PI / 180; // m, rad
enum { MEMORY_AZIMUTH, MEMORY_TURNED, MEMORY_ENERGY };

static void build_disk(ob_world *w, uint32_t run, const double *variant)
{
	double turn = ob_reference_disk_precession(radius, half_thick, lean, OB_WORLD_GRAVITY);
	double spin = ob_reference_disk_spin(radius, half_thick, lean, OB_WORLD_GRAVITY);
	ob_world_ground(w);
	ob_vec3 at = ob_v3(0, 0, radius * sin(lean) + half_thick * cos(lean));
	ob_world_body b = ob_world_cylinder(w, 10, radius, half_thick, at);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, lean, 0));
	b.state->w = ob_v3(spin * sin(lean), 0, spin * cos(lean) + turn);
	ob_world_material(w, .5, 0);
}

static void observe_disk(ob_case_run_state *t)
{
	ob_mat3 r = ob_quat_matrix(ob_look_at(t, 1).pose.q);
	double azimuth = atan2(r.m[1][2], r.m[0][2]), *memory = t->memory;
	double lying = t->world->passport[1].mass * ob_look_gravity(t) * half_thick, energy = ob_look_energy(t) - lying;
	if (!t->frame)
		memory[MEMORY_ENERGY] = energy;
	else
		memory[MEMORY_TURNED] += remainder(azimuth - memory[MEMORY_AZIMUTH], 2 * M_PI);
	memory[MEMORY_AZIMUTH] = azimuth;
	ob_look_keep(&t->figure[2], fabs(acos(fmin(1, r.m[2][2])) / lean - 1));
}

static void judge_disk(ob_case_run_state *t)
{
	double lying = t->world->passport[1].mass * ob_look_gravity(t) * half_thick;
	double exact = ob_reference_disk_precession(radius, half_thick, lean, ob_look_gravity(t));
	t->figure[0] = fabs(t->memory[MEMORY_TURNED] / t->time / exact - 1);
	t->figure[1] = fabs(1 - (ob_look_energy(t) - lying) / t->memory[MEMORY_ENERGY]) / t->time;
	ob_look_fail_below(t);
}

const ob_case ob_case_rolling_disk = {
	.row = 32,
	.name = "rolling-disk",
	.title = "Disk that rolls on its rim",
	.setup = "A disk of 1 m x 50 mm rolls on its rim for 3 s, at 10 degrees to the ground, its centre at rest; "
		 "friction .5.",
	.duration = 3,
	.figures = 3,
	.figure = { { "error of the precession", "1", 1e-3,
		      "steady rolling without slip (Moffatt 2000, with thickness)" },
		    { "change of energy in a second", "1", 2e-3, "none; over that above lying flat" },
		    { "change of the tilt", "1", NAN, "none" } },
	.build = build_disk,
	.observe = observe_disk,
	.judge = judge_disk,
};
