#include "cli/observe.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/log.h"
#include "cli/quantity.h"

static bool all_stay(const ob_scene *s)
{
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].born > 0 || isfinite(s->object[i].dies))
			return false;
	}
	return true;
}

static bool forces_vary(const ob_scene *s)
{
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].force)
			return true;
	}
	return false;
}

static bool is_closed(const ob_scene *s)
{
	if (ob_norm2(s->run.gravity) > 0 || !all_stay(s) || forces_vary(s))
		return false;
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].passport.flags & OB_OBJECT_PRESCRIBED || ob_norm2(s->object[i].passport.force) > 0)
			return false;
	}
	return true;
}

bool ob_observer_open(ob_observer *o, const ob_scene *scene, const char *path, ob_error *e)
{
	*o = (ob_observer){
		.gravity = scene->run.gravity,
		.closed = is_closed(scene),
		.energy_stays = all_stay(scene) && !forces_vary(scene),
		.momentum_error = NAN,
	};
	if (!path)
		return true;
	o->series_path = path;
	o->series = fopen(path, "we");
	if (!o->series)
		return ob_fail(e, "--series %s: %s", path, strerror(errno));
	fputs("step,time_s,energy_j,momentum_x,momentum_y,momentum_z,penetration_max_m,penetration_mean_m,touching_"
	      "pairs,"
	      "asleep\n",
	      o->series);
	return true;
}

void ob_observer_save(const ob_observer *o, ob_saved_figures *out)
{
	*out = (ob_saved_figures){
		.started = o->started,
		.energy_start = o->energy_start,
		.energy_top = o->energy_top,
		.momentum_start = o->momentum_start,
		.momentum_scale = o->momentum_scale,
		.momentum_error = o->momentum_error,
		.worst = o->worst,
		.worst_time = o->worst_time,
	};
}

void ob_observer_resume(ob_observer *o, const ob_saved_figures *from)
{
	o->started = from->started;
	o->last_step = UINT64_MAX;
	o->energy_start = from->energy_start;
	o->energy_top = from->energy_top;
	o->momentum_start = from->momentum_start;
	o->momentum_scale = from->momentum_scale;
	o->momentum_error = from->momentum_error;
	o->now.max_m = o->now.mean_m = isnan(from->worst) ? NAN : 0;
	o->worst = from->worst;
	o->worst_time = from->worst_time;
}

static bool moves(const ob_snapshot *s, uint32_t i)
{
	return (s->passport[i].flags & OB_OBJECT_PRESENT) && !(s->passport[i].flags & OB_OBJECT_PRESCRIBED);
}

static void write_line(const ob_observer *o, const ob_snapshot *s, ob_vec3 momentum)
{
	uint32_t asleep = 0;
	for (uint32_t i = 0; i < s->count; i++)
		asleep += moves(s, i) && (s->motion[i].flags & OB_MOTION_ASLEEP);
	fprintf(o->series, "%" PRIu64 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.9g,%.9g,%zu,%" PRIu32 "\n", s->step, s->time,
		o->energy, momentum.x, momentum.y, momentum.z, o->now.max_m, o->now.mean_m, o->now.pairs, asleep);
}

static void start(ob_observer *o, const ob_snapshot *s, ob_vec3 momentum)
{
	o->started = true;
	o->energy_start = o->energy_top = o->energy;
	o->momentum_start = momentum;
	for (uint32_t i = 0; i < s->count; i++) {
		if (moves(s, i))
			o->momentum_scale += s->passport[i].mass * ob_norm(s->motion[i].v);
	}
}

static bool is_interrupted(void *host)
{
	return ob_host_interrupted(host);
}

// Measures penetration. If that is too much work, the run goes on without: the worst is unknown from then on, also
// after a resume.
static bool measure_penetration(ob_observer *o, const ob_snapshot *s, const ob_host *host, ob_error *e)
{
	ob_error why;
	if (isnan(o->worst) || ob_measure_penetration_unless(s, &o->now, is_interrupted, (void *)host, &why))
		return true;
	if (ob_host_interrupted(host))
		return ob_fail(e, "%s", why.text);
	ob_log_warn("penetration is not measured from here on: %s", why.text);
	o->worst = o->worst_time = NAN;
	return true;
}

// Warns of the two objects that begin deepest inside each other, if by more than what contacts explain.
static void warn_of_overlap(const ob_penetration *now, const ob_snapshot *s, const ob_host *host)
{
	static const double much = 10; // tolerances
	const double tolerance = ob_universe_settings(ob_host_universe(host))->tolerance;
	ob_quantity depth;
	if (now->max_m > much * (tolerance > 0 ? tolerance : OB_DEFAULT_TOLERANCE))
		ob_log_warn("\"%s\" (object %" PRIu32 ") and \"%s\" (object %" PRIu32
			    ") begin %s inside each other: move them apart",
			    s->passport[now->worst_a].name, now->worst_a, s->passport[now->worst_b].name, now->worst_b,
			    ob_quantity_text(&depth, now->max_m, "m"));
}

void ob_warn_of_overlap(ob_host *h)
{
	ob_snapshot s = { 0 };
	ob_penetration now;
	if (ob_snapshot_take(&s, ob_host_universe(h), 0, NULL) &&
	    ob_measure_penetration_unless(&s, &now, is_interrupted, h, NULL))
		warn_of_overlap(&now, &s, h);
	ob_snapshot_finish(&s);
}

bool ob_observer_measure(ob_observer *o, const ob_snapshot *s, const ob_host *host, ob_error *e)
{
	if (o->started && s->step == o->last_step)
		return true;
	o->energy = ob_measure_energy(s, o->gravity);
	ob_vec3 momentum = ob_measure_momentum(s);
	const bool begins = !o->started;
	if (begins)
		start(o, s, momentum);
	o->last_step = s->step;
	o->energy_top = fmax(o->energy_top, o->energy);
	if (o->closed && o->momentum_scale > 0)
		o->momentum_error =
			fmax(o->momentum_error, ob_norm(ob_sub(momentum, o->momentum_start)) / o->momentum_scale);
	if (!measure_penetration(o, s, host, e))
		return false;
	if (begins)
		warn_of_overlap(&o->now, s, host);
	if (o->now.max_m > o->worst) {
		o->worst = o->now.max_m;
		o->worst_time = s->time;
	}
	if (o->series)
		write_line(o, s, momentum);
	return true;
}

void ob_observer_report(const ob_observer *o, bool each_step, ob_report *r)
{
	// where the scene counts its energy from 0, the gain is in joules
	double scale = o->energy_start != 0 ? fabs(o->energy_start) : 1;
	r->energy_start = o->energy_start;
	r->energy_end = o->energy;
	r->energy_gain_max = each_step && o->energy_stays ? (o->energy_top - o->energy_start) / scale : NAN;
	r->momentum_error = each_step ? o->momentum_error : NAN;
	r->penetration_max_m = o->now.max_m;
	r->penetration_mean_m = o->now.mean_m;
	r->worst_penetration_m = each_step ? o->worst : NAN;
	r->worst_penetration_time_s = each_step ? o->worst_time : NAN;
}

bool ob_observer_close(ob_observer *o, ob_error *e)
{
	if (!o->series)
		return true;
	bool broken = ferror(o->series);
	broken |= fclose(o->series) != 0;
	o->series = NULL;
	return broken ? ob_fail(e, "--series %s: %s", o->series_path, strerror(errno)) : true;
}
