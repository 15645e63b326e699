#include "base/file.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/budget.h"

static int check(int fd, uint64_t most, uint64_t *size, ob_error *e)
{
	struct stat st;
	if (fstat(fd, &st) != 0)
		return ob_fail(e, "%s", strerror(errno));
	if (S_ISDIR(st.st_mode))
		return ob_fail(e, "it is no file, but a directory");
	if (!S_ISREG(st.st_mode))
		return ob_fail(e, "it is no file, but a pipe or a device");
	*size = (uint64_t)st.st_size;
	if (*size <= most)
		return 1;
	return most >> 20 ? ob_fail(e, "it is larger than %" PRIu64 " MiB", most >> 20)
			  : ob_fail(e, "it is larger than %" PRIu64 " KiB", most >> 10);
}

int ob_file_open(const char *path, uint64_t most, uint64_t *size, ob_error *e)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
	if (fd < 0) {
		ob_fail(e, "%s", strerror(errno));
		return -1;
	}
	if (check(fd, most, size, e))
		return fd;
	close(fd);
	return -1;
}

int ob_file_read(int fd, void *to, size_t size, ob_error *e)
{
	char *at = to;
	while (size > 0) {
		const ssize_t n = read(fd, at, size);
		if (n == 0)
			return ob_fail(e, "it became shorter");
		if (n < 0 && errno != EINTR)
			return ob_fail(e, "%s", strerror(errno));
		at += n > 0 ? n : 0;
		size -= n > 0 ? (size_t)n : 0;
	}
	return 1;
}

char *ob_file_load(const char *path, size_t most, size_t *size, ob_error *e)
{
	uint64_t bytes = 0;
	const int fd = ob_file_open(path, most, &bytes, e);
	if (fd < 0)
		return NULL;
	const bool allowed = ob_budget_allows(bytes, e);
	char *text = allowed ? malloc(bytes + 1) : NULL;
	if (allowed && !text)
		ob_fail(e, "no memory");
	const bool good = text && ob_file_read(fd, text, bytes, e);
	close(fd);
	if (good) {
		text[bytes] = 0;
		*size = bytes;
		return text;
	}
	free(text);
	return NULL;
}

// ---- own file

// Cuts the last name off a path; false at the root.
static bool climb(char *path)
{
	char *slash = strrchr(path, '/');
	if (!slash || slash == path)
		return false;
	*slash = '\0';
	return true;
}

static bool is_there(char *path, const char *folder, const char *below, const char *name)
{
	char way[PATH_MAX]; // may lead up and down again
	return snprintf(way, sizeof way, "%s/%s/%s", folder, below, name) < PATH_MAX && realpath(way, path);
}

// Folder of the program; for code that a library brought, where the program of that library lies: beside it, or as installed.
static bool find_folder(char folder[PATH_MAX])
{
	char way[PATH_MAX], program[PATH_MAX];
	Dl_info here;
	ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
	if (n <= 0)
		return false;
	program[n] = '\0';
	if (!dladdr(&find_folder, &here) || !here.dli_fname || !strstr(here.dli_fname, ".so") ||
	    !realpath(here.dli_fname, way))
		return climb(strcpy(folder, program));
	climb(way);
	if (is_there(folder, way, ".", "obsim") || is_there(folder, way, OB_PROGRAM_FROM_PARTS, "obsim") ||
	    is_there(folder, way, OB_PROGRAM_FROM_LIBRARIES, "obsim"))
		return climb(folder);
	return strcpy(folder, way);
}

// The root of the build tree is the nearest folder above the program in which ninja works.
bool ob_own_file_find(char path[PATH_MAX], const char *installed, const char *built, const char *name)
{
	char folder[PATH_MAX];
	if (!find_folder(folder))
		return false;
	if (is_there(path, folder, ".", name) || is_there(path, folder, installed, name))
		return true;
	do {
		if (is_there(path, folder, ".", "build.ninja"))
			return is_there(path, folder, built, name);
	} while (climb(folder));
	return false;
}
