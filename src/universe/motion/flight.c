#include "motion/flight.h"

#include "elementary/elementary.h"

// 1 - cos x without cancellation near 0
static double versine(double x)
{
	const double half = ob_sin(.5 * x);
	return 2 * half * half;
}

ob_vec3 ob_centre_at(const ob_motion *m, double t)
{
	const double s = t - m->t0, f = m->frequency;
	if (m->flags & OB_MOTION_SWINGS)
		return ob_madd(ob_madd(m->p, ob_sin(f * s) / f, m->v), versine(f * s) / (f * f), m->a);
	return ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a);
}

ob_vec3 ob_velocity_at(const ob_motion *m, double t)
{
	const double s = t - m->t0, f = m->frequency;
	if (m->flags & OB_MOTION_SWINGS)
		return ob_madd(ob_scale(m->v, ob_cos(f * s)), ob_sin(f * s) / f, m->a);
	return ob_madd(m->v, s, m->a);
}

ob_vec3 ob_acceleration_at(const ob_motion *m, double t)
{
	const double s = t - m->t0, f = m->frequency;
	if (m->flags & OB_MOTION_SWINGS)
		return ob_madd(ob_scale(m->a, ob_cos(f * s)), -f * ob_sin(f * s), m->v);
	return m->a;
}

ob_state ob_motion_at(const ob_motion *m, ob_vec3 inertia, double t)
{
	double s = t - m->t0;
	ob_state out;
	out.pose.p = ob_centre_at(m, t);
	out.v = ob_velocity_at(m, t);
	ob_rotate_free(m->q, m->w, inertia, s, &out.pose.q, &out.w);
	return out;
}

// Shoemake's spherical-linear interpolation (SIGGRAPH 1985) along the shorter way, as the fraction f of the turn from a
// to b: exact for small turns too.
static ob_quat between(ob_quat a, ob_quat b, double f)
{
	ob_quat turn = ob_quat_mul(b, ob_quat_conjugate(a));
	ob_vec3 axis = ob_v3(turn.x, turn.y, turn.z);
	double sine = ob_norm(axis);
	if (!(sine > 0))
		return a;
	double angle = 2 * ob_atan2(turn.w < 0 ? -sine : sine, fabs(turn.w));
	return ob_quat_turn(a, ob_scale(axis, f * angle / sine));
}

ob_pose ob_motion_between(const ob_motion *prev, const ob_motion *next, ob_vec3 inertia, double t)
{
	if (t <= prev->t0)
		return (ob_pose){ prev->p, prev->q };
	if (!(t < next->t0))
		return (ob_pose){ next->p, next->q };
	if (next->flags & OB_MOTION_FREE)
		return ob_motion_at(prev, inertia, t).pose;
	double f = (t - prev->t0) / (next->t0 - prev->t0);
	return (ob_pose){ ob_madd(prev->p, f, ob_sub(next->p, prev->p)), between(prev->q, next->q, f) };
}

// Evaluates gap + v t + a t^2 / 2 without cancellation errors (Kahan 2004, "On the cost of floating-point computation
// without extra-precise arithmetic").
static double discriminant(double gap, double v, double a)
{
	double product = 2 * a * gap;
	return fma(v, v, -product) + fma(-2 * a, gap, product);
}

double ob_time_of_closing(double gap, double v, double a, double s)
{
	if (!(gap < INFINITY))
		return INFINITY;
	if (gap <= 0 && (v < 0 || (v == 0 && a < 0)))
		return 0;
	if (v >= 0 && !(a < 0))
		return INFINITY;
	double d = discriminant(gap, v, a), t;
	if (d > 0)
		t = v < 0 ? 2 * gap / (sqrt(d) - v) : (-v - sqrt(d)) / a;
	else
		t = a < 0 ? -v / a : INFINITY; // overlaps throughout, and falls back from then on; or never closes
	return t <= s ? t : INFINITY;
}

bool ob_published_stands(const ob_motion *m, const ob_passport *p, double t)
{
	return m->t0 == t || p->flags & OB_OBJECT_STATIC || m->flags & OB_MOTION_RESTS;
}

ob_state ob_published_at(const ob_motion *m, const ob_passport *p, double t)
{
	if (ob_published_stands(m, p, t))
		return (ob_state){ { m->p, m->q }, m->v, m->w };
	return ob_motion_at(m, p->inertia, t);
}

bool ob_turns_add(ob_turns *t, size_t row, const ob_motion *m, const ob_passport *p, double time)
{
	const int k = t->n++;
	t->row[k] = row, t->s[k] = time - m->t0, t->of[k] = &t->spin[k];
	ob_spin_plan(t->of[k], m->q, m->w, p->inertia);
	return t->n == OB_TURNS;
}

int ob_turns_find(ob_turns *t, ob_quat *q, ob_vec3 *w)
{
	const int n = t->n;
	ob_spin_prepare(t->of, t->s, n);
	for (int i = 0; i < n; i++)
		ob_spin_at(t->of[i], t->s[i], &q[i], &w[i]);
	t->n = 0;
	return n;
}

static void end_turns(ob_turns *t, ob_state *out)
{
	ob_quat q[OB_TURNS];
	ob_vec3 w[OB_TURNS];
	const int n = ob_turns_find(t, q, w);
	for (int i = 0; i < n; i++)
		out[t->row[i]].pose.q = q[i], out[t->row[i]].w = w[i];
}

void ob_published_all(const ob_motion *m, const ob_passport *p, uint32_t n, double t, ob_state *out)
{
	ob_turns all;
	all.n = 0;
	for (uint32_t i = 0; i < n; i++) {
		if (ob_published_stands(&m[i], &p[i], t) || ob_norm2(m[i].w) == 0) {
			out[i] = ob_published_at(&m[i], &p[i], t);
			continue;
		}
		out[i].pose.p = ob_centre_at(&m[i], t);
		out[i].v = ob_velocity_at(&m[i], t);
		if (ob_turns_add(&all, i, &m[i], &p[i], t))
			end_turns(&all, out);
	}
	end_turns(&all, out);
}
