// Limits on properties, places and loads of objects. Scenes, scripts, viewers, requests, checkpoints and records all
// pass them before an object is simulated or shown.
//
// Lengths keep fourteen orders of magnitude to where the simulators' numbers were seen to fail: an object
// of 1e-20 m and a kilogram makes its neighbours diverge. Pure functions, thread-safe.
#ifndef OB_SCENE_OBJECT_LIMITS_H
#define OB_SCENE_OBJECT_LIMITS_H

#include "scene/scene.h"

#define OB_LENGTH_LEAST 1e-6 // m: an edge, a radius, a length, a hull's width; the smallest tolerance
#define OB_LENGTH_MOST 1e6 // m
#define OB_SLENDERNESS_MOST 1e4 // longest extent by least, of a body that forces move
#define OB_INERTIA_LEAST 1e-4 // largest moment by mass and the square of the bounding ball's radius, and its inverse
#define OB_MASS_LEAST 1e-12 // kg
#define OB_MASS_MOST 1e12 // kg: 1 km of water
#define OB_PLACE_MOST 1e7 // m from the origin along each axis: a double has steps of 2e-9 m there
#define OB_TIME_MOST 1e9 // s: of points of a path or a force
#define OB_JOINT_MOST 1e15 // along the axis of a joint: forces, stiffness, damping, targets
#define OB_SPEED_MOST 1e5 // m/s along each axis, and of the surface by spin
#define OB_SPIN_MOST 1e4 // rad/s
#define OB_FORCE_MOST 1e15 // N
#define OB_ACCELERATION_MOST 1e6 // m/s^2 along each axis, by a force; rad/s^2, by a torque
// Surface of an object whose scene or request says nothing of it.
#define OB_FRICTION_USUAL .5
#define OB_ROUGHNESS_USUAL .45
#define OB_FRICTION_MOST 1e3

// False and e, as "mass: expected from 1e-12 to 1e+12 kg, got 0 kg". The inertia is not looked at: these limits bound it.
bool ob_passport_check(const ob_passport *p, ob_error *e);
// Likewise of an object before it begins, with its passport, its path and its force.
bool ob_object_def_check(const ob_object_def *def, ob_error *e);
// Likewise of a state to go on from, and of a force (N) or an impulse (N s) with an angular impulse (N m s), world frame.
bool ob_state_check(const ob_passport *p, const ob_state *s, ob_error *e);
bool ob_push_check(const ob_passport *p, ob_vec3 force, ob_vec3 twist, ob_error *e);
// Likewise of a spline: its points are in bounds and their times grow from 0, a loop is closed, neighbours are less than half a
// turn and at least two steps of step_length (s) apart, speeds are in bounds.
bool ob_path_check(const ob_path *path, double step_length, ob_error *e);
// The part of it about ends and turns: e begins with the field of a scene's path that is wrong, as "loop: expected ..".
bool ob_path_check_turns(const ob_path *path, ob_error *e);
bool ob_friction_check(double friction, ob_error *e);
bool ob_surface_velocity_check(const ob_passport *p, ob_vec3 v, ob_error *e); // and the object is static or kinematic
// The same, and its name ends; e names the object, too.
bool ob_object_check(const ob_object_def *def, ob_error *e);
// The same for the properties that a checkpoint has of an object.
bool ob_object_check_saved(const ob_passport *p, ob_error *e);

// The most that may act on an object along each axis: a force (N) or an impulse (N s), a torque (N m) or an angular
// impulse (N m s). They change its speed, or its spin, by OB_ACCELERATION_MOST in a second, or at once.
double ob_force_most(const ob_passport *p);
double ob_torque_most(const ob_passport *p);

#endif
