#include "ranks/ranks.h"

#include <dlfcn.h>
#include <stdlib.h>

#include "ranks/module.h"

struct ob_wire {
	void *library;
	const ob_wire_module *module;
	uint32_t ranks;
	size_t *at; // [ranks + 1]
	char *all;
	size_t max;
};

// otherwise: the environment does not say
static uint32_t number(const char *name, uint32_t otherwise)
{
	const char *text = getenv(name);
	return text ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

ob_ranks ob_ranks_started(void)
{
	const uint32_t ranks = number("OMPI_COMM_WORLD_SIZE", 1), rank = number("OMPI_COMM_WORLD_RANK", 0);
	return rank < ranks ? (ob_ranks){ rank, ranks } : (ob_ranks){ 0, 1 };
}

static bool load(ob_wire *w, ob_error *e)
{
	w->library =
		dlopen(OB_WIRE_MODULE, RTLD_NOW | RTLD_GLOBAL); // global: MPI loads parts of itself, which look for it
	if (!w->library)
		return ob_fail(e,
			       "several ranks need MPI: %s; install libopenmpi3, and an obsim that was built with it",
			       dlerror());
	w->module = dlsym(w->library, OB_WIRE_MODULE_ENTRY);
	return w->module || ob_fail(e, "%s is another obsim's: %s", OB_WIRE_MODULE, dlerror());
}

ob_wire *ob_wire_open(const ob_ranks *ranks, ob_error *e)
{
	uint32_t rank, all;
	ob_wire *w = calloc(1, sizeof *w);
	if (w)
		w->at = calloc(ranks->ranks + 1, sizeof *w->at);
	if (!w || !w->at) {
		free(w);
		ob_fail(e, "out of memory");
		return NULL;
	}
	w->ranks = ranks->ranks;
	if (!load(w, e) || (!w->module->open(&rank, &all) && !ob_fail(e, "MPI does not start"))) {
		free(w->at);
		free(w);
		return NULL;
	}
	if (rank == ranks->rank && all == ranks->ranks)
		return w;
	ob_fail(e, "the launcher has said rank %u of %u, MPI says %u of %u", ranks->rank, ranks->ranks, rank, all);
	ob_wire_close(w);
	return NULL;
}

const char *ob_wire_gather(ob_wire *w, const void *mine, size_t n, const size_t **at)
{
	w->module->sizes(n, w->at + 1);
	for (uint32_t r = 0; r < w->ranks; r++)
		w->at[r + 1] += w->at[r];
	if (w->at[w->ranks] > w->max) {
		const size_t max = 2 * w->at[w->ranks];
		char *larger = realloc(w->all, max);
		if (!larger)
			return NULL;
		w->all = larger;
		w->max = max;
	}
	w->module->bytes(mine, w->all, w->at);
	*at = w->at;
	return w->all;
}

void ob_wire_close(ob_wire *w)
{
	if (!w)
		return;
	w->module->close();
	free(w->at);
	free(w->all);
	free(w);
}
