// Objects and joints that come while a universe runs, joints that go and are driven: requests, and posts of scripts.
//
// Thread-safety: the host's, while the universe is paused; checks by any thread of the host.
#ifndef OB_HOST_JOINING_H
#define OB_HOST_JOINING_H

#include "host/request.h"
#include "table/table.h"

static inline bool ob_is_joint_request(const ob_request *r)
{
	return r->kind == OB_REQUEST_MOTOR || r->kind == OB_REQUEST_JOIN || r->kind == OB_REQUEST_UNJOIN;
}

// Completes a request to a joint that holds by its name: its number, and its first object. false and e: there is none. Any
// thread, any program.
bool ob_joint_request_find(const ob_universe *u, const char *name, ob_request *r, ob_error *e);
// Asks for each object and each joint of a text, which is written as a scene is, until one is refused. Likewise.
bool ob_create_as_scene(ob_universe *u, const char *text, size_t bytes, uint32_t origin,
			bool (*ask)(void *with, ob_request *r, ob_error *e), void *with, ob_error *e);
bool ob_joint_request_check(const ob_universe *u, const ob_request *r, ob_error *e);
// Carries out a request that is valid now; warns if there is no room.
void ob_joint_request_carry_out(ob_universe *u, const ob_request *r);
// Carries out a post of a kind of joints'. It is not trusted; one of a joint or an object that has gone is left out. false: it
// makes no sense, or there is no room.
bool ob_joint_post_carry_out(ob_universe *u, const ob_script_post *post, ob_error *e);

#endif
