// Requests of any thread to a run.
#include "host/host_state.h"
#include "scene/object_limits.h"

static bool request(ob_host *h, const ob_request *r)
{
	if (!ob_requests_push(h->requests, r))
		return false;
	ob_host_pause_early(h);
	return true;
}

bool ob_host_request_add(ob_host *h, const ob_object_def *def, ob_error *e)
{
	return ob_object_check(def, e) &&
	       (request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = *def }) || ob_fail(e, "out of memory"));
}

bool ob_host_request(ob_host *h, const ob_request *r, ob_error *e)
{
	return (r->kind != OB_REQUEST_ADD || ob_object_check(&r->def, e)) &&
	       (request(h, r) || ob_fail(e, "out of memory"));
}

bool ob_host_request_remove(ob_host *h, uint32_t id, uint32_t generation)
{
	return request(h, &(ob_request){ .kind = OB_REQUEST_REMOVE, .id = id, .generation = generation });
}
