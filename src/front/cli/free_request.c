// Options of a free run (obsim run --sync free).
#include "cli/request.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cli/quantity.h"
#include "free/schedule.h"

static const double steps_of_lag = 2; // bound of the lag where the clock gives none, in steps of a simulator

// Settings that a run in lockstep has not.
static const uint64_t of_free = OB_BIT(OB_SETTING_UPDATE_RATE) | OB_BIT(OB_SETTING_COUPLING) |
				OB_BIT(OB_SETTING_MAX_LAG) | OB_BIT(OB_SETTING_JITTER) | OB_BIT(OB_SETTING_DELAY) |
				OB_BIT(OB_SETTING_RECORD_SCHEDULE);

bool ob_free_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	const uint64_t settled = OB_BIT(OB_OPTION_PACE) | OB_BIT(OB_OPTION_ISOLATION) | OB_BIT(OB_OPTION_WORKERS) |
				 OB_BIT(OB_OPTION_FAULT);
	// what a free run has not
	const uint64_t settings =
		OB_BIT(OB_SETTING_ARCHITECTURE) | OB_BIT(OB_SETTING_TOLERANCE) | OB_BIT(OB_SETTING_LAG);
	const uint64_t options = OB_BIT(OB_OPTION_HARDEN) | OB_BIT(OB_OPTION_STRICT) | OB_BIT(OB_OPTION_EXPLAIN) |
				 OB_BIT(OB_OPTION_CHECK) | OB_BIT(OB_OPTION_CHECKPOINT) | OB_BIT(OB_OPTION_RESUME) |
				 OB_BIT(OB_OPTION_ON_DEATH);
	const char *value = NULL;
	r->free_command = a->command == OB_COMMAND_RUN || a->command == OB_COMMAND_SERVE;
	r->of_free = ob_options_given(a, 0, of_free | OB_BIT(OB_SETTING_REPLAY_SCHEDULE));
	r->of_lockstep = ob_options_given(a, options, settings);
	if (a->value[OB_OPTION_OVERLAY] && strstr(a->value[OB_OPTION_OVERLAY], "contacts"))
		value = "overlay contacts";
	if (ob_setting_is_set(&r->asked, OB_SETTING_SLEEPING) && r->asked.run.sleeping)
		value = "set sleeping=on";
	if (r->asked.measure == OB_MEASURE_PROFILE)
		value = "set measure=profile";
	if (value)
		snprintf(r->of_lockstep.text, sizeof r->of_lockstep.text, "%s", value);
	return !r->asked.replay_schedule ||
	       ob_options_refuse(
		       a, settled, of_free,
		       " does not go with --set replay_schedule, which repeats a run as it was: leave it away", e);
}

static bool has_compounds(const ob_scene *s)
{
	uint32_t i = 0;
	while (i < s->hulls && !s->hull[i].parts)
		i++;
	return i < s->hulls;
}

// The same of one that is solved in groups, by lockstep's step.
static bool check_groups(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	const char *const given = r->asked.record_schedule || r->asked.replay_schedule ? "record_schedule"
				  : r->free.jitter > 0                                 ? "jitter"
				  : r->free.delay > 0                                  ? "delay"
										       : NULL;
	if (given)
		return ob_fail(e, "--set %s does not go with coupling=group: leave one of them away", given);
	if (r->free.rate_most != r->free.update_rate || r->free.update_rate != 1 / r->run.step_length)
		return ob_fail(e, "--set coupling=group: all bodies have the rate of --step: leave update_rate away");
	return true;
}

// Refuses what a free run cannot have.
static bool check(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	if (!r->free_command)
		return ob_fail(
			e,
			"the scene runs free (scene.sync), which obsim run and serve can do: set sync = \"lockstep\"");
	if (*r->of_lockstep.text)
		return ob_fail(e, "--%s does not go with --sync free: leave one of them away", r->of_lockstep.text);
	if (r->run.monolith || r->run.solver == OB_SOLVER_JACOBI)
		return ob_fail(e, "--sync free: expected object simulators with the solver coloured, ghost or lagged");
	if (s->scripts > 0)
		return ob_fail(e, "--sync free: the scene has scripts, which run in lockstep alone");
	if (s->joints > 0)
		return ob_fail(e, "--sync free: the scene has joints, which hold in lockstep alone");
	if (r->free.coupling == OB_COUPLING_GROUP)
		return check_groups(r, s, e);
	if (has_compounds(s))
		return ob_fail(e, "--sync free: the scene has compounds, which collide in lockstep alone");
	if (s->terrains)
		return ob_fail(e, "--sync free: the scene has heightfields or meshes, which collide in lockstep alone");
	if (r->free.coupling == OB_COUPLING_LEDGER &&
	    (r->run.solver != OB_SOLVER_COLOURED || r->run.integrator != OB_INTEGRATOR_EXACT))
		return ob_fail(
			e, "--set coupling=ledger: a pair has one impulse, so leave the settings solver and integrator "
			   "away");
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
	const ob_settings *asked = &r->asked;
	const char *path = asked->replay_schedule ? asked->replay_schedule : asked->record_schedule;
	if (!path)
		return true;
	if (asked->replay_schedule) {
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
	ob_settings all = s->asked;
	ob_settings_overlay(&all, &r->asked);
	r->is_free = ob_setting_is_set(&r->asked, OB_SETTING_SYNC) ? r->asked.sync : all.sync || all.replay_schedule;
	if (!r->is_free)
		return !*r->of_free.text || ob_fail(e, "--%s is for --sync free", r->of_free.text);
	r->schedule_digest = digest_of(r, s);
	*f = all.free;
	const bool replays = all.replay_schedule;
	if (!resolve_schedule(r, e))
		return false;
	if (!replays && !ob_setting_is_set(&all, OB_SETTING_UPDATE_RATE))
		f->update_rate = 1 / r->run.step_length;
	f->rate_most = f->update_rate;
	for (uint32_t i = 0; i < s->objects; i++)
		f->rate_most = fmax(f->rate_most, s->object[i].update_rate);
	if (!replays && !ob_setting_is_set(&all, OB_SETTING_MAX_LAG))
		f->max_lag = isinf(r->pace) ? steps_of_lag / f->update_rate : INFINITY;
	f->pace = f->replays ? f->pace : r->pace;
	f->end = r->duration;
	f->seed = r->scene_options.has_seed ? r->scene_options.seed : s->seed;
	if (!check(r, s, e))
		return false;
	if (f->coupling == OB_COUPLING_GROUP)
		return true;
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
