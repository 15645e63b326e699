#include "cli/lab_folder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/version.h"
#include "lab/provenance.h"
#include "lab/report.h"
#include "lab/tables.h"

bool ob_lab_folder_make(const char *folder, ob_error *e)
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

char *ob_lab_folder_path(const char *folder, const char *name)
{
	char *path;
	if (asprintf(&path, "%s/%s", folder, name) < 0)
		abort();
	return path;
}

// Results of another program or machine are not mixed with these: their file gets a number.
static bool set_aside(const char *folder, const char *file, ob_error *e)
{
	for (int i = 1;; i++) {
		char name[32];
		snprintf(name, sizeof name, "results-%d.csv", i);
		char *path = ob_lab_folder_path(folder, name);
		bool taken = access(path, F_OK) == 0, fine = taken || rename(file, path) == 0;
		if (!fine)
			ob_fail(e, "%s cannot be renamed: %s", file, strerror(errno));
		else if (!taken)
			fprintf(stderr, "obsim: results of another program or machine are kept in %s\n", path);
		free(path);
		if (!taken)
			return fine;
	}
}

bool ob_lab_folder_open(const char *folder, ob_results *r, ob_error *e)
{
	ob_results now = { 0 };
	ob_provenance_machine(now.machine, sizeof now.machine);
	ob_provenance_commit(ob_version_commit, now.commit, sizeof now.commit);
	if (!ob_lab_folder_make(folder, e))
		return false;
	char *file = ob_lab_folder_path(folder, "results.csv");
	bool same = ob_results_read(r, file, NULL);
	for (size_t i = 0; same && i < r->count; i++)
		same = strcmp(r->result[i].commit, now.commit) == 0 && strcmp(r->machine, now.machine) == 0;
	bool fine = same || set_aside(folder, file, e);
	if (!same)
		ob_results_finish(r);
	free(file);
	memcpy(r->machine, now.machine, sizeof r->machine);
	memcpy(r->commit, now.commit, sizeof r->commit);
	return fine;
}

static bool write_file(const char *folder, const char *name, const ob_digest *d,
		       void (*write)(FILE *, const ob_digest *), ob_error *e)
{
	char *path = ob_lab_folder_path(folder, name);
	FILE *f = fopen(path, "we");
	if (f)
		write(f, d);
	bool fine = f && !ferror(f);
	fine = (!f || fclose(f) == 0) && fine;
	if (!fine)
		ob_fail(e, "%s cannot be written: %s", path, strerror(errno));
	free(path);
	return fine;
}

static void write_rows(FILE *f, const ob_digest *d)
{
	ob_lab_print_rows(f, d, true);
}

static void write_equal(FILE *f, const ob_digest *d)
{
	ob_lab_print_equal(f, d, true);
}

bool ob_lab_folder_write(const char *folder, const ob_results *r, ob_error *e)
{
	ob_digest d = ob_digest_make(r);
	return write_file(folder, "rows.md", &d, write_rows, e) && write_file(folder, "equal.md", &d, write_equal, e) &&
	       write_file(folder, "equal.csv", &d, ob_lab_write_equal, e) && ob_lab_report(r, folder, e);
}
