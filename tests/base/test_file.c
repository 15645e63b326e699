// Files from untrusted sources: anything but a regular file, or a larger one than allowed, is refused at once, without
// waiting.
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "check.h"

static char folder[] = "/tmp/obsim-test-file-XXXXXX";

static const char *in_folder(const char *name)
{
	static char path[64];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void put(const char *name, const char *text)
{
	FILE *f = fopen(in_folder(name), "w");
	CHECK(f && fputs(text, f) >= 0 && fclose(f) == 0);
}

static void refuse(const char *path, size_t most, const char *saying)
{
	ob_error e = { "" };
	size_t size = 0;
	CHECK(!ob_file_load(path, most, &size, &e));
	CHECK(strstr(e.text, saying));
}

int main(void)
{
	ob_error e = { "" };
	size_t size = 0;
	CHECK(mkdtemp(folder));
	put("text", "seven");
	char *text = ob_file_load(in_folder("text"), 5, &size, &e);
	CHECK(text && size == 5 && strcmp(text, "seven") == 0);
	free(text);
	refuse(in_folder("text"), 4, "larger than 0 KiB");
	put("empty", "");
	text = ob_file_load(in_folder("empty"), 0, &size, &e);
	CHECK(text && size == 0 && text[0] == 0);
	free(text);

	CHECK(truncate(in_folder("empty"), (off_t)1 << 40) == 0); // all of it a hole
	refuse(in_folder("empty"), 4 << 20, "larger than 4 MiB");
	CHECK(mkfifo(in_folder("pipe"), 0600) == 0);
	refuse(in_folder("pipe"), 1 << 20, "no file, but a pipe or a device");
	CHECK(chdir(folder) == 0 && symlink("pipe", "link") == 0 && symlink("nothing", "dangling") == 0 &&
	      symlink("round", "round") == 0);
	refuse(in_folder("link"), 1 << 20, "no file, but a pipe or a device");
	refuse(in_folder("dangling"), 1 << 20, "No such file");
	refuse(in_folder("round"), 1 << 20, "Too many levels of symbolic links");
	refuse(folder, 1 << 20, "no file, but a directory");
	refuse("/dev/zero", 1 << 20, "no file, but a pipe or a device");
	refuse("/dev/tty", 1 << 20, ""); // no terminal, or a device
	static const char *const names[] = { "text", "empty", "pipe", "link", "dangling", "round" };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		unlink(in_folder(names[i]));
	rmdir(folder);
	return check_end();
}
