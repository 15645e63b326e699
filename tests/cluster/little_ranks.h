// Several ranks for tests, each a thread: they exchange messages by an ob_peers whose wire is a little_wire.
#ifndef OB_TESTS_CLUSTER_LITTLE_RANKS_H
#define OB_TESTS_CLUSTER_LITTLE_RANKS_H

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/peers.h"

enum { LITTLE_RANKS = 3 };

// Messages of a round, by sender: one to each rank.
typedef struct little_exchange {
	pthread_barrier_t together;
	const void *said[LITTLE_RANKS][LITTLE_RANKS];
	size_t bytes[LITTLE_RANKS][LITTLE_RANKS];
} little_exchange;

typedef struct little_wire {
	little_exchange *x;
	uint32_t rank;
	char *heard; // free() it
	size_t at[LITTLE_RANKS + 1];
} little_wire;

static inline void little_exchange_open(little_exchange *x)
{
	memset(x, 0, sizeof *x);
	pthread_barrier_init(&x->together, NULL, LITTLE_RANKS);
}

static inline void little_exchange_close(little_exchange *x)
{
	pthread_barrier_destroy(&x->together);
}

// Barrier of all ranks.
static inline void little_meet(little_wire *w)
{
	pthread_barrier_wait(&w->x->together);
}

static inline const char *little_deal(void *wire, const void *const *mine, const size_t *bytes, const size_t **at)
{
	little_wire *w = wire;
	memcpy(w->x->said[w->rank], mine, sizeof w->x->said[0]);
	memcpy(w->x->bytes[w->rank], bytes, sizeof w->x->bytes[0]);
	*at = w->at;
	little_meet(w);
	for (uint32_t from = 0; from < LITTLE_RANKS; from++)
		w->at[from + 1] = w->at[from] + w->x->bytes[from][w->rank];
	free(w->heard);
	w->heard = malloc(w->at[LITTLE_RANKS]);
	for (uint32_t from = 0; w->heard && from < LITTLE_RANKS; from++)
		memcpy(w->heard + w->at[from], w->x->said[from][w->rank], w->x->bytes[from][w->rank]);
	little_meet(w);
	return w->heard;
}

static inline const char *little_gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	const void *same[LITTLE_RANKS];
	size_t bytes[LITTLE_RANKS];
	for (uint32_t r = 0; r < LITTLE_RANKS; r++)
		same[r] = mine, bytes[r] = n;
	return little_deal(wire, same, bytes, at);
}

static inline ob_peers little_peers(little_wire *w)
{
	return (ob_peers){
		.rank = w->rank, .ranks = LITTLE_RANKS, .gather = little_gather, .deal = little_deal, .wire = w
	};
}

#endif
