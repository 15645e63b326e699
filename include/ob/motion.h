// Closed forms of motion: evaluates a published motion at any instant. Pure functions, thread-safe.
#ifndef OB_MOTION_H
#define OB_MOTION_H

#include <ob/universe.h>

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

typedef struct ob_pose {
	ob_vec3 p; // m
	ob_quat q; // body to world
} ob_pose;

typedef struct ob_state {
	ob_pose pose;
	ob_vec3 v; // m/s
	ob_vec3 w; // rad/s, world frame
} ob_state;

// Point of a path that a kinematic object follows.
typedef struct ob_path_point {
	double t; // s, after the path begins
	ob_vec3 p; // m
	ob_quat q; // body to world, if the path turns
} ob_path_point;

// State at time t (s): parabola for the centre, torque-free rotation for the attitude. A swinging object with frequency
// f moves along the ellipse p + v sin(f s) / f + a (1 - cos(f s)) / f^2, s = t - t0: to and fro if v and a are
// parallel. Torque-free rotation of a rigid body in closed form: Jacobi elliptic functions for the body rates (Jacobi
// 1849; Whittaker 1937, ch. VI), the attitude by theta functions (van Zon and Schofield 2007). inertia = principal
// moments (kg m^2, body frame); equal moments or w along a principal axis turn at constant w.
ob_state ob_motion_at(const ob_motion *m, ob_vec3 inertia, double t);

// Attitude and rate after time s (s) of torque-free rotation from (q, w).
void ob_rotate_free(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out);

// Pose between two publications of one object (prev->t0 <= t <= next->t0). Exact if next is marked OB_MOTION_FREE;
// otherwise linear in position and spherical-linear in attitude, so that a landing body is never drawn inside the
// ground.
ob_pose ob_motion_between(const ob_motion *prev, const ob_motion *next, ob_vec3 inertia, double t);

// Tight axis-aligned box (xmin ymin zmin xmax ymax zmax, m) of a shape at a pose. A plane gives an infinite box, a hull
// the box of its bounding ball (ob_hull_bounds is tight).
void ob_shape_bounds(ob_shape shape, ob_vec3 size, ob_pose pose, double bounds[6]);

// Name of a shape, as scenes have it; "" for none.
const char *ob_shape_name(ob_shape shape);

// Radius (m) of the bounding sphere about the centre of mass; infinity for a plane.
double ob_shape_radius(ob_shape shape, ob_vec3 size);

// Smallest thickness (m) of a shape: after moving farther, it could have passed through something undetected.
double ob_shape_thickness(ob_shape shape, ob_vec3 size);

// Axis-aligned box that contains the shape over [t0, t0 + s] of its free motion: extremes of the parabola, or of the
// whole ellipse, plus the bounding sphere if it turns.
void ob_motion_swept_bounds(const ob_motion *m, ob_shape shape, ob_vec3 size, double s, double bounds[6]);

// First time in [0, s] at which a gap (m) with rate v (m/s) and constant acceleration a (m/s^2) closes: gap + v t + a
// t^2 / 2 = 0 with a closing rate; infinity if it does not. A gap <= 0 that closes gives 0. A gap <= 0 that opens, but
// never above 0, closes from its turning point on.
double ob_time_of_closing(double gap, double v, double a, double s);

#pragma GCC visibility pop

#endif
