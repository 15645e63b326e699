// Impacts within a partial substep, each at its instant: with restitution and without.
//
// A round takes the contacts that hit before any other contact of their bodies. Those that hit at the same instant and
// are connected through bodies form one set. Its bodies are moved to that instant, the contact points are found there,
// and all are solved at once (contact/impact.h). Then the bodies are set back along their new free flights to the
// partial substep's start; the rest of it is computed as if they had always moved so. Results do not depend on the
// order of bodies or contacts.
//
// A plastic hit (e = 0) is an impact, too; the bodies then stay in contact. So
//
//   - points that carry a load do not hit, but are held, by the contact solver;
//   - contacts that touch hit bodies, and would be closed by the hit, are hit with them: a rocking block gets its
//     pivot's impulse, too, when the other edge comes down;
//   - a contact that carried a load and that the hit opens loses the load at the instant: the block goes on about its
//     new edge. The load moved its bodies until then, and they are set back without it;
//   - if nothing external acts, nothing presses bodies together, and a contact that turns is a row of hits: each
//     reverses the approach by turning since the last one, in a hop as long as a partial substep. So angular momentum
//     and energy are kept to rounding.
//
// In a field, only sets of few points are solved so: the contact solver takes islands that rest on themselves.
#ifndef OB_SOLVER_IMPACTS_H
#define OB_SOLVER_IMPACTS_H

#include "solver/solver.h"

// Prepares the first impacts of a partial substep.
void ob_impacts_begin(ob_solver *s);
// Solves all impacts within the partial substep: changes velocities, poses, and the geometry of the contacts that hit.
// true: there were some. first: the first call in the partial substep; later calls test contacts of hit bodies alone.
bool ob_impacts_resolve(ob_solver *s, bool first);
// Gap, m, that the contact solver leaves to a point of a contact that approaches fast but misses. Its row may seem to
// close by this much; slowed down until it just touched, the point would carry a load before it hits.
double ob_impacts_slack(const ob_solver *s, const ob_contact *contact, uint32_t point);
void ob_impacts_finish(ob_impacts *x);

#endif
