#include "host/given_paths.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "scene/object_limits.h"

// Index of the path of an object, or where it would be.
static uint32_t index_of(const ob_given_paths *p, uint32_t id)
{
	uint32_t low = 0, high = p->count;
	while (low < high) {
		const uint32_t middle = low + (high - low) / 2;
		if (p->at[middle].id < id)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool has(const ob_given_paths *p, uint32_t index, uint32_t id)
{
	return index < p->count && p->at[index].id == id;
}

static bool reserve(ob_given_paths *p, uint32_t count, uint32_t points)
{
	if (count > OB_GIVEN_PATHS_MAX || points > OB_GIVEN_POINTS_MAX)
		return false;
	if (!OB_RESERVE(p->at, count, p->room))
		return false;
	if (points > p->point_room) {
		if (!OB_GROW(p->point, 2 * (size_t)points))
			return false;
		p->point_room = 2 * points;
	}
	return true;
}

void ob_given_paths_drop(ob_given_paths *p, uint32_t id)
{
	const uint32_t i = index_of(p, id);
	if (!has(p, i, id))
		return;
	const ob_given_path gone = p->at[i];
	const uint32_t end = gone.first + gone.points;
	memmove(p->point + gone.first, p->point + end, (p->points - end) * sizeof *p->point);
	memmove(p->at + i, p->at + i + 1, (--p->count - i) * sizeof *p->at);
	p->points -= gone.points;
	for (uint32_t k = 0; k < p->count; k++)
		if (p->at[k].first > gone.first)
			p->at[k].first -= gone.points;
}

// Makes the path of a request: from where the object is now through the request's points. point: memory for them.
static ob_path requested_path(const ob_request_path *r, const ob_state *now, ob_path_point point[OB_REQUEST_POINTS + 1])
{
	const uint32_t more = r->points < OB_REQUEST_POINTS ? r->points : OB_REQUEST_POINTS;
	point[0] = (ob_path_point){ 0, now->pose.p, now->pose.q };
	memcpy(point + 1, r->point, more * sizeof *point);
	return (ob_path){ .points = more + 1, .loop = r->loop, .turns = r->turns, .point = point };
}

bool ob_given_path_check(const ob_request_path *r, const ob_passport *pass, const ob_state *now, double step_length,
			 ob_error *e)
{
	ob_path_point point[OB_REQUEST_POINTS + 1];
	const ob_path path = requested_path(r, now, point);
	if (!(pass->flags & OB_OBJECT_KINEMATIC) || pass->flags & OB_OBJECT_STATIC)
		return ob_fail(e, "path: expected a kinematic object, and object %u (%.*s) is none", pass->id,
			       OB_NAME_MAX, pass->name);
	if (r->points > OB_REQUEST_POINTS || r->loop > 1 || r->turns > 1)
		return ob_fail(e, "path: expected at most %d points at once, got %u", OB_REQUEST_POINTS, r->points);
	return ob_path_check(&path, step_length, e);
}

bool ob_given_paths_ask(ob_given_paths *p, uint32_t id, uint32_t born, const ob_request_path *r, const ob_state *now)
{
	ob_path_point point[OB_REQUEST_POINTS + 1];
	const ob_path all = requested_path(r, now, point), *path = &all;
	ob_given_paths_drop(p, id);
	if (!reserve(p, p->count + 1, p->points + path->points))
		return false;
	const uint32_t i = index_of(p, id);
	memmove(p->at + i + 1, p->at + i, (p->count++ - i) * sizeof *p->at);
	p->at[i] = (ob_given_path){ .id = id,
				    .born = born,
				    .first = p->points,
				    .points = path->points,
				    .loop = path->loop,
				    .turns = path->turns };
	memcpy(p->point + p->points, path->point, path->points * sizeof *path->point);
	p->points += path->points;
	return true;
}

static ob_path path_at(const ob_given_paths *p, const ob_given_path *at)
{
	return (ob_path){ .points = at->points, .loop = at->loop, .turns = at->turns, .point = p->point + at->first };
}

bool ob_given_paths_check(const ob_given_paths *p, uint64_t step, double step_length, ob_error *e)
{
	ob_error why;
	for (uint32_t i = 0; i < p->count; i++) {
		const ob_given_path *at = &p->at[i];
		const bool fits = at->first <= p->points && at->points <= p->points - at->first && at->loop <= 1 &&
				  at->turns <= 1 && at->born <= step && (i == 0 || at->id > at[-1].id);
		if (!fits)
			return ob_fail(e, "path %u makes no sense", i);
		const ob_path path = path_at(p, at);
		if (!ob_path_check(&path, step_length, &why))
			return ob_fail(e, "path %u: %s", i, why.text);
	}
	return true;
}

bool ob_given_paths_find(const ob_given_paths *p, uint32_t id, ob_path *path, uint32_t *born)
{
	const uint32_t i = index_of(p, id);
	if (!has(p, i, id))
		return false;
	*path = path_at(p, &p->at[i]);
	*born = p->at[i].born;
	return true;
}

bool ob_given_paths_copy(ob_given_paths *to, const ob_given_paths *from)
{
	if (!reserve(to, from->count, from->points))
		return false;
	if (from->count) {
		memcpy(to->at, from->at, from->count * sizeof *to->at);
		memcpy(to->point, from->point, from->points * sizeof *to->point);
	}
	to->count = from->count;
	to->points = from->points;
	return true;
}

void ob_given_paths_finish(ob_given_paths *p)
{
	free(p->at);
	free(p->point);
	*p = (ob_given_paths){ 0 };
}
