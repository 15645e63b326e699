#include "cli/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>

#include "cli/quantity.h"
#include "shape/shape.h"

// Prints one line: an item and its description.
__attribute__((format(printf, 3, 4))) static void line(FILE *f, const char *thing, const char *format, ...)
{
	va_list list;
	va_start(list, format);
	fprintf(f, "    %-12s ", thing);
	vfprintf(f, format, list);
	fputc('\n', f);
	va_end(list);
}

// Traits of the scene's objects that a part of the step would have to model.
typedef struct traits {
	uint32_t bodies, round, rough, elastic, forced, varying;
} traits;

static traits traits_of(const ob_scene *s)
{
	traits t = { 0 };
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_passport *p = &s->object[i].passport;
		bool moves = !(p->flags & OB_OBJECT_PRESCRIBED);
		t.bodies += moves;
		t.round += moves && ob_shape_is(p->shape, OB_ISOTROPIC);
		t.forced += moves && ob_norm2(p->force) > 0;
		t.varying += s->object[i].force != NULL;
		t.rough += p->friction > 0;
		t.elastic += p->restitution > 0;
	}
	return t;
}

static void explain_motion(const ob_explained *x, const traits *t, FILE *f)
{
	const ob_counters *c = &x->counters;
	uint64_t awake = c->ballistic_advances + c->body_steps;
	double asleep = x->body_steps - (double)awake;
	bool exact = x->settings->integrator == OB_INTEGRATOR_EXACT;
	if (c->ballistic_advances)
		line(f, "flight", "%s: %" PRIu64 " steps of objects that touched nothing",
		     exact ? "closed form, no substeps" : "ODE's stepper", c->ballistic_advances);
	else
		line(f, "flight", "none: no object was ever alone");
	if (c->body_steps)
		line(f, "substeps", "%.3g a step, for %" PRIu64 " steps of objects that touched, or might have",
		     (double)c->body_substeps / (double)c->body_steps, c->body_steps);
	else
		line(f, "substeps", "none: nothing came near anything");
	if (!x->settings->sleeping)
		line(f, "sleep", "none: it is switched off");
	else if (asleep > .5)
		line(f, "sleep", "%.0f steps of objects were not computed at all", asleep);
	else
		line(f, "sleep", "none: no island was ever at rest for long enough");
	if (c->gyroscopic_steps)
		line(f, "gyroscope",
		     "Euler's equations in %" PRIu64
		     " substeps of objects that turned while they touched or were joined",
		     c->gyroscopic_steps);
	else if (!exact)
		line(f, "gyroscope", "ODE's own");
	else
		line(f, "gyroscope", "none: %s",
		     t->round == t->bodies ? "all are spheres" : "nothing that touched or was joined turned");
	if (t->forced)
		line(f, "forces", "constant ones on %" PRIu32 " objects", t->forced);
	if (t->varying)
		line(f, "varying", "forces that change in time on %" PRIu32 " objects: energy is put in and taken out",
		     t->varying);
}

static void explain_contact(const ob_explained *x, const traits *t, FILE *f)
{
	const ob_counters *c = &x->counters;
	if (c->narrowphase_tests)
		line(f, "collision",
		     "%" PRIu64 " tests of pairs; %" PRIu64 " of them followed the pair through its substep",
		     c->narrowphase_tests, c->swept_tests);
	else
		line(f, "collision", "none: no two boxes came near each other");
	if (c->pair_solves)
		line(f, "contact", "%" PRIu64 " solves of pairs in %" PRIu64 " iterations; %" PRIu64 " direct solves",
		     c->pair_solves, c->solver_iterations, c->direct_solves);
	else
		line(f, "contact", "none: nothing touched");
	if (!t->rough)
		line(f, "friction", "none: no object has any");
	else if (c->pair_solves > c->frictionless_solves)
		line(f, "friction", "Coulomb's cone in %" PRIu64 " solves; %" PRIu64 " without rows for it",
		     c->pair_solves - c->frictionless_solves, c->frictionless_solves);
	else
		line(f, "friction", "none: no two rough objects touched");
	if (!t->elastic)
		line(f, "restitution", "none: no object has any; %" PRIu64 " plastic impacts at their own instants",
		     c->impacts);
	else
		line(f, "restitution", "%" PRIu64 " impacts at their own instants, in %" PRIu64 " iterations",
		     c->impacts, c->impact_iterations);
	line(f, "recovery", "%.3g J of potential energy, from pushing penetrations apart", c->recovered);
	if (x->settings->tolerance > 0)
		line(f, "tolerance", "%" PRIu64 " islands were solved, %" PRIu64 " solutions rejected as too coarse",
		     c->island_steps, c->islands_redone);
	else
		line(f, "tolerance", "none: every island takes %" PRIu32 " substeps", x->settings->substeps);
}

static void explain_rest(const ob_run_request *q, const ob_scene *scene, FILE *f)
{
	line(f, "renderer", q->frames.wanted ? "frames were asked for" : "none: no frames were asked for");
	line(f, "recorder", q->record ? "--record" : "none: nothing was to be recorded");
	line(f, "measuring",
	     q->asked.measure == OB_MEASURE_STEPS ? "energy, momentum and penetration of each step (--set measure=step)"
						  : "only of the start and the end (--set measure)");
	line(f, "Lua",
	     scene->scripts ? "objects' scripts, when they are due" : "none: it ended when the scene had been read");
	line(f, "one world", "none: each object is a simulator of its own");
}

static void print_costs(const ob_explained *x, FILE *f)
{
	static const char *const what[OB_PROFILE_SECTIONS] = {
		[OB_PROFILE_BROADPHASE] = "broad-phase queries",
		[OB_PROFILE_SCHEDULE] = "pairs, islands, and their workers",
		[OB_PROFILE_BALLISTIC] = "closed forms of flight",
		[OB_PROFILE_LOAD] = "islands out of the universe, and back",
		[OB_PROFILE_NARROWPHASE] = "collision tests",
		[OB_PROFILE_IMPACTS] = "impacts",
		[OB_PROFILE_SOLVE] = "iterations of the contact solver",
		[OB_PROFILE_MOVE] = "turning, predicting, displacing",
		[OB_PROFILE_PROJECT] = "penetrations pushed apart",
		[OB_PROFILE_PUBLISH] = "publication of motions",
		[OB_PROFILE_SCRIPTS] = "objects' scripts",
		[OB_PROFILE_ESTIMATE] = "steps solved again to estimate their errors",
		[OB_PROFILE_VERIFY] = "steps solved again to know their errors",
	};
	double rest = x->cpu_s;
	ob_quantity q;
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++) {
		double s = 1e-9 * (double)x->counters.time_ns[i];
		rest -= s;
		fprintf(f, "    %-11s %10s %5.1f %%  %s\n", ob_profile_name((uint32_t)i), ob_quantity_text(&q, s, "s"),
			100 * s / x->cpu_s, what[i]);
	}
	rest = fmax(0, rest);
	fprintf(f, "    %-11s %10s %5.1f %%  waiting for each other, and the cost of these clocks\n", "gate",
		ob_quantity_text(&q, rest, "s"), 100 * rest / x->cpu_s);
}

void ob_explain_print(const ob_explained *x, FILE *f)
{
	const traits t = traits_of(x->scene);
	ob_quantity q;
	fputs("  what was modelled, and what was not\n", f);
	explain_motion(x, &t, f);
	explain_contact(x, &t, f);
	explain_rest(x->request, x->scene, f);
	fprintf(f, "  what it cost: %s of CPU\n", ob_quantity_text(&q, x->cpu_s, "s"));
	print_costs(x, f);
}
