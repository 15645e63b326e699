// The part of obsim that serves by libwebsockets (base/part.h): obsim-serve.so. Its functions are those of serve.h.
#ifndef OB_SERVE_PART_H
#define OB_SERVE_PART_H

#include "base/part.h"
#include "serve/serve.h"

typedef struct ob_serve_part {
	ob_part_head head;
	ob_server *(*start)(const ob_server_config *c, ob_host *const *h, uint32_t hosts, ob_pace *pace, ob_error *e);
	const char *(*url)(const ob_server *s, ob_role role);
	void (*tell)(ob_server *s, ob_message *m);
	void (*hold)(ob_server *s);
	bool (*go_on)(ob_server *s, const ob_scene *scene, ob_host *const *h, ob_error *e);
	void (*stop)(ob_server *s);
} ob_serve_part;

// First member of each server.
typedef struct ob_server_base {
	const ob_serve_part *part;
} ob_server_base;

#endif
