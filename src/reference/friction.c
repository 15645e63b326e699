#include "reference/friction.h"

#include <math.h>

double ob_reference_incline(double g, double angle, double mu)
{
	return fmax(0, g * (sin(angle) - mu * cos(angle)));
}

double ob_reference_friction_angle(double mu)
{
	return atan(mu);
}

double ob_reference_stop_time(double v, double mu, double g)
{
	return v / (mu * g);
}

double ob_reference_stop_distance(double v, double mu, double g)
{
	return v * v / (2 * mu * g);
}

double ob_reference_roll_time(double v, double mu, double g)
{
	return 2 * v / (7 * mu * g);
}

double ob_reference_roll_speed(double v)
{
	return 5 * v / 7;
}

ob_reference_roll ob_reference_slip_to_roll(double v, double mu, double g, double t)
{
	double rolls = ob_reference_roll_time(v, mu, g), a = mu * g, speed = ob_reference_roll_speed(v);
	if (t < rolls)
		return (ob_reference_roll){ t * (v - .5 * a * t), v - a * t, 2.5 * a * t };
	return (ob_reference_roll){ rolls * (v - .5 * a * rolls) + speed * (t - rolls), speed, speed };
}

double ob_reference_ball_grip(double angle)
{
	return 2 * tan(angle) / 7;
}

double ob_reference_ball_incline(double g, double angle, double mu)
{
	return mu >= ob_reference_ball_grip(angle) ? 5 * g * sin(angle) / 7 : ob_reference_incline(g, angle, mu);
}

ob_reference_rolling ob_reference_push(double force, double mu_ground, double box_mass, double ball_mass, int balls,
				       double g)
{
	ob_reference_rolling r = { .ground = mu_ground * (box_mass + balls * ball_mass) * g };
	r.ball = (force - r.ground) / box_mass / (3.5 / ball_mass + balls / box_mass);
	r.box_a = (force - r.ground - balls * r.ball) / box_mass;
	r.ball_a = r.ball / ball_mass;
	r.grip = r.ball / (ball_mass * g);
	return r;
}
