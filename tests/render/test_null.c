// Without EGL: a clear error instead of frames.
#include <string.h>

#include "../check.h"
#include "render/render.h"

int main(void)
{
	ob_render_setup setup = { .width = 64, .height = 64, .samples = 4 };
	ob_look_def look = { 0 };
	ob_error e = { "" };
	CHECK(!ob_render_available());
	CHECK(ob_renderer_create(&setup, &look, &e) == NULL);
	CHECK(strstr(e.text, "without EGL") != NULL);
	e.text[0] = 0;
	CHECK(!ob_renderer_draw(NULL, NULL, NULL, 0, NULL, NULL, &e));
	CHECK(strstr(e.text, "without EGL") != NULL);
	ob_renderer_destroy(NULL);
	return check_end();
}
