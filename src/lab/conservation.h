// What every case is watched for, whatever it is about: momentum, angular momentum and energy, as far as its world
// keeps them. A world where nothing is fixed, nothing is pulled and no gravity acts is closed: all three are watched.
// Where gravity, constant forces and fixed bodies act, the energy can only fall. Where bodies move as they are told,
// nothing is watched. One thread per watch.
#ifndef OB_LAB_CONSERVATION_H
#define OB_LAB_CONSERVATION_H

#include "measure/measure.h"
#include "world/world.h"

typedef enum ob_conserved {
	OB_CONSERVED_MOMENTUM, // drift, over the largest sum of m |v| so far
	// drift about the centre of mass at the start, over the largest sum so far of |I w| and m |v| times the body's
	// radius: what lies far apart does not hide an error
	OB_CONSERVED_ANGULAR,
	// largest rise of the energy from its lowest so far, less what pushing penetrations apart has added, over the
	// largest kinetic energy so far and the bodies' weights times their radii
	OB_CONSERVED_ENERGY,
	OB_CONSERVED
} ob_conserved;

typedef struct ob_conserved_kind {
	const char *title; // for people
	double bound; // at most this much is rounding
} ob_conserved_kind;

extern const ob_conserved_kind ob_conserved_kinds[OB_CONSERVED];

typedef struct ob_conservation {
	const ob_world *world;
	bool closed, begun, driven;
	ob_vec3 centre, momentum, angular; // at the start
	double scale[OB_CONSERVED], lowest; // kg m/s, kg m^2/s, J; J
	double worst[OB_CONSERVED]; // NAN: not kept by this world
} ob_conservation;

ob_conservation ob_conservation_begin(const ob_world *w);
// At each frame, from the first on. recovered: J, as ob_engine_kind has it
void ob_conservation_look(ob_conservation *c, const ob_snapshot *now, double recovered);
// Worst of two runs; NAN counts for nothing.
void ob_conservation_keep(double worst[OB_CONSERVED], const double other[OB_CONSERVED]);

#endif
