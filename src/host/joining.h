// Joints that come, go and are driven while a universe runs: requests, and posts of scripts.
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

// Finds an object of the universe by its name, as it is now (ob_scene_options.find); any thread, any program.
bool ob_joined_find(void *universe, const char *name, ob_joined *out);
// Completes a request to a joint that holds by its name: its number, and its first object. false and e: there is none.
// Likewise.
bool ob_joint_request_find(const ob_universe *u, const char *name, ob_request *r, ob_error *e);
// Request for a joint that was read so.
void ob_joint_request_make(ob_request *r, const ob_joint_passport *j);
bool ob_joint_request_check(const ob_universe *u, const ob_request *r, ob_error *e);
// Carries out a request that was valid when it came; warns if it is not any more.
void ob_joint_request_carry_out(ob_universe *u, const ob_request *r);
// Carries out a post of a kind of joints'. It is not trusted; one of a joint or an object that has gone is left out. false: it
// makes no sense, or there is no room.
bool ob_joint_post_carry_out(ob_universe *u, const ob_script_post *post, ob_error *e);

#endif
