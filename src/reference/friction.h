// Coulomb friction (Coulomb 1785, Theorie des machines simples) on blocks and solid spheres. Pure functions,
// thread-safe. SI units; angles in rad against the horizontal; one mu for sticking and sliding.
#ifndef OB_REFERENCE_FRICTION_H
#define OB_REFERENCE_FRICTION_H

// Acceleration down a slope of a block that starts at rest: 0 if mu >= tan(angle), else g (sin - mu cos).
double ob_reference_incline(double g, double angle, double mu);
double ob_reference_friction_angle(double mu); // rad: the slope on which it just sticks, atan(mu)

// A block at speed v on level ground comes to rest after v / (mu g), having gone v^2 / (2 mu g).
double ob_reference_stop_time(double v, double mu, double g);
double ob_reference_stop_distance(double v, double mu, double g);

// A solid sphere set down at speed v without spin slides at -mu g while mu m g r / (2 m r^2 / 5) spins it up; it rolls
// from t = 2 v / (7 mu g) on, at 5/7 v (Routh 1905, Dynamics of a System of Rigid Bodies, elementary part, on a sphere
// that slides and rolls; the speed, for any law of friction, from the angular momentum about the line of contact).
double ob_reference_roll_time(double v, double mu, double g);
double ob_reference_roll_speed(double v);
typedef struct ob_reference_roll {
	double way; // m
	double speed; // m/s
	double surface; // m/s: radius times rate of turn; = speed while it rolls
} ob_reference_roll;
ob_reference_roll ob_reference_slip_to_roll(double v, double mu, double g, double t);

// Acceleration down a slope of a solid sphere that starts at rest: it rolls at 5/7 g sin if mu >= 2/7 tan(angle), else
// slides at g (sin - mu cos) (Routh 1905, as above).
double ob_reference_ball_incline(double g, double angle, double mu);
double ob_reference_ball_grip(double angle); // 2/7 tan(angle): the least mu with which it rolls

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

#endif
