// Forces along the free axis of a joint: those of limits, a spring with a damper, dry friction, a motor.
//
// Springs, dampers and motors that pull to a value are forces of the value and its rate. Friction and motors that hold a
// rate are forces between bounds at one rate, and constant at all others. So the axis is at each time in one of three
// states; the last two are an equality row of the joint (engaged):
//
//   slides    its rate lies between those held: a constant force            ends as it comes to one of them
//   is held   its rate is one of them                                       ends as that takes a greater force
//   rests     its value is a limit                                          ends as that would take a pull
//
// A limit that is reached is hit: the rate is reversed with its restitution, and forces give no impulse, but for a motor
// whose force has no bound.
#ifndef OB_SOLVER_JOINT_AXIS_H
#define OB_SOLVER_JOINT_AXIS_H

#include "solver/solver.h"

typedef enum ob_axis_event {
	OB_AXIS_NONE,
	OB_AXIS_LOW, // a limit is reached
	OB_AXIS_HIGH,
	OB_AXIS_RELEASED, // a limit would have to pull
	OB_AXIS_SLOWER, // leaves, or comes to, the next state of smaller or greater rates
	OB_AXIS_FASTER,
} ob_axis_event;

// Takes the value, and finds its violation at this time (s) of the run. turned: rad, of a ball's axis: since the flight began.
void ob_axis_find(ob_held_joint *j, double value, double turned, double time);
// Finds the state of an axis with this rate, at the time and value found. Rows are to be factored anew.
void ob_axis_enter(ob_held_joint *j, double rate, double time);
// Lets it rest on a limit (-1, 1), or leave its equality.
void ob_axis_rest(ob_held_joint *j, int limit, double time);
void ob_axis_disengage(ob_held_joint *j);
// Goes to the next state after an event that is not a hit.
void ob_axis_pass(ob_held_joint *j, ob_axis_event event, double time);
// Force (N, N m) along the axis at its value and this rate, beside its equality row and its rotor. h: s, length of the
// flight: springs too stiff for it are softened.
double ob_axis_force(const ob_held_joint *j, double rate, double h);
// The same as force - damping * rate, with a motor that is clamped or not as it is at this rate.
void ob_axis_find_terms(const ob_held_joint *j, double rate, double h, double *force, double *damping);
// Inertia of its rotor (kg, kg m^2); 0: none.
double ob_axis_armature(const ob_held_joint *j);
// Distance from the event that ends the state; below 0: it has happened. force: of the equality row.
double ob_axis_margin(const ob_held_joint *j, double rate, double force, ob_axis_event *event);
// True if a motor holds the rate whatever force that takes.
bool ob_axis_is_driven(const ob_held_joint *j);
// True if friction or a motor gives all of its force, and holds no rate.
bool ob_axis_slides(const ob_held_joint *j);
// Rate (1/s) at which spring and damper may move it.
double ob_axis_swing(const ob_held_joint *j);
// True if its force depends on its rate.
bool ob_axis_is_damped(const ob_held_joint *j);
// True if a spring or a damper acts along the axis: its response is needed.
bool ob_axis_is_soft(const ob_held_joint *j);
// Restitution of a hit on a limit with this rate: 0 for slow ones.
double ob_axis_restitution(const ob_held_joint *j, double rate);

// Among contacts: finds the rows of a partial substep of h (s) whose midpoint has been found, for this rate at its start.
void ob_axis_begin(ob_held_joint *j, double rate, double h);
// After the rows have been solved: true if they are not those of the solution, and have changed. change: N s, to be given
// to the axis.
bool ob_axis_settle(ob_held_joint *j, double rate, double h, double *change);

#endif
