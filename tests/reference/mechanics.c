#include "reference/mechanics.h"

#include <math.h>
#include <stdbool.h>

ob_vec3 ob_reference_parabola(ob_vec3 p, ob_vec3 v, ob_vec3 a, double t)
{
	return ob_madd(ob_madd(p, t, v), .5 * t * t, a);
}

static double fall_time(double height, double g)
{
	return sqrt(2 * height / g);
}

double ob_reference_apex(double height, double e, int k)
{
	return height * pow(e, 2 * k);
}

double ob_reference_impact_time(double height, double g, double e, int k)
{
	double falls = 1, power = 1; // in units of the first fall
	for (int i = 1; i < k; i++) {
		power *= e;
		falls += 2 * power;
	}
	return falls * fall_time(height, g);
}

ob_reference_pair ob_reference_impact(double mass_a, double mass_b, ob_reference_pair before, double e)
{
	// share of the velocity change
	double share_a = isinf(mass_b) ? 1 : isinf(mass_a) ? 0 : mass_b / (mass_a + mass_b);
	double share_b = isinf(mass_b) ? 0 : isinf(mass_a) ? 1 : mass_a / (mass_a + mass_b);
	double change = (1 + e) * (before.b - before.a);
	return (ob_reference_pair){ before.a + share_a * change, before.b - share_b * change };
}

void ob_reference_cradle(int n, int k, double v, double *velocity)
{
	for (int i = 0; i < n; i++)
		velocity[i] = i < n - k ? 0 : v;
}

double ob_reference_incline(double g, double angle, double mu)
{
	return fmax(0, g * (sin(angle) - mu * cos(angle)));
}

double ob_reference_friction_angle(double mu)
{
	return atan(mu);
}

// First instant after from + fine / 2 at which a function crosses 0; until: none before. Samples, then bisects.
static double crossing(double (*f)(const double *of, double t), const double *of, double from, double until,
		       double fine)
{
	const double begin = f(of, from + .5 * fine);
	for (double t = from + fine; t - fine < until; t += fine) {
		double low = t - fine, high = fmin(t, until);
		if (f(of, high) * begin > 0)
			continue;
		for (int i = 0; i < 60; i++) {
			const double middle = .5 * (low + high);
			*(f(of, middle) * begin > 0 ? &low : &high) = middle;
		}
		return high;
	}
	return until;
}

// Parameters: velocity of the block at "since", its acceleration, since, velocity amplitude of the table, its
// frequency.
static double slip_at(const double *of, double t)
{
	return of[0] + of[1] * (t - of[2]) - of[3] * cos(of[4] * t);
}

// Parameters: the table's acceleration amplitude, its frequency, and the limit. Negative: friction no longer holds.
static double grip_at(const double *of, double t)
{
	return of[2] - fabs(of[0] * sin(of[1] * t));
}

ob_reference_shaken ob_reference_shaken_block(double amplitude, double frequency, double mu, double g, double v,
					      double t)
{
	const double fine = 2 * M_PI / frequency / 4096, fastest = amplitude * frequency, limit = mu * g;
	ob_reference_shaken b = { 0, v };
	double now = 0;
	bool sticks = fabs(v - fastest) < 1e-12 * fastest;
	while (now < t) {
		const double table = fastest * frequency; // its acceleration is -table sin
		if (sticks) {
			const double grip[3] = { table, frequency, limit };
			const double end =
				grip_at(grip, now + 1e-6 * fine) < 0 ? now : crossing(grip_at, grip, now, t, fine);
			b.x += amplitude * (sin(frequency * end) - sin(frequency * now));
			b.v = fastest * cos(frequency * end);
			now = end;
			sticks = false;
			if (now >= t)
				break;
		}
		const double ahead =
			fastest * cos(frequency * (now + fine)) - b.v; // the table's; it drags the block along
		const double slip[5] = { b.v, ahead > 0 ? limit : -limit, now, fastest, frequency };
		const double end = crossing(slip_at, slip, now, t, fine), s = end - now;
		b.x += b.v * s + .5 * slip[1] * s * s;
		b.v += slip[1] * s;
		now = end;
		sticks = now < t && fabs(table * sin(frequency * now)) <= limit;
	}
	return b;
}

double ob_reference_turntable_radius(double rate, double mu, double g)
{
	return mu * g / (rate * rate);
}

ob_vec3 ob_reference_turntable_ball(double rate, ob_vec3 p, ob_vec3 v, double t)
{
	const double f = 2. / 7 * rate; // v' = f z x v
	const ob_vec3 across = ob_v3(-v.y, v.x, 0);
	return ob_madd(ob_madd(p, sin(f * t) / f, ob_v3(v.x, v.y, 0)), (1 - cos(f * t)) / f, across);
}

double ob_reference_stop_time(double v, double mu, double g)
{
	return v / (mu * g);
}

double ob_reference_stop_distance(double v, double mu, double g)
{
	return v * v / (2 * mu * g);
}

double ob_reference_roll_time(double v, double mu, double g)
{
	return 2 * v / (7 * mu * g);
}

double ob_reference_roll_speed(double v)
{
	return 5 * v / 7;
}

ob_reference_roll ob_reference_slip_to_roll(double v, double mu, double g, double t)
{
	double rolls = ob_reference_roll_time(v, mu, g), a = mu * g, speed = ob_reference_roll_speed(v);
	if (t < rolls)
		return (ob_reference_roll){ t * (v - .5 * a * t), v - a * t, 2.5 * a * t };
	return (ob_reference_roll){ rolls * (v - .5 * a * rolls) + speed * (t - rolls), speed, speed };
}

double ob_reference_ball_grip(double angle)
{
	return 2 * tan(angle) / 7;
}

double ob_reference_ball_incline(double g, double angle, double mu)
{
	return mu >= ob_reference_ball_grip(angle) ? 5 * g * sin(angle) / 7 : ob_reference_incline(g, angle, mu);
}

double ob_reference_round_incline(double g, double angle, double moment)
{
	return g * sin(angle) / (1 + moment);
}

ob_reference_rolling ob_reference_push(double force, double mu_ground, double box_mass, double ball_mass, int balls,
				       double g)
{
	ob_reference_rolling r = { .ground = mu_ground * (box_mass + balls * ball_mass) * g };
	r.ball = (force - r.ground) / box_mass / (3.5 / ball_mass + balls / box_mass);
	r.box_a = (force - r.ground - balls * r.ball) / box_mass;
	r.ball_a = r.ball / ball_mass;
	r.grip = r.ball / (ball_mass * g);
	return r;
}

double ob_reference_overhang_shift(int k)
{
	return .5 / k;
}

double ob_reference_overhang(int n)
{
	double reach = 0;
	for (int k = n; k >= 1; k--)
		reach += ob_reference_overhang_shift(k);
	return reach;
}

double ob_reference_cards_grip(double angle, double length, double thickness)
{
	return .5 * (tan(angle) - thickness / length);
}

static ob_vec3 surface_velocity(const ob_reference_sphere *s, ob_vec3 normal)
{
	return ob_add(s->v, ob_cross(s->w, ob_scale(normal, s->radius)));
}

static void push(ob_reference_sphere *s, ob_vec3 normal, ob_vec3 impulse)
{
	if (isinf(s->mass))
		return;
	double moment = .4 * s->mass * s->radius * s->radius;
	s->v = ob_madd(s->v, 1 / s->mass, impulse);
	s->w = ob_madd(s->w, s->radius / moment, ob_cross(normal, impulse));
}

void ob_reference_oblique(ob_reference_sphere *a, ob_reference_sphere *b, ob_vec3 normal, double e, double mu)
{
	ob_vec3 to_b = ob_scale(normal, -1), u = ob_sub(surface_velocity(a, to_b), surface_velocity(b, normal));
	double mass = 1 / (1 / a->mass + 1 / b->mass), approach = -ob_dot(u, normal);
	ob_vec3 slip = ob_madd(u, approach, normal);
	double along = (1 + e) * mass * approach, across = mass / 3.5, speed = ob_norm(slip);
	double friction = fmin(mu * along, across * speed);
	ob_vec3 impulse = ob_scale(normal, along);
	if (speed > 0)
		impulse = ob_madd(impulse, -friction / speed, slip);
	push(a, to_b, impulse);
	push(b, normal, ob_scale(impulse, -1));
}
