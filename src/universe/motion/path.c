#include "motion/path.h"

#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"

ob_path *ob_path_copy(const ob_path *path)
{
	ob_path *copy = malloc(sizeof *copy + path->points * sizeof *copy->point);
	if (!copy)
		return NULL;
	*copy = *path;
	copy->point = path->points ? (ob_path_point *)(copy + 1) : NULL;
	if (path->points)
		memcpy(copy->point, path->point, path->points * sizeof *copy->point);
	return copy;
}

ob_path ob_path_sine(ob_state *state, ob_vec3 amplitude, double frequency, double phase)
{
	state->v = ob_scale(amplitude, frequency * ob_cos(phase));
	state->pose.p = ob_madd(state->pose.p, ob_sin(phase), amplitude);
	return (ob_path){ .frequency = frequency, .a = ob_scale(amplitude, -frequency * frequency * ob_sin(phase)) };
}

ob_path ob_path_circle(ob_state *state, ob_vec3 centre, ob_vec3 axis, double frequency)
{
	state->v = ob_scale(ob_cross(axis, ob_sub(state->pose.p, centre)), frequency);
	return (ob_path){ .frequency = frequency, .a = ob_scale(ob_cross(axis, state->v), frequency) };
}

static uint64_t step_of(const ob_path *path, uint32_t i, double h)
{
	return (uint64_t)llround(path->point[i].t / h);
}

bool ob_path_fits(const ob_path *path, double h, uint32_t *which)
{
	for (uint32_t i = 1; i < path->points; i++)
		if (step_of(path, i, h) < step_of(path, i - 1, h) + 2) {
			*which = i;
			return false;
		}
	return true;
}

// Mean slope from a point to the next, of one component.
static double slope(double from, double to, double steps, double h)
{
	return (to - from) / (steps * h);
}

// Velocity at a point between two slopes that avoids overshoot: their harmonic mean, and 0 if the direction reverses or
// one slope is 0 (Fritsch and Butland 1984, SIAM J. Sci. Stat. Comput. 5).
static double smooth(double before, double after)
{
	return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

static ob_vec3 velocity_at(const ob_path *path, uint32_t i, double h)
{
	const uint32_t last = path->points - 1, end = i == 0 || i == last;
	if (end && !path->loop)
		return ob_v3(0, 0, 0);
	const uint32_t before = i == 0 ? last - 1 : i - 1, here = i == 0 ? last : i, next = i == last ? 1 : i + 1,
		       from = i == last ? 0 : i;
	const double a = (double)(step_of(path, here, h) - step_of(path, before, h)),
		     b = (double)(step_of(path, next, h) - step_of(path, from, h));
	const ob_vec3 p = path->point[before].p, q = path->point[i].p, r = path->point[next].p;
	return ob_v3(smooth(slope(p.x, q.x, a, h), slope(q.x, r.x, b, h)),
		     smooth(slope(p.y, q.y, a, h), slope(q.y, r.y, b, h)),
		     smooth(slope(p.z, q.z, a, h), slope(q.z, r.z, b, h)));
}

// First of two accelerations, over s1 and s2 (s), that lead from p at v to q at w.
static ob_vec3 first_acceleration(ob_vec3 p, ob_vec3 v, ob_vec3 q, ob_vec3 w, double s1, double s2)
{
	// v + a1 s1 + a2 s2 = w and p + v (s1 + s2) + a1 s1 (s1 / 2 + s2) + a2 s2^2 / 2 = q, with a2 eliminated
	const ob_vec3 way = ob_madd(ob_sub(q, p), -(s1 + s2), v), gain = ob_scale(ob_sub(w, v), .5 * s2);
	return ob_scale(ob_sub(way, gain), 2 / (s1 * (s1 + s2)));
}

bool ob_path_turn(ob_quat from, ob_quat to, ob_vec3 *turn)
{
	ob_quat r = ob_quat_mul(to, ob_quat_conjugate(from));
	if (r.w < 0)
		r = (ob_quat){ -r.w, -r.x, -r.y, -r.z };
	const ob_vec3 v = ob_v3(r.x, r.y, r.z);
	const double s = ob_norm(v); // sine of half the angle
	*turn = s > 0 ? ob_scale(v, 2 * ob_atan2(s, r.w) / s) : v;
	return r.w > 1e-9;
}

// Attitude and rate of a piece that begins `since` (s) after point i; s: time to the next point.
static void turn_piece(const ob_path *path, uint32_t i, double since, double s, ob_path_piece *piece)
{
	ob_vec3 turn;
	if (!path->turns)
		return;
	ob_path_turn(path->point[i].q, path->point[i + 1].q, &turn);
	piece->w = ob_scale(turn, 1 / s);
	piece->q = since > 0 ? ob_quat_turn(path->point[i].q, ob_scale(piece->w, since)) : path->point[i].q;
}

ob_path_piece ob_path_piece_at(const ob_path *path, double h, uint64_t step)
{
	const uint32_t last = path->points - 1;
	const uint64_t period = step_of(path, last, h), round = path->loop ? step / period * period : 0;
	const uint64_t since = step - round;
	uint32_t i = 0;
	if (since >= period)
		return (ob_path_piece){
			.from = period, .until = UINT64_MAX, .p = path->point[last].p, .q = path->point[last].q
		};
	while (step_of(path, i + 1, h) <= since)
		i++;
	const uint64_t from = step_of(path, i, h), until = step_of(path, i + 1, h), middle = from + (until - from) / 2;
	const double s1 = (double)(middle - from) * h, s2 = (double)(until - middle) * h;
	const ob_vec3 p = path->point[i].p, q = path->point[i + 1].p, v = velocity_at(path, i, h),
		      w = velocity_at(path, i + 1, h), a = first_acceleration(p, v, q, w, s1, s2);
	const ob_vec3 halfway = ob_madd(v, s1, a);
	const bool first = since < middle;
	ob_path_piece piece = { .from = round + (first ? from : middle), .until = round + (first ? middle : until) };
	piece.p = first ? p : ob_madd(ob_madd(p, s1, v), .5 * s1 * s1, a);
	piece.v = first ? v : halfway;
	piece.a = first ? a : ob_scale(ob_sub(w, halfway), 1 / s2);
	turn_piece(path, i, first ? 0 : s1, s1 + s2, &piece);
	return piece;
}
