#include "motion/spin.h"

#include <ob/motion.h>

#include "elementary/elementary.h"
#include "motion/magnus.h"
#include "motion/spin_lanes.h"

#include "elementary/real.h" // for one body
#include "motion/theta.h"

// Moments closer than this are equal: over a thousand radians the difference stays below 1e-12 rad.
static const double SAME = 1e-15;
// A direction this near (sine) to a principal axis is on it.
static const double ON_AXIS = 1e-16;

// ---- interface of theta.h for one body

static inline real signed_as(real size, real x)
{
	return copysign(size, x);
}

static inline real angle_of(real y, real x)
{
	return ob_atan2(y, x);
}

static inline real power_of_e(real x)
{
	return ob_exp(x);
}

static inline real power_of_e_less_1(real x)
{
	return ob_expm1(x);
}

static real excess_of(real w, real x, real y, real z)
{
	return ob_quat_excess((ob_quat){ w, x, y, z });
}

static inline void sines_of(real a, real b, real *sine_a, real *cosine_a, real *sine_b, real *cosine_b)
{
	double sine[2], cosine[2];
	ob_sincos_of_two((double[2]){ a, b }, sine, cosine);
	*sine_a = sine[0], *cosine_a = cosine[0];
	*sine_b = sine[1], *cosine_b = cosine[1];
}

// ---- kinds of rotation

static void get(ob_vec3 v, double out[3])
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

static void plan_turns(ob_spin *spin, ob_vec3 world, ob_vec3 body)
{
	spin->kind = OB_SPIN_TURNS;
	spin->world = world;
	spin->body = body;
}

// The pair of equal moments decides: L / I of the pair in the world, the rest about the third axis of the body. With
// three equal moments the rest is zero. Returns false if no two are equal.
static int plan_symmetric(ob_spin *spin, ob_vec3 momentum, const double l[3], const double inertia[3])
{
	for (int k = 0; k < 3; k++) {
		double a = inertia[(k + 1) % 3], b = inertia[(k + 2) % 3];
		if (fabs(a - b) > SAME * ob_max(a, b))
			continue;
		double pair = .5 * (a + b), rest = l[k] * (1 / inertia[k] - 1 / pair);
		plan_turns(spin, ob_scale(momentum, 1 / pair),
			   ob_v3(k == 0 ? rest : 0, k == 1 ? rest : 0, k == 2 ? rest : 0));
		return 1;
	}
	return 0;
}

// Sorts the axes: moments ascending, or descending if the momentum circles the axis of the smallest one; signs so that
// the frame is right-handed and n3 >= 0. Component i is sign[i] times component axis[i] of the body.
static void sort_axes(const double n[3], const double inertia[3], int axis[3], double sign[3])
{
	int o[3] = { 0, 1, 2 };
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2 - i; j++)
			if (inertia[o[j]] > inertia[o[j + 1]]) {
				int swap = o[j];
				o[j] = o[j + 1];
				o[j + 1] = swap;
			}
	double low = inertia[o[0]], mid = inertia[o[1]], high = inertia[o[2]];
	if (squared(n[o[0]]) * (mid / low - 1) > squared(n[o[2]]) * (1 - mid / high)) {
		int swap = o[0];
		o[0] = o[2];
		o[2] = swap;
	}
	int even = o[1] == (o[0] + 1) % 3;
	for (int i = 0; i < 3; i++)
		axis[i] = o[i];
	sign[0] = 1;
	sign[2] = n[o[2]] < 0 ? -1 : 1;
	sign[1] = even ? sign[2] : -sign[2];
}

// Energy and momentum are constant; each bounds the rate b (body frame) by the least moment.
static double fastest_of(ob_vec3 b, ob_vec3 i)
{
	const ob_vec3 l = ob_v3(i.x * b.x, i.y * b.y, i.z * b.z);
	const double least = ob_min(i.x, ob_min(i.y, i.z));
	if (!(least > 0) || (i.x == i.y && i.y == i.z))
		return ob_norm(b);
	return sqrt(ob_min(ob_dot(l, b) / least, ob_norm2(l) / (least * least)));
}

double ob_spin_bound(ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	const ob_mat3 r = ob_quat_matrix(q);
	return fastest_of(ob_rotate_back(&r, w), inertia);
}

// With k the largest |c_i|, |b'| <= k w^2 / sqrt(3) and |b''| <= 2/3 k^2 w^3, for sums of products of shares that add
// up to 1. In the world frame the second derivative of the rate also has b x b'; the arm's third derivative consists of
// products of these.
ob_bending ob_bending_of(ob_vec3 i, double w)
{
	ob_bending x = { .coupling = { 0, 0, 0 } };
	if (i.x > 0 && i.y > 0 && i.z > 0)
		x.coupling = ob_v3((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z);
	const double k = ob_max(fabs(x.coupling.x), ob_max(fabs(x.coupling.y), fabs(x.coupling.z))), once = k / sqrt(3);
	x.most = w * w * (1 + once);
	x.jerk = w * w * w * (1 + 4 * once + 2. / 3 * k * k);
	return x;
}

void ob_spin_plan(ob_spin *spin, ob_quat q, ob_vec3 w, ob_vec3 inertia)
{
	const ob_mat3 r = ob_quat_matrix(q);
	spin->kind = OB_SPIN_TURNS;
	spin->q = q;
	spin->w = w;
	spin->rate_0 = ob_rotate_back(&r, w);
	spin->inertia = inertia;
	spin->fastest = fastest_of(spin->rate_0, inertia);
	spin->planned = false;
	spin->last = 0;
	spin->last_q = q;
	spin->last_w = w;
}

// Returns false for a rate that is treated as constant.
static bool is_ordinary(const ob_spin *spin)
{
	const ob_vec3 i = spin->inertia;
	return i.x > 0 && i.y > 0 && i.z > 0 && ob_norm2(spin->w) > 1e-280; // smaller squares would lose digits
}

// Determines the kind, and for OB_SPIN_THETA the input of its constants.
static void classify(ob_spin *spin, ob_theta_start *from)
{
	const ob_quat q = spin->q;
	const ob_vec3 w = spin->w, body = spin->rate_0;
	double i[3], l[3], n[3];
	get(spin->inertia, i);
	spin->planned = true;
	plan_turns(spin, w, ob_v3(0, 0, 0));
	if (!is_ordinary(spin))
		return;
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 momentum = ob_v3(i[0] * body.x, i[1] * body.y, i[2] * body.z);
	get(momentum, l);
	double size = ob_norm(momentum);
	get(ob_scale(momentum, 1 / size), n);
	for (int k = 0; k < 3; k++)
		if (squared(n[(k + 1) % 3]) + squared(n[(k + 2) % 3]) <= squared(ON_AXIS))
			return;
	if (plan_symmetric(spin, ob_rotate(&r, momentum), l, i))
		return;
	spin->kind = OB_SPIN_THETA;
	int axis[3];
	double sign[3], *k = spin->theta;
	sort_axes(n, i, axis, sign);
	*from = (ob_theta_start){ .size = size };
	k[OB_THETA_START] = q.w, k[OB_THETA_START + 1] = q.x, k[OB_THETA_START + 2] = q.y, k[OB_THETA_START + 3] = q.z;
	for (int j = 0; j < 9; j++)
		k[OB_THETA_FRAME + j] = 0;
	for (int j = 0; j < 3; j++) {
		const int o = axis[j];
		k[OB_THETA_RATE + j] = size / i[j];
		k[OB_THETA_FRAME + 3 * o + j] = sign[j];
		from->direction[j] = sign[j] * n[o];
		from->inertia[j] = i[o];
	}
}

static void plan_theta_of(ob_spin *spin, const ob_theta_start *from)
{
	ob_theta_series *t = &spin->series;
	double count;
	t->terms = plan_theta(spin->theta, t->plain, t->even, t->odd, &count, from->size,
			      (vector){ from->direction[0], from->direction[1], from->direction[2] }, from->inertia[0],
			      from->inertia[1], from->inertia[2]);
}

static void plan_long_turns(ob_spin *spin)
{
	ob_theta_start from;
	classify(spin, &from);
	if (spin->kind == OB_SPIN_THETA)
		plan_theta_of(spin, &from);
}

static inline __attribute__((always_inline)) double excess(ob_quat q)
{
	return fma(q.w, q.w, fma(q.x, q.x, fma(q.y, q.y, fma(q.z, q.z, -1))));
}

// Same bits in one call, if the processor has fused operations: otherwise each product is a library call.
#ifdef __x86_64__
__attribute__((target("fma"))) static double excess_by_processor(ob_quat q)
{
	return excess(q);
}
#endif

double ob_quat_excess(ob_quat q)
{
#ifdef __x86_64__
	if (__builtin_cpu_supports("fma"))
		return excess_by_processor(q);
#endif
	return excess(q);
}

static ob_quat unit(ob_quat q)
{
	const quaternion u = unit_of((quaternion){ q.w, q.x, q.y, q.z });
	return (ob_quat){ u.w, u.x, u.y, u.z };
}

static void turns_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	ob_quat own = ob_quat_turn(ob_quat_identity(), ob_scale(spin->body, s));
	ob_quat q = unit(ob_quat_mul(ob_quat_turn(spin->q, ob_scale(spin->world, s)), own));
	ob_mat3 r = ob_quat_matrix(q);
	*q_out = q;
	*w_out = ob_add(spin->world, ob_rotate(&r, spin->body));
}

static void long_turn_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	const ob_theta_series *own = &spin->series;
	const series t = { own->terms, own->even, own->odd, own->plain };
	quaternion q;
	vector w;
	turn_theta(spin->theta, &t, s, &q, &w);
	*q_out = (ob_quat){ q.w, q.x, q.y, q.z };
	*w_out = ob_v3(w.x, w.y, w.z);
}

// The rate follows from the momentum, which is constant.
static void short_turn_at(const ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	const ob_vec3 i = spin->inertia, b = spin->rate_0;
	const ob_mat3 before = ob_quat_matrix(spin->q);
	const ob_vec3 momentum = ob_rotate(&before, ob_v3(i.x * b.x, i.y * b.y, i.z * b.z));
	*q_out = unit(ob_quat_mul(spin->q, ob_magnus_turn(b, i, s)));
	const ob_mat3 r = ob_quat_matrix(*q_out);
	const ob_vec3 l = ob_rotate_back(&r, momentum);
	*w_out = ob_rotate(&r, ob_v3(l.x / i.x, l.y / i.y, l.z / i.z));
}

static bool is_short(const ob_spin *spin, double s)
{
	return is_ordinary(spin) && ob_norm2(spin->w) * s * s < OB_MAGNUS_LONGEST * OB_MAGNUS_LONGEST;
}

static void find_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s == 0) {
		*q_out = spin->q;
		*w_out = spin->w;
		return;
	}
	if (is_short(spin, s)) {
		short_turn_at(spin, s, q_out, w_out);
		return;
	}
	if (!spin->planned)
		plan_long_turns(spin);
	if (spin->kind == OB_SPIN_THETA)
		long_turn_at(spin, s, q_out, w_out);
	else
		turns_at(spin, s, q_out, w_out);
}

void ob_spin_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s != spin->last) {
		find_at(spin, s, &spin->last_q, &spin->last_w);
		spin->last = s;
	}
	*q_out = spin->last_q;
	*w_out = spin->last_w;
}

#ifdef OB_HAVE_MOTION_LANES
// Evaluates up to four long turns, each at its own instant. A single one is left for later.
static void turn_together(ob_spin *const *spin, const double *s, int n)
{
	ob_theta_start from[OB_LANES];
	ob_spin *plan[OB_LANES], *turn[OB_LANES];
	double when[OB_LANES];
	int plans = 0, turns = 0;
	if (n < 2)
		return;
	for (int i = 0; i < n; i++) {
		ob_spin *x = spin[i];
		const bool planned = x->planned;
		if (!planned)
			classify(x, &from[plans]);
		if (!planned && x->kind == OB_SPIN_THETA)
			plan[plans++] = x;
		if (x->kind == OB_SPIN_THETA)
			when[turns] = s[i], turn[turns++] = x;
	}
	if (plans == 1)
		plan_theta_of(plan[0], from);
	else if (plans)
		ob_spin_lanes_plan(plan, from, plans);
	if (turns > 1)
		ob_spin_lanes_turn(turn, when, turns);
}

void ob_spin_prepare(ob_spin *const *spin, const double *s, int n)
{
	ob_spin *turn[OB_LANES];
	double when[OB_LANES];
	int turns = 0;
	if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
		return;
	for (int i = 0; i < n; i++) {
		if (s[i] == spin[i]->last || s[i] == 0 || is_short(spin[i], s[i]))
			continue;
		when[turns] = s[i], turn[turns++] = spin[i];
		if (turns == OB_LANES)
			turn_together(turn, when, turns), turns = 0;
	}
	turn_together(turn, when, turns);
}
#else
void ob_spin_prepare(ob_spin *const *spin, const double *s, int n) {}
#endif

void ob_rotate_free(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out)
{
	if (s == 0 || ob_norm2(w) == 0) { // exactly the published attitude, and fast for all bodies at rest
		*q_out = q;
		*w_out = w;
		return;
	}
	ob_spin spin;
	ob_spin_plan(&spin, q, w, inertia);
	ob_spin_at(&spin, s, q_out, w_out);
}
