// Conservation checks of every case: momentum, angular momentum and energy, as far as its world conserves them. A world
// without fixed bodies, forces and gravity is closed: all three are checked. With gravity, constant forces or fixed
// bodies, the energy can only fall. With driven bodies, nothing is checked. One thread per watch.
#ifndef OB_LAB_CONSERVATION_H
#define OB_LAB_CONSERVATION_H

#include "measure/measure.h"
#include "engine/world.h"

typedef enum ob_conserved {
	OB_CONSERVED_MOMENTUM, // drift, over the largest sum of m |v| so far
	// drift about the initial centre of mass, over the largest sum so far of |I w| and m |v| times the body's
	// radius: large distances do not hide an error
	OB_CONSERVED_ANGULAR,
	// largest rise of the energy from its lowest so far, minus the energy added by pushing penetrations apart. The
	// scale: the largest kinetic energy so far and the bodies' weights times their radii
	OB_CONSERVED_ENERGY,
	OB_CONSERVED
} ob_conserved;

typedef struct ob_conserved_kind {
	const char *title; // for people
	double bound; // up to here it counts as rounding
} ob_conserved_kind;

extern const ob_conserved_kind ob_conserved_kinds[OB_CONSERVED];

typedef struct ob_conservation {
	const ob_world *world;
	bool closed, begun, driven;
	ob_vec3 centre, momentum, angular; // at the start
	double scale[OB_CONSERVED], lowest; // kg m/s, kg m^2/s, J; J
	double worst[OB_CONSERVED]; // NAN: not conserved in this world
} ob_conservation;

ob_conservation ob_conservation_begin(const ob_world *w);
// Call at each frame, from the first on. recovered: J, see ob_engine_kind
void ob_conservation_look(ob_conservation *c, const ob_snapshot *now, double recovered);
// Keeps the worst of two runs; ignores NaN.
void ob_conservation_keep(double worst[OB_CONSERVED], const double other[OB_CONSERVED]);

#endif
