#include "render/draw_list.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "shape/shape.h"

// ---- the view of a camera

// Objects farther away are not drawn: the fog has hidden them (see fog_ranges in frame.c).
static const double far_ranges = 60, far_least = 2000; // camera ranges; m
static const double sensor_near = .01, sensor_range = 10; // m, for camera sensors
static const double steepest = 89 * M_PI / 180; // rad: a level horizon needs a direction that is not vertical

// Direction after pan and tilt, limited.
static ob_vec3 turned(ob_vec3 direction, double pan, double tilt)
{
	double azimuth = atan2(direction.y, direction.x) + pan;
	double elevation = atan2(direction.z, hypot(direction.x, direction.y)) + tilt;
	elevation = fmax(-steepest, fmin(steepest, elevation));
	return ob_v3(cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation));
}

ob_view ob_view_of_camera(const ob_camera_def *c, double t, int width, int height)
{
	ob_view v = { .eye = ob_madd(c->eye, t, c->velocity), .range = ob_norm(ob_sub(c->target, c->eye)) };
	ob_vec3 look = v.range > 0 ? ob_sub(c->target, c->eye) : ob_v3(0, 1, 0);
	v.forward = turned(look, c->pan * t, c->tilt * t);
	v.right = ob_cross(v.forward, ob_v3(0, 0, 1));
	v.right = ob_scale(v.right, 1 / ob_norm(v.right));
	v.up = ob_cross(v.right, v.forward);
	v.tan_y = tan(.5 * c->fov);
	v.tan_x = v.tan_y * width / height;
	v.near_plane = fmax(.01, fmin(.5, .01 * v.range));
	v.far_plane = fmax(far_least, far_ranges * v.range);
	return v;
}

ob_view ob_view_of_sensor(const ob_sensor_passport *s, ob_pose at)
{
	const ob_mat3 r = ob_quat_matrix(at.q);
	return (ob_view){ .eye = at.p,
			  .right = ob_scale(ob_column(&r, 1), -1),
			  .up = ob_column(&r, 2),
			  .forward = ob_column(&r, 0),
			  .tan_x = tan(.5 * s->fan),
			  .tan_y = tan(.5 * s->rise),
			  .near_plane = sensor_near,
			  .far_plane = far_least,
			  .range = sensor_range };
}

bool ob_view_in_frustum(const ob_view *v, ob_vec3 centre, double radius)
{
	ob_vec3 d = ob_sub(centre, v->eye);
	double x = ob_dot(d, v->right), y = ob_dot(d, v->up), z = ob_dot(d, v->forward);
	if (z < -radius || z > v->far_plane + radius)
		return false;
	return (fabs(x) - z * v->tan_x) <= radius * hypot(1, v->tan_x) &&
	       (fabs(y) - z * v->tan_y) <= radius * hypot(1, v->tan_y);
}

void ob_view_projection(const ob_view *v, float m[16])
{
	double n = v->near_plane, f = v->far_plane;
	double row[4][3] = {
		{ v->right.x / v->tan_x, v->right.y / v->tan_x, v->right.z / v->tan_x },
		{ -v->up.x / v->tan_y, -v->up.y / v->tan_y, -v->up.z / v->tan_y },
		{ v->forward.x, v->forward.y, v->forward.z },
		{ v->forward.x, v->forward.y, v->forward.z },
	};
	for (int i = 0; i < 3; i++) {
		m[4 * i + 0] = (float)row[0][i];
		m[4 * i + 1] = (float)row[1][i];
		m[4 * i + 2] = (float)(row[2][i] * (f + n) / (f - n));
		m[4 * i + 3] = (float)row[3][i];
	}
	m[12] = m[13] = m[15] = 0;
	m[14] = (float)(-2 * f * n / (f - n));
}

// ---- bodies

static const double bevel_share = .1, bevel_most = .05; // relative to the smallest half size; m
static const double medium_px = 7, fine_px = 45; // screen radius from which rounder meshes are used

// Between two publications it needs the older one; without it the body rests at the start of the
// newer motion.
ob_pose ob_draw_pose(const ob_snapshot *prev, const ob_snapshot *now, uint32_t i, double t)
{
	const ob_motion *m = &now->motion[i];
	ob_vec3 inertia = now->passport[i].inertia;
	if (t >= m->t0)
		return ob_motion_at(m, inertia, t).pose;
	bool same = prev && i < prev->count && (prev->passport[i].flags & OB_OBJECT_PRESENT) &&
		    prev->passport[i].generation == now->passport[i].generation && prev->motion[i].t0 <= t;
	if (!same)
		return (ob_pose){ m->p, m->q };
	ob_motion before = prev->motion[i];
	// it flew until then; its motion after that is unknown
	if (before.t0 < prev->time && !(m->flags & OB_MOTION_FREE)) {
		ob_pose then = ob_motion_at(&before, inertia, prev->time).pose;
		before.p = then.p;
		before.q = then.q;
		before.t0 = prev->time;
	}
	return ob_motion_between(&before, m, inertia, t);
}

// NULL: drawn as its collision shape.
static const ob_mesh *look_of(const ob_draw_list *b, const ob_passport *p)
{
	return p->mesh > 0 && p->mesh <= b->meshes ? &b->mesh[p->mesh - 1] : NULL;
}

static bool grow(ob_draw_list *b, uint32_t count)
{
	if (count <= b->capacity)
		return true;
	if (!OB_GROW(b->body, count) || !OB_GROW_CLEARED(b->attention, b->capacity, count))
		return false;
	b->capacity = count;
	return true;
}

static const double attention_fade = 1; // s of rest in which it falls by the factor e
static const double attention_least = .05, attention_gap = 1; // gap: s between fills, after which it begins anew

// Attention to object i at time t, s after the last fill. Waking takes time, too: else the picture would jump.
static void attend(ob_draw_list *b, uint32_t i, double t, double s)
{
	ob_attention *a = &b->attention[i];
	const ob_motion *m = &b->now->motion[i];
	const uint32_t generation = b->now->passport[i].generation;
	const bool rests = m->flags & OB_MOTION_RESTS, goes_on = a->level > 0 && a->generation == generation;
	const double goal = rests ? attention_least : 1, from = goes_on ? a->level : 1;
	const double since = goes_on ? s : fmax(t - m->t0, 0);
	*a = (ob_attention){ generation, (float)(goal + (from - goal) * exp(-since / attention_fade)) };
}

static ob_drawn drawn_as(const ob_passport *p)
{
	return p->flags & OB_OBJECT_HIDDEN   ? OB_DRAWN_NOT
	       : p->flags & OB_OBJECT_SENSOR ? OB_DRAWN_THROUGH
					     : OB_DRAWN_SOLID;
}

bool ob_draw_list_fill(ob_draw_list *b, const ob_snapshot *prev, const ob_snapshot *now, double t)
{
	if (!grow(b, now->count))
		return false;
	const double since = t - b->time;
	if (b->now && !(since >= 0 && since <= attention_gap))
		memset(b->attention, 0, b->capacity * sizeof *b->attention);
	b->time = t;
	b->now = now;
	b->count = 0;
	b->planes = 0;
	for (uint32_t i = 0; i < now->count; i++) {
		const ob_passport *p = &now->passport[i];
		const bool unbounded = ob_shape_is(p->shape, OB_UNBOUNDED);
		if (!(p->flags & OB_OBJECT_PRESENT) ||
		    !(unbounded || ob_shape_is_bounded(p->shape) ||
		      (ob_shape_is(p->shape, OB_SURFACED) && look_of(b, p))) ||
		    (ob_shape_is(p->shape, OB_HULLED) && !ob_snapshot_hull(now, i)))
			continue;
		ob_pose pose = ob_draw_pose(prev, now, i, t);
		attend(b, i, t, since);
		if (!unbounded) {
			const ob_mesh *look = look_of(b, p);
			const double radius = look ? look->radius : ob_shape_radius(p->shape, p->size);
			b->body[b->count++] = (ob_draw_item){ pose, radius, 0, i, drawn_as(p) };
		} else if (b->planes < OB_PLANES_MAX && drawn_as(p) == OB_DRAWN_SOLID) {
			b->plane_id[b->planes] = i;
			b->plane[b->planes++] = pose;
		}
	}
	return true;
}

// ---- automatic cameras

// Weighted fourth moments instead of extremes: no single body makes the camera jump, and one that leaves the others for
// good is left behind. Bodies that move together, or the only one that moves, are followed wherever they go.
static const double lost_ranges =
	1.5; // camera ranges, or distances of the nearest: bodies farther off count less and less
static const double left_ranges = 20; // camera ranges from the initial target: likewise, however few move
static const double present_least = .05, present_most = .1; // bodies in sight: the camera goes back to its beginning
static const double spread =
	2.45; // distance to a side of the picture, in one-sided fourth moments; this holds all of an even cube seen cornerwise
static const double ground_clearance = .05; // of the eye, relative to its distance
static const double nearest = .3; // relative to the initial distance: it comes no nearer

// Extent of bodies beyond two opposite sides of a view pyramid with its tip in their middle (see call_camera.c).
typedef struct reach {
	double high, low; // m
} reach;

typedef struct crowd {
	const ob_draw_list *list;
	const ob_camera_def *camera;
	ob_view view;
	ob_vec3 about; // m: place of those that move
	double lost; // m^4: fourth power of the distance from there at which a body counts half
	ob_vec3 middle; // m
	double present, weight; // bodies that are not lost, before and after their attention
} crowd;

static double square(double x)
{
	return x * x;
}

static double fourth_power(double x)
{
	return square(square(x));
}

// By the eighth power of the distance, so that even the fourth moment of one that is lost vanishes.
static double presence_of(const crowd *all, uint32_t i)
{
	const ob_draw_item *body = &all->list->body[i];
	if (all->list->now->passport[body->id].flags & (OB_OBJECT_STATIC | OB_OBJECT_HIDDEN))
		return 0;
	const double far = square(ob_norm2(ob_sub(body->pose.p, all->about))) / all->lost;
	const double left = ob_norm2(ob_sub(body->pose.p, all->camera->target)) / square(left_ranges * all->view.range);
	return 1 / ((1 + square(far)) * (1 + square(left)));
}

static double attention_to(const crowd *all, uint32_t i)
{
	return all->list->attention[all->list->body[i].id].level;
}

static double weight_of(const crowd *all, uint32_t i)
{
	return attention_to(all, i) * presence_of(all, i);
}

// Weight of a body among those that move: next to none at rest.
static double motion_of(const crowd *all, uint32_t i)
{
	const double attention = square(attention_to(all, i));
	return attention * square(attention) * presence_of(all, i);
}

// Looks from another place: from how far on bodies are lost depends on how near to it any moves, by a mean of distances
// that the nearest decide.
static void look_about(crowd *all, ob_vec3 place)
{
	const double range = square(all->view.range);
	double all_moving = 0, near = 0;
	all->about = place;
	all->lost = INFINITY; // none is, while this is found
	for (uint32_t i = 0; i < all->list->count; i++) {
		const double moving = motion_of(all, i);
		all_moving += moving;
		near += moving / square(ob_norm2(ob_sub(all->list->body[i].pose.p, place)) + .25 * range);
	}
	all->lost = fourth_power(lost_ranges) * (square(range) + (near > 0 ? all_moving / near : 0));
}

// Looks from the middle of those that move.
static void find_moving(crowd *all)
{
	ob_vec3 sum = { 0 };
	double weight = 0;
	look_about(all, all->camera->target);
	for (uint32_t i = 0; i < all->list->count; i++) {
		const double moving = motion_of(all, i);
		sum = ob_madd(sum, moving, all->list->body[i].pose.p);
		weight += moving;
	}
	if (weight > 0)
		look_about(all, ob_scale(sum, 1 / weight));
}

static void find_middle(crowd *all)
{
	for (uint32_t i = 0; i < all->list->count; i++) {
		double w = weight_of(all, i);
		all->present += presence_of(all, i);
		all->middle = ob_madd(all->middle, w, all->list->body[i].pose.p);
		all->weight += w;
	}
	all->middle = ob_scale(all->middle, 1 / all->weight);
}

// Extent along an axis of the picture; `tangent` is that of half of the angle that may be filled.
static reach reach_of(const crowd *all, ob_vec3 axis, double tangent)
{
	const double slant = hypot(1, tangent);
	double high = 0, low = 0;
	for (uint32_t i = 0; i < all->list->count; i++) {
		const ob_draw_item *body = &all->list->body[i];
		ob_vec3 d = ob_sub(body->pose.p, all->middle);
		double x = ob_dot(d, axis), r = body->radius * slant - ob_dot(d, all->view.forward) * tangent;
		double w = weight_of(all, i) / all->weight;
		high += w * fourth_power(fmax(r + x, 0));
		low += w * fourth_power(fmax(r - x, 0));
	}
	return (reach){ spread * pow(high, .25), spread * pow(low, .25) };
}

// Offset of the tip from the middle along an axis, at this distance, for equal room on both sides of the picture. With
// spare room, a narrower pyramid holds the bodies as well; iteration finds it.
static double centre(const crowd *all, ob_vec3 axis, double tangent, double away)
{
	reach r = reach_of(all, axis, tangent);
	for (int i = 0; i < 4; i++)
		r = reach_of(all, axis, fmin((r.high + r.low) / (2 * away), tangent));
	return .5 * (r.high - r.low);
}

// Moves the eye above the level ground that the camera began above.
static void keep_above_ground(ob_camera_def *to, const ob_camera_def *c, const ob_draw_list *b, double clearance)
{
	for (int i = 0; i < b->planes; i++) {
		const ob_pose *plane = &b->plane[i];
		if (ob_quat_matrix(plane->q).m[2][2] > .999 && c->eye.z > plane->p.z)
			to->eye.z = fmax(to->eye.z, plane->p.z + clearance);
	}
}

// Moves the camera along with the object that it follows; without one of this name it stays.
static void go_along(ob_camera_def *to, const ob_draw_list *b)
{
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_pose *pose = &b->body[i].pose;
		if (strcmp(b->now->passport[b->body[i].id].name, to->follow) != 0)
			continue;
		if (to->aboard) {
			const ob_mat3 r = ob_quat_matrix(pose->q);
			to->eye = ob_add(pose->p, ob_rotate(&r, to->eye));
			to->target = ob_add(pose->p, ob_rotate(&r, to->target));
		} else {
			to->eye = ob_add(to->eye, ob_sub(pose->p, to->target));
			to->target = pose->p;
		}
		return;
	}
}

ob_camera_def ob_camera_follow(const ob_camera_def *c, const ob_draw_list *b, int width, int height)
{
	ob_camera_def to = *c;
	if (*c->follow)
		go_along(&to, b);
	if (!c->automatic)
		return to;
	crowd all = { .list = b, .camera = c, .view = ob_view_of_camera(c, 0, width, height) };
	const ob_view *v = &all.view;
	find_moving(&all);
	find_middle(&all);
	const double sight = fmin(1, (all.present - present_least) / (present_most - present_least));
	if (!(sight > 0))
		return to; // no body may move, or all are lost
	reach x = reach_of(&all, v->right, v->tan_x), y = reach_of(&all, v->up, v->tan_y);
	double away = fmax((x.high + x.low) / (2 * v->tan_x), (y.high + y.low) / (2 * v->tan_y));
	away = fmax(away, nearest * v->range);
	to.target = ob_madd(all.middle, centre(&all, v->right, v->tan_x, away), v->right);
	to.target = ob_madd(to.target, centre(&all, v->up, v->tan_y, away), v->up);
	to.eye = ob_madd(to.target, -away, v->forward);
	to.target = ob_madd(c->target, sight, ob_sub(to.target, c->target));
	to.eye = ob_madd(c->eye, sight, ob_sub(to.eye, c->eye));
	keep_above_ground(&to, c, b, ground_clearance * away);
	return to;
}

// Equal distances in the order of ids, so that the same frame gives the same bytes.
static int by_distance(const void *a, const void *b)
{
	const ob_draw_item *x = a, *y = b;
	if (x->distance != y->distance)
		return x->distance < y->distance ? -1 : 1;
	return x->id < y->id ? -1 : 1;
}

void ob_draw_list_sort(ob_draw_list *b, ob_vec3 eye)
{
	for (uint32_t i = 0; i < b->count; i++)
		b->body[i].distance = ob_norm2(ob_sub(b->body[i].pose.p, eye));
	qsort(b->body, b->count, sizeof *b->body, by_distance);
}

void ob_draw_list_finish(ob_draw_list *b)
{
	free(b->body);
	free(b->attention);
	*b = (ob_draw_list){ 0 };
}

// Colours that show the architecture are shown without patterns.
static ob_pattern shown_pattern(const ob_draw_list *b, const ob_passport *p)
{
	return b->colouring.key == OB_COLOUR_OWN ? ob_passport_pattern(p) : OB_PATTERN_PLAIN;
}

static uint32_t mesh_of(const ob_draw_list *b, const ob_passport *p, const ob_draw_item *body, const ob_view *v,
			int height, bool exact)
{
	if (look_of(b, p))
		return OB_MESHES + b->now->hulls + p->mesh - 1;
	if (ob_shape_is(p->shape, OB_SIDED))
		return shown_pattern(b, p) ? OB_MESH_PATTERNED_BOX : OB_MESH_BOX;
	if (ob_shape_is(p->shape, OB_HULLED))
		return OB_MESHES + p->hull;
	if (exact)
		return (ob_shape_is(p->shape, OB_RIMMED) ? OB_MESH_CYLINDER : OB_MESH_ROUND) + OB_MESH_LEVELS - 1;
	double distance = ob_norm(ob_sub(body->pose.p, v->eye));
	double px = .5 * height * p->size.x / (v->tan_y * fmax(distance, v->near_plane));
	uint32_t level = px < medium_px ? 0 : px < fine_px ? 1 : 2;
	return (ob_shape_is(p->shape, OB_RIMMED) ? OB_MESH_CYLINDER : OB_MESH_ROUND) + level;
}

static double bevel_width(double smallest)
{
	return fmin(bevel_share * smallest, bevel_most);
}

static void set_vec4(float to[4], double x, double y, double z, double w)
{
	to[0] = (float)x;
	to[1] = (float)y;
	to[2] = (float)z;
	to[3] = (float)w;
}

static ob_instance instance_of(const ob_draw_list *b, const ob_draw_item *body, ob_vec3 eye, bool look)
{
	const ob_passport *p = &b->now->passport[body->id];
	const ob_pose *pose = &body->pose;
	ob_instance i;
	ob_vec3 at = ob_sub(pose->p, eye);
	double rounding = 0;
	ob_outline o;
	if (!ob_shape_outline(p->shape, p->size, &o) || look)
		o = (ob_outline){ .half = { 1, 1, 1 } }; // meshes and hulls are in metres
	if (look) {
		rounding -= p->flags & OB_OBJECT_MESH_COLOUR && b->colouring.key == OB_COLOUR_OWN ? 1 : 0;
		rounding -= p->flags & OB_OBJECT_MESH_SURFACE ? 2 : 0;
	} else if (ob_shape_is(p->shape, OB_SIDED)) {
		rounding = bevel_width(fmin(o.half.x, fmin(o.half.y, o.half.z)));
	} else if (o.rim > 0) {
		o.ball = bevel_width(fmin(o.rim, o.half.z));
		o.half = ob_v3(o.rim - o.ball, o.rim - o.ball, o.half.z - o.ball);
	}
	set_vec4(i.position_radius, at.x, at.y, at.z, o.ball);
	set_vec4(i.attitude, pose->q.x, pose->q.y, pose->q.z, pose->q.w);
	set_vec4(i.core, o.half.x, o.half.y, o.half.z, rounding);
	ob_colouring_of(&b->colouring, b->now, body->id, i.colour);
	i.colour[3] = ob_surface_pack(p->roughness, p->metal);
	if (!look && ob_shape_is(p->shape, OB_SIDED))
		i.colour[3] += 16 * (float)shown_pattern(b, p);
	return i;
}

// Instance of the shape that collides, or of the look, with the object's number for its colour.
static ob_instance exact_instance_of(const ob_draw_list *b, const ob_draw_item *body, ob_vec3 eye, bool look)
{
	const ob_passport *p = &b->now->passport[body->id];
	const ob_vec3 at = ob_sub(body->pose.p, eye);
	const ob_quat q = body->pose.q;
	ob_instance i;
	ob_outline o;
	double kind = 0;
	if (!ob_shape_outline(p->shape, p->size, &o) || look)
		o = (ob_outline){ .half = { 1, 1, 1 } };
	else if (o.rim > 0)
		o.half = ob_v3(o.rim, o.rim, o.half.z), kind = -2;
	else if (o.ball > 0)
		kind = -1;
	set_vec4(i.position_radius, at.x, at.y, at.z, o.ball);
	set_vec4(i.attitude, q.x, q.y, q.z, q.w);
	set_vec4(i.core, o.half.x, o.half.y, o.half.z, kind);
	set_vec4(i.colour, body->id, 0, 0, 0);
	return i;
}

static bool expect_meshes(ob_instances *out, uint32_t meshes)
{
	if (meshes > out->meshes_max) {
		if (!OB_GROW(out->first, meshes + 1))
			return false;
		out->meshes_max = meshes;
	}
	out->meshes = meshes;
	return out->first;
}

bool ob_instances_fill(ob_instances *out, const ob_draw_list *b, const ob_view *v, int height, ob_draw_filter filter,
		       const void *context)
{
	if (b->count > out->capacity) {
		if (!OB_GROW(out->instance, b->count))
			return false;
		out->capacity = b->count;
	}
	if (!expect_meshes(out, OB_MESHES + b->now->hulls + b->meshes))
		return false;
	uint32_t *mesh = malloc((b->count + 1) * sizeof *mesh), *count = calloc(out->meshes + 1, sizeof *count);
	for (uint32_t i = 0; mesh && count && i < b->count; i++) {
		const ob_draw_item *body = &b->body[i];
		bool taken = filter(body, context);
		mesh[i] = taken ? mesh_of(b, &b->now->passport[body->id], body, v, height, out->exact) : out->meshes;
		count[mesh[i]]++;
	}
	out->first[0] = 0;
	for (uint32_t k = 0; count && k < out->meshes; k++) {
		out->first[k + 1] = out->first[k] + count[k];
		count[k] = out->first[k];
	}
	for (uint32_t i = 0; mesh && count && i < b->count; i++)
		if (mesh[i] < out->meshes)
			out->instance[count[mesh[i]]++] = (out->exact ? exact_instance_of : instance_of)(
				b, &b->body[i], v->eye, mesh[i] >= OB_MESHES + b->now->hulls);
	const bool fine = mesh && count;
	free(mesh);
	free(count);
	return fine;
}

void ob_instances_finish(ob_instances *i)
{
	free(i->instance);
	free(i->first);
	*i = (ob_instances){ 0 };
}

// ---- overlays

static const float awake[4] = { 1, .86f, .25f, 1 }, flying[4] = { .45f, .95f, 1, 1 };
static const float asleep[4] = { .62f, .66f, .74f, 1 }, fixed[4] = { .35f, .37f, .42f, 1 };
static const float rim[4] = { .08f, .02f, .05f, .85f }, dot_colour[4] = { 1, .30f, .20f, 1 };
static const float normal_colour[4] = { 1, .95f, .55f, 1 };
static const float joint_colour[4] = { .35f, .85f, 1, 1 }, axis_colour[4] = { 1, .45f, .9f, 1 };
static const float reading_colour[4] = { 1, .42f, .7f, .9f };
static const float edge_px = 1.5f, dot_px = 6, rim_px = 8.5f, normal_px = 2, reading_px = 2;
static const double normal_length_px = 26;

static bool reserve_segments(ob_overlay *o, size_t count)
{
	o->count = 0;
	return OB_RESERVE(o->segment, count, o->capacity);
}

static void add_segment(ob_overlay *o, ob_vec3 from, ob_vec3 to, const float colour[4], float width)
{
	ob_segment *s = &o->segment[o->count++];
	*s = (ob_segment){ .from = { (float)from.x, (float)from.y, (float)from.z },
			   .to = { (float)to.x, (float)to.y, (float)to.z },
			   .width = width };
	for (int k = 0; k < 4; k++)
		s->colour[k] = colour[k];
}

static const float *colour_of(const ob_passport *p, const ob_motion *m)
{
	if (p->flags & OB_OBJECT_PRESCRIBED)
		return fixed;
	if (m->flags & OB_MOTION_ASLEEP)
		return asleep;
	return m->flags & OB_MOTION_FREE ? flying : awake;
}

static ob_vec3 corner(const double bounds[6], int which, ob_vec3 eye)
{
	return ob_v3(bounds[which & 1 ? 3 : 0] - eye.x, bounds[which & 2 ? 4 : 1] - eye.y,
		     bounds[which & 4 ? 5 : 2] - eye.z);
}

bool ob_overlay_boxes(ob_overlay *o, const ob_draw_list *b, const ob_view *v)
{
	if (!reserve_segments(o, 12 * (size_t)b->count))
		return false;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_draw_item *body = &b->body[i];
		const ob_passport *p = &b->now->passport[body->id];
		if (!ob_view_in_frustum(v, body->pose.p, 2 * body->radius))
			continue;
		double bounds[6];
		const ob_hull *hull = ob_snapshot_hull(b->now, body->id);
		if (hull)
			ob_hull_bounds(hull, body->pose, bounds);
		else
			ob_shape_bounds(p->shape, p->size, body->pose, bounds);
		for (int from = 0; from < 8; from++)
			for (int axis = 1; axis <= 4; axis *= 2)
				if (!(from & axis))
					add_segment(o, corner(bounds, from, v->eye),
						    corner(bounds, from | axis, v->eye),
						    colour_of(p, &b->now->motion[body->id]), edge_px);
	}
	return true;
}

bool ob_overlay_contacts(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height)
{
	if (!reserve_segments(o, 3 * s->contacts))
		return false;
	double metres_per_px = 2 * v->tan_y / height; // at a distance of 1 m
	for (size_t i = 0; i < s->contacts; i++) {
		ob_vec3 at = ob_sub(s->contact[i].position, v->eye);
		double length = normal_length_px * metres_per_px * ob_norm(at);
		ob_vec3 tip = ob_madd(at, length, s->contact[i].normal);
		add_segment(o, at, tip, normal_colour, normal_px);
		add_segment(o, at, at, rim, rim_px);
		add_segment(o, at, at, dot_colour, dot_px);
	}
	return true;
}

// A body's way along x: bodies are sorted by its begin, and those that overlap follow each other.
typedef struct span {
	float low, high; // m
	uint32_t body;
} span;

static int by_begin(const void *a, const void *b)
{
	const span *x = a, *y = b;
	return x->low != y->low ? (x->low > y->low) - (x->low < y->low) : (x->body > y->body) - (x->body < y->body);
}

// Spans of the bodies with bounds. They are not planes, whose bounds would overlap all.
static uint32_t list_spans(span *to, const ob_draw_list *b)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < b->count; i++) {
		const float *bounds = b->now->bounds[b->body[i].id];
		if (!isnan(bounds[0]))
			to[n++] = (span){ bounds[0], bounds[3], i };
	}
	qsort(to, n, sizeof *to, by_begin);
	return n;
}

static bool names(const ob_draw_list *b, uint32_t body, const char *name)
{
	return !*name || strncmp(b->now->passport[b->body[body].id].name, name, OB_NAME_MAX) == 0;
}

// True if one of the two is moved by forces: others read nothing.
static bool reads(const ob_draw_list *b, uint32_t x, uint32_t y)
{
	const float *one = b->now->bounds[b->body[x].id], *other = b->now->bounds[b->body[y].id];
	const ob_passport *p = &b->now->passport[b->body[x].id], *q = &b->now->passport[b->body[y].id];
	return !(p->flags & OB_OBJECT_PRESCRIBED && q->flags & OB_OBJECT_PRESCRIBED) && one[1] <= other[4] &&
	       other[1] <= one[4] && one[2] <= other[5] && other[2] <= one[5];
}

bool ob_overlay_reads(ob_overlay *o, const ob_draw_list *b, const ob_view *v, const char *reader)
{
	span *s = malloc((b->count + 1) * sizeof *s);
	bool fine = s;
	const uint32_t n = fine ? list_spans(s, b) : 0;
	o->count = 0;
	for (uint32_t i = 0; i < n && fine; i++)
		for (uint32_t k = i + 1; k < n && s[k].low <= s[i].high && fine; k++) {
			const uint32_t x = s[i].body, y = s[k].body;
			if ((!names(b, x, reader) && !names(b, y, reader)) || !reads(b, x, y))
				continue;
			fine = OB_MAKE_ROOM(o->segment, o->count, o->capacity);
			if (fine)
				add_segment(o, ob_sub(b->body[x].pose.p, v->eye), ob_sub(b->body[y].pose.p, v->eye),
					    reading_colour, reading_px);
		}
	free(s);
	return fine;
}

// Place of a joint's end, relative to the eye, and of the centre of its object.
static ob_vec3 joint_end(const ob_snapshot *s, const ob_joint_passport *j, int side, ob_vec3 eye, ob_vec3 *centre,
			 ob_vec3 *axis)
{
	const uint32_t id = j->object[side];
	const bool world = id == OB_JOINT_WORLD || id >= s->count;
	const ob_pose at = world ? (ob_pose){ { 0, 0, 0 }, ob_quat_identity() } : ob_snapshot_state(s, id).pose;
	const ob_mat3 r = ob_quat_matrix(at.q), axes = ob_quat_matrix(ob_quat_mul(at.q, j->frame[side].q));
	const ob_vec3 end = ob_sub(ob_add(at.p, ob_rotate(&r, j->frame[side].p)), eye);
	*centre = world ? end : ob_sub(at.p, eye);
	*axis = ob_column(&axes, 2);
	return end;
}

bool ob_overlay_joints(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height)
{
	if (!reserve_segments(o, 6 * (size_t)s->joints))
		return false;
	const double metres_per_px = 2 * v->tan_y / height; // at a distance of 1 m
	for (uint32_t i = 0; i < s->joints; i++) {
		const ob_joint_passport *j = &s->joint[i];
		ob_vec3 centre[2], axis[2], end[2];
		if (!ob_snapshot_has_joint(s, i) || j->flags & OB_JOINT_BROKEN || j->kind == OB_JOINT_APART)
			continue;
		for (int side = 0; side < 2; side++)
			end[side] = joint_end(s, j, side, v->eye, &centre[side], &axis[side]);
		for (int side = 0; side < 2; side++)
			add_segment(o, centre[side], end[side], joint_colour, edge_px);
		add_segment(o, end[0], end[1], joint_colour, edge_px);
		const double length = normal_length_px * metres_per_px * ob_norm(end[1]);
		if (j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_SLIDER)
			add_segment(o, ob_madd(end[1], -length, axis[1]), ob_madd(end[1], length, axis[1]), axis_colour,
				    normal_px);
		add_segment(o, end[1], end[1], rim, rim_px);
		add_segment(o, end[1], end[1], joint_colour, dot_px);
	}
	return true;
}

void ob_overlay_finish(ob_overlay *o)
{
	free(o->segment);
	*o = (ob_overlay){ 0 };
}
