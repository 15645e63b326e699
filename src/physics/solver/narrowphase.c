#include "solver/narrowphase.h"

#include "shape/shape.h"
#include "solver/budget.h"
#include "solver/contact_solver.h"

static const double swept_travel =
	.4; // share of the smaller thickness: faster pairs are followed through the partial substep
static const double swept_gap = 1e-3; // m: a smaller gap counts as touching

// ---- the collision test of the run

static uint64_t corners_of(const ob_placed *x)
{
	enum { OF_A_BOX = 8 };
	return ob_shape_is(x->shape, OB_SIDED) ? OF_A_BOX : x->hull ? x->hull->corners : 0;
}

// Returns the work of a test, with that of finding the points of a touching pair: a cylinder's rim is compared with all
// features of the other shape.
static uint64_t work_of_test(const ob_placed *a, const ob_placed *b)
{
	enum { LEAST = 8 };
	return LEAST + (a->hull || b->hull ? corners_of(a) + corners_of(b) : 0);
}

static uint64_t work_of_points(const ob_placed *a, const ob_placed *b)
{
	enum { OF_A_CORNER = 100, OF_TWO_ROUND = 256 };
	if (!ob_shape_is(a->shape, OB_RIMMED) && !ob_shape_is(b->shape, OB_RIMMED))
		return 0;
	const bool two = ob_shape_is(a->shape, OB_AXIAL) && ob_shape_is(b->shape, OB_AXIAL);
	return two ? OF_TWO_ROUND : OF_A_CORNER * (corners_of(a) + corners_of(b));
}

// Returns the work of tests with the ground below triangles of a terrain, whether points come of them or not.
static uint64_t work_of_pieces(const ob_placed *a, uint32_t pieces)
{
	enum { OF_A_BALL = 8, OF_A_HULL = 100, OF_A_RIM = 2500 };
	return (uint64_t)pieces * (ob_shape_is(a->shape, OB_ISOTROPIC) ? OF_A_BALL
				   : ob_shape_is(a->shape, OB_RIMMED)  ? OF_A_RIM
								       : OF_A_HULL);
}

void ob_shapes_find(ob_solver *s, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_manifold_find(a, b, margin, out);
	ob_budget_note(s, out->pieces ? work_of_pieces(a, out->pieces) : out->points ? work_of_points(a, b) : 0);
}

// Runs a collision test. Once the budget is spent all shapes are far apart, so that loops over many pairs, and searches
// in time, end soon.
static void find_manifold(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const double far = 1e30; // m: beyond all that moves within a run
	ob_solver *s = with;
	ob_placed part[2];
	a = ob_placed_own(a, &part[0]);
	b = ob_placed_own(b, &part[1]);
	ob_budget_note(s, work_of_test(a, b));
	out->disc_radius = 0;
	out->pieces = 0;
	out->valid_path = INFINITY;
	if (ob_budget_spent(s)) {
		out->points = 0;
		out->separation = far;
		return;
	}
	s->methods.find(s, a, b, margin, out);
}

ob_manifold_finder ob_narrowphase_finder(ob_solver *s)
{
	return (ob_manifold_finder){ find_manifold, s, s->methods.boxes };
}

// Tests two shapes at an instant of a search. The search places both by their rotation and looks for a direction along
// which they stay apart, which costs several tests.
static void find_on_the_way(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	enum { WORK_OF_ADVANCE = 16 };
	ob_budget_note(with, WORK_OF_ADVANCE);
	find_manifold(with, a, b, margin, out);
}

ob_manifold_finder ob_narrowphase_follower(ob_solver *s)
{
	return (ob_manifold_finder){ find_on_the_way, s, s->methods.boxes };
}

double ob_narrowphase_rest_depth(const ob_solver *s, double thickness, bool pressed)
{
	const double of_slop = pressed ? 2 : .01, of_thickness = .02;
	return ob_min(of_slop * ob_solver_slop(s), of_thickness * thickness);
}

double ob_narrowphase_far_future(const ob_solver *s)
{
	const double far_future = 10;
	return far_future * s->island.unit.time;
}

void ob_narrowphase_place(const ob_solver *s, uint32_t row, const ob_hull *part, ob_vec3 p, const ob_mat3 *r, ob_vec3 v,
			  ob_vec3 w, ob_placed *out)
{
	const ob_body *body = &s->island.body[row];
	out->shape = body->shape;
	out->size = body->size;
	out->p = p;
	out->r = *r;
	out->v = v;
	out->w = w;
	out->inertia = body->inertia;
	out->a = body->acceleration;
	out->rest_depth = body->rest_depth;
	out->far_future = ob_narrowphase_far_future(s);
	out->hull = part ? part : body->hull;
}

// Fills in the body, or a part of it, in its present state.
static void place(const ob_solver *s, uint32_t row, const ob_hull *part, ob_placed *out)
{
	const ob_body *body = &s->island.body[row];
	const double *v = s->island.v[row];
	ob_narrowphase_place(s, row, part, body->p, &body->r, ob_v3(v[0], v[1], v[2]), ob_v3(v[3], v[4], v[5]), out);
}

bool ob_narrowphase_area(const ob_solver *s, const ob_contact *contact, ob_contact_area *out)
{
	const ob_batch *b = &s->island.batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES;
	const ob_vec3 n = ob_batch_vector(b->n, l), t1 = ob_batch_vector(b->t1, l), t2 = ob_batch_vector(b->t2, l);
	ob_placed pa, pb;
	place(s, contact->a, contact->part[0], &pa);
	place(s, contact->b, contact->part[1], &pb);
	return ob_area_find(&pa, &pb, n, ob_add(pa.p, contact->friction_a), ob_add(pb.p, contact->friction_b), t1, t2,
			    out);
}

double ob_narrowphase_distance(ob_solver *s, uint32_t a, uint32_t b, double margin)
{
	ob_placed pa, pb;
	ob_manifold m;
	s->counters.narrowphase_tests++;
	place(s, a, NULL, &pa);
	place(s, b, NULL, &pb);
	find_manifold(s, &pa, &pb, margin, &m);
	return m.separation;
}

// Bounds the speed at which any two points of the pair may approach (m/s), with external acceleration.
static double closing_speed(const ob_solver *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	const double *va = w->v[contact->a], *vb = w->v[contact->b];
	ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	const double speed = ob_norm(rel) + w->body[contact->a].turning + w->body[contact->b].turning;
	return speed + w->max_acceleration * w->h;
}

// Extrapolates the gaps of points found at the time of impact t back to now: points that close at t have a gap that
// closes then. Nothing touches before t, so a point that opens at t does not penetrate now.
static void extrapolate_gaps_back(const ob_placed *a, const ob_placed *b, double t, ob_manifold *m)
{
	ob_vec3 rel = ob_sub(a->v, b->v);
	ob_vec3 pa = ob_madd(a->p, t, a->v), pb = ob_madd(b->p, t, b->v);
	for (int j = 0; j < m->points; j++) {
		ob_vec3 spin = ob_sub(ob_cross(a->w, ob_sub(m->at[j], pa)), ob_cross(b->w, ob_sub(m->at[j], pb)));
		m->gap[j] = ob_max(m->gap[j] - t * ob_dot(m->normal, ob_add(rel, spin)), ob_min(m->gap[j], 0));
	}
}

static double smaller_thickness(const ob_island_work *w, const ob_contact *contact)
{
	return ob_min(w->body[contact->a].thickness, w->body[contact->b].thickness);
}

// Returns the time of impact (s), and the points up to "reach" (m) at that time.
static double time_of_impact(ob_solver *s, const ob_contact *contact, double horizon, double reach, ob_manifold *m)
{
	const ob_island_work *w = &s->island;
	ob_placed a, b;
	place(s, contact->a, contact->part[0], &a);
	place(s, contact->b, contact->part[1], &b);
	double near = ob_min(swept_gap * w->unit.length, .25 * smaller_thickness(w, contact));
	s->counters.swept_tests++;
	return ob_time_of_impact(&a, &b, closing_speed(s, contact), horizon, near, reach, ob_narrowphase_follower(s),
				 m);
}

double ob_narrowphase_time_of_impact(ob_solver *s, const ob_contact *contact, double horizon)
{
	ob_manifold m;
	return time_of_impact(s, contact, horizon,
			      ob_min(swept_gap * s->island.unit.length, .25 * smaller_thickness(&s->island, contact)),
			      &m);
}

void ob_narrowphase_find(ob_solver *s, const ob_contact *contact, double tolerance, ob_manifold *m, double *when)
{
	const ob_island_work *w = &s->island;
	ob_placed a, b;
	place(s, contact->a, contact->part[0], &a);
	place(s, contact->b, contact->part[1], &b);
	double thin = smaller_thickness(w, contact), travel = closing_speed(s, contact) * w->h;
	*when = 0;
	if (travel < swept_travel * thin) {
		find_manifold(s, &a, &b, ob_min(tolerance + 1.5 * travel, ob_max(.5 * thin, tolerance + travel)), m);
		return;
	}
	double impact =
		time_of_impact(s, contact, w->h, ob_min(w->body[contact->a].radius, w->body[contact->b].radius), m);
	if (isinf(impact))
		return;
	*when = impact;
	extrapolate_gaps_back(&a, &b, *when, m);
}
