// Requests of viewers: a JSON object each, as {"do": "create", "shape": "box", "size": [.5, .5, .5], "at": [0, 0, 3]}. "do" is a
// command of the table of requests (host/request_table.h), the other members are its fields there, and what names its target:
// id and generation of an object, name of a joint. Numbers of a field are a list, or alone if it has one.
//
// Other members are errors, and no byte is trusted. Pure; any thread.
#ifndef OB_SERVE_COMMAND_H
#define OB_SERVE_COMMAND_H

#include "host/request.h"

enum { OB_COMMAND_REQUESTS = 5 };

typedef struct ob_command {
	uint32_t requests; // 0: it was invalid
	// [requests] to the host, in this order, with origin 0; or one of ob_look_kind. To a joint: its name is in values
	ob_request request[OB_COMMAND_REQUESTS];
} ob_command;

enum { OB_COMMAND_BYTES_MAX = 2048 };

// false and e, for the viewer, if it is invalid.
bool ob_command_read(ob_command *c, const char *json, size_t size, ob_error *e);

#endif
