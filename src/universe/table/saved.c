#include "table/saved.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/shape.h"
#include "table/layout.h"
#include "table/pages.h"

static_assert(sizeof(ob_saved_record) == 320, "saved record");

// ---- saving

static bool is_present(const ob_universe *u, uint32_t id)
{
	ob_passport p;
	return ob_passport_read(u, id, &p) && p.flags & OB_OBJECT_PRESENT;
}

void ob_universe_count_saved(const ob_universe *u, ob_saved_universe *out)
{
	const ob_step_data *data = &u->step_data;
	*out = (ob_saved_universe){
		.step = ob_step_count(u),
		.checked = data->count->checked,
		.ids = ob_universe_ids(u),
		.planes = data->count->planes,
		.joints = ob_joints_end(data),
		.sensors = data->sensors,
		.sensor_numbers = u->header.sizes.sensor_values,
	};
	if (data->script_cells) {
		out->script_cells = data->script_counts->cells;
		out->script_bytes = u->header.sizes.script_bytes;
	}
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		out->pairs += data->pair[i].a != data->pair[i].b;
		out->records += data->pair[i].record != OB_NO_RECORD;
	}
}

static void save_object(const ob_universe *u, uint32_t id, ob_saved_universe *out)
{
	const ob_step_data *data = &u->step_data;
	const bool present = is_present(u, id);
	out->passport[id] = present ? *ob_passport_of(u, id) : (ob_passport){ 0 };
	out->motion[id] = present ? *ob_newest_motion(u, id) : (ob_motion){ 0 };
	out->schedule[id] = present ? data->schedule[id] : (ob_schedule){ 0 };
	out->neighbours[id] = present ? data->neighbours[id].count : 0;
	memset(out->bounds[id], 0, sizeof out->bounds[id]);
	if (present)
		memcpy(out->bounds[id], data->bounds[id], sizeof out->bounds[id]);
}

static void save_record(const ob_universe *u, uint32_t record, ob_saved_record *out)
{
	const ob_step_data *data = &u->step_data;
	const ob_pair_record *r = &data->record[record];
	const int newest = r->stamp[1] > r->stamp[0];
	*out = (ob_saved_record){ .state = r->version[newest], .stamp = r->stamp[newest] };
	if (ob_solver_is_two_sided(u->header.run.solver))
		memcpy(out->impulse_b, data->impulse_b[record][newest], sizeof out->impulse_b);
}

// Saves pairs sorted by ids, as their places in pair[] depend on the run.
static void save_pairs(const ob_universe *u, ob_saved_universe *out)
{
	const ob_step_data *data = &u->step_data;
	uint32_t pairs = 0, records = 0;
	for (uint32_t i = 0; i < ob_pairs_end(data) && pairs < out->pairs; i++)
		if (data->pair[i].a != data->pair[i].b)
			out->pair[pairs++] = data->pair[i];
	qsort(out->pair, pairs, sizeof *out->pair, ob_pairs_by_ids);
	for (uint32_t i = 0; i < pairs; i++) {
		ob_pair_key *k = &out->pair[i];
		k->in_island = 0; // the step has ended
		if (k->record == OB_NO_RECORD)
			continue;
		save_record(u, k->record, &out->record[records]);
		k->record = records++;
	}
}

// Saves scripts without the requests of the last step, which have been carried out.
static void save_scripts(const ob_universe *u, ob_saved_universe *out)
{
	const ob_step_data *data = &u->step_data;
	for (uint32_t i = 0; i < out->script_cells; i++) {
		const ob_script_turn *turn = &data->script_turn[i];
		ob_script_cell *c = &out->script_cell[i];
		out->script_turn[i] = *turn;
		memset(c, 0, sizeof *c);
		if (!turn->script)
			continue;
		*c = data->script_cell[i];
		c->asks = c->outbox_bytes = 0;
		memset(c->outbox, 0, sizeof c->outbox);
	}
	if (out->script_bytes)
		memcpy(out->script_text, data->script_text, out->script_bytes);
}

static void save_joints(const ob_universe *u, ob_saved_universe *out)
{
	const ob_step_data *data = &u->step_data;
	for (uint32_t i = 0; i < out->joints; i++)
		out->joint[i] = (ob_saved_joint){ data->joint[i], data->joint_state[i] };
}

void ob_universe_save(const ob_universe *u, ob_saved_universe *out)
{
	save_scripts(u, out);
	const ob_step_data *data = &u->step_data;
	for (uint32_t id = 0; id < out->ids; id++)
		save_object(u, id, out);
	memcpy(out->plane, data->plane, out->planes * sizeof *out->plane);
	save_pairs(u, out);
	save_joints(u, out);
	if (out->sensors) {
		memcpy(out->sensor_cell, data->sensor_cell, out->sensors * sizeof *out->sensor_cell);
		memcpy(out->sensor_value, data->sensor_value, out->sensor_numbers * sizeof *out->sensor_value);
	}
}

// ---- checking

static bool all_finite(const double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (!isfinite(x[i]))
			return false;
	return true;
}

static bool at_least_0(float x)
{
	return x >= 0 && isfinite(x);
}

static bool principal_moments_make_sense(const ob_passport *p)
{
	const double x = p->inertia.x, y = p->inertia.y, z = p->inertia.z, more = 1 + 1e-9;
	if (p->flags & OB_OBJECT_PRESCRIBED)
		return p->mass == 0 && x == 0 && y == 0 && z == 0;
	return p->mass > 0 && x > 0 && y > 0 && z > 0 && x <= (y + z) * more && y <= (z + x) * more &&
	       z <= (x + y) * more;
}

static uint32_t kind_of(const ob_passport *p)
{
	return p->flags & OB_OBJECT_KINEMATIC        ? OB_SCHEDULE_KINEMATIC
	       : !(p->flags & OB_OBJECT_STATIC)      ? OB_SCHEDULE_AWAKE
	       : ob_shape_is(p->shape, OB_UNBOUNDED) ? OB_SCHEDULE_PLANE
						     : OB_SCHEDULE_STATIC;
}

static bool schedule_makes_sense(const ob_schedule *s, const ob_passport *p, uint64_t step)
{
	const bool moves = s->state >= OB_SCHEDULE_AWAKE && s->state <= OB_SCHEDULE_EQUILIBRIUM;
	return (moves ? OB_SCHEDULE_AWAKE : s->state) == kind_of(p) && isfinite(s->path) && at_least_0(s->reach) &&
	       s->since <= step;
}

static bool motion_of_run_makes_sense(const ob_motion *m, uint64_t step)
{
	enum {
		KNOWN = OB_MOTION_FREE | OB_MOTION_STEADY | OB_MOTION_RESTS | OB_MOTION_SWINGS | OB_MOTION_REFINEMENT,
		SUBSTEPS_MAX = 1 << (OB_SUBSTEP_CHOICES - 1)
	};
	return ob_motion_makes_sense(m) && !(m->flags & ~(uint32_t)KNOWN) && m->step <= step &&
	       m->substeps <= SUBSTEPS_MAX && isfinite(m->path) &&
	       (m->flags & OB_MOTION_SWINGS || at_least_0(m->rest_time)) && at_least_0(m->reach);
}

static bool bounds_make_sense(const float *b, const ob_passport *p)
{
	for (int c = 0; c < 3; c++)
		if (!(b[c] <= b[c + 3]) || (!ob_shape_is(p->shape, OB_UNBOUNDED) && !isfinite(b[c + 3] - b[c])))
			return false;
	return true;
}

static bool check_object(const ob_saved_universe *s, uint32_t id, ob_error *e)
{
	const uint32_t groups = UINT32_MAX << OB_OBJECT_GROUP;
	const uint32_t known = OB_OBJECT_PRESENT | OB_OBJECT_PRESCRIBED | OB_OBJECT_FROZEN | OB_OBJECT_MESH_COLOUR |
			       OB_OBJECT_MESH_SURFACE | OB_OBJECT_SENSOR | OB_OBJECT_HIDDEN |
			       OB_OBJECT_PATTERN_BITS << OB_OBJECT_PATTERN | groups;
	const ob_passport *p = &s->passport[id];
	const char *wrong = NULL;
	if (!(p->flags & OB_OBJECT_PRESENT))
		return p->flags == 0 && s->schedule[id].state == OB_SCHEDULE_ABSENT
			       ? true
			       : ob_fail(e, "object %u is half there", id);
	if (!ob_passport_makes_sense(p, id) || p->flags & ~known || !principal_moments_make_sense(p))
		wrong = "passport";
	else if (!motion_of_run_makes_sense(&s->motion[id], s->step) ||
		 (s->motion[id].flags & OB_MOTION_SWINGS && !(p->flags & OB_OBJECT_KINEMATIC)))
		wrong = "motion";
	else if (!schedule_makes_sense(&s->schedule[id], p, s->step))
		wrong = "schedule";
	else if (!bounds_make_sense(s->bounds[id], p))
		wrong = "bounds";
	return wrong ? ob_fail(e, "the %s of object %u makes no sense", wrong, id) : true;
}

// An object that exists; ids that came from outside.
static bool is_there(const ob_saved_universe *s, uint32_t id)
{
	return id < s->ids && s->passport[id].flags & OB_OBJECT_PRESENT;
}

static bool check_planes(const ob_saved_universe *s, ob_error *e)
{
	bool *listed = calloc((size_t)s->ids + 1, sizeof *listed), sense = listed;
	for (uint32_t i = 0; i < s->planes && sense; i++) {
		const uint32_t id = s->plane[i];
		sense = is_there(s, id) && s->schedule[id].state == OB_SCHEDULE_PLANE && !listed[id];
		if (sense)
			listed[id] = true;
	}
	free(listed);
	return sense ? true : ob_fail(e, "the list of planes makes no sense");
}

static bool record_makes_sense(const ob_saved_record *r, uint64_t step)
{
	const ob_pair_state *p = &r->state;
	const double n2 = ob_norm2(p->normal);
	return p->points <= OB_PAIR_POINTS && (p->points == 0 || (n2 > .9 && n2 < 1.1)) && r->stamp > 0 &&
	       r->stamp <= step + 1 && r->zero == 0 && isfinite(p->creep) &&
	       all_finite((const double *)p, offsetof(ob_pair_state, points) / sizeof(double)) &&
	       all_finite(r->impulse_b, OB_PAIR_ROWS);
}

static bool check_pairs(const ob_saved_universe *s, ob_error *e)
{
	uint32_t records = 0;
	for (uint32_t i = 0; i < s->pairs; i++) {
		const ob_pair_key *k = &s->pair[i], *last = i ? k - 1 : NULL;
		const bool ids = k->a < k->b && is_there(s, k->a) && is_there(s, k->b) &&
				 (!last || ob_pairs_by_ids(last, k) < 0);
		const bool moves = ids && (ob_schedule_is_dynamic(&s->schedule[k->a]) ||
					   ob_schedule_is_dynamic(&s->schedule[k->b]));
		if (!moves || isnan(k->limit) || (k->active && k->record == OB_NO_RECORD))
			return ob_fail(e, "pair %u makes no sense", i);
		if (k->record == OB_NO_RECORD)
			continue;
		if (k->record != records || records == s->records || !record_makes_sense(&s->record[records], s->step))
			return ob_fail(e, "the contact points of pair %u make no sense", i);
		records++;
	}
	return records == s->records ? true : ob_fail(e, "there are contact points of no pair");
}

static bool script_makes_sense(const ob_saved_universe *s, uint32_t cell)
{
	enum { KNOWN = (OB_SCRIPT_BROKE << 1) - 1 };
	const ob_script_turn *t = &s->script_turn[cell];
	const ob_script_cell *c = &s->script_cell[cell];
	if (!t->script)
		return t->flags == 0;
	return is_there(s, t->object) && s->passport[t->object].generation == t->generation &&
	       t->script <= OB_SCRIPTS_MAX && !(t->flags & ~(uint32_t)KNOWN) && c->state_bytes <= sizeof c->state &&
	       c->inbox_bytes <= sizeof c->inbox && c->touches <= OB_SCRIPT_TOUCHES && !c->asks && !c->outbox_bytes &&
	       isfinite(ob_norm2(c->torque)) && memchr(c->error, 0, sizeof c->error);
}

static bool check_scripts(const ob_saved_universe *s, ob_error *e)
{
	bool *taken = calloc((size_t)s->ids + 1, sizeof *taken), sense = taken;
	for (uint32_t i = 0; i < s->script_cells && sense; i++) {
		sense = script_makes_sense(s, i);
		const uint32_t id = s->script_turn[i].object;
		if (!sense || !s->script_turn[i].script)
			continue;
		sense = !taken[id];
		taken[id] = true;
	}
	free(taken);
	return sense ? true : ob_fail(e, "what its scripts keep makes no sense");
}

static bool joint_makes_sense(const ob_saved_joint *j, uint32_t ids, uint64_t step)
{
	const ob_joint_state *s = &j->state;
	const uint32_t *id = j->passport.object;
	bool sense = (!ob_joint_exists(&j->passport) || (id[0] < ids && (id[1] < ids || id[1] == OB_JOINT_WORLD) &&
							 ob_joint_makes_sense(&j->passport))) &&
		     s->broke <= step && !s->zero;
	for (int i = 0; i < 2; i++)
		sense = sense && s->stamp[i] <= step &&
			all_finite((const double *)&s->version[i], sizeof s->version[i] / sizeof(double));
	return sense;
}

static bool check_joints(const ob_saved_universe *s, ob_error *e)
{
	for (uint32_t i = 0; i < s->joints; i++)
		if (!joint_makes_sense(&s->joint[i], s->ids, s->step))
			return ob_fail(e, "joint %u makes no sense", i);
	return true;
}

static bool check_sensors(const ob_saved_universe *s, ob_error *e)
{
	for (uint32_t i = 0; i < s->sensors; i++) {
		const ob_sensor_cell *c = &s->sensor_cell[i];
		if (c->step > s->step || !all_finite((const double *)c->past, sizeof c->past / 8))
			return ob_fail(e, "sensor %u makes no sense", i);
	}
	return true;
}

bool ob_saved_universe_check(const ob_saved_universe *s, ob_error *e)
{
	if (s->step > UINT32_MAX - 2 || s->checked > s->step) // a motion carries its step as 32 bits
		return ob_fail(e, "no run is so long");
	for (uint32_t id = 0; id < s->ids; id++)
		if (!check_object(s, id, e))
			return false;
	return check_planes(s, e) && check_pairs(s, e) && check_scripts(s, e) && check_joints(s, e) &&
	       check_sensors(s, e);
}

// ---- loading

static void load_object(ob_universe *u, uint32_t id, const ob_saved_universe *s)
{
	ob_step_data *data = &u->step_data;
	data->result_island[id] = UINT32_MAX;
	if (!(s->passport[id].flags & OB_OBJECT_PRESENT))
		return;
	ob_publish_motion(u, id, &s->motion[id]);
	ob_write_passport(u, id, &s->passport[id]);
	data->schedule[id] = s->schedule[id];
	data->neighbours[id].count = s->neighbours[id];
	memcpy(data->bounds[id], s->bounds[id], sizeof data->bounds[id]);
	if (s->neighbours[id] == UINT32_MAX)
		ob_requery_append(u, id);
}

static void load_record(ob_universe *u, uint32_t record, const ob_saved_record *from)
{
	ob_step_data *data = &u->step_data;
	ob_pair_record *to = &data->record[record];
	to->version[0] = from->state;
	to->stamp[0] = from->stamp;
	to->stamp[1] = 0;
	if (ob_solver_is_two_sided(u->header.run.solver))
		memcpy(data->impulse_b[record][0], from->impulse_b, sizeof from->impulse_b);
}

static bool reserve(ob_universe *u, const ob_saved_universe *s, ob_error *e)
{
	if (!ob_universe_reserve(u, s->ids, e))
		return false;
	bool fine = ob_reserve_joints(u, s->joints) && ob_reserve_pairs(u, 0, s->pairs);
	for (uint32_t i = 0; i < s->records && fine; i++)
		fine = ob_reserve_record(u, i);
	return fine ||
	       ob_fail(e, "/dev/shm is full: enlarge it (mount -o remount,size=..., docker run --shm-size=...)");
}

// false: the memory file system is full
static bool load_scripts(ob_universe *u, const ob_saved_universe *s)
{
	ob_step_data *data = &u->step_data;
	for (uint32_t i = 0; i < s->script_cells; i++) {
		const ob_script_turn *turn = &s->script_turn[i];
		if (turn->script && (!ob_pages_take(u, OB_AREA_SCRIPT_CELL, i, 1) ||
				     !ob_pages_take(u, OB_AREA_PASSPORT_EVEN, turn->object, 1)))
			return false;
		data->script_turn[i] = *turn;
		if (!turn->script)
			continue;
		data->script_cell[i] = s->script_cell[i];
		data->script_of[turn->object] = i + 1;
		data->script_counts->failed += (turn->flags & (OB_SCRIPT_STOPPED | OB_SCRIPT_WARNED)) != 0;
		data->script_counts->stopped += turn->flags & OB_SCRIPT_STOPPED && *data->script_cell[i].error;
	}
	if (data->script_cells)
		data->script_counts->cells = s->script_cells;
	return true;
}

static bool scripts_are_the_same(const ob_universe *u, const ob_saved_universe *s)
{
	return s->script_bytes == u->header.sizes.script_bytes && s->script_cells <= u->step_data.script_cells &&
	       (!s->script_bytes || memcmp(s->script_text, u->step_data.script_text, s->script_bytes) == 0);
}

static void load_joints(ob_universe *u, const ob_saved_universe *s)
{
	ob_step_data *data = &u->step_data;
	ob_joints_write(u, NULL, 0);
	for (uint32_t i = 0; i < s->joints; i++) {
		data->joint[i] = s->joint[i].passport;
		data->joint_state[i] = s->joint[i].state;
	}
	ob_joints_write(u, data->joint, s->joints);
}

bool ob_universe_load(ob_universe *u, const ob_saved_universe *s, ob_error *e)
{
	if (!scripts_are_the_same(u, s))
		return ob_fail(e, "its scripts are not those of the saved run: a file beside the scene has changed");
	ob_step_data *data = &u->step_data;
	if (s->sensors != data->sensors || s->sensor_numbers != u->header.sizes.sensor_values)
		return ob_fail(e, "its sensors, with their samples, are not those of the saved run");
	if (s->joints > data->joints_max)
		return ob_fail(e, "this run has room for %u joints, the saved one has %u", data->joints_max, s->joints);
	if (s->pairs > data->pairs_max || s->ids > data->objects_max)
		return ob_fail(
			e, "this run has room for %u objects and %u pairs of neighbours, the saved one has %u and %u",
			data->objects_max, data->pairs_max, s->ids, s->pairs);
	if (!reserve(u, s, e))
		return false;
	for (uint32_t id = 0; id < s->ids; id++)
		load_object(u, id, s);
	if (!load_scripts(u, s))
		return ob_fail(e, "/dev/shm is full: no room for the objects' scripts");
	memcpy(data->plane, s->plane, s->planes * sizeof *s->plane);
	memcpy(data->pair, s->pair, s->pairs * sizeof *s->pair);
	for (uint32_t i = 0; i < s->records; i++)
		load_record(u, i, &s->record[i]);
	load_joints(u, s);
	if (s->sensors) {
		memcpy(data->sensor_cell, s->sensor_cell, s->sensors * sizeof *s->sensor_cell);
		memcpy(data->sensor_value, s->sensor_value, s->sensor_numbers * sizeof *s->sensor_value);
	}
	data->count->planes = s->planes;
	data->count->pairs = s->pairs;
	data->count->records_used = s->records;
	data->count->checked = s->checked;
	__atomic_store_n(&u->control->pairs, s->pairs, __ATOMIC_RELAXED);
	__atomic_store_n(&u->control->step, s->step, __ATOMIC_RELEASE);
	return true;
}
