#include "base/part.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define STRING(x) #x
#define NAME(x) STRING(x)

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
	return snprintf(path, PATH_MAX, "%s%s/obsim-%s.so", folder, below, name) < PATH_MAX && access(path, F_OK) == 0;
}

// The root of the build tree is the nearest folder above the program in which ninja works.
static bool find(char path[PATH_MAX], const char *name)
{
	char folder[PATH_MAX], ninja[PATH_MAX + 16];
	ssize_t n = readlink("/proc/self/exe", folder, sizeof folder - 1);
	if (n <= 0)
		return false;
	folder[n] = '\0';
	climb(folder);
	if (is_there(path, folder, "", name) || is_there(path, folder, "/" OB_PARTS_FROM_PROGRAM, name))
		return true;
	do {
		snprintf(ninja, sizeof ninja, "%s/build.ninja", folder);
		if (access(ninja, F_OK) == 0)
			return is_there(path, folder, "", name);
	} while (climb(folder));
	return false;
}

static void *open_library(const char *name, bool global, const char *package, ob_error *e)
{
	char path[PATH_MAX];
	if (!find(path, name)) {
		ob_fail(e, "obsim-%s.so is missing: this obsim was built or installed without it; it needs %s", name, package);
		return NULL;
	}
	void *library = dlopen(path, RTLD_NOW | (global ? RTLD_GLOBAL : RTLD_LOCAL));
	if (!library)
		ob_fail(e, "%s; install %s", dlerror(), package);
	return library;
}

bool ob_part_check(const char *name, const char *package, ob_error *e)
{
	ob_error told = { "" };
	int ends[2];
	if (pipe2(ends, O_CLOEXEC) != 0)
		return ob_fail(e, "pipe: %s", strerror(errno));
	pid_t child = fork();
	if (child == 0) {
		if (!open_library(name, false, package, &told) && write(ends[1], &told, sizeof told) < 0)
			_exit(2);
		_exit(0);
	}
	close(ends[1]);
	int status = 0;
	ssize_t n = child < 0 ? 0 : read(ends[0], &told, sizeof told);
	close(ends[0]);
	if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
		return ob_fail(e, "obsim-%s.so cannot be loaded: install %s", name, package);
	return n <= 0 || ob_fail(e, "%s", told.text);
}

const void *ob_part_load(const char *name, size_t bytes, bool global, const char *package, ob_error *e)
{
	void *library = open_library(name, global, package, e);
	if (!library)
		return NULL;
	const ob_part_head *table = dlsym(library, NAME(OB_PART_ENTRY));
	if (!table || table->bytes != bytes || strcmp(table->version, OB_VERSION) != 0) {
		ob_fail(e, "obsim-%s.so belongs to another obsim: build or install it again", name);
		return NULL;
	}
	return table;
}
