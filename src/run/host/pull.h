// Pulls: forces from outside that act for as long as they are held: a torque, a force at a point of a body, or a spring from
// such a point to a target, by which a visitor drags an object. They act as impulses of half a step's length when a step
// begins and when it has ended, from the state that the object has then. So the same pulls give the same bits in any run, and
// motions have errors of second order in the step.
//
//   drag   J = -(K + s 1)^-1 (v + b c)          v velocity of the point, c = point - target, J impulse at the point (N s)
//          K = 1/m - [r] I^-1 [r]               r from the centre of mass to the point, I inertia
//          s = 1 / (h (d + h k)), b = h k s     k = m w^2, d = 2 m w, w = 2 pi frequency: critically damped
//
// This soft constraint (E. Catto, Soft Constraints, GDC 2011) is implicit in the velocity, so it is stable for any step,
// mass and frequency. A target farther away than HAND_SPEED takes to reach pulls no more, and the spin decays slowly.
//
// Thread-safety: the host's thread, at a pause; the check is pure.
#ifndef OB_HOST_PULL_H
#define OB_HOST_PULL_H

#include "host/request.h"
#include "table/table.h"

typedef enum ob_pull_kind { OB_PULL_TORQUE, OB_PULL_PUSH, OB_PULL_DRAG } ob_pull_kind;

// A pull is that of its object, kind and origin: another of these replaces it. 96 bytes, saved as they are.
typedef struct ob_pull {
	uint32_t kind; // ob_pull_kind
	uint32_t id, generation; // of the object
	uint32_t origin; // number of the connection that holds on
	ob_vec3 point; // m, from the centre of mass, body frame; not for torques
	ob_vec3 value; // torque (N m), force (N) or target (m), world frame
	double frequency; // Hz, drags
	double zero;
} ob_pull;

enum { OB_PULLS_MAX = 10000 };
#define OB_PULL_FREQUENCY 3. // Hz, a hand's, unless it says otherwise

typedef struct ob_pulls {
	ob_pull *at; // [count], in the order in which they act
	uint32_t count, room;
	ob_pull *aside; // [asides], viewers'
	uint32_t asides;
} ob_pulls;

// True for a request that begins a pull; that pull.
bool ob_is_pull_request(const ob_request *r);
ob_pull ob_pull_of_request(const ob_request *r);
// Returns false and e if an object cannot be pulled so: it does not move by forces, or numbers are out of range.
bool ob_pull_check(const ob_pull *pull, const ob_passport *p, ob_error *e);
// Begins a pull, or changes it; a torque or force of 0 ends it. false: no room.
bool ob_pulls_set(ob_pulls *p, const ob_pull *pull);
// Ends the pulls of an origin on an object; id UINT32_MAX: on all objects.
void ob_pulls_release(ob_pulls *p, uint32_t id, uint32_t origin);
// Sets the pulls of viewers aside, while others are put in their place. Without memory they end.
void ob_pulls_set_aside(ob_pulls *p);
// Takes them up again in place of all pulls of viewers, as far as their objects are there.
void ob_pulls_take_up(ob_pulls *p, const ob_universe *u);
// Ends all pulls on an object.
void ob_pulls_drop(ob_pulls *p, uint32_t id);
// Copies all. false: no memory, and `to` keeps what it had.
bool ob_pulls_copy(ob_pulls *to, const ob_pulls *from);
void ob_pulls_finish(ob_pulls *p);
// Adds the impulses of half a step.
void ob_pulls_act(const ob_pulls *p, ob_universe *u);

#endif
