// Velocity at which a gap may close in the substep: the law of a normal row. Four gaps side by side: one of each of four
// pairs (contact/kernel.c), or those of one (contact/lone.c).
//
// Points of a resting contact keep the gaps that rounding left: they would take turns for ever to close them.
// Restitution is exact in time, so an elastic point must not be stopped early. A body in free fall closes less than its
// final velocity says, by half of what it gains. A point at the surface that does not leave has no room for such a fall.
// In an isolated pair, a point that opens now may close as fast again: over the substep, the push that turns it back
// does no work.
#ifndef OB_CONTACT_BIAS_H
#define OB_CONTACT_BIAS_H

#include "elementary/lanes.h"

// Returns the points that keep their gaps (m). load: N s; most: m, gap of a resting contact.
static inline lane_mask bias_keeps(lanes load, lanes gap, lanes most)
{
	return (load > 0) & (gap < most);
}

// Returns the way (m) by which an elastic point falls less in the substep h (s) than its final velocity says. now: m/s,
// its opening; gained: m/s, what external forces add.
static inline lanes bias_of_fall(lanes gap, lanes now, lanes gained, double h)
{
	return lanes_max(lanes_min(-.5 * h * gained, gap + h * now), lanes_of(0));
}

static inline lanes bias_of(lanes gap, lane_mask keeps, double h)
{
	return lanes_where(~keeps, lanes_max(gap, lanes_of(0))) / h;
}

// Adds what an isolated pair may close, since its point opens at "now" (m/s).
static inline lanes bias_alone(lanes bias, lanes now)
{
	return lanes_max(bias, now);
}

#endif
