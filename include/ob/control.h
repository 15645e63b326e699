// Control of a run: its steps, snapshots of its state, and changes of its objects.
//
// The run is one of `obsim control SCENE.lua`, which stands until a program takes control of it, and ends when that
// program leaves. Its states are read by the functions of <ob/universe.h>, which any other program may do, too.
//
// Each function returns when the host has carried it out. Changes take effect at the current step boundary, in the order
// of the calls, and are seen by readers at once. A run that is controlled in the same way ends in the same bits, for any
// workers and isolation. Units: SI, radians, world frame. On failure functions return false and explain it in e; nothing
// else is changed, unless a list of changes is longer than OB_CONTROL_BATCH: then earlier parts of it took effect.
//
// Torques, pushes and drags act on what objects do at each step boundary, until they are changed, released, or the
// program leaves. A drag is a critically damped spring that moves objects of any mass alike, at 100 m/s at most.
//
// Thread-safety: one thread at a time for each ob_controller.
#ifndef OB_CONTROL_H
#define OB_CONTROL_H

#include <ob/motion.h>
#include <ob/universe.h>

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

typedef struct ob_controller ob_controller;

// A change of one object. Numbers beyond those named are ignored.
typedef struct ob_change {
	uint32_t id, generation; // generation 0: whichever object has the id
	double value[13];
} ob_change;
enum { OB_CONTROL_BATCH = 500 };

// Takes control of a universe, which must outlive the controller. NULL and e: its host is not reachable, it is not
// to be controlled, or another program controls it.
ob_controller *ob_controller_open(const ob_universe *u, ob_error *e);
// Runs a scene within this program: each step is a function call, and the calling thread the only worker, so there is
// neither a gate nor a packet between the two. words: a scene and options, as of `obsim control`. The same commands end in
// the same bits as outside. Refused is all that takes other threads or processes: ob_controller_run, ob_controller_kill, FMUs,
// free runs. Readers attach the universe of this name as any other. The library needs obsim-inside.so, which is installed with obsim.
// Several runs may go on in a program, in threads of its own; signals and output stay the program's, but for warnings on
// standard error. After a fork the child may not use it. NULL and e: the scene or an option is wrong.
ob_controller *ob_controller_open_inside(const char *const *words, size_t n, char name[OB_NAME_MAX], ob_error *e);
void ob_controller_close(ob_controller *c); // the run ends; NULL is allowed
int ob_controller_fd(const ob_controller *c); // readable when the host has left; -1: the run is inside

// Runs some steps and waits until they are complete.
bool ob_controller_step(ob_controller *c, uint64_t steps, ob_error *e);
// The same after changes of motors and forces, as of ob_controller_set_motors and ob_controller_set_forces, in one exchange.
bool ob_controller_step_with(ob_controller *c, uint64_t steps, const struct ob_change *motor, size_t motors,
			     const struct ob_change *force, size_t forces, ob_error *e);
// Part of one run in ob_controller_step_all.
typedef struct ob_run_step {
	ob_controller *controller;
	const ob_universe *universe; // its universe, to read from
	uint64_t snapshot; // restored first; 0: none
	const struct ob_change *motor, *force; // [motors], [forces], as of ob_controller_step_with
	size_t motors, forces;
	const uint32_t *joint; // [joints]: read after the steps, as of ob_universe_get_joint_values
	size_t joints;
	double *values; // [joints][2]
	ob_state_arrays states; // read after the steps, as of ob_universe_get_states
	size_t objects; // rows of these arrays, 0: none is read; then the number of objects
	bool failed; // written: true, and error, if this run could not do its part
	ob_error error;
} ob_run_step;
// Steps n runs of different controllers, each to the bits that it reaches alone. threads: how many share them (1 to 257),
// the caller's among them; they end before it returns. false and e: a run failed, the first is named; all others have stepped.
bool ob_controller_step_all(ob_run_step *run, size_t n, uint64_t steps, unsigned threads, ob_error *e);
// Lets the run go on by itself, at a pace of simulated time per wall-clock time (INFINITY: as fast as it can), until
// paused or stepped. Other functions interrupt it for an instant.
bool ob_controller_run(ob_controller *c, double pace, ob_error *e);
bool ob_controller_pause(ob_controller *c, ob_error *e);

// Keeps the whole state in the host's memory; snapshot: its number. Restoring puts it back to the bit, with all objects,
// scripts and the clock; snapshots stay until they are forgotten. Some 2 kB of memory for each object.
bool ob_controller_snapshot(ob_controller *c, uint64_t *snapshot, ob_error *e);
bool ob_controller_restore(ob_controller *c, uint64_t snapshot, ob_error *e);
bool ob_controller_forget(ob_controller *c, uint64_t snapshot, ob_error *e);

// Begins again, as the scene makes it of a seed (NULL: the same as before) and of parameters, "name=value" as -D has them,
// which replace those of the same names. The universe is a new one of the same name: attach it again. Snapshots are lost.
bool ob_controller_reset(ob_controller *c, const uint64_t *seed, const char *const *parameters, size_t n, ob_error *e);
// Writes the state into a checkpoint file, from which obsim run and obsim control go on (--resume). path: as the host's
// process finds it.
bool ob_controller_save(ob_controller *c, const char *path, ob_error *e);

// Contact of two objects that began or ended in a step.
typedef struct ob_contact_event {
	uint32_t a, b; // ids, a < b
	uint32_t step; // number of steps that were then complete
	uint32_t begins; // 1, or 0: it ended
} ob_contact_event;

// Notes all contacts that begin and end from now on, or no longer. The run then pauses after each step.
bool ob_controller_subscribe_contacts(ob_controller *c, bool on, ob_error *e);
// Takes the oldest events, at most max; n: how many; lost: events that found no room, a million before they are taken.
bool ob_controller_take_contacts(ob_controller *c, ob_contact_event *out, size_t max, size_t *n, uint64_t *lost,
				 ob_error *e);

// Changes n objects: constant external force from now on (value: x y z, N); impulse and angular impulse (N s, N m s);
// state to go on from (position m, attitude w x y z, velocity m/s, angular velocity rad/s; a part whose first number is NaN
// stays as it is), also of static and kinematic objects, whose path ends; colour (linear r g b, 0 to 1, and 1: opaque).
bool ob_controller_set_forces(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_kick(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_set_states(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_set_colours(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Likewise: torque from now on (x y z, N m); force at a point of the body (force x y z, N, from now on; point x y z, m, from
// the centre of mass in the body frame); spring from a point of the body to a target (target x y z, m; point x y z, m;
// frequency, Hz, 0 = 3). Torques and forces of 0 end. release ends all three of an object. friction: coefficient; the
// object's contacts begin anew.
bool ob_controller_set_torques(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_push(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_drag(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_release(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_set_frictions(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Velocity of the surface of static and kinematic objects, as of a belt (x y z, m/s, body frame).
bool ob_controller_set_surface_velocities(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Motor of a joint: a change's id is that of the joint's first object, its values are the joint's number, as in <ob/joint.h>,
// and the new target (m/s, rad/s, or m, rad).
bool ob_controller_set_motors(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Removes joints: a change's id is that of the joint's first object, its value the joint's number.
bool ob_controller_unjoin(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Path of a kinematic object from now on, in place of any other: from where it stands through n points, with times from now, as
// a scene's path = { kind = "spline" } has it: it accelerates and decelerates between them, and stands at the last. turns: it
// takes their attitudes, by the shortest way; else it keeps its spin. loop: it begins again at the last point, which is where
// it stands now. The path ends with a new one, and with set_states. false and e: among others, if points are less than two
// steps apart.
enum { OB_CONTROL_POINTS = 64 };
bool ob_controller_set_path(ob_controller *c, uint32_t id, const ob_path_point *point, size_t n, bool turns, bool loop,
			    ob_error *e);
// Kills the worker processes that simulate these objects (value unused): a fault, after which the run goes on to the same
// bits. Refused where simulators are threads.
bool ob_controller_kill(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
bool ob_controller_remove(ob_controller *c, const ob_change *change, size_t n, ob_error *e);
// Creates objects and joints with the syntax of scenes: "box { size = { 1, 1, 1 }, at = { 0, 0, 5 } }". Joints hold objects that
// exist before the call, as they are now. Writes at most max ids, which
// ascend, and their number, which may exceed it.
bool ob_controller_create(ob_controller *c, const char *text, uint32_t *ids, size_t max, size_t *n, ob_error *e);
// Sends a message of some words to an object's script: numbers, true, false, or text.
bool ob_controller_message(ob_controller *c, uint32_t id, const char *const *words, size_t n, ob_error *e);

// Clock of the run as the last answer has it: steps that are complete, simulated time (s).
uint64_t ob_controller_steps(const ob_controller *c);
double ob_controller_time(const ob_controller *c);

#pragma GCC visibility pop

#endif
