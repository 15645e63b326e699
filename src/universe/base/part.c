#include "base/part.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__ // a sanitizer takes no such module
#define OWN_FIRST RTLD_LOCAL
#else
#define OWN_FIRST (RTLD_LOCAL | RTLD_DEEPBIND)
#endif

#define STRING(x) #x
#define NAME(x) STRING(x)

static void *open_library(const char *name, ob_part_scope scope, const char *package, ob_error *e)
{
	static const int flags[] = {
		[OB_PART_PROGRAM] = RTLD_LOCAL, [OB_PART_OPEN] = RTLD_GLOBAL, [OB_PART_OWN] = OWN_FIRST
	};
	char path[PATH_MAX], file[NAME_MAX];
	snprintf(file, sizeof file, "obsim-%s.so", name);
	if (!ob_own_file_find(path, OB_PARTS_FROM_PROGRAM, ".", file)) {
		ob_fail(e, "obsim-%s.so is missing: this obsim was built or installed without it; it needs %s", name,
			package);
		return NULL;
	}
	void *library = dlopen(path, RTLD_NOW | flags[scope]);
	if (!library)
		ob_fail(e, "%s; install %s", dlerror(), package);
	return library;
}

bool ob_part_check(const char *name, const char *package, ob_error *e)
{
	ob_error error = { "" };
	int ends[2];
	if (pipe2(ends, O_CLOEXEC) != 0)
		return ob_fail(e, "pipe: %s", strerror(errno));
	pid_t child = fork();
	if (child == 0) {
		if (!open_library(name, OB_PART_PROGRAM, package, &error) && write(ends[1], &error, sizeof error) < 0)
			_exit(2);
		_exit(0);
	}
	close(ends[1]);
	int status = 0;
	ssize_t n = child < 0 ? 0 : read(ends[0], &error, sizeof error);
	close(ends[0]);
	if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
		return ob_fail(e, "obsim-%s.so cannot be loaded: install %s", name, package);
	return n <= 0 || ob_fail(e, "%s", error.text);
}

const void *ob_part_load(const char *name, size_t bytes, ob_part_scope scope, const char *package, ob_error *e)
{
	void *library = open_library(name, scope, package, e);
	if (!library)
		return NULL;
	const ob_part_head *table = dlsym(library, NAME(OB_PART_ENTRY));
	if (!table || table->bytes != bytes || strcmp(table->version, OB_VERSION) != 0) {
		ob_fail(e, "obsim-%s.so belongs to another obsim: build or install it again", name);
		return NULL;
	}
	return table;
}
