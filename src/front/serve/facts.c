#include "serve/facts.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "measure/measure.h"
#include "motion/flight.h"
#include "table/free.h"
#include "table/table.h"

static void put_numbers(ob_message *m, const char *name, const double *v, int n)
{
	ob_message_print(m, ",\"%s\":[", name);
	for (int i = 0; i < n; i++)
		ob_message_print(m, isfinite(v[i]) ? "%s%.9g" : "%snull", i ? "," : "", v[i]);
	ob_message_print(m, "]");
}

static void put_number(ob_message *m, const char *name, double x)
{
	ob_message_print(m, isfinite(x) ? ",\"%s\":%.9g" : ",\"%s\":null", name, x);
}

static void put_text(ob_message *m, const char *name, const char *text)
{
	ob_message_print(m, ",\"%s\":", name);
	ob_message_put_json(m, text);
}

static void put_vec3(ob_message *m, const char *name, ob_vec3 v)
{
	put_numbers(m, name, (double[]){ v.x, v.y, v.z }, 3);
}

static void put_colour(ob_message *m, const char *name, const float c[3])
{
	put_numbers(m, name, (double[]){ c[0], c[1], c[2] }, 3);
}

// Parameters and controls for viewers, and the name of the template of avatars; "" if there is none.
static void put_offers(ob_message *m, const ob_scene *s)
{
	ob_message_print(m, ",\"params\":[");
	for (uint32_t i = 0; i < s->params; i++) {
		const ob_param_def *p = &s->param[i];
		ob_message_print(m, "%s{\"name\":", i ? "," : "");
		ob_message_put_json(m, p->name);
		put_text(m, "label", p->label);
		put_text(m, "unit", p->unit);
		ob_message_print(m, ",\"value\":%.10g,\"min\":%.10g,\"max\":%.10g,\"whole\":%s}", p->value, p->min,
				 p->max, p->whole ? "true" : "false");
	}
	ob_message_print(m, "],\"controls\":[");
	for (uint32_t i = 0; i < s->controls; i++) {
		const ob_control_def *c = &s->control[i];
		ob_message_print(m, "%s{\"key\":", i ? "," : "");
		ob_message_put_json(m, c->key);
		if (c->gamepad < OB_CONTROL_BUTTONS)
			ob_message_print(m, ",\"gamepad\":%u", c->gamepad);
		put_text(m, "label", c->label);
		put_text(m, "sends", c->sends);
		put_text(m, "to", c->to);
		put_numbers(m, "values", c->value, c->slider ? 1 : (int)c->values);
		if (c->slider)
			put_numbers(m, "range", (double[]){ c->min, c->max }, 2);
		ob_message_print(m, "}");
	}
	ob_message_print(m, "],\"seed\":%llu,\"avatar\":", (unsigned long long)s->seed);
	ob_message_put_json(m, s->avatar ? s->avatar->passport.name : "");
}

// Cameras on objects, whose pictures the page fetches.
static void put_pictures(ob_message *m, const ob_scene *scene)
{
	bool first = true;
	ob_message_print(m, ",\"pictures\":[");
	for (uint32_t i = 0; i < scene->sensors; i++) {
		if (scene->sensor[i].kind != OB_SENSOR_CAMERA)
			continue;
		ob_message_print(m, "%s{\"sensor\":%u,\"name\":", first ? "" : ",", i);
		ob_message_put_json(m, scene->sensor[i].name);
		ob_message_print(m, "}");
		first = false;
	}
	ob_message_print(m, "]");
}

ob_message *ob_facts_picture(const ob_universe *u, uint32_t sensor)
{
	enum { HEAD = 54, ACROSS = 320, BITS = 24, INFO = 40 };
	ob_sensor_passport p;
	uint64_t number;
	double time;
	if (!ob_universe_get_sensor(u, sensor, &p) || p.kind != OB_SENSOR_CAMERA)
		return NULL;
	double *value = malloc(p.width * sizeof *value);
	ob_message *m =
		value && ob_universe_get_samples(u, sensor, 0, &number, &time, value, 1) ? ob_message_new(false) : NULL;
	const ob_pixel *pixel = ob_picture_of(value);
	const uint32_t most = p.beams > p.rows ? p.beams : p.rows, each = (most + ACROSS - 1) / ACROSS;
	const uint32_t width = p.beams / each ? p.beams / each : 1, height = p.rows / each ? p.rows / each : 1,
		       row = (3 * width + 3) / 4 * 4;
	const uint32_t head[] = { HEAD + row * height, 0, HEAD, INFO, width, -height, 1 | BITS << 16, 0,
				  row * height,        0, 0,    0,    0 };
	if (m) {
		ob_message_put(m, "BM", 2);
		ob_message_put(m, head, sizeof head);
	}
	for (uint32_t y = 0; m && y < height; y++) {
		for (uint32_t x = 0; x < width; x++) {
			const uint8_t *c = pixel[(size_t)y * each * p.beams + (size_t)x * each].rgba;
			ob_message_put(m, (uint8_t[]){ c[2], c[1], c[0] }, 3);
		}
		ob_message_put(m, (uint8_t[3]){ 0 }, row - 3 * width);
	}
	free(value);
	return m;
}

ob_message *ob_facts_welcome(const ob_server_config *c, ob_role role, const ob_universe_info *info, bool free_run,
			     const ob_content *mesh)
{
	const ob_scene *scene = c->scene;
	const ob_look_def *look = &scene->look;
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_print(m, "{\"welcome\":{\"protocol\":1,\"title\":");
	ob_message_put_json(m, scene->title);
	put_text(m, "universe", info->name);
	put_text(m, "version", c->version);
	put_text(m, "isolation", info->isolation);
	put_text(m, "arch", info->arch);
	put_text(m, "sync", free_run ? "free" : "lockstep");
	ob_message_print(m, ",\"tour\":%s,\"fixed\":%s,\"saves\":%s", scene->tour ? "true" : "false",
			 c->fixed ? "true" : "false", c->saves ? "true" : "false");
	ob_message_print(m, ",\"workers\":%u,\"role\":\"%s\",\"look_only\":%s,\"step_length\":%.17g", info->workers,
			 ob_role_name(role), role == OB_ROLE_WATCH ? "true" : "false", info->step_length);
	put_vec3(m, "gravity", info->gravity);
	put_colour(m, "sky_top", look->sky_top);
	put_colour(m, "sky_horizon", look->sky_horizon);
	put_colour(m, "ground", look->ground_colour);
	put_vec3(m, "sun", look->sun);
	ob_message_print(m, ",\"grid\":%s,\"cameras\":[", look->grid ? "true" : "false");
	for (uint32_t i = 0; i < scene->cameras; i++) {
		const ob_camera_def *camera = &scene->camera[i];
		ob_message_print(m, "%s{\"name\":", i ? "," : "");
		ob_message_put_json(m, camera->name);
		put_vec3(m, "eye", camera->eye);
		put_vec3(m, "target", camera->target);
		ob_message_print(m, ",\"fov\":%.9g,\"automatic\":%s,\"aboard\":%s,\"follow\":", camera->fov,
				 camera->automatic ? "true" : "false", camera->aboard ? "true" : "false");
		ob_message_put_json(m, camera->follow);
		ob_message_print(m, "}");
	}
	ob_message_print(m, "]");
	put_offers(m, scene);
	ob_message_print(m, ",\"meshes\":[");
	for (uint32_t i = 0; mesh && i < scene->meshes; i++) {
		ob_message_print(m, i ? "," : "");
		ob_message_put_json(m, mesh[i].path + 1); // the path in the page
	}
	ob_message_print(m, "]");
	put_pictures(m, scene);
	ob_message_print(m, "}}");
	return m;
}

static uint64_t cpu_of_workers(const ob_universe *u)
{
	ob_worker_info w;
	uint64_t ns = 0;
	for (uint32_t i = 0; ob_universe_get_worker(u, i, &w); i++)
		ns += w.cpu_ns;
	return ns;
}

ob_message *ob_facts_metrics(ob_host *h, uint32_t viewers)
{
	const ob_universe *u = ob_host_universe(h);
	ob_universe_info info;
	const uint64_t cpu_ns = cpu_of_workers(u);
	ob_universe_get_info(u, &info);
	const struct metric {
		const char *name, *type, *help;
		double value;
	} metrics[] = {
		{ "steps_total", "counter", "Steps that are complete.", (double)info.step },
		{ "simulated_seconds_total", "counter", "Simulated time.", info.time },
		{ "simulator_cpu_seconds_total", "counter", "CPU time of all workers.", 1e-9 * (double)cpu_ns },
		{ "simulator_deaths_total", "counter", "Times that simulators died or stalled.", info.deaths },
		{ "objects", "gauge", "Objects that exist.", info.objects },
		{ "objects_awake", "gauge", "Dynamic objects that are not asleep.", info.awake },
		{ "objects_frozen", "gauge", "Objects frozen by deaths or failures.", info.frozen },
		{ "pairs", "gauge", "Pairs of objects whose bounds overlap.", info.pairs },
		{ "islands", "gauge", "Groups of objects solved together.", info.islands },
		{ "workers", "gauge", "Workers.", info.workers },
		{ "viewers", "gauge", "Viewers connected.", viewers },
		{ "running", "gauge", "1: the run goes on or is paused; 0: it has ended.",
		  info.state == OB_UNIVERSE_RUNNING },
	};
	ob_message *m = ob_message_new(true);
	for (size_t i = 0; m && i < sizeof metrics / sizeof *metrics; i++)
		ob_message_print(m, "# HELP obsim_%s %s\n# TYPE obsim_%s %s\nobsim_%s{universe=\"%s\"} %.17g\n",
				 metrics[i].name, metrics[i].help, metrics[i].name, metrics[i].type, metrics[i].name,
				 info.name, metrics[i].value);
	return m;
}

ob_message *ob_facts_workers(ob_host *h)
{
	const ob_universe *u = ob_host_universe(h);
	ob_worker_info w;
	ob_death deaths[OB_DEATHS_KEPT];
	const uint32_t n = ob_host_get_deaths(h, deaths);
	const uint64_t now = ob_clock_ns();
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_print(m, "{\"workers\":[");
	for (uint32_t i = 0; i < ob_universe_simulators(u) && ob_universe_get_worker(u, i, &w); i++) {
		const uint32_t object = ob_worker_object(u, i);
		ob_message_print(m, "%s[%d,%u,%u,%.3f,", i ? "," : "", w.pid, ob_universe_rank_of(u, i), w.objects,
				 1e-9 * (double)w.cpu_ns);
		ob_message_print(m, object == OB_NO_OBJECT ? "null," : "%u,", object);
		uint32_t k = n; // its latest death is the one before
		while (k > 0 && deaths[k - 1].worker != i)
			k--;
		ob_message_print(m, k > 0 ? "%.2f]" : "null]", k > 0 ? 1e-9 * (double)(now - deaths[k - 1].when) : 0);
	}
	ob_message_print(m, "]}");
	return m;
}

// True if nothing was published for another step while the snapshot was taken.
static bool is_of_one_step(const ob_snapshot *s, const ob_universe *u)
{
	ob_universe_info now;
	ob_universe_get_info(u, &now);
	for (uint32_t id = 0; id < s->count; id++)
		if (s->motion[id].step > s->step)
			return false;
	return now.step == s->step;
}

static bool is_late(void *end)
{
	return ob_clock_wall() > *(const double *)end;
}

// Deepest penetration, m; NaN: the run is free, the snapshot is between two steps, or it would take too long.
static double deepest(const ob_snapshot *s, const ob_universe *u)
{
	const double patience = .005; // s: viewers wait
	double end = ob_clock_wall() + patience;
	ob_penetration p;
	const bool known = !ob_free_settings_of(u) && is_of_one_step(s, u) &&
			   ob_measure_penetration_unless(s, &p, is_late, &end, NULL);
	return known ? p.max_m : NAN;
}

ob_message *ob_facts_statistics(const ob_host *h, uint32_t viewers, bool energy, bool paused)
{
	const ob_universe *u = ob_host_universe(h);
	ob_universe_info info;
	ob_snapshot s = { 0 };
	char hash[20] = "";
	ob_universe_get_info(u, &info);
	const bool ended = info.state == OB_UNIVERSE_FINISHED, stands = ended || paused,
		   taken = (energy || stands) && ob_snapshot_take(&s, u, 0, NULL);
	const double joules = taken && energy ? ob_measure_energy(&s, info.gravity) : NAN,
		     depth = taken && energy ? deepest(&s, u) : NAN;
	if (taken && stands && (ended || is_of_one_step(&s, u)))
		snprintf(hash, sizeof hash, "%016llx", (unsigned long long)ob_measure_hash(&s));
	ob_snapshot_finish(&s);
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_print(m,
			 "{\"statistics\":{\"viewers\":%u,\"objects\":%u,\"awake\":%u,\"pairs\":%u,\"islands\":%u,"
			 "\"step\":%llu,\"frozen\":%u,\"ended\":%s,\"deaths\":%u,\"hash\":\"%s\",\"last_death\":",
			 viewers, info.objects, info.awake, info.pairs, info.islands, (unsigned long long)info.step,
			 info.frozen, ended ? "true" : "false", info.deaths, hash);
	ob_message_put_json(m, info.last_death);
	put_number(m, "cpu", 1e-9 * (double)cpu_of_workers(u));
	put_number(m, "energy", joules);
	put_number(m, "penetration", depth);
	ob_message_print(m, "}}");
	return m;
}

// Returns the latest of these deaths that froze objects; NULL: none.
static const ob_death *latest_frozen(const ob_death *death, uint32_t n)
{
	while (n > 0 && death[n - 1].frozen == 0)
		n--;
	return n ? &death[n - 1] : NULL;
}

ob_message *ob_facts_notice(const char *text)
{
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_print(m, "{\"notice\":");
	ob_message_put_json(m, text);
	ob_message_print(m, "}");
	return m;
}

ob_message *ob_facts_frozen(ob_host *h, uint64_t *since)
{
	ob_death deaths[OB_DEATHS_KEPT];
	const uint32_t n = ob_host_get_deaths(h, deaths);
	ob_error text;
	for (uint32_t i = 0; i < n; i++) {
		const ob_death *d = &deaths[i];
		if (d->when <= *since || d->frozen == 0)
			continue;
		*since = d->when;
		ob_death_print(d, text.text, sizeof text.text);
		size_t end = strlen(text.text);
		snprintf(text.text + end, sizeof text.text - end, "; frozen for it: %u", d->frozen);
		return ob_facts_notice(text.text);
	}
	return NULL;
}

ob_message *ob_facts_own_frozen(ob_host *h, uint32_t id, uint32_t more)
{
	ob_death deaths[OB_DEATHS_KEPT];
	const ob_death *d = latest_frozen(deaths, ob_host_get_deaths(h, deaths));
	ob_roster_entry entry;
	ob_error why;
	char text[sizeof why.text + OB_NAME_MAX + 80], others[32] = "";
	if (!d || !ob_roster_find(ob_host_roster(h), id, &entry))
		return NULL;
	ob_death_print(d, why.text, sizeof why.text);
	if (more > 0)
		snprintf(others, sizeof others, " and %u more of yours", more);
	snprintf(text, sizeof text, "your object %u%s%s%s%s was frozen: %s", id, *entry.name ? " (" : "", entry.name,
		 *entry.name ? ")" : "", others, why.text);
	return ob_facts_notice(text);
}

ob_message *ob_facts_avatar(uint32_t id, uint32_t generation)
{
	ob_message *m = ob_message_new(true);
	if (m)
		ob_message_print(m, "{\"avatar\":{\"id\":%u,\"generation\":%u}}", id, generation);
	return m;
}

static const char *state_of(const ob_passport *p, const ob_motion *m)
{
	if (p->flags & OB_OBJECT_FROZEN)
		return "frozen";
	if (p->flags & OB_OBJECT_STATIC)
		return "static";
	if (p->flags & OB_OBJECT_KINEMATIC)
		return "kinematic";
	if (m->flags & OB_MOTION_ASLEEP)
		return "asleep";
	if (m->flags & OB_MOTION_EQUILIBRIUM)
		return "in equilibrium";
	return ob_norm2(m->a) > 0 ? "flies" : "touches";
}

// The worker that simulates an object, and those that it simulates beside it.
static void put_home(ob_message *m, const ob_universe *u, uint32_t id)
{
	enum { NAMED = 6 };
	ob_universe_info info;
	ob_worker_info worker;
	ob_passport p;
	uint32_t home, other, shared = 0;
	ob_universe_get_info(u, &info);
	if (!ob_universe_get_home(u, id, &home) || !ob_universe_get_worker(u, home, &worker))
		return;
	ob_message_print(m, ",\"home\":%u,\"pid\":%d,\"cpu_s\":%.3f,\"shares\":[", home, worker.pid,
			 1e-9 * (double)worker.cpu_ns);
	for (uint32_t i = 0; i < info.capacity; i++) {
		if (!ob_universe_get_home(u, i, &other) || other != home || !ob_universe_get_passport(u, i, &p))
			continue;
		if (shared < NAMED) {
			ob_message_print(m, shared ? "," : "");
			ob_message_put_json(m, p.name);
		}
		shared++;
	}
	ob_message_print(m, "],\"shared\":%u", shared);
}

// Objects that its simulator reads: those whose bounds overlap its own. Left out if there are many.
static void put_readings(ob_message *m, const ob_universe *u, uint32_t id)
{
	enum { MOST = 200 };
	ob_universe_info info;
	float own[6], other[6];
	uint32_t reads[MOST], n = 0;
	ob_universe_get_info(u, &info);
	if (!ob_universe_get_bounds(u, id, own))
		return;
	for (uint32_t i = 0; i < info.capacity && n <= MOST; i++) {
		bool near = i != id && ob_universe_get_bounds(u, i, other);
		for (int k = 0; k < 3 && near; k++)
			near = own[k] <= other[k + 3] && other[k] <= own[k + 3];
		if (near && n < MOST)
			reads[n] = i;
		n += near;
	}
	if (n > MOST)
		return;
	ob_message_print(m, ",\"reads\":[");
	for (uint32_t i = 0; i < n; i++)
		ob_message_print(m, "%s%u", i ? "," : "", reads[i]);
	ob_message_print(m, "]");
}

// Own time of an object of a free run, ahead of the common time, and the object that its simulator waits for.
static void put_own_time(ob_message *m, const ob_universe *u, uint32_t id, double common)
{
	double own;
	uint32_t blocker;
	if (!ob_universe_get_own_time(u, id, &own))
		return;
	ob_message_print(m, ",\"ahead_s\":%.6f", own - common);
	if (ob_free_blocker(u, id, &blocker))
		ob_message_print(m, ",\"waits_for\":%" PRIu32, blocker);
}

ob_message *ob_facts_details(const ob_scene *scene, const ob_host *h, uint32_t id)
{
	const ob_universe *u = ob_host_universe(h);
	ob_roster_entry entry;
	ob_passport p;
	ob_motion motion;
	ob_worker_info worker;
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	if (!ob_roster_find(ob_host_roster(h), id, &entry) || !ob_universe_get_passport(u, id, &p) ||
	    !ob_universe_get_motion(u, id, &motion)) {
		ob_message_print(m, "{\"details\":{\"id\":%u,\"gone\":true}}", id);
		return m;
	}
	ob_message_print(m, "{\"details\":{\"id\":%u,\"generation\":%u,\"name\":", id, p.generation);
	ob_message_put_json(m, p.name);
	ob_message_print(
		m,
		",\"state\":\"%s\",\"mass\":%.9g,\"friction\":%.9g,\"restitution\":%.9g,\"island\":%u,\"step\":%u,"
		"\"substeps\":%u",
		state_of(&p, &motion), p.mass, p.friction, p.restitution,
		motion.flags & OB_MOTION_SWINGS ? id : motion.island, motion.step,
		motion.flags & OB_MOTION_RESTS ? 0 : motion.substeps);
	put_vec3(m, "size", p.size);
	ob_state now = ob_published_at(&motion, &p, info.time);
	put_vec3(m, "p", now.pose.p);
	put_numbers(m, "q", (double[]){ now.pose.q.w, now.pose.q.x, now.pose.q.y, now.pose.q.z }, 4);
	put_vec3(m, "v", now.v);
	put_vec3(m, "w", now.w);
	if (entry.script && entry.script <= scene->scripts) {
		put_text(m, "script", scene->script[entry.script - 1].name);
	}
	if (entry.own_worker && ob_universe_get_worker(u, entry.id, &worker))
		ob_message_print(m, ",\"worker\":%u,\"tid\":%d,\"cpu\":%d", entry.id, worker.tid, worker.cpu);
	put_home(m, u, id);
	put_readings(m, u, id);
	put_own_time(m, u, id, info.time);
	ob_message_print(m, "}}");
	return m;
}
