#include "solver/push_apart.h"

#include <string.h>

#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/contact_solver.h"
#include "solver/contacts.h"

static const double pushed_share = .3; // share of the penetration, per partial substep
static const double most_share = 1.1; // largest factor on relative velocities, where a push has to give energy back

// ---- a free pair

typedef struct body_in_pair {
	double mass;
	ob_vec3 inertia, p, v, w;
	ob_mat3 r;
} body_in_pair;

// Motion of the pair about its centre of mass.
typedef struct pair_motion {
	ob_vec3 centre, v, angular; // m, m/s, N m s
	double inertia[6]; // kg m^2, as of one rigid body: xx xy xz yy yz zz
	double energy; // J
} pair_motion;

static body_in_pair body_of(const ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	return (body_in_pair){ body->mass, body->inertia, body->p, ob_row_linear(w->v[row]), ob_row_angular(w->v[row]),
			       body->r };
}

// Returns the body moved by the row's displacement: its rate turns with it.
static body_in_pair displaced(const ob_island_work *w, uint32_t row)
{
	body_in_pair x = body_of(w, row);
	const ob_vec3 rate = ob_rotate_back(&x.r, x.w);
	x.p = ob_add(x.p, ob_row_linear(w->d[row]));
	x.r = ob_quat_matrix(ob_quat_turn(w->body[row].q, ob_row_angular(w->d[row])));
	x.w = w->body[row].isotropic ? x.w : ob_rotate(&x.r, rate);
	return x;
}

// Adds a body's inertia about the axes, and that of its mass at the arm.
static void add_inertia(double *sum, const body_in_pair *x, ob_vec3 arm)
{
	const double k[3] = { x->inertia.x, x->inertia.y, x->inertia.z }, a[3] = { arm.x, arm.y, arm.z };
	int c = 0;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++, c++) {
			sum[c] += x->mass * ((i == j ? ob_norm2(arm) : 0) - a[i] * a[j]);
			for (int n = 0; n < 3; n++)
				sum[c] += x->r.m[i][n] * x->r.m[j][n] * k[n];
		}
}

static pair_motion motion_of(const body_in_pair *x)
{
	const double share = x[1].mass / (x[0].mass + x[1].mass);
	pair_motion m = { .centre = ob_madd(x[0].p, share, ob_sub(x[1].p, x[0].p)),
			  .v = ob_madd(x[0].v, share, ob_sub(x[1].v, x[0].v)) };
	for (int i = 0; i < 2; i++) {
		const ob_vec3 arm = ob_sub(x[i].p, m.centre), v = ob_sub(x[i].v, m.v),
			      rate = ob_rotate_back(&x[i].r, x[i].w), k = x[i].inertia;
		const ob_vec3 spin = ob_rotate(&x[i].r, ob_v3(k.x * rate.x, k.y * rate.y, k.z * rate.z));
		m.angular = ob_add(m.angular, ob_madd(spin, x[i].mass, ob_cross(arm, v)));
		m.energy += .5 * (x[i].mass * ob_norm2(v) + ob_dot(spin, x[i].w));
		add_inertia(m.inertia, &x[i], arm);
	}
	return m;
}

// Returns the rate, rad/s, at which the two would turn as one rigid body with this angular momentum.
static ob_vec3 turn_of(const pair_motion *m, ob_vec3 angular)
{
	const double *s = m->inertia;
	const double a = s[3] * s[5] - s[4] * s[4], b = s[2] * s[4] - s[1] * s[5], c = s[1] * s[4] - s[2] * s[3],
		     d = s[0] * s[5] - s[2] * s[2], e = s[1] * s[2] - s[0] * s[4], f = s[0] * s[3] - s[1] * s[1];
	const ob_vec3 sum =
		ob_v3(a * angular.x + b * angular.y + c * angular.z, b * angular.x + d * angular.y + e * angular.z,
		      c * angular.x + e * angular.y + f * angular.z);
	return ob_scale(sum, 1 / (s[0] * a + s[1] * b + s[2] * c));
}

// Sets velocities for the new poses that keep angular momentum, and energy as far as the relative motion can give or
// take it. false: there are none.
static bool keep_motion(const pair_motion *before, body_in_pair *x)
{
	const pair_motion moved = motion_of(x);
	const ob_vec3 given_back = turn_of(&moved, ob_sub(before->angular, moved.angular));
	for (int i = 0; i < 2; i++) {
		x[i].v = ob_add(x[i].v, ob_cross(given_back, ob_sub(x[i].p, moved.centre)));
		x[i].w = ob_add(x[i].w, given_back);
	}
	const double now = motion_of(x).energy;
	const ob_vec3 as_one = turn_of(&moved, before->angular); // least energy at this angular momentum
	const double least = .5 * ob_dot(as_one, before->angular);
	if (now <= before->energy && !(now > least))
		return true;
	if (!(before->energy >= least && now > least))
		return false;
	const double share = ob_min(sqrt((before->energy - least) / (now - least)), most_share);
	for (int i = 0; i < 2; i++) {
		const ob_vec3 v = ob_add(moved.v, ob_cross(as_one, ob_sub(x[i].p, moved.centre)));
		x[i].v = ob_madd(v, share, ob_sub(x[i].v, v));
		x[i].w = ob_madd(as_one, share, ob_sub(x[i].w, as_one));
	}
	return true;
}

// Applies the displacements of two bodies whose poses were up to date.
static void move_pair(ob_island_work *w, uint32_t a, uint32_t b)
{
	const bool free = w->body[a].inv_mass > 0 && w->body[b].inv_mass > 0;
	const uint32_t row[2] = { a, b };
	body_in_pair x[2] = { body_of(w, a), body_of(w, b) };
	const pair_motion before = motion_of(x);
	for (int i = 0; i < 2; i++)
		x[i] = displaced(w, row[i]);
	const bool kept = !free || keep_motion(&before, x);
	for (int i = 0; i < 2; i++) {
		if (!kept)
			memset(w->d[row[i]], 0, sizeof *w->d);
		ob_body_update_pose(w, row[i]);
		if (kept && free)
			ob_body_set_velocity(w, row[i], x[i].v, x[i].w);
	}
}

static bool is_deep(const ob_island_work *w, const ob_batch *b, double left)
{
	lanes moved[OB_ROWS];
	bool deep = false;
	ob_batch_row_velocities(b, w->d, moved);
	for (int j = 0; j < OB_POINTS; j++)
		for (int l = 0; l < OB_LANES; l++)
			deep |= b->live >> l & 1 && b->gap[j][l] + moved[j][l] < -left;
	return deep;
}

// Pushes colour by colour, also where the solver is Jacobi's.
static void push_free(ob_solver *s, double left)
{
	ob_island_work *w = &s->island;
	for (uint32_t k = 0; k < w->batches && !ob_budget_spent(s); k++) {
		ob_batch *b = &w->batch[w->batch_order[k]];
		if (!b->live || !is_deep(w, b, left))
			continue;
		for (int l = 0; l < OB_LANES; l++)
			if (b->live >> l & 1) {
				// each pose updates the gaps of all its body's contacts
				ob_budget_note(s, w->body[b->body_a[l]].adjacent + w->body[b->body_b[l]].adjacent);
				ob_body_update_pose(w, b->body_a[l]);
				ob_body_update_pose(w, b->body_b[l]);
			}
		if (!ob_batch_project(b, left, pushed_share, false, w->d, w->delta))
			continue;
		w->projected = true;
		for (int l = 0; l < OB_LANES; l++)
			if (b->live >> l & 1)
				move_pair(w, b->body_a[l], b->body_b[l]);
	}
}

// ---- bodies under external forces

// Returns the potential energy (J) that all bodies' displacements add against their external accelerations.
static double potential_energy(const ob_island_work *w)
{
	double sum = 0;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_vec3 a = w->body[i].acceleration;
		sum -= w->body[i].mass * (a.x * w->d[i][0] + a.y * w->d[i][1] + a.z * w->d[i][2]);
	}
	return sum;
}

// Adds the pushes to the contacts' paths. A pushed body turns, too, and its axis-aligned box grows or shrinks: the
// narrow phase must test it again.
static void add_push_to_paths(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++) {
		double *was = w->delta[i];
		const double *is = w->d[i];
		ob_vec3 shift = ob_v3(is[0] - was[0], is[1] - was[1], is[2] - was[2]);
		ob_vec3 turn = ob_v3(is[3] - was[3], is[4] - was[4], is[5] - was[5]);
		const double path = ob_norm(shift) + w->body[i].radius * ob_norm(turn);
		w->body[i].path += path;
		for (uint32_t k = 0; k < w->body[i].adjacent; k++)
			w->contact[w->adjacency[w->body[i].first_adjacent + k]].path += path;
		memset(was, 0, sizeof *w->delta);
	}
}

// True if rows of the body's contacts, which are straight lines, do not describe its turn in the partial substep.
static bool turns_fast(const ob_island_work *w, const ob_body *body)
{
	const double turn = .03; // rad
	return body->turning * w->h > turn * body->radius;
}

// Finds contacts anew that carry no load but seem deeper than "left" (m), where a body turns fast: one that only
// passes another would be pushed, and its angular momentum turned.
static void renew_passing(ob_solver *s, double left)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		if (contact->lane == OB_NO_LANE ||
		    !(turns_fast(w, &w->body[contact->a]) || turns_fast(w, &w->body[contact->b])) ||
		    ob_contact_load_of(w, contact) > 0 || !(ob_contact_gap(w, contact) < -left))
			continue;
		s->counters.narrowphase_tests++;
		ob_contact_find(s, contact);
	}
}

void ob_push_apart(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double left = ob_solver_slop(s);
	renew_passing(s, left);
	if (w->plastic && w->max_acceleration == 0) {
		push_free(s, left);
		return;
	}
	const bool jacobi = s->methods.jacobi, aabb = s->methods.boxes && !jacobi;
	const double before = potential_energy(w);
	if (aabb)
		memcpy(w->delta + 1, w->d + 1, w->bodies * sizeof *w->d);
	for (uint32_t k = 0; k < w->batches; k++) {
		ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			w->projected |= ob_batch_project(b, left, pushed_share, jacobi, w->d, w->delta);
	}
	if (jacobi)
		ob_solver_add_rows(w, w->d, w->delta);
	if (aabb)
		add_push_to_paths(w);
	w->recovered += potential_energy(w) - before;
}
