// Paths: prescribed motions of kinematic objects, as closed forms that hold for whole steps. Pure functions,
// thread-safe. Units: m, s, rad/s.
//
// Constant and swinging motions are one closed form for good. A spline is a sequence of parabolas, two between each two
// points. Velocities are continuous; the object accelerates in the first half and decelerates in the second as a lift
// does. Times are rounded to steps, so that a published motion holds throughout a step. If its points have attitudes,
// it turns from each to the next by the shortest way (Shoemake 1985, SIGGRAPH: slerp). The rate is constant in between,
// and changes at each point.
#ifndef OB_MOTION_PATH_H
#define OB_MOTION_PATH_H

#include <ob/motion.h>

enum { OB_PATH_POINTS_MAX = 1024 };

typedef struct ob_path {
	double frequency; // rad/s; 0: it does not swing
	ob_vec3 a; // m/s^2, if it swings: at the first instant
	uint32_t points; // number of points of the spline, ascending by time, the first at 0; 0: no spline
	bool loop; // after the last point, at the place of the first, the spline begins again
	bool turns; // its points have attitudes; neighbours are less than half a turn apart
	ob_path_point *point; // [points]
} ob_path;

// Copies a path with its points into one block of memory; release it with free(). NULL: out of memory.
ob_path *ob_path_copy(const ob_path *path);

// A parabola of a spline, in steps after the object's first instant.
typedef struct ob_path_piece {
	uint64_t from, until; // UINT64_MAX: for good
	ob_vec3 p, v, a; // at "from"
	ob_quat q; // attitude at "from", if the path turns
	ob_vec3 w; // rad/s, world: constant rate of turn
} ob_path_piece;

// Path that swings about the place of its state: displacement amplitude (m) times sin(frequency t + phase), t in s. The
// state becomes that of t = 0.
ob_path ob_path_sine(ob_state *state, ob_vec3 amplitude, double frequency, double phase);
// Path on a circle about an axis (unit) through a centre with a frequency, from the place of its state on.
ob_path ob_path_circle(ob_state *state, ob_vec3 centre, ob_vec3 axis, double frequency);

// Piece that holds from "step" on. h: length of a step (s).
ob_path_piece ob_path_piece_at(const ob_path *path, double h, uint64_t step);

// Turn (rad, about an axis in the world frame) from one attitude to another by the shortest way. Returns false if they
// are half a turn apart, which leaves it undefined.
bool ob_path_turn(ob_quat from, ob_quat to, ob_vec3 *turn);

// True if there are at least two steps of h (s) between each two points; if not, "which" is the first point too near to
// the one before it.
bool ob_path_fits(const ob_path *path, double h, uint32_t *which);

#endif
