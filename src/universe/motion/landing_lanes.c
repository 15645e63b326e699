// Same operations as advance and land_points of landing.c, corner by corner instead of two corners at a time.
#include "motion/landing_lanes.h"

#include <math.h>

#include "elementary/lanes.h"

enum { CORNERS = 8, BLOCK = 4, NUMBERS = sizeof(ob_falling_box) / sizeof(double) };
_Static_assert(NUMBERS % BLOCK == 0, "boxes are turned over in blocks of four numbers");

typedef struct vector {
	lanes x, y, z;
} vector;

static inline vector cross(vector a, vector b)
{
	return (vector){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static inline vector by_component(vector a, vector b)
{
	return (vector){ a.x * b.x, a.y * b.y, a.z * b.z };
}

// Turns into the frame of a body with attitude q, as ob_rotate_back and ob_quat_matrix do.
static inline void turn_back(lanes w, vector q, const vector *from, int n, vector *to)
{
	const lanes x = q.x, y = q.y, z = q.z;
	const vector row[3] = { { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
				{ 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
				{ 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) } };
	for (int i = 0; i < n; i++) {
		const vector v = from[i];
		to[i] = (vector){ row[0].x * v.x + row[1].x * v.y + row[2].x * v.z,
				  row[0].y * v.x + row[1].y * v.y + row[2].y * v.z,
				  row[0].z * v.x + row[1].z * v.y + row[2].z * v.z };
	}
}

// Values at the corners: value of the centre, and its change along each half side.
static inline void corners_of(lanes centre, vector by, lanes *out)
{
	for (int k = 0; k < CORNERS; k++)
		out[k] = (centre + (k & 1 ? by.x : -by.x)) + ((k & 2 ? by.y : -by.y) + (k & 4 ? by.z : -by.z));
}

static inline lanes fall_time(lanes gap, lanes rate, lanes most)
{
	const lanes root = lanes_sqrt(rate * rate + 2 * most * gap);
	return lanes_select(rate < 0, 2 * gap / (root - rate),
			    lanes_select(most > 0, (rate + root) / most, lanes_of(INFINITY)));
}

// Corner, and its assumed acceleration.
typedef struct corner {
	lanes gap, rate, bend, fall;
} corner;

static inline corner chosen(lane_mask m, corner a, corner b)
{
	return (corner){ lanes_select(m, a.gap, b.gap), lanes_select(m, a.rate, b.rate),
			 lanes_select(m, a.bend, b.bend), lanes_select(m, a.fall, b.fall) };
}

// Finds the corner that is first on the plane within *t, in the lanes of "on"; returns the lanes that have one.
static inline lane_mask first_to_land(const corner *of, lane_mask on, lanes *t, corner *first)
{
	lane_mask found = { 0 };
	while (lanes_bits(on)) {
		corner deepest = of[0];
		lanes least = of[0].gap + *t * (of[0].rate - .5 * *t * of[0].fall);
		lane_mask below = (lane_mask)least;
		for (int k = 1; k < CORNERS; k++) {
			const lanes height = of[k].gap + *t * (of[k].rate - .5 * *t * of[k].fall);
			const lane_mask deeper = height < least;
			deepest = chosen(deeper, of[k], deepest);
			least = lanes_select(deeper, height, least);
			below |= (lane_mask)height;
		}
		const lanes when = fall_time(deepest.gap, deepest.rate, deepest.fall);
		on &= (below < 0) & ~(found & ~(when < *t));
		*first = chosen(on, deepest, *first);
		// as ob_min
		const lanes sooner = lanes_select(when == when, lanes_select(*t < when, *t, when), *t);
		*t = lanes_select(on, sooner, *t);
		found |= on;
	}
	return found;
}

static inline void land(const lanes *gap_of, const lanes *rate, const lanes *bend, lanes most, lanes jerk,
			lanes tolerance, lanes left, lanes *t_out, lane_mask *lands)
{
	corner of[CORNERS];
	lane_mask landed = { 0 };
	corner lowest = { 0 };
	for (int k = 0; k < CORNERS; k++) {
		const lane_mask touches = gap_of[k] <= tolerance, falls = rate[k] < 0;
		landed |= touches & falls;
		of[k] = (corner){ .rate = rate[k], .bend = bend[k] };
		of[k].gap = lanes_where(~(touches & (~falls | (gap_of[k] < 0))), gap_of[k]);
		lowest = k ? chosen(of[k].gap < lowest.gap, of[k], lowest) : of[0];
	}
	const lanes down = -lowest.bend, guess = 1.1 * fall_time(lowest.gap, lowest.rate, lanes_where(0 < down, down));
	const lanes until = lanes_select(guess == guess, lanes_select(left < guess, left, guess), left),
		    more = jerk * until / 3;
	for (int k = 0; k < CORNERS; k++) {
		const lanes fall = more - bend[k], some = lanes_where(fall > 0, fall);
		of[k].fall = lanes_select(most < some, most, some);
	}
	lanes t = until;
	corner first = of[0];
	const lane_mask found = first_to_land(of, ~landed, &t, &first);
	const lanes above = .5 * t * t * (first.fall + first.bend + jerk * t / 3);
	const lane_mask comes = (above <= tolerance) & (first.rate + t * (first.bend + .5 * t * jerk) < 0);
	const lanes none = lanes_select(until < left, until, lanes_of(INFINITY));
	*t_out = lanes_select(landed, lanes_of(0), lanes_select(found, t, none));
	*lands = landed | (found & comes);
}

void ob_landing_lanes_advance(const ob_falling_box *box, int n, double *t, bool *lands)
{
	lanes x[NUMBERS];
	for (int i = 0; i < NUMBERS; i += BLOCK) {
		for (int l = 0; l < OB_LANES; l++)
			x[i + l] = lanes_load((const double *)&box[l < n ? l : 0] + i);
		lanes_transpose(x + i);
	}
	const vector half = { x[0], x[1], x[2] }, q = { x[4], x[5], x[6] }, c = { x[13], x[14], x[15] };
	const vector world[2] = { { x[7], x[8], x[9] }, { x[10], x[11], x[12] } };
	const lanes height = x[16], speed = x[17], a = x[18], most = x[19], jerk = x[20], tolerance = x[21],
		    left = x[22];
	vector own[2];
	turn_back(x[3], q, world, 2, own);
	const vector b = own[0], normal = own[1], turning = cross(normal, b);
	const vector gain = { c.x * b.y * b.z, c.y * b.z * b.x, c.z * b.x * b.y };
	const vector across = cross(normal, gain), inwards = cross(turning, b),
		     turn = { across.x + inwards.x, across.y + inwards.y, across.z + inwards.z };
	lanes gap[CORNERS], rate[CORNERS], bend[CORNERS], when;
	lane_mask comes;
	corners_of(height, by_component(half, normal), gap);
	corners_of(speed, by_component(half, turning), rate);
	corners_of(a, by_component(half, turn), bend);
	land(gap, rate, bend, most, jerk, tolerance, left, &when, &comes);
	for (int l = 0; l < n; l++) {
		t[l] = when[l];
		lands[l] = comes[l];
	}
}
