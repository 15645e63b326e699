#include "host/request.h"

#include <stdlib.h>
#include <urcu/wfcqueue.h>

#include "host/rcu_tsan.h"

typedef struct queued_request {
	struct cds_wfcq_node node;
	ob_request request;
} queued_request;

struct ob_requests {
	struct cds_wfcq_head head;
	struct cds_wfcq_tail tail;
};

ob_requests *ob_requests_create(void)
{
	ob_requests *q = calloc(1, sizeof *q);
	if (q)
		cds_wfcq_init(&q->head, &q->tail);
	return q;
}

void ob_requests_destroy(ob_requests *q)
{
	ob_request dropped;
	if (!q)
		return;
	while (ob_requests_take(q, &dropped))
		;
	cds_wfcq_destroy(&q->head, &q->tail);
	free(q);
}

bool ob_requests_push(ob_requests *q, const ob_request *r)
{
	queued_request *e = malloc(sizeof *e);
	if (!e)
		return false;
	e->request = *r;
	cds_wfcq_node_init(&e->node);
	OB_ORDER_BEFORE(e);
	cds_wfcq_enqueue(&q->head, &q->tail, &e->node);
	return true;
}

bool ob_requests_take(ob_requests *q, ob_request *out)
{
	// there is one consumer only, so the queue's lock is not needed
	struct cds_wfcq_node *node = __cds_wfcq_dequeue_blocking(&q->head, &q->tail);
	if (!node)
		return false;
	queued_request *e = caa_container_of(node, queued_request, node);
	OB_ORDER_AFTER(e);
	*out = e->request;
	free(e);
	return true;
}

bool ob_requests_waiting(ob_requests *q)
{
	return !cds_wfcq_empty(&q->head, &q->tail);
}
