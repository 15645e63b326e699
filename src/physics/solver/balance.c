#include "solver/balance.h"

#include <string.h>

#include "solver/bodies.h"
#include "solver/contact_solver.h"
#include "solver/contacts.h"
#include "solver/joints.h"

static const double sleep_delay = .5, sleep_interval = .5; // s: rest time before the first test; interval of tests
static const double own_speed = 1e-3; // m/s: speed that may remain after contacts have stopped the bodies
static const double slack = 1e-5; // m: a smaller gap counts as contact
static const double converged_share = .01; // share of the bounds above: the solver ends once an iteration changes less
static const uint32_t max_stop_iterations = 64, max_hold_iterations = 512;

// Reduces the gaps of all existing contact points by so much (m).
static void close_gaps(ob_island_work *w, double by)
{
	for (uint32_t i = 0; i < w->batches; i++)
		for (int j = 0; j < OB_POINTS; j++) {
			lanes *gap = &w->batch[i].gap[j];
			*gap = lanes_select(*gap < .5 * ob_no_contact, *gap - by, *gap);
		}
}

// Returns the largest speed (m/s) of any point of a body.
static double fastest(const ob_island_work *w)
{
	double most = 0;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const double *u = w->u[i];
		most = ob_max(most,
			      ob_norm(ob_v3(u[0], u[1], u[2])) + w->body[i].radius * ob_norm(ob_v3(u[3], u[4], u[5])));
	}
	return most;
}

static void restore_impulses(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->batches; i++)
		memcpy(w->batch[i].impulse, w->batch[i].impulse_start, sizeof w->batch[i].impulse);
}

// True if contacts and joints bring the bodies to rest from their present velocities.
static bool contacts_stop(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_bodies_predict_velocities(s);
	ob_joints_find_rest(s);
	ob_solver_converge(s, converged_share * own_speed * w->unit.speed, max_stop_iterations);
	restore_impulses(w);
	return fastest(w) <= own_speed * w->unit.speed;
}

// True if contacts and joints hold the bodies at rest against the external accelerations.
static bool contacts_hold(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double enough = ob_balanced_change(w, w->h);
	ob_body_row *v = w->v;
	w->v = w->drift; // free as scratch memory here
	memset(w->v, 0, w->rows * sizeof *w->v);
	ob_bodies_predict_velocities(s);
	ob_joints_find_rest(s);
	ob_solver_converge(s, converged_share * enough, max_hold_iterations);
	w->v = v;
	return fastest(w) <= enough;
}

bool ob_balance_may_sleep(ob_solver *s, double rest_time)
{
	ob_island_work *w = &s->island;
	const double step = s->settings->step_length;
	// A test costs as much as several steps. It comes sooner in coarse runs, where steps cost less.
	const double time = ob_coarse_time(w);
	const long steps = lround(rest_time / step), delay = lround(sleep_delay * time / step),
		   interval = lround(ob_max(1, sleep_interval * time / step));
	if (!s->settings->sleeping || steps < delay || (steps - delay) % interval)
		return false;
	ob_contacts_prepare(s);
	close_gaps(w, slack * w->unit.length);
	ob_bodies_warm_start(s);
	const bool balances = contacts_stop(s) && contacts_hold(s);
	close_gaps(w, -slack * w->unit.length);
	if (!balances)
		restore_impulses(w);
	return balances;
}
