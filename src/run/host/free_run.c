#include "host/free_run.h"

#include <math.h>
#include <time.h>

#include "base/clock.h"
#include "free/free.h"

static const double look_interval = 5e-4; // s

bool ob_host_free_is_ahead(const ob_host *h)
{
	return ob_free_settings_of(h->u) && ob_free_until(h->u) > ob_step_count(h->u);
}

// Moves `until` ahead of the common time.
static void extend(ob_host *h)
{
	const uint64_t events = ob_population_next_step(h->population), window = ob_free_window(h->u),
		       ahead = ob_step_count(h->u) + (h->free_window < window ? h->free_window : window);
	const uint32_t now = ob_free_until(h->u);
	uint64_t until = ahead < events ? ahead : events;
	until = until < h->free_end ? until : h->free_end;
	ob_free_run_until(h->u, h->free_hold || until < now ? now : until);
}

void ob_host_free_pace(ob_host *h, double pace, uint64_t stands)
{
	const double step = ob_universe_settings(h->u)->step_length, end = pace > 0 ? INFINITY : (double)stands * step;
	if (pace == h->free_pace && (pace > 0 || stands == h->free_stands))
		return;
	h->free_pace = pace;
	h->free_stands = stands;
	ob_free_set_clock(h->u, (double)ob_step_count(h->u) * step, pace > 0 ? pace : INFINITY, end);
}

void ob_host_free_resume(ob_host *h)
{
	ob_step_begin(h->u);
	if (!ob_host_free_is_ahead(h)) {
		ob_free_enter_objects(h->u);
		h->free_hold = false;
	}
	extend(h);
}

// Step at which the interval ends; any thread may pull it in.
static uint64_t interval_end(ob_host *h)
{
	pthread_mutex_lock(&h->interval.lock);
	const uint64_t end = h->interval.end;
	pthread_mutex_unlock(&h->interval.lock);
	return end;
}

bool ob_host_free_wait(ob_host *h, double timeout)
{
	const double end = ob_clock_wall() + timeout;
	for (;;) {
		const uint64_t goal = interval_end(h);
		const bool reached = ob_free_complete(h->u, goal) >= goal;
		if (!ob_host_free_is_ahead(h) && !reached) { // all wait, as they were to
			ob_population_update(h->population, ob_step_count(h->u), h->requests);
			ob_host_free_resume(h);
		}
		const uint32_t until = ob_free_until(h->u);
		extend(h);
		if (!reached && !h->free_hold && ob_free_until(h->u) == until)
			ob_free_looked(h->u);
		if (reached || ob_step_failed(h->u, NULL) != OB_STEP_OK)
			return true;
		if (ob_clock_wall() >= end)
			return false;
		nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * look_interval) }, NULL);
	}
}
