// Built without libwebsockets: obsim serve says so.
#include "serve/serve.h"

ob_server *ob_server_start(const ob_server_config *c, ob_host *h, ob_pace *pace, ob_error *e)
{
	ob_fail(e, "this obsim was built without libwebsockets (Debian: libwebsockets-dev), which serve needs");
	return NULL;
}

const char *ob_server_url(const ob_server *s)
{
	return "";
}

void ob_server_stop(ob_server *s) {}
