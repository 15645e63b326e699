// Surfaces with prescribed motion: kinematic bodies, and bodies with a running surface, a belt. Each contact with one
// has a row of its own in the island, of infinite mass, which no impulse changes. It holds the velocity that the
// contact's body is to feel:
//     v row   at the partial substep's start: the velocity then
//     v row   at the partial substep's start: the velocity then
//     u row   at its end: velocity at the future place of the contact's body; so bodies that stick to a turntable turn
//
// A body that spins about an axis of symmetry looks the same at any time: where it touches with a round surface, it takes
// nothing along, and is a running surface. Its contact stays where it is in space.
//
// A running surface moves in the plane of the contact only. Its velocity is in the rows from before the iterations
// until the positions are integrated, and nowhere else, for the shape itself stays.
//
// Carried bodies are moved by the trapezoidal rule as all are. The difference to the surface's own motion, which is
// known, is added. So they stay where they lie, whatever the length of the partial substeps.
#ifndef OB_SOLVER_SURFACES_H
#define OB_SOLVER_SURFACES_H

#include "solver/solver.h"

// True if the object needs such rows.
bool ob_surface_moves(const ob_passport *p);
// Adds a row for the island's pair number "pair", whose body has been loaded.
void ob_surface_add(ob_solver *s, uint32_t row, uint32_t pair, const ob_island_object *object);
// Returns the pair's row; 0: none.
uint32_t ob_surface_row(const ob_island_work *w, uint32_t pair);
// Notes the normal n of the row's contact: a cylinder that spins about its axis is a running surface at its side, and a
// turntable at its ends.
void ob_surface_note_normal(ob_island_work *w, uint32_t row, ob_vec3 n);
// True if the row's surface has an acceleration that changes all the time.
bool ob_surface_swings(const ob_island_work *w, uint32_t row);
// True if a surface of the island swings, turns or runs: no frame of reference has it at rest.
bool ob_surfaces_drive(const ob_island_work *w);
// Links surfaces to contacts when all contacts are loaded; the island's largest acceleration includes that of
// carried bodies.
void ob_surfaces_begin(ob_solver *s);
// Time (s) into the coming partial substep at which a body that slides on an accelerating surface stops sliding, if
// friction stays as it is: it then slides back, or sticks. Infinity: not within h.
double ob_surfaces_reversal(const ob_solver *s, double h);
// Marks contacts with turning surfaces, before the narrow phase: their geometry differs in each partial substep.
void ob_surfaces_renew_contacts(ob_solver *s);
// Sets v and dv of the surfaces, after dv of the bodies.
void ob_surfaces_warm_start(ob_solver *s);
// Adds running surfaces to v, and sets u = v + dv.
void ob_surfaces_predict_velocities(ob_solver *s);
// Sets the change of velocity in the partial substep as impacts use it, without running surfaces.
void ob_surfaces_set_drift(ob_island_work *w);
// Velocity, m/s, world, of the running surface at the row's contact; 0 for other rows.
ob_vec3 ob_surface_velocity(const ob_island_work *w, uint32_t row);
// State of the row's surface, in the island's frame, at t (s) into the partial substep. It does not include a running
// surface.
ob_state ob_surface_state(const ob_island_work *w, uint32_t row, double t);
// Displacement (m) of the row's surface in the partial substep beyond that of a constant acceleration.
double ob_surface_bend(const ob_island_work *w, uint32_t row);
// Adds the displacement of carried bodies beyond the trapezoidal rule, before their positions are integrated.
void ob_surfaces_carry(ob_solver *s);
// Move a surface to the midpoint of the partial substep (solver/midpoint.h), and all back.
void ob_surface_halve(ob_solver *s, uint32_t row);
void ob_surfaces_undo_halves(ob_solver *s);
// Sets its velocity, path and displacement row to the partial substep's end, and `end` to its pose then. false: it is
// at rest, or no surface.
bool ob_surface_advance(ob_solver *s, uint32_t row, ob_pose *end);
// True if a body of the island touches a kinematic object that moves: then it is not at rest.
bool ob_surfaces_carry_any(const ob_island_work *w);
void ob_surfaces_finish(ob_surfaces *x);

#endif
