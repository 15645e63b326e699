// Closed forms of mechanics with their sources: free fall and bouncing, central impacts, Coulomb friction, statics.
// Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_MECHANICS_H
#define OB_REFERENCE_MECHANICS_H

#include <ob/vec.h>

// ---- Free fall and bouncing of a point mass

// p + v t + a t^2 / 2 (Galilei 1638, Discorsi, fourth day): the centre of mass of any body in free flight.
ob_vec3 ob_reference_parabola(ob_vec3 p, ob_vec3 v, ob_vec3 a, double t);

// A ball dropped from height (m, of its lowest point) onto a fixed ground, with Newton's restitution e: each impact
// leaves e times the speed (Newton 1687, Principia, scholium to the laws), so it rises to e^2 of the height.
double ob_reference_apex(double height, double e, int k); // m: height e^(2 k), after the k-th impact; k = 0: height
double ob_reference_impact_time(double height, double g, double e, int k); // s after the drop, of the k-th, from 1

// ---- Central impacts

typedef struct ob_reference_pair {
	double a, b; // m/s, along the line of centres
} ob_reference_pair;

// Velocities after a central impact of masses a and b (kg; INFINITY = fixed) with restitution e: momentum is kept, and
// b - a after = -e (b - a) before (Newton 1687, Principia, scholium to the laws and corollary 3).
ob_reference_pair ob_reference_impact(double mass_a, double mass_b, ob_reference_pair before, double e);

// Newton's cradle: n equal spheres in a row that touch, the first k come in together at speed v, e = 1. Pair after pair
// changes velocities until the last k go on at v and the rest stand still (Herrmann and Seitz 1982, Am. J. Phys. 50,
// 977). Fills velocity[n].
void ob_reference_cradle(int n, int k, double v, double *velocity);

// Two solid spheres, or a solid sphere and what never moves, that hit obliquely: Newton's restitution along the normal,
// Coulomb's friction across it, which ends the slip or takes mu times the normal impulse. Slip keeps its direction, for
// a sphere answers a push across the normal the same in all directions (Routh 1905, Dynamics of a System of Rigid
// Bodies, elementary part, on the impact of rough spheres).
typedef struct ob_reference_sphere {
	double mass, radius; // kg, INFINITY = fixed; m
	ob_vec3 v, w; // before; after
} ob_reference_sphere;
// normal: from b to a, of length 1; they approach.
void ob_reference_oblique(ob_reference_sphere *a, ob_reference_sphere *b, ob_vec3 normal, double e, double mu);

// ---- Coulomb friction (Coulomb 1785, Theorie des machines simples) on blocks and solid spheres: angles in rad against
// the horizontal; one mu for sticking and sliding

// Acceleration down a slope of a block that starts at rest: 0 if mu >= tan(angle), else g (sin - mu cos).
double ob_reference_incline(double g, double angle, double mu);
double ob_reference_friction_angle(double mu); // rad: the slope on which it just sticks, atan(mu)

// A block on a table that goes to and fro as amplitude sin(frequency t) (m, rad/s), with v (m/s) at the start, against
// the ground: it slides at mu g until it has the table's velocity, and sticks while friction can give it the table's
// acceleration (Coulomb). Its displacement and velocity at t (s), from the closed form of each phase; the ends of phases to
// 1e-14 of a period.
typedef struct ob_reference_shaken {
	double x, v; // m, m/s
} ob_reference_shaken;
ob_reference_shaken ob_reference_shaken_block(double amplitude, double frequency, double mu, double g, double v,
					      double t);
// m: a block farther from the axis of a turntable (rad/s) slides off.
double ob_reference_turntable_radius(double rate, double mu, double g);
// The centre (m) at t (s) of a homogeneous ball that rolls without slipping on a turntable with rate (rad/s) about the
// origin, from a place with a velocity, and with the spin of rolling: a circle with 2/7 of the turntable's rate
// (Milne 1948, Vectorial Mechanics; Weltner 1979, Am. J. Phys. 47).
ob_vec3 ob_reference_turntable_ball(double rate, ob_vec3 p, ob_vec3 v, double t);

// A block at speed v on level ground comes to rest after v / (mu g), having gone v^2 / (2 mu g).
double ob_reference_stop_time(double v, double mu, double g);
double ob_reference_stop_distance(double v, double mu, double g);

// A solid sphere set down at speed v without spin slides at -mu g while mu m g r / (2 m r^2 / 5) spins it up; it rolls
// from t = 2 v / (7 mu g) on, at 5/7 v (Routh 1905, Dynamics of a System of Rigid Bodies, elementary part, on a sphere
// that slides and rolls; the speed, for any law of friction, from the angular momentum about the line of contact).
double ob_reference_roll_time(double v, double mu, double g);
double ob_reference_roll_speed(double v);
typedef struct ob_reference_roll {
	double distance; // m
	double speed; // m/s
	double surface; // m/s: radius times rate of turn; = speed while it rolls
} ob_reference_roll;
ob_reference_roll ob_reference_slip_to_roll(double v, double mu, double g, double t);

// Acceleration down a slope of a solid sphere that starts at rest: it rolls at 5/7 g sin if mu >= 2/7 tan(angle), else
// slides at g (sin - mu cos) (Routh 1905, as above).
double ob_reference_ball_incline(double g, double angle, double mu);
double ob_reference_ball_grip(double angle); // 2/7 tan(angle): the least mu with which it rolls

// The same for any round body with moment of inertia "moment" over mass and radius squared, 1/2 of a solid cylinder:
// it rolls at g sin / (1 + moment) if mu is large enough.
double ob_reference_round_incline(double g, double angle, double moment);

// SimBenchmark's rolling test (Kang and Hwangbo 2018): a box of mass M on the ground is pushed by a force along it, n
// solid spheres of mass m on it roll. The ground takes mu (M + n m) g off the force; a sphere's lowest point, which
// the friction f accelerates at f / m + f r^2 / (2 m r^2 / 5) = 7 f / (2 m), keeps up with the box:
// f = (F - f_ground) / M / (3.5 / m + n / M).
typedef struct ob_reference_rolling {
	double ground, ball; // N: friction from the ground on the box, from the box on each sphere
	double box_a, ball_a; // m/s^2, along the force
	double grip; // least mu between box and sphere for which this holds
} ob_reference_rolling;
ob_reference_rolling ob_reference_push(double force, double mu_ground, double box_mass, double ball_mass, int balls,
				       double g);

// ---- Statics: what stands and what falls

// The farthest that a stack of n equal bricks, one on each level, reaches over the edge of a table, in lengths of a
// brick: sum of 1 / (2 k), k = 1 .. n (Johnson 1955, Am. J. Phys. 23, 240; Paterson and Zwick 2009, Am. Math.
// Monthly 116, 19). The k-th brick from the top is shifted by 1 / (2 k) against the one below.
double ob_reference_overhang(int n);
double ob_reference_overhang_shift(int k); // in lengths; k from 1, at the top

// Two equal boxes lean against each other at the top, their long sides at "angle" (rad) to the vertical. Each stands
// on its inner lower edge and touches the other with its inner upper edge, so with length l and thickness d its centre
// lies (l sin - d cos) / 2 inwards of its foot. The other pushes horizontally, by symmetry, at height l cos:
//	push l cos = weight (l sin - d cos) / 2,
// and the ground's friction must hold against the push: mu >= push / weight = (tan(angle) - d / l) / 2, which is
// tan(angle) / 2 for thin ones. The two boxes must be able to push horizontally where they touch: between themselves,
// rough enough for the normal that is found there. The least mu between each box and the ground:
double ob_reference_cards_grip(double angle, double length, double thickness);

#endif
