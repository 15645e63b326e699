// Paths: how a kinematic object is told to move, as closed forms that hold for whole steps. Pure functions,
// thread-safe. Units: m, s, rad/s.
//
// A motion that goes on as it begins, or swings, is one closed form for good. A spline is a row of parabolas, two
// between each two points: velocities are continuous, and the object speeds up in the first half of the way and slows
// down in the second as a lift does. Its times are rounded to steps, so that what is published holds throughout a step.
// Where its points have attitudes, it turns from each to the next by the shortest way at a constant rate (Shoemake
// 1985, SIGGRAPH: slerp), which another one follows at each point.
#ifndef OB_MOTION_PATH_H
#define OB_MOTION_PATH_H

#include <ob/motion.h>

enum { OB_PATH_POINTS_MAX = 1024 };

typedef struct ob_path_point {
	double t; // s, after the object's first instant
	ob_vec3 p; // m
	ob_quat q; // body to world, if the path turns
} ob_path_point;

typedef struct ob_path {
	double frequency; // rad/s; 0: it does not swing
	ob_vec3 a; // m/s^2, if it swings: at the first instant
	uint32_t points; // of the spline, ascending by time, the first at 0; 0: it is none
	bool loop; // after the last point, which lies where the first does, the spline begins again
	bool turns; // its points have attitudes; those next to each other are less than half a turn apart
	ob_path_point *point; // [points]
} ob_path;

// A copy with its points in one block of memory, which free() ends; NULL: out of memory.
ob_path *ob_path_copy(const ob_path *path);

// A parabola of a spline, in steps after the object's first instant.
typedef struct ob_path_piece {
	uint64_t from, until; // UINT64_MAX: for good
	ob_vec3 p, v, a; // at "from"
	ob_quat q; // likewise, if the path turns ..
	ob_vec3 w; // rad/s, world: .. all the time
} ob_path_piece;

// The path of what swings about the place of its state with an amplitude (m), sin(frequency t + phase) of it at t (s);
// the state becomes that of t = 0.
ob_path ob_path_sine(ob_state *state, ob_vec3 amplitude, double frequency, double phase);
// The path of what goes about an axis (unit) through a centre with a frequency, from the place of its state on.
ob_path ob_path_circle(ob_state *state, ob_vec3 centre, ob_vec3 axis, double frequency);

// The piece that holds from "step" on. h: s, of a step.
ob_path_piece ob_path_piece_at(const ob_path *path, double h, uint64_t step);

// The turn (rad, about an axis in the world's frame) from one attitude to another by the shortest way. false: they are
// half a turn apart, where there is none.
bool ob_path_turn(ob_quat from, ob_quat to, ob_vec3 *turn);

// Whether steps of h (s) leave at least two between each two points; if not, "which" is the first point too near to the
// one before it.
bool ob_path_fits(const ob_path *path, double h, uint32_t *which);

#endif
