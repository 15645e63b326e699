// Impacts within a partial substep, each at its instant: with restitution and without.
//
// A round takes the contacts that hit before any other of their bodies does. Those that hit at the same instant and are
// connected through bodies are one set: its bodies are where they are at that instant, the contact points are found
// there, and all are solved at once (contact/impact.h). Then the bodies are set back along their new free flights to
// the partial substep's start, from where the rest of it is as if they had always moved so. No result depends on the
// order of bodies or contacts.
//
// A plastic hit (e = 0) is an impact, too, and what it brings together goes on as a contact. So
//
//   - points that carry a load do not hit, but are held, by the contact solver;
//   - what touches bodies that are hit, and would be closed by that, is hit with them: a block that rocks has its
//     pivot's impulse, too, when the other edge comes down;
//   - where the hit opens a contact that carried a load, that ends at the instant: the block goes on about its new
//     edge. Bodies were moved by it until then, and are set back without it;
//   - where nothing external acts, nothing presses bodies together, and a contact that turns is a row of hits: each
//     reverses what turning has closed since the last one, in a hop as long as a partial substep. So angular
//     momentum and energy are kept to rounding.
//
// In a field, sets of few points alone are solved so: an island that rests on itself is the contact solver's.
#ifndef OB_SIM_IMPACTS_H
#define OB_SIM_IMPACTS_H

#include "sim/state.h"

// Before the first impacts of a partial substep.
void ob_impacts_begin(ob_sim *s);
// All impacts within the partial substep: changes velocities, poses, and the geometry of the contacts that hit. true if
// there were any. first: in the partial substep; later on, contacts of bodies that were hit are looked at alone.
bool ob_impacts_resolve(ob_sim *s, bool first);
// m: a point that approaches fast in a contact that misses may seem to close by so much, by its row, and is not closed by
// the contact solver either: slowed down until it just touches, it would carry a load before it hits.
double ob_impacts_slack(const ob_sim *s, const ob_contact *contact, uint32_t point);
void ob_impacts_finish(ob_impacts *x);

#endif
