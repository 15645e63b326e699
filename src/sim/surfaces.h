// Surfaces that move as they are told: of kinematic bodies, and of what has a running surface, a belt. They are rows of
// an island that no impulse changes (mass infinite), one for each contact, so that each says what its body is to feel:
//
//     v row   at the partial substep's start: the velocity then
//     u row   at its end: of the place where the contact's body will be, so that what sticks to a turntable goes about
//             with it, and does not leave it along the tangent
//
// A running surface moves in the plane of the contact only. Its velocity is in the rows from before the iterations
// until the positions are integrated, and nowhere else, for the shape itself stays.
//
// What is carried moves by the trapezoidal rule as everything does, and what that leaves out of the surface's own
// motion, which is known, is added. So it stays where it lies, whatever the length of the partial substeps.
#ifndef OB_SIM_SURFACES_H
#define OB_SIM_SURFACES_H

#include "sim/state.h"

// Does the object need rows of this kind?
bool ob_surface_moves(const ob_passport *p);
// A row for the island's pair number "pair", whose body has been loaded.
void ob_surface_add(ob_sim *s, uint32_t row, uint32_t pair);
// The row that was made for the pair; 0: none.
uint32_t ob_surface_row(const ob_island_work *w, uint32_t pair);
// Is the row that of a surface whose acceleration changes all the time?
bool ob_surface_swings(const ob_island_work *w, uint32_t row);
// When all contacts are loaded: to whom the surfaces belong, and how fast what they carry is accelerated.
void ob_surfaces_begin(ob_sim *s);
// When, in the coming partial substep, what slides on a surface that speeds up will stop doing so, if friction goes on
// as it does (s): there it turns back, or sticks. Infinity: not within h.
double ob_surfaces_reversal(const ob_sim *s, double h);
// Before the narrow phase: contacts with what turns have another geometry in each partial substep.
void ob_surfaces_renew_contacts(ob_sim *s);
// After dv of the bodies: v and dv of the surfaces.
void ob_surfaces_warm_start(ob_sim *s);
// v with running surfaces, and u = v + dv.
void ob_surfaces_predict_velocities(ob_sim *s);
// The change of velocity in the partial substep as impacts see it, without running surfaces.
void ob_surfaces_set_drift(ob_island_work *w);
// m/s, world: of the running surface at the row's contact; 0 of other rows.
ob_vec3 ob_surface_velocity(const ob_island_work *w, uint32_t row);
// Before the positions of bodies are integrated: what they are carried by beyond the trapezoidal rule.
void ob_surfaces_carry(ob_sim *s);
// To the midpoint of the partial substep (sim/midpoint.h), and back.
void ob_surface_halve(ob_sim *s, uint32_t row);
void ob_surfaces_undo_halves(ob_sim *s);
// Its velocity, path and displacement row, as of the partial substep's end, and its pose then. false: it stays where it
// is, or is none.
bool ob_surface_advance(ob_sim *s, uint32_t row, ob_pose *end);
// Does a body of the island touch something kinematic that moves? Then it is not at rest.
bool ob_surfaces_carry_any(const ob_island_work *w);
void ob_surfaces_finish(ob_surfaces *x);

#endif
