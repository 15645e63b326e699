#include "schedule/involved.h"

#include "table/forest.h"

ob_involved ob_involved_begin(ob_universe *u, bool merges)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	return (ob_involved){ .u = u,
			      .data = data,
			      .ids = ids,
			      .body = data->scratch,
			      .place = data->scratch + ids,
			      .parent = data->scratch + 2 * (size_t)ids,
			      .island_of = data->scratch + 3 * (size_t)ids,
			      .merges = merges,
			      .alone = ob_universe_ranks(u) < 2,
			      .step = ob_step_count(u) };
}

ob_involved ob_involved_all(ob_universe *u)
{
	const struct ob_step_counts *count = ob_universe_step_data(u)->count;
	ob_involved p = ob_involved_begin(u, count->merged);
	p.bodies = count->involved < p.ids ? count->involved : p.ids;
	return p;
}

static bool is_involved(const ob_involved *p, uint32_t id)
{
	const uint32_t i = p->place[id];
	return i < p->bodies && p->body[i] == id;
}

void ob_involve_again(ob_involved *p, uint32_t id)
{
	if (is_involved(p, id) || p->bodies == p->ids)
		return;
	p->place[id] = p->bodies;
	p->body[p->bodies++] = id;
	p->parent[id] = id;
}

void ob_involve_joined(ob_involved *p, uint32_t a, uint32_t b)
{
	ob_involve_again(p, a);
	ob_involve_again(p, b);
	ob_forest_join(p->parent, a, b);
}

uint32_t ob_involved_roots(const ob_involved *p)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < p->bodies; i++) {
		const uint32_t id = p->body[i];
		p->parent[id] = ob_forest_root(p->parent, id);
		n += p->parent[id] == id;
	}
	return n;
}

void ob_involve_due(ob_universe *u, uint32_t id)
{
	struct ob_step_counts *count = ob_universe_step_data(u)->count;
	const ob_involved p = ob_involved_begin(u, false);
	ob_involve(&p, id);
	count->due = count->involved;
}

uint32_t ob_involved_bodies(ob_universe *u, const uint32_t **body, const uint32_t **root)
{
	const ob_involved p = ob_involved_all(u);
	ob_involved_roots(&p);
	*body = p.body;
	*root = p.parent;
	return p.bodies;
}

void ob_involved_drop(ob_universe *u, const uint8_t *leaves)
{
	const ob_involved p = ob_involved_all(u);
	uint32_t n = 0;
	for (uint32_t i = 0; i < p.bodies; i++) {
		const uint32_t id = p.body[i];
		if (leaves[ob_forest_root(p.parent, id)]) {
			p.data->result_island[id] = UINT32_MAX;
			continue;
		}
		p.place[id] = n;
		p.body[n++] = id;
	}
	p.data->count->involved = n;
}

void ob_involved_join(ob_universe *u, uint32_t a, uint32_t b)
{
	ob_involved p = ob_involved_all(u);
	if (p.merges) {
		ob_involve_joined(&p, a, b);
		p.data->count->involved = p.bodies;
		return;
	}
	ob_involve(&p, a);
	ob_involve(&p, b);
	ob_forest_join(p.parent, a, b);
}
