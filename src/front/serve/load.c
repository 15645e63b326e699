// Loader of the server: loads the part that calls libwebsockets.
#include "serve/part.h"

#define PACKAGE "libwebsockets17"

bool ob_serve_check(ob_error *e)
{
	return ob_part_check("serve", PACKAGE, e);
}

ob_server *ob_server_start(const ob_server_config *c, ob_host *const *h, uint32_t hosts, ob_pace *pace, ob_error *e)
{
	const ob_serve_part *part = ob_part_load("serve", sizeof *part, OB_PART_PROGRAM, PACKAGE, e);
	ob_server *s = part ? part->start(c, h, hosts, pace, e) : NULL;
	if (s)
		((ob_server_base *)s)->part = part;
	return s;
}

const char *ob_server_url(const ob_server *s, ob_role role)
{
	return ((const ob_server_base *)s)->part->url(s, role);
}

void ob_server_tell(ob_server *s, ob_message *m)
{
	((ob_server_base *)s)->part->tell(s, m);
}

void ob_server_hold(ob_server *s)
{
	((ob_server_base *)s)->part->hold(s);
}

bool ob_server_go_on(ob_server *s, const ob_scene *scene, ob_host *const *h, ob_error *e)
{
	return ((ob_server_base *)s)->part->go_on(s, scene, h, e);
}

void ob_server_stop(ob_server *s)
{
	if (s)
		((ob_server_base *)s)->part->stop(s);
}
