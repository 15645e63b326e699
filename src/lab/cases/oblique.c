// Ten thousand random oblique hits: a sphere on a sphere, on a box, on a capsule, on a plane. All in free space, each
// pair in a cell of its own.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum { PARTNERS = 4, HITS = 2500, SIDE = 50 };
static const double cell = 8, hit_by = .18; // m, s
static const ob_shape partner[PARTNERS] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_PLANE };

// A hit, drawn anew from its seed on each use.
typedef struct hit {
	ob_reference_sphere a, b; // before; b: a sphere, or fixed
	ob_vec3 point, normal; // contact point; from b to a
	ob_pose pose; // pose of b at the hit
	ob_vec3 size; // size of b
	double e, mu, time; // s
} hit;

static ob_vec3 unit(uint64_t *seed)
{
	ob_vec3 v;
	do
		v = ob_splitmix_vector(seed, 1);
	while (ob_norm2(v) > 1 || ob_norm2(v) < .01);
	return ob_scale(v, 1 / ob_norm(v));
}

// Draws a point of b's surface and the normal there, in the frame of b.
static void draw_point(hit *h, ob_shape shape, uint64_t *seed)
{
	h->normal = ob_v3(0, 0, 1);
	h->point = ob_v3(0, 0, 0);
	if (shape == OB_SHAPE_SPHERE) {
		h->normal = unit(seed);
		h->point = ob_scale(h->normal, h->size.x);
	} else if (shape == OB_SHAPE_BOX) { // well inside the face +z
		h->point = ob_v3(ob_splitmix_within(seed, -.8, .8) * h->size.x,
				 ob_splitmix_within(seed, -.8, .8) * h->size.y, h->size.z);
	} else if (shape == OB_SHAPE_CAPSULE) { // the side, or a cap
		ob_vec3 n = unit(seed);
		bool cap = ob_splitmix_real(seed) < .5;
		double round = 1 / hypot(n.x, n.y);
		h->normal = cap ? n : ob_v3(n.x * round, n.y * round, 0);
		h->point = ob_scale(h->normal, h->size.x);
		h->point.z += cap ? copysign(h->size.y, n.z) : .9 * n.z * h->size.y;
	}
}

static hit draw(uint32_t run, uint32_t i)
{
	uint64_t seed = 1000003 * (run + 1) + i;
	for (int warm = 0; warm < 4; warm++)
		ob_splitmix(&seed);
	hit h = { .e = ob_splitmix_real(&seed), .mu = 1.2 * ob_splitmix_real(&seed) };
	ob_shape shape = partner[run];
	h.time = ob_splitmix_within(&seed, .03, hit_by);
	h.size = ob_add(ob_v3(.3, .3, .3), ob_splitmix_vector(&seed, .2));
	bool plane = shape == OB_SHAPE_PLANE;
	h.pose.p = ob_v3(cell * (i % SIDE - SIDE / 2.), cell * (i / SIDE - SIDE / 2.), 0);
	h.pose.q = plane ? ob_quat_identity() : ob_world_random_attitude(&seed);
	draw_point(&h, shape, &seed);
	ob_mat3 r = ob_quat_matrix(h.pose.q);
	h.normal = ob_rotate(&r, h.normal);
	h.point = ob_add(h.pose.p, ob_rotate(&r, h.point));
	h.b = (ob_reference_sphere){ .mass = INFINITY, .radius = h.size.x };
	h.a = (ob_reference_sphere){ .mass = ob_splitmix_within(&seed, .5, 5),
				     .radius = ob_splitmix_within(&seed, .05, .5) };
	h.a.v = ob_splitmix_vector(&seed, 4);
	h.a.v = ob_madd(h.a.v, -ob_dot(h.a.v, h.normal) - ob_splitmix_within(&seed, .5, 5), h.normal);
	h.a.w = ob_splitmix_vector(&seed, 10);
	if (shape == OB_SHAPE_SPHERE) {
		h.b.mass = ob_splitmix_within(&seed, .5, 5);
		h.b.v = ob_splitmix_vector(&seed, 1);
		h.b.w = ob_splitmix_vector(&seed, 10);
		h.a.v = ob_add(h.a.v, h.b.v);
	}
	return h;
}

// Body i of the first HITS is the sphere of hit i, body HITS + i its target (a plane: body HITS, for all).
static void build_oblique(ob_world *w, uint32_t run, const double *variant)
{
	w->gravity = ob_v3(0, 0, 0);
	for (uint32_t i = 0; i < HITS; i++) {
		hit h = draw(run, i);
		ob_vec3 at = ob_madd(ob_madd(h.point, h.a.radius, h.normal), -h.time, h.a.v);
		ob_world_body a = ob_world_sphere(w, h.a.mass, h.a.radius, at);
		a.state->v = h.a.v;
		a.state->w = h.a.w;
		a.passport->friction = h.mu * h.mu;
		a.passport->restitution = h.e;
	}
	for (uint32_t i = 0; i < (partner[run] == OB_SHAPE_PLANE ? 1 : HITS); i++) {
		hit h = draw(run, i);
		double mass = isinf(h.b.mass) ? 0 : h.b.mass;
		bool plane = partner[run] == OB_SHAPE_PLANE;
		ob_vec3 at = plane ? ob_v3(0, 0, 0) : ob_madd(h.pose.p, -h.time, h.b.v);
		ob_world_body b = ob_world_add(w, partner[run], plane ? ob_v3(0, 0, 0) : h.size, mass, at);
		b.state->pose.q = h.pose.q;
		b.state->v = h.b.v;
		b.state->w = h.b.w;
		b.passport->friction = 1;
	}
}

// Error over the relative speed at the contact point.
static double error(const ob_case_run_state *t, uint32_t id, const ob_reference_sphere *exact, double scale)
{
	ob_state s = ob_look_at(t, id);
	return fmax(ob_norm(ob_sub(s.v, exact->v)), exact->radius * ob_norm(ob_sub(s.w, exact->w))) / scale;
}

static void judge_oblique(ob_case_run_state *t)
{
	uint32_t missed = 0;
	for (uint32_t i = 0; i < HITS; i++) {
		hit h = draw(t->run, i);
		double approach = -ob_dot(ob_sub(h.a.v, h.b.v), h.normal);
		ob_vec3 slip = ob_cross(ob_madd(ob_scale(h.a.w, h.a.radius), h.b.radius, h.b.w), h.normal);
		double scale = ob_norm(ob_sub(h.a.v, h.b.v)) + ob_norm(slip);
		ob_reference_oblique(&h.a, &h.b, h.normal, h.e, h.mu);
		missed += ob_dot(ob_sub(ob_look_at(t, i).v, h.b.v), h.normal) < -.5 * approach;
		ob_look_keep(&t->figure[t->run], error(t, i, &h.a, scale));
		if (isfinite(h.b.mass))
			ob_look_keep(&t->figure[t->run], error(t, HITS + i, &h.b, scale));
	}
	if (missed)
		t->failed = "passed through";
}

#define ROUTH "Newton's restitution, Coulomb's friction (Routh 1905)"

const ob_case ob_case_oblique = {
	.row = 30,
	.name = "oblique",
	.title = "Ten thousand oblique hits",
	.setup = "A spinning sphere hits a sphere, a fixed box, a fixed capsule, a plane, each 2500 times: sizes, "
		 "masses, "
		 "velocities, restitution 0 to 1 and friction 0 to 1.2 drawn by lot; in free space.",
	.duration = .2,
	.runs = PARTNERS,
	.figures = PARTNERS,
	.figure = { { "worst error, on spheres", "1", 1e-9, ROUTH },
		    { "worst error, on boxes", "1", 1e-9, ROUTH },
		    { "worst error, on capsules", "1", 1e-9, ROUTH },
		    { "worst error, on planes", "1", 1e-9, ROUTH } },
	.build = build_oblique,
	.judge = judge_oblique,
};
