// Roles: permissions of visitors of a universe, whichever way the request comes: the socket of `obsim send` and of programs
// that control a run, the page, or a script that talks to the server.
//
//   watch       reads: objects, motions, contacts, figures
//   take part   also creates objects, removes those of its own, sends messages, drags and pushes
//   operate     also pauses, edits, removes, kills simulators, and puts the universe back
//
// Users of the same name as the run's operate. The server decides for others (serve/serve.h); the socket refuses them.
// Pure; any thread.
#ifndef OB_HOST_ROLE_H
#define OB_HOST_ROLE_H

#include <stdbool.h>

#include <ob/error.h>

typedef enum ob_role {
	OB_ROLE_WATCH,
	OB_ROLE_TAKE_PART,
	OB_ROLE_OPERATE,
	OB_ROLES
} ob_role; // each includes those before

const char *ob_role_name(ob_role role); // "watch", "take part", "operate"
// False and e, for the visitor, if its role does not include the one needed.
bool ob_role_check(ob_role role, ob_role needed, ob_error *e);

#endif
