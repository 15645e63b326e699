// Closed forms of mechanics with their sources: free fall and bouncing, central impacts, Coulomb friction, statics.
// Pure functions, thread-safe. SI units.
#ifndef OB_REFERENCE_MECHANICS_H
#define OB_REFERENCE_MECHANICS_H

#include <ob/vec.h>

// ---- Free fall and bouncing of a point mass

// p + v t + a t^2 / 2 (Galilei 1638, Discorsi, fourth day): centre of mass of any body in free flight.
ob_vec3 ob_reference_parabola(ob_vec3 p, ob_vec3 v, ob_vec3 a, double t);

// Ball dropped from height (m, of its lowest point) onto fixed ground, with Newton's restitution e. Each impact leaves
// e times the speed (Newton 1687, Principia, scholium to the laws), so it rises to e^2 of the height.
double ob_reference_apex(double height, double e, int k); // m: height e^(2 k), after the k-th impact; k = 0: height
double ob_reference_impact_time(double height, double g, double e, int k); // s after the drop, of the k-th, from 1

// ---- Central impacts

typedef struct ob_reference_pair {
	double a, b; // m/s, along the line of centres
} ob_reference_pair;

// Velocities after a central impact of masses a and b (kg; INFINITY = fixed) with restitution e. Momentum is conserved,
// and b - a after = -e (b - a) before (Newton 1687, Principia, scholium to the laws and corollary 3).
ob_reference_pair ob_reference_impact(double mass_a, double mass_b, ob_reference_pair before, double e);

// Newton's cradle: n equal spheres in contact in a row, e = 1; the first k come in together at speed v. Pair after pair
// changes velocities until the last k leave at v and the others are at rest (Herrmann and Seitz 1982, Am. J. Phys. 50,
// 977). Fills velocity[n].
void ob_reference_cradle(int n, int k, double v, double *velocity);

// Oblique impact of two solid spheres, or of one with a fixed obstacle. Newton's restitution acts along the normal;
// Coulomb's friction across it ends the slip or takes mu times the normal impulse. The slip keeps its direction, as a
// sphere's response across the normal is isotropic (Routh 1905, Dynamics of a System of Rigid Bodies, elementary part,
// on the impact of rough spheres).
typedef struct ob_reference_sphere {
	double mass, radius; // kg, INFINITY = fixed; m
	ob_vec3 v, w; // before; after
} ob_reference_sphere;
// normal: from b to a, unit length; the spheres approach.
void ob_reference_oblique(ob_reference_sphere *a, ob_reference_sphere *b, ob_vec3 normal, double e, double mu);

// ---- Coulomb friction (Coulomb 1785, Theorie des machines simples) on blocks and solid spheres: angles in rad against
// the horizontal; one mu for sticking and sliding

// Acceleration of a block down a slope from rest: 0 if mu >= tan(angle), else g (sin - mu cos).
double ob_reference_incline(double g, double angle, double mu);
double ob_reference_friction_angle(double mu); // rad: the steepest slope on which it sticks, atan(mu)

// Block on a table that moves as amplitude sin(frequency t) (m, rad/s); the block starts with v (m/s) against the
// ground. It slides at mu g until it has the table's velocity, and sticks while friction can provide the table's
// acceleration (Coulomb). Displacement and velocity at t (s), from the closed form of each phase; phases end to 1e-14
// of a period.
typedef struct ob_reference_shaken {
	double x, v; // m, m/s
} ob_reference_shaken;
ob_reference_shaken ob_reference_shaken_block(double amplitude, double frequency, double mu, double g, double v,
					      double t);
// m: a block farther than this from the axis of a turntable (rad/s) slides off
double ob_reference_turntable_radius(double rate, double mu, double g);
// Centre (m) at t (s) of a homogeneous ball that rolls without slipping on a turntable with rate (rad/s) about the
// origin, from a place with a velocity, and with the spin of rolling. It moves on a circle with 2/7 of the turntable's
// rate (Milne 1948, Vectorial Mechanics; Weltner 1979, Am. J. Phys. 47).
ob_vec3 ob_reference_turntable_ball(double rate, ob_vec3 p, ob_vec3 v, double t);

// Block at speed v on level ground: it stops after v / (mu g) and a distance of v^2 / (2 mu g).
double ob_reference_stop_time(double v, double mu, double g);
double ob_reference_stop_distance(double v, double mu, double g);

// Solid sphere set down at speed v without spin: it slides at -mu g while mu m g r / (2 m r^2 / 5) spins it up, and
// rolls from t = 2 v / (7 mu g) on, at 5/7 v (Routh 1905, Dynamics of a System of Rigid Bodies, elementary part, on a
// sphere that slides and rolls). The final speed holds for any law of friction, by the angular momentum about the line
// of contact.
double ob_reference_roll_time(double v, double mu, double g);
double ob_reference_roll_speed(double v);
typedef struct ob_reference_roll {
	double distance; // m
	double speed; // m/s
	double surface; // m/s: radius times rate of turn; equals speed while it rolls
} ob_reference_roll;
ob_reference_roll ob_reference_slip_to_roll(double v, double mu, double g, double t);

// Acceleration of a solid sphere down a slope from rest: it rolls at 5/7 g sin if mu >= 2/7 tan(angle), else slides at
// g (sin - mu cos) (Routh 1905, as above).
double ob_reference_ball_incline(double g, double angle, double mu);
double ob_reference_ball_grip(double angle); // 2/7 tan(angle): least mu for rolling

// Same for any round body with "moment" = moment of inertia over mass and radius squared, 1/2 for a solid cylinder. It
// rolls at g sin / (1 + moment) if mu is large enough.
double ob_reference_round_incline(double g, double angle, double moment);

// SimBenchmark's rolling test (Kang and Hwangbo 2018): a force pushes a box of mass M along the ground, with n solid
// spheres of mass m rolling on it. The ground takes mu (M + n m) g off the force. Friction f accelerates a sphere's
// lowest point at f / m + f r^2 / (2 m r^2 / 5) = 7 f / (2 m), and it keeps up with the box: f = (F - f_ground) / M /
// (3.5 / m + n / M).
typedef struct ob_reference_rolling {
	double ground, ball; // N: friction from the ground on the box, from the box on each sphere
	double box_a, ball_a; // m/s^2, along the force
	double grip; // least mu between box and sphere for this to hold
} ob_reference_rolling;
ob_reference_rolling ob_reference_push(double force, double mu_ground, double box_mass, double ball_mass, int balls,
				       double g);

// ---- Statics: stability

// Farthest reach over the edge of a table, in lengths of a brick, of a stack of n equal bricks, one on each level: sum
// of 1 / (2 k), k = 1 .. n (Johnson 1955, Am. J. Phys. 23, 240; Paterson and Zwick 2009, Am. Math. Monthly 116, 19).
// The k-th brick from the top is shifted by 1 / (2 k) against the one below.
double ob_reference_overhang(int n);
double ob_reference_overhang_shift(int k); // in lengths; k from 1, at the top

// Two equal boxes lean against each other at the top, their long sides at "angle" (rad) to the vertical. Each stands on
// its inner lower edge and touches the other with its inner upper edge. So with length l and thickness d, its centre
// lies (l sin - d cos) / 2 inwards of its foot. By symmetry the other pushes horizontally, at height l cos:
//      push l cos = weight (l sin - d cos) / 2,
// and friction must balance the push: mu >= push / weight = (tan(angle) - d / l) / 2, which is tan(angle) / 2 for thin
// boxes. The contact between the boxes must be able to push horizontally: it needs enough friction for the normal found
// there. Returns the least mu between each box and the ground.
double ob_reference_cards_grip(double angle, double length, double thickness);

#endif
