#include "cli/free_request.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cli/quantity.h"
#include "free/schedule.h"

static const double steps_of_lag = 2; // bound of the lag where the clock gives none, in steps of a simulator

static bool read_max_lag(ob_run_request *r, const char *text, ob_error *e)
{
	if (text && strcmp(text, "none") == 0)
		r->free.max_lag = INFINITY;
	else
		return ob_number_real("max-lag", text, 0, 1e3, &r->free.max_lag, e);
	return true;
}

// Refuses options that a replayed schedule has settled.
static bool check_replay(const ob_arguments *a, ob_error *e)
{
	static const ob_option_id settled[] = { OB_OPTION_UPDATE_RATE,    OB_OPTION_COUPLING, OB_OPTION_MAX_LAG,
						OB_OPTION_JITTER,         OB_OPTION_DELAY,    OB_OPTION_PACE,
						OB_OPTION_ISOLATION,      OB_OPTION_WORKERS,  OB_OPTION_FAULT,
						OB_OPTION_RECORD_SCHEDULE };
	for (size_t i = 0; a->value[OB_OPTION_REPLAY_SCHEDULE] && i < sizeof settled / sizeof *settled; i++)
		if (a->value[settled[i]])
			return ob_fail(
				e,
				"--%s does not go with --replay-schedule, which repeats a run as it was: leave it away",
				ob_option_table[settled[i]].name);
	return true;
}

bool ob_free_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	static const ob_option_id of_free[] = { OB_OPTION_UPDATE_RATE,    OB_OPTION_COUPLING, OB_OPTION_MAX_LAG,
						OB_OPTION_JITTER,         OB_OPTION_DELAY,    OB_OPTION_RECORD_SCHEDULE,
						OB_OPTION_REPLAY_SCHEDULE };
	// what a free run has not
	static const ob_option_id of_lockstep[] = {
		OB_OPTION_ARCH,    OB_OPTION_HARDEN, OB_OPTION_TOLERANCE,  OB_OPTION_STRICT, OB_OPTION_LAG,
		OB_OPTION_EXPLAIN, OB_OPTION_CHECK,  OB_OPTION_CHECKPOINT, OB_OPTION_RESUME, OB_OPTION_ON_DEATH,
	};
	const char *sync = a->value[OB_OPTION_SYNC], *coupling = a->value[OB_OPTION_COUPLING];
	r->free = (ob_free_settings){ .update_rate = NAN, .max_lag = NAN, .coupling = UINT32_MAX };
	r->sync_asked = sync != NULL;
	r->record_schedule = a->value[OB_OPTION_RECORD_SCHEDULE];
	r->replay_schedule = a->value[OB_OPTION_REPLAY_SCHEDULE];
	if (sync && strchr(sync, ','))
		return ob_fail(e, "--sync %s: a run has one of them; obsim compare runs both ways", sync);
	r->is_free = sync ? strcmp(sync, "free") == 0 : r->replay_schedule != NULL;
	r->free_command = a->command == OB_COMMAND_RUN || a->command == OB_COMMAND_SERVE;
	for (size_t i = 0; i < sizeof of_free / sizeof *of_free; i++)
		if (a->value[of_free[i]])
			r->of_free = ob_option_table[of_free[i]].name;
	for (size_t i = 0; i < sizeof of_lockstep / sizeof *of_lockstep; i++)
		if (a->value[of_lockstep[i]])
			r->of_lockstep = ob_option_table[of_lockstep[i]].name;
	if (a->value[OB_OPTION_SLEEPING] && strcmp(a->value[OB_OPTION_SLEEPING], "on") == 0)
		r->of_lockstep = "sleeping on";
	if (a->value[OB_OPTION_OVERLAY] && strstr(a->value[OB_OPTION_OVERLAY], "contacts"))
		r->of_lockstep = "overlay contacts";
	if (r->measure == OB_MEASURE_PROFILE)
		r->of_lockstep = "measure profile";
	if (coupling && !ob_setting_find(OB_COUPLING_NAMES, coupling, &r->free.coupling))
		return ob_fail(e, "--coupling %s: expected one of %s", coupling, OB_COUPLING_NAMES);
	return check_replay(a, e) &&
	       ob_number_real("update-rate", a->value[OB_OPTION_UPDATE_RATE], 0, OB_UPDATE_RATE_MOST,
			      &r->free.update_rate, e) &&
	       read_max_lag(r, a->value[OB_OPTION_MAX_LAG], e) &&
	       (!a->value[OB_OPTION_JITTER] || strcmp(a->value[OB_OPTION_JITTER], "0") == 0 ||
		ob_number_real("jitter", a->value[OB_OPTION_JITTER], 0, OB_JITTER_MOST, &r->free.jitter, e)) &&
	       (!a->value[OB_OPTION_DELAY] || strcmp(a->value[OB_OPTION_DELAY], "0") == 0 ||
		ob_number_real("delay", a->value[OB_OPTION_DELAY], 0, OB_DELAY_MOST, &r->free.delay, e));
}

static bool has_compounds(const ob_scene *s)
{
	uint32_t i = 0;
	while (i < s->hulls && !s->hull[i].parts)
		i++;
	return i < s->hulls;
}

// Refuses what a free run cannot have.
static bool check(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	if (!r->free_command)
		return ob_fail(
			e,
			"the scene runs free (scene.sync), which obsim run and serve can do: set sync = \"lockstep\"");
	if (r->of_lockstep)
		return ob_fail(e, "--%s does not go with --sync free: leave one of them away", r->of_lockstep);
	if (r->run.monolith || r->run.solver == OB_SOLVER_JACOBI)
		return ob_fail(e, "--sync free: expected object simulators with the solver coloured, ghost or lagged");
	if (s->scripts > 0)
		return ob_fail(e, "--sync free: the scene has scripts, which run in lockstep alone");
	if (s->joints > 0)
		return ob_fail(e, "--sync free: the scene has joints, which hold in lockstep alone");
	if (has_compounds(s))
		return ob_fail(e, "--sync free: the scene has compounds, which collide in lockstep alone");
	if (s->terrains)
		return ob_fail(e, "--sync free: the scene has heightfields or meshes, which collide in lockstep alone");
	if (r->free.coupling == OB_COUPLING_LEDGER &&
	    (r->run.solver != OB_SOLVER_COLOURED || r->run.integrator != OB_INTEGRATOR_EXACT))
		return ob_fail(e, "--coupling ledger: a pair has one impulse, so leave --solver and --integrator away");
	return true;
}

// Digest of all that decides a free run beside its settings and its schedule.
static uint64_t digest_of(const ob_run_request *r, const ob_scene *s)
{
	const ob_scene_options *o = &r->scene_options;
	ob_run_settings run = r->run;
	memset(&run.fault, 0, sizeof run.fault);
	run.timed = run.load = 0;
	uint64_t hash = ob_hash_on(OB_HASH_BEGIN, s->text, s->text_size);
	for (uint32_t i = 0; i < o->define_count; i++)
		hash = ob_hash_on(hash, o->defines[i], strlen(o->defines[i]) + 1);
	hash = ob_hash_on(hash, &s->seed, sizeof s->seed);
	hash = ob_hash_on(hash, &r->duration, sizeof r->duration);
	return ob_hash_on(hash, &run, sizeof run);
}

// Names the schedule's file in the settings, for workers of any process. Replay: takes the recorded settings.
static bool resolve_schedule(ob_run_request *r, ob_error *e)
{
	ob_free_settings *f = &r->free;
	const char *path = r->replay_schedule ? r->replay_schedule : r->record_schedule;
	if (!path)
		return true;
	if (r->replay_schedule) {
		if (!ob_free_schedule_check(path, r->schedule_digest, f, e))
			return false;
		f->replays = 1;
		r->workers = 1;
		r->isolation = OB_ISOLATION_THREAD;
	}
	char *here = *path == '/' ? NULL : realpath(".", NULL);
	const int n = snprintf(f->schedule, sizeof f->schedule, "%s%s%s", here ? here : "", here ? "/" : "", path);
	free(here);
	return (n > 0 && (size_t)n < sizeof f->schedule) || ob_fail(e, "%s: the path is too long for a schedule", path);
}

bool ob_free_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	ob_free_settings *f = &r->free;
	r->is_free |= !r->sync_asked && s->free.update_rate != 0;
	if (!r->is_free)
		return !r->of_free || ob_fail(e, "--%s is for --sync free", r->of_free);
	r->schedule_digest = digest_of(r, s);
	if (!resolve_schedule(r, e))
		return false;
	if (isnan(f->update_rate))
		f->update_rate = s->free.update_rate > 0 ? s->free.update_rate : 1 / r->run.step_length;
	f->rate_most = f->update_rate;
	for (uint32_t i = 0; i < s->objects; i++)
		f->rate_most = fmax(f->rate_most, s->object[i].update_rate);
	if (f->coupling == UINT32_MAX)
		f->coupling = s->free.coupling;
	if (isnan(f->max_lag) && s->free.max_lag > 0)
		f->max_lag = s->free.max_lag;
	if (isnan(f->max_lag))
		f->max_lag = isinf(r->pace) ? steps_of_lag / f->update_rate : INFINITY;
	f->pace = f->replays ? f->pace : r->pace;
	f->end = r->duration;
	f->seed = r->scene_options.has_seed ? r->scene_options.seed : s->seed;
	if (!check(r, s, e))
		return false;
	f->heavy = r->run.solver == OB_SOLVER_GHOST;
	// as many substeps a second as the default has, and one a step at least
	r->run.tolerance = 0;
	r->run.sleeping = 0;
	if (!ob_setting_is_set(&r->asked, OB_SETTING_SUBSTEPS)) {
		const double n = rint(OB_DEFAULT_SUBSTEPS / (OB_DEFAULT_STEP * f->update_rate));
		r->run.substeps = n > 1 ? (uint32_t)n : 1;
	}
	return true;
}
