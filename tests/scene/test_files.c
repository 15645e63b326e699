// Files that cannot be read, and such that begin in an unusual way.
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "check.h"
#include "text.h"

static void check_refused(const char *path, const char *expected)
{
	ob_error e = { "" };
	CHECK(!ob_scene_load(path, NULL, &e));
	CHECK(strncmp(e.text, path, strlen(path)) == 0 && strstr(e.text, expected));
	if (!strstr(e.text, expected))
		fprintf(stderr, "  got %s\n", e.text);
}

static void check_unreadable(void)
{
	char path[] = "/tmp/obsim-test-XXXXXX";
	int fd = mkstemp(path);
	CHECK(fd >= 0 && fchmod(fd, 0) == 0);
	close(fd);
	if (geteuid() != 0) // root reads everything
		check_refused(path, "cannot read the scene: Permission denied");
	unlink(path);
}

static void check_large(void)
{
	char path[] = "/tmp/obsim-test-XXXXXX";
	int fd = mkstemp(path);
	CHECK(fd >= 0 && ftruncate(fd, (4 << 20) + 1) == 0);
	close(fd);
	check_refused(path, "larger than 4 MiB");
	unlink(path);
}

static void check_text_refused(const char *text, size_t size, const char *expected)
{
	ob_error e = { "" };
	CHECK(!load_bytes(text, size, NULL, &e));
	CHECK(strstr(e.text, expected));
	if (!strstr(e.text, expected))
		fprintf(stderr, "  got %s\n", e.text);
}

int main(void)
{
	check_refused("/nonexistent/scene.lua", "cannot read the scene: No such file or directory");
	check_refused("/tmp", "cannot read the scene: it is no file, but a directory");
	check_refused("/dev/zero", "it is no file, but a pipe or a device");
	check_unreadable();
	check_large();
	check_text_refused("", 0, ":1: expected at least one object");
	check_text_refused("\x1bLua\x54\x00", 6, ":1: expected Lua text, got compiled Lua");
	check_text_refused("\0\0\0\0", 4, ":1: ");
	check_text_refused("#!/usr/bin/obsim\nbox {}", 23, ":2: box.size: expected");
	ob_scene *s = load_good("\xef\xbb\xbf#!/usr/bin/obsim run\nsphere { radius = 1 }");
	CHECK(s && s->objects == 1);
	ob_scene_free(s);
	s = load_good("\xef\xbb\xbfsphere { radius = 1, name = 'W\xc3\xbcrfel' }");
	CHECK(s && strcmp(s->object[0].passport.name, "W\xc3\xbcrfel") == 0);
	ob_scene_free(s);
	ob_scene_free(NULL);
	CHECK(!ob_scene_load("/nonexistent", NULL, NULL));
	return check_end();
}
