#include "experiment/folder.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>

#include "base/cpu.h"
#include "base/hash.h"

bool ob_folder_make(const char *folder, ob_error *e)
{
	char *path = strdup(folder);
	bool fine = path;
	errno = ENOMEM;
	for (char *at = path; fine && at;) {
		at = strchr(at + 1, '/');
		if (at)
			*at = 0;
		fine = mkdir(path, 0777) == 0 || errno == EEXIST;
		if (at)
			*at = '/';
	}
	struct stat s;
	int why = errno;
	if (fine && !(stat(path, &s) == 0 && S_ISDIR(s.st_mode))) {
		fine = false;
		why = ENOTDIR;
	}
	free(path);
	return fine || ob_fail(e, "--out %s: %s", folder, strerror(why));
}

char *ob_folder_path(const char *folder, const char *name)
{
	char *path;
	if (asprintf(&path, "%s/%s", folder, name) < 0)
		abort();
	return path;
}

bool ob_file_replace(const char *path, void (*write)(FILE *f, const void *with), const void *with, ob_error *e)
{
	char *beside;
	if (asprintf(&beside, "%s.new", path) < 0)
		return ob_fail(e, "no memory for %s", path);
	FILE *f = fopen(beside, "we");
	bool fine = f;
	if (f) {
		write(f, with);
		fine = !ferror(f);
		fine &= fclose(f) == 0;
	}
	fine = fine && rename(beside, path) == 0;
	int why = errno;
	if (!fine && f)
		remove(beside);
	free(beside);
	return fine || ob_fail(e, "%s cannot be written: %s", path, strerror(why));
}

bool ob_folder_write(const char *folder, const char *name, void (*write)(FILE *f, const void *with), const void *with,
		     ob_error *e)
{
	char *path = ob_folder_path(folder, name);
	bool fine = ob_file_replace(path, write, with, e);
	free(path);
	return fine;
}

static void find_processor(char *to, size_t room)
{
	char line[256];
	FILE *f = fopen("/proc/cpuinfo", "re");
	snprintf(to, room, "unknown processor");
	while (f && fgets(line, sizeof line, f)) {
		char *value = strstr(line, ": ");
		if (strncmp(line, "model name", 10) != 0 || !value)
			continue;
		snprintf(to, room, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
		break;
	}
	if (f)
		fclose(f);
}

void ob_provenance_machine(char *to, size_t room)
{
	char processor[96];
	struct utsname u = { 0 };
	int cores = ob_cpu_count();
	find_processor(processor, sizeof processor);
	uname(&u);
	snprintf(to, room, "%s, %d core%s, %.16s %.32s", processor, cores, cores == 1 ? "" : "s", u.sysname, u.release);
}

void ob_provenance_commit(const char *commit, char *to, size_t room)
{
	size_t n = strlen(commit);
	snprintf(to, room, "%s", commit);
	FILE *f =
		n == 0 || commit[n - 1] == '+' || strcmp(commit, "unknown") == 0 ? fopen("/proc/self/exe", "re") : NULL;
	if (!f)
		return;
	uint64_t hash = OB_HASH_BEGIN;
	for (int c; (c = getc(f)) != EOF;)
		hash = ob_hash_on(hash, &(unsigned char){ (unsigned char)c }, 1);
	fclose(f);
	snprintf(to + strlen(to), room - strlen(to), "%s%08" PRIx32, n && commit[n - 1] == '+' ? "" : "+",
		 (uint32_t)(hash ^ hash >> 32));
}
