#include "host/worker.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/cpu.h"
#include "base/log.h"
#include "ode/ode_body.h"
#include "sim/sim.h"

int ob_worker_live(ob_universe *u, uint32_t worker)
{
	ob_error e;
	int cpu = ob_cpu_pin(worker); // more workers than cores: in turn
	ob_ode_init();
	ob_ode_thread_init();
	ob_sim *s = ob_sim_create(u, worker, &e);
	if (!s) {
		ob_log_warn("worker %u: %s", worker, e.text);
		ob_ode_thread_finish();
		return EXIT_FAILURE;
	}
	ob_worker_announce(u, worker, getpid(), gettid(), cpu); // from here on it is ready for the gate
	ob_sim_run(s);
	ob_sim_destroy(s);
	ob_ode_thread_finish();
	return EXIT_SUCCESS;
}
