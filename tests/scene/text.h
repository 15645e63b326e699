// Scenes from text: tests say what they need in place.
#ifndef OB_TESTS_SCENE_TEXT_H
#define OB_TESTS_SCENE_TEXT_H

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "scene/scene.h"

// As ob_scene_load from a file of these bytes.
static inline ob_scene *load_bytes(const char *bytes, size_t size, const ob_scene_options *o, ob_error *e)
{
	char path[64];
	int fd = memfd_create("scene.lua", 0);
	ob_scene *s = NULL;
	if (fd >= 0 && write(fd, bytes, size) == (ssize_t)size) {
		snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
		s = ob_scene_load(path, o, e);
	}
	close(fd);
	return s;
}

static inline ob_scene *load_text(const char *text, ob_error *e)
{
	return load_bytes(text, strlen(text), NULL, e);
}

// Loads a scene that must be valid; errors go to standard error.
static inline ob_scene *load_good(const char *text)
{
	ob_error e = { "" };
	ob_scene *s = load_text(text, &e);
	if (!s)
		fprintf(stderr, "%s\n", e.text);
	return s;
}

#endif
