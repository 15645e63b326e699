// Stability of an arch of loose stones. Pure, thread-safe.
#ifndef OB_REFERENCE_ARCH_H
#define OB_REFERENCE_ARCH_H

// Least thickness (m) at which a semicircular arch of equal voussoirs stands by its own weight, with unlimited
// friction. The stones' corners lie on two circles about the same centre, thickness / 2 inside and outside of the
// radius (m); joints are radial, springers stand on level ground. The arch stands as long as a line of thrust lies
// within all joints (Heyman 1969, "The safety of masonry arches"). For many voussoirs, the thickness is .10743 of the
// radius (Milankovitch 1907: .1075). voussoirs: even, at least 4.
double ob_reference_arch_thickness(int voussoirs, double radius);

#endif
