// The host: makes the universe, starts the workers as threads or processes, lets them run to a step, watches
// over them, and ends them. spawn_thread.c and spawn_process.c are the only files that know which it is.
#ifndef OB_HOST_HOST_H
#define OB_HOST_HOST_H

#include "scene/scene.h"
#include "table/table.h"

typedef enum ob_isolation { OB_ISOLATION_THREAD, OB_ISOLATION_PROCESS } ob_isolation;

typedef struct ob_host_config {
	const char *name;         // of the universe; NULL = obsim-<pid>
	ob_isolation isolation;
	uint32_t workers;         // 0 = one per object
	ob_run_settings run;      // one_per_object is set by the host from workers
} ob_host_config;

typedef struct ob_host_times {
	double startup_s;         // from the call to start until every worker stood at the gate
	double wall_s, cpu_s;     // stepping only: wall between go and pause; CPU of the workers in that time
	double step_p50_s, step_p99_s; // wall per step
	size_t memory_bytes;      // PSS of the workers' own memory + the table
} ob_host_times;

typedef struct ob_host ob_host;

ob_host *ob_host_start(const ob_scene *scene, const ob_host_config *config, ob_error *e);
// Lets the universe run until "step" steps are complete (returns at once) / waits until it stands there.
// wait: false and e when a simulator died, the run diverged, or SIGINT/SIGTERM came (ob_host_interrupted).
void ob_host_go(ob_host *h, uint64_t step);
bool ob_host_wait(ob_host *h, ob_error *e);
bool ob_host_interrupted(const ob_host *h);
const ob_universe *ob_host_universe(const ob_host *h);
void ob_host_get_times(ob_host *h, ob_host_times *out);
// Requests, carried out at the next step boundary. id comes back through the roster. Any thread.
bool ob_host_request_add(ob_host *h, const ob_object_def *def);
bool ob_host_request_remove(ob_host *h, uint32_t id);
// Ends all workers and removes the universe. Always succeeds; NULL is allowed.
void ob_host_stop(ob_host *h);

#endif
