// When an arch of loose stones stands. Pure, thread-safe.
#ifndef OB_REFERENCE_ARCH_H
#define OB_REFERENCE_ARCH_H

// The least thickness (m) with which a half circle of equal voussoirs stands by its own weight, where friction holds
// whatever pushes: their corners lie on two circles about the same centre, thickness / 2 inside and outside of the
// radius (m); the joints are radial, the springers stand on level ground. It stands as long as a line of thrust lies
// within all joints (Heyman 1969, "The safety of masonry arches"); for many voussoirs that is .10743 of the radius
// (Milankovitch 1907: .1075). voussoirs: even, at least 4.
double ob_reference_arch_thickness(int voussoirs, double radius);

#endif
