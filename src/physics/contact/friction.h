// Coulomb's law of friction of a pair: its force f is at most mu times the load x, and opposes the slip.
//
//      |f| <= mu x                at a point, and at the centroid of a contact in a stack or heap: a disc
//      |twist| <= mu radius x     about the normal, at that centroid
//      (f, twist) in C(x)         of an area whose pressure is known, as nothing else carries the two: contact/patch.h
//
// The law stands here and in contact/patch.h alone, as a text compiled for one number and for four in lanes. Sweeps of the
// contact solver call it for four pairs side by side (contact/kernel.c), sweeps and Newton steps for one (contact/lone.c).
// Two callers have other equations, of which the bound alone is the same:
//
// - An impact (contact/impact.c) finds load and friction of all points together, as velocities jump. So the bound moves
//   with the unknown load. A single point that slides has one unknown, the direction of its slip afterwards; several
//   have the derivative of the projection on this disc (Alart and Curnier 1991).
// - A direct solve (solver/direct_solver.c) takes friction within the bound for rows that hold, a linear system. It
//   projects the solution on this disc.
//
// The including file first includes elementary/real.h or elementary/real_lanes.h.
#ifndef OB_CONTACT_FRICTION_H
#define OB_CONTACT_FRICTION_H

// Returns the lanes where an impulse of load counts. Below, a slip over its square would be beyond all numbers.
static inline mask is_load(real x)
{
	const double least = 1e-75; // N s
	return x > least;
}

// A load pushes, and never pulls: change of a normal's impulse x where its row alone would change it by "step".
static inline real push_change(real x, real step)
{
	return larger_of(-x, step);
}

// Sweeps over a normal: changes its impulse x in the lanes "open", and adds it to the load. response: the row's own.
// largest: of the changes of a velocity. Returns the change, for the other rows.
static inline real push_sweep(mask open, real step, real response, real *x, real *load, real *largest)
{
	const real d = push_change(*x, step);
	*x += chosen(open, d, real_of(0));
	*load += *x;
	*largest = larger_of(*largest, size_of(d) * response);
	return d;
}

// Returns the factor that brings a force of this squared length to the disc: 1 within it.
static inline real disc_share(real bound, real length2)
{
	return bound / root_of(larger_of(length2, bound * bound) + 1e-300);
}

// Returns the lanes where friction, of this squared length, is at its bound: it slides.
static inline mask disc_slides(real bound, real length2)
{
	const double at_limit = 1 - 1e-9;
	return length2 >= at_limit * bound * bound;
}

// Sliding friction in a step of Newton's method: its length stays mu times the load, and it stays opposite to the slip
// (Alart and Curnier 1991). At a slip of t times its impulse, a change y across it meets the rows' response and t y.
typedef struct disc_tangent {
	real brought[2]; // friction for a unit of load
	real across[2]; // unit, across the friction
	real t; // m/s for a unit of impulse
} disc_tangent;

static inline disc_tangent disc_follow(const real *x, real load, const real *slip)
{
	const real length = root_of(x[0] * x[0] + x[1] * x[1]);
	const real against = -(slip[0] * x[0] + slip[1] * x[1]) / (length * length);
	return (disc_tangent){
		.brought = { x[0] / load, x[1] / load },
		.across = { -x[1] / length, x[0] / length },
		.t = larger_of(real_of(0), against),
	};
}

// Inverts A's block of friction, a: 11 12 22. Returns its largest eigenvalue.
static inline real disc_invert(const real *a, real *m)
{
	const real half = .5 * (a[0] - a[2]), det = a[0] * a[2] - a[1] * a[1];
	const real inverse = chosen(det > 0, 1 / det, real_of(0));
	m[0] = a[2] * inverse, m[1] = -a[1] * inverse, m[2] = a[0] * inverse;
	return .5 * (a[0] + a[2]) + root_of(half * half + a[1] * a[1]);
}

// Limits a twist, or the change of one, to an interval.
static inline real twist_within(real low, real high, real twist)
{
	return larger_of(low, smaller_of(high, twist));
}

// Finds the friction x of points that slide, to the end: the one within the disc that leaves the least slip. Such a
// point has (A + t) x = load, |x| = bound, t = slip over impulse: Newton's method in 1/|x|. a: A, as 11 12 22. Changes x
// in the lanes "slides" alone. Returns t.
static inline real point_slide(mask slides, real bound, const real *a, const real *load, real *x)
{
	enum { MOST = 16 };
	const double close = 1e-13; // relative to the bound
	const real m = a[1];
	real t = real_of(0);
	mask goes = both_of(slides, is_load(bound));
	for (int k = 0; k < MOST && is_any(goes); k++) {
		const real p = a[0] + t, q = a[2] + t, inverse = 1 / (p * q - m * m);
		const real y[2] = { (q * load[0] - m * load[1]) * inverse, (p * load[1] - m * load[0]) * inverse };
		const real n2 = y[0] * y[0] + y[1] * y[1], n = root_of(n2), off = n / bound - 1;
		const real falls = (q * y[0] * y[0] - 2 * m * y[0] * y[1] + p * y[1] * y[1]) * inverse;
		for (int i = 0; i < 2; i++)
			x[i] = chosen(goes, y[i] * (bound / n), x[i]);
		t = chosen(goes, t + off * n2 / falls, t);
		goes = both_of(goes, size_of(off) > close);
	}
	for (int i = 0; i < 2; i++)
		x[i] = chosen(both_of(slides, not_of(is_load(bound))), real_of(0), x[i]);
	return t;
}

#endif
