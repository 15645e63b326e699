// The host: creates the universe, starts the workers as threads or processes, lets them run to a step, supervises
// them, and ends them. spawn_thread.c and spawn_process.c are the only files that know which it is.
//
//   ob_host_start   universe, fork server, objects of t = 0, workers; all stand at the gate
//   ob_host_go      the gate opens; the workers run on by themselves until the requested step
//   ob_host_wait    the caller sleeps until they stand there; objects are added and removed on the way, by timetable or
//                   on request, in pauses that the caller does not see
//   ob_host_stop    all workers leave; the universe is removed
//
// One per object: worker i runs object i. An empty slot has its (sleeping) worker, too, so that an object can be added
// in it.
//
// Thread-safety: start, go, wait, get_times and stop are one thread's; the rest may be called by any thread.
// start forks: call it before other threads take locks that a child could need (EGL, above all).
#ifndef OB_HOST_HOST_H
#define OB_HOST_HOST_H

#include "host/worker.h"
#include "host/population.h"
#include "host/request_table.h"
#include "host/script_log.h"
#include "host/timeline.h"
#include "ranks/ranks.h"
#include "scene/scene.h"
#include "settings/settings.h"
#include "table/saved.h"

// Saved run at a step boundary: all that it needs to go on, beside its scene and its settings. The arrays belong to
// their creator.
typedef struct ob_saved_host {
	ob_saved_universe universe;
	ob_saved_population population;
	ob_counters counters; // of all workers together
} ob_saved_host;

// INSIDE: the thread that waits for the run is its only worker; the host starts no thread and no process, leaves signals to
// the program, and is not reached by others than its caller.
typedef enum ob_isolation { OB_ISOLATION_THREAD, OB_ISOLATION_PROCESS, OB_ISOLATION_INSIDE } ob_isolation;

// Limit of deaths within some seconds; more end the run (OTP's restart intensity). deaths 0: only deaths that prevent
// progress do (restart.h).
typedef struct ob_restart_limit {
	uint32_t deaths;
	double seconds; // wall
} ob_restart_limit;
enum { OB_RESTART_LIMIT_MAX = 10000, OB_DEATHS_KEPT = 16, OB_SCRIPT_ERRORS_KEPT = 16 };

typedef struct ob_host_config {
	const char *name; // of the universe; NULL = obsim-<pid>
	ob_isolation isolation;
	uint32_t workers; // 0 = one per object; a monolith has one in any case
	ob_ranks ranks; // of one universe, each with as many workers, in processes; ranks 0 or 1: one
	bool shares_contacts; // with several ranks: each has the state of all contacts after each step
	uint32_t spare; // slots for objects added on request; a pool has 64 at least
	double patience; // s without a completed step after which the run counts as stalled (stall.h); 0 = 60
	bool saved; // after Ctrl-C the step is ended in any case, as the run is to be saved (ob_host_save)
	uint32_t harden; // measures that confine processes (confine.h): bits, 1 << ob_harden_measure; 0 = none
	ob_on_death on_death; // policy for deaths of simulators; a monolith's end ends the run in any case
	ob_restart_limit limit;
	uint32_t budget; // ob_run_settings.budget; 0: as of any run
	bool check; // checks the state that simulators share after each step (step/invariants.h)
	const char *trace; // file for the timeline of workers and host (timeline.h); NULL = none
	ob_run_settings run; // one_per_object is set by the host from workers
	const ob_free_settings
		*free; // settings of a free run (free/free.h); NULL: in lockstep. `objects` is set by the host
	double free_window; // s that its simulators may be ahead of the common time; 0: as far as memory reaches
	ob_request_log *log; // input from outside; NULL = none. It must outlive the host
	bool returns; // visitors may put the run back (ob_host_operate)
	bool wishes; // the leader takes wishes of visitors (ob_host_take_wish)
	const char *fixed; // why it does not start the scene anew; NULL: it does
	const char *checkpoint; // path of the run's checkpoint; NULL = none. Both must outlive the host
	struct ob_pace
		*pace; // visitors may lead the run's time by it (pace.h); NULL = they may not. It must outlive the host
	struct ob_control *control; // takes programs that control the run (control.h); NULL = refuses them. Likewise
	const ob_logged_requests *replay; // requests to carry out again, each in its place; NULL = none
	const ob_saved_host *from; // start of the run, checked (ob_saved_universe_check); NULL = the scene's start
} ob_host_config;

typedef struct ob_host_times {
	double startup_s; // from the call to start until every worker stood at the gate
	double wall_s; // stepping only: between go and pause
	double cpu_s; // CPU of the workers in that time; of processes as of the kernel's last tick, some ms ago
	double step_p50_s, step_p90_s, step_p99_s, step_max_s; // wall per step, pauses left out, to 1 %
	double critical_s; // if timed: critical path of all steps: the longest worker in each phase, and scheduling (CPU)
	double alone_s; // of that, scheduling
	double simulated_s; // likewise, of OB_SIMULATED_WORKERS workers (step/profile.h); NaN: unmeasured
	double elapsed_s; // from the first go that stepped to the last pause, pauses included
	uint32_t deaths; // times that simulators died, stalled, or failed
	uint32_t frozen; // objects that stay in place because of that
	double gate_s; // if timed: all workers' waiting at the gate in that time, pauses included (wall)
	double host_cpu_s; // CPU of the host's process since then, without its workers: renderer, recorder, measures
	uint64_t switches; // context switches of workers since then
	size_t memory_bytes; // PSS of host, fork server and workers, and the table's touched pages once
	size_t worker_memory_bytes; // of that, the workers' own: 0 where they are threads
} ob_host_times;

typedef struct ob_host ob_host;

// The scene must outlive the host.
ob_host *ob_host_start(const ob_scene *scene, const ob_host_config *config, ob_error *e);
// Lets the universe run until "step" steps are complete (returns at once) / waits until it stands there. The first go
// may be to step 0: the first broad phase runs, and nothing moves. A process that dies or stalls does not end the run,
// unless the policy says so. All simulators are restarted from the last checkpoint, unseen by the caller, and come to
// the same bits (restart.h lists exceptions). Where failing objects are frozen, the run goes on with them as they were
// when the last step was complete. wait: false and e when a simulator died and could not be restarted, the run
// diverged, or SIGINT/SIGTERM came (ob_host_interrupted).
void ob_host_go(ob_host *h, uint64_t step);
bool ob_host_wait(ob_host *h, ob_error *e);
// Sets the pace of a free run (simulated s a second; 0: it stands at this step) from the steps that are complete on.
// Between a wait and the next go.
void ob_host_set_pace(ob_host *h, double pace, uint64_t stands);
// States to readers that no step will follow (OB_UNIVERSE_FINISHED). Workers stay, and requests are still taken by go.
// Call it after a wait; again has no effect.
void ob_host_finish(ob_host *h);
// Requests the state of all contacts at this step, as a save there needs it. Call it between a wait and the next go, on
// each of several ranks alike, for one step at a time.
void ob_host_want_contacts(ob_host *h, uint64_t step);
bool ob_host_interrupted(const ob_host *h);
// True if the run ended because the simulators' shared state breaks an invariant. After a wait.
bool ob_host_broke_invariant(const ob_host *h);
const ob_universe *ob_host_universe(const ob_host *h);
const ob_roster *ob_host_roster(const ob_host *h);
void ob_host_get_times(ob_host *h, ob_host_times *out);
// Copies the last deaths, oldest first, OB_DEATHS_KEPT of them at most; returns their number.
uint32_t ob_host_get_deaths(ob_host *h, ob_death out[OB_DEATHS_KEPT]);
// Copies the first errors that have stopped scripts, OB_SCRIPT_ERRORS_KEPT of them at most; returns their number. Paused.
uint32_t ob_host_get_script_errors(ob_host *h, ob_script_error out[OB_SCRIPT_ERRORS_KEPT]);
// Requests that change objects, of the program itself, carried out at the next step boundary. The id of an added object appears
// in the roster. Any thread. false: no memory, or an invalid definition to add, explained by e. remove: nothing happens if another
// generation has the id by then.
bool ob_host_request(ob_host *h, const ob_request *r, ob_error *e);
bool ob_host_request_remove(ob_host *h, uint32_t id, uint32_t generation);
// Requests of visitors and other programs, of any kind: checks the request against the universe as it is now, completes
// it, and carries it out or queues it, whatever the role. Any thread.
bool ob_host_ask(ob_host *h, ob_request *r, ob_error *e);
// The same for a visitor, whose number is the request's origin: checks its role first. Those who take part remove what they
// have created, and steer no avatar but their own. Any thread.
bool ob_host_ask_as(ob_host *h, ob_role role, ob_request *r, ob_error *e);
// Carries out requests to keep a snapshot and to go back to one. Between a wait and the next go; returns true if the
// universe was put back, to an earlier or later step. The first call keeps the start, where go begins.
bool ob_host_operate(ob_host *h);
// Takes the oldest wish of a visitor, which the leader is to carry out: OB_REQUEST_SET, _SEED or _SAVE. false: there is none.
// Between a wait and the next go.
bool ob_host_take_wish(ob_host *h, ob_request *out);
// With a trace: records an activity of the calling thread, the one that starts and stops the host, since begin
// (ob_clock_ns).
void ob_host_trace(ob_host *h, ob_trace_kind kind, uint64_t begin, uint32_t number);
// Ends the trace's file; stop does so, too. false and e if it is not whole. Without a trace: true, and no events.
bool ob_host_end_trace(ob_host *h, ob_timeline_sums *sums, ob_error *e);
// Saves the run as it stands: first the lengths of the arrays, then the arrays. Between a wait and the next go. false:
// it does not stand at a step boundary, or it is a monolith, whose state ODE does not expose in full.
bool ob_host_count_saved(ob_host *h, ob_saved_host *out);
void ob_host_save(ob_host *h, ob_saved_host *out);
// Ends all workers and removes the universe. Always succeeds; NULL is allowed.
void ob_host_stop(ob_host *h);

#endif
