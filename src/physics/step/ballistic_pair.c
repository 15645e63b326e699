#include "step/flight.h"

#include "contact/impact.h"
#include "contact/manifold.h"
#include "exchange/results.h"
#include "motion/flight.h"
#include "solver/narrowphase.h"
#include "step/budget.h"

static const double least_approach = 1e-6; // m/s: the contact solver treats slower approaches
static const double points_margin = 1e-6; // m: margin of contact points; those of them as near as the first are hit

// First contact of the two bodies.
typedef struct touch {
	double time; // s; infinity: no contact
	ob_manifold m; // at that time and place
} touch;

static ob_placed placed_of(ob_sim *s, const ob_course *c, ob_vec3 v)
{
	const ob_passport *p = ob_passport_of(s->u, c->id);
	const ob_state now = ob_course_state(s, c);
	return (ob_placed){ .shape = p->shape,
			    .size = p->size,
			    .p = now.pose.p,
			    .r = ob_quat_matrix(now.pose.q),
			    .v = v,
			    .w = now.w,
			    .inertia = p->inertia,
			    .rest_depth =
				    ob_narrowphase_rest_depth(&s->solver, ob_shape_thickness(p->shape, p->size), false),
			    .far_future = ob_narrowphase_far_future(&s->solver),
			    .hull = ob_hull_of(s->u, p) };
}

// Finds the first contact between the present time of the courses and "until" (s), in the frame of the second body.
// Returns false if the search failed.
static bool find_touch(ob_sim *s, const ob_course c[2], double until, touch *x)
{
	const double since = c[0].since;
	const ob_vec3 none = { 0, 0, 0 }, v = ob_sub(ob_velocity_at(&c[0].m, since), ob_velocity_at(&c[1].m, since));
	const ob_placed a = placed_of(s, &c[0], v), b = placed_of(s, &c[1], none);
	const ob_turning turning[2] = { { c[0].spin, since - c[0].m.t0 }, { c[1].spin, since - c[1].m.t0 } };
	double when;
	s->solver.counters.swept_tests++;
	if (!ob_time_of_touch(&a, &b, turning, until - since, points_margin * s->solver.island.unit.length,
			      ob_narrowphase_follower(&s->solver), &when, &x->m))
		return false;
	x->time = since + when;
	const ob_vec3 gone = ob_sub(ob_centre_at(&c[1].m, x->time), b.p);
	for (int j = 0; j < x->m.points && when < INFINITY; j++)
		x->m.at[j] = ob_add(x->m.at[j], gone);
	return true;
}

// Collects the points that are hit: those as near as the first, projected into one plane, as convex bodies touch in
// one. Returns their number.
static uint32_t points_of(const ob_sim *s, const ob_manifold *m, const ob_state at[2], double mu, double e,
			  ob_impact_point *point)
{
	const double near = OB_IMPACT_SIMULTANEOUS * s->solver.island.unit.length;
	double level = 0;
	uint32_t n = 0;
	for (int j = 0; j < m->points; j++)
		if (m->gap[j] <= near)
			level += ob_dot(m->normal, ob_sub(m->at[j], at[0].pose.p)), n++;
	level /= n ? n : 1;
	n = 0;
	for (int j = 0; j < m->points; j++) {
		const double off = level - ob_dot(m->normal, ob_sub(m->at[j], at[0].pose.p));
		const ob_vec3 on = ob_madd(m->at[j], off, m->normal);
		if (m->gap[j] <= near)
			point[n++] = (ob_impact_point){ .b = 1,
							.normal = m->normal,
							.arm_a = ob_sub(on, at[0].pose.p),
							.arm_b = ob_sub(on, at[1].pose.p),
							.mu = mu,
							.e = e };
	}
	return n;
}

// Applies the impact at the contact points to the velocities of both bodies. Returns false if they do not rebound.
static bool apply_impact(ob_sim *s, const ob_course c[2], const ob_manifold *m, ob_state at[2])
{
	const ob_passport *p[2] = { ob_passport_of(s->u, c[0].id), ob_passport_of(s->u, c[1].id) };
	const double mu = ob_pair_friction(p[0]->friction, p[1]->friction),
		     e = ob_pair_restitution(p[0]->restitution, p[1]->restitution);
	ob_impact_point point[OB_PAIR_POINTS];
	ob_impact_body body[2];
	const uint32_t points = points_of(s, m, at, mu, e, point);
	for (int i = 0; i < 2; i++) {
		const ob_mat3 r = ob_quat_matrix(at[i].pose.q);
		body[i] = (ob_impact_body){ .inv_mass = 1 / p[i]->mass, .v = at[i].v, .w = at[i].w };
		ob_inverse_inertia(p[i]->inertia, &r, body[i].inv_inertia);
	}
	const double approach = ob_impact_approach(body, point, points);
	if (!(approach > least_approach * s->solver.island.unit.speed))
		return false;
	const bool parted = ob_impact_part(body, 2, point, points, approach);
	ob_touches_note(s->u, c[0].id, c[1].id, p[0]->mass * ob_dot(ob_sub(body[0].v, at[0].v), m->normal),
			ob_add(at[0].pose.p, point[0].arm_a));
	for (int i = 0; i < 2; i++)
		at[i].v = body[i].v, at[i].w = body[i].w;
	return parted;
}

static bool rebound_from_each_other(ob_sim *s, ob_course c[2], const ob_manifold *m)
{
	ob_state at[2] = { ob_course_state(s, &c[0]), ob_course_state(s, &c[1]) };
	const ob_deviation most = ob_deviation_larger(ob_course_deviation(s, &c[0]), ob_course_deviation(s, &c[1]));
	if (!apply_impact(s, c, m, at) || !ob_course_set_off(s, &c[0], &at[0], most) ||
	    !ob_course_set_off(s, &c[1], &at[1], most))
		return false;
	ob_courses_find_landings(s, (ob_course *[]){ &c[0], &c[1] }, 2);
	return true;
}

static bool rebound_from_plane(ob_sim *s, ob_course *c)
{
	if (!ob_course_rebound(s, c))
		return false;
	ob_courses_find_landings(s, &c, 1);
	return true;
}

// Advances both bodies from impact to impact until the step's end (s). impacts: their number. Returns false if the
// contact solver must treat the pair.
static bool follow(ob_sim *s, ob_course c[2], double end, uint32_t *impacts)
{
	for (*impacts = 0;; ++*impacts) {
		ob_course *first = &c[c[1].m.valid_until < c[0].m.valid_until];
		const double until = ob_min(first->m.valid_until, end);
		touch x;
		if (!find_touch(s, c, until, &x))
			return false;
		const bool meet = x.time < INFINITY;
		for (int i = 0; i < 2; i++)
			ob_course_follow(s, &c[i], meet ? x.time : until);
		if (meet ? !rebound_from_each_other(s, c, &x.m) : until < end && !rebound_from_plane(s, first))
			return false;
		if (!meet && until == end)
			return true;
	}
}

bool ob_ballistic_pair_advance(ob_sim *s, const uint32_t id[2])
{
	const double end = (double)(ob_step_count(s->u) + 1) * s->settings->step_length;
	ob_course c[2];
	uint32_t impacts;
	if (!s->solver.methods.instants || !(ob_pair_restitution(ob_passport_of(s->u, id[0])->restitution,
								 ob_passport_of(s->u, id[1])->restitution) > 0))
		return false;
	ob_courses_begin(s, id, c, 2);
	const bool parted = ob_equal(c[0].m.a, c[1].m.a) && follow(s, c, end, &impacts);
	ob_budget_note(&s->solver, c[0].work + c[1].work);
	if (!parted)
		return false;
	s->solver.counters.impacts += impacts;
	for (int i = 0; i < 2; i++)
		ob_course_publish(s, &c[i]);
	return true;
}
