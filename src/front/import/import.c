#include "import/import.h"

#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/budget.h"
#include "base/file.h"
#include "base/utf8.h"

#define MUJOCO "libmujoco2.2.2"

enum {
	SECONDS = OB_SANITIZED ? 100 : OB_BUDGET_SECONDS, // of CPU
	WALL_PER_CPU = 10,
	TEXT_MOST = 256 << 20, // bytes
	FILE_MOST = 64 << 20,
	FILES = 64,
};
#define MEMORY ((rlim_t)OB_BUDGET_BYTES) // of addresses

// Message of the child: this, then the scene, then the list.
typedef struct report {
	uint64_t scene, omitted; // bytes
	ob_error e; // empty: none
} report;

// ---- files of the model

static bool guarded; // in the child

typedef FILE *opener(const char *path, const char *mode);

// Opens a file for the program, or a library. In the child regular files of a bounded size alone are read: at a pipe the
// parser would wait.
static FILE *open_guarded(const char *real, const char *path, const char *mode)
{
	uint64_t size;
	ob_error e;
	opener *open_any;
	if (!guarded || *mode != 'r') {
		*(void **)&open_any = dlsym(RTLD_NEXT, real);
		return open_any(path, mode);
	}
	const int fd = ob_file_open(path, FILE_MOST, &size, &e);
	return fd < 0 ? NULL : fdopen(fd, mode);
}

// In place of the C library's, by which MuJoCo and its libraries open all files.
__attribute__((visibility("default"))) FILE *open_long(const char *path, const char *mode) __asm__("fopen64");
FILE *open_long(const char *path, const char *mode)
{
	return open_guarded("fopen64", path, mode);
}

__attribute__((visibility("default"))) FILE *open_plain(const char *path, const char *mode) __asm__("fopen");
FILE *open_plain(const char *path, const char *mode)
{
	return open_guarded("fopen", path, mode);
}

// ---- the child

static void limit(void)
{
	if (!OB_SANITIZED) // a sanitizer reserves more than any machine has
		setrlimit(RLIMIT_AS, &(struct rlimit){ MEMORY, MEMORY });
	setrlimit(RLIMIT_CPU, &(struct rlimit){ SECONDS, SECONDS });
	setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
	setrlimit(RLIMIT_FSIZE, &(struct rlimit){ FILE_MOST, FILE_MOST });
	setrlimit(RLIMIT_NOFILE, &(struct rlimit){ FILES, FILES });
	signal(SIGXCPU, SIG_DFL);
	signal(SIGALRM, SIG_DFL);
	alarm(WALL_PER_CPU * SECONDS);
}

static void put(int fd, const void *bytes, size_t n)
{
	const char *at = bytes;
	while (n) {
		const ssize_t written = write(fd, at, n);
		if (written < 0)
			_exit(EXIT_FAILURE);
		at += written, n -= (size_t)written;
	}
}

static _Noreturn void be_child(const char *path, const char *folder, int link, pid_t parent)
{
	char *text[2] = { NULL, NULL };
	size_t size[2] = { 0, 0 };
	report r = { 0 };
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(EXIT_FAILURE);
	if (!OB_SANITIZED && !freopen("/dev/null", "w", stderr)) // for what libraries print
		_exit(EXIT_FAILURE);
	const ob_import_part *part = ob_part_load("import", sizeof *part, OB_PART_PROGRAM, MUJOCO, &r.e);
	limit();
	guarded = true;
	FILE *scene = open_memstream(&text[0], &size[0]), *omitted = open_memstream(&text[1], &size[1]);
	if (part && scene && omitted && part->convert(path, folder, scene, omitted, &r.e))
		*r.e.text = 0;
	if (scene && omitted && (fclose(scene) != 0 || fclose(omitted) != 0))
		ob_fail(&r.e, "%s: out of memory", path);
	r.scene = size[0], r.omitted = size[1];
	put(link, &r, sizeof r);
	put(link, text[0], size[0]);
	put(link, text[1], size[1]);
	_exit(EXIT_SUCCESS);
}

static bool get(int fd, void *bytes, size_t n)
{
	char *at = bytes;
	while (n) {
		const ssize_t got = read(fd, at, n);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			return false;
		at += got, n -= (size_t)got;
	}
	return true;
}

// Reads a text of the child, which may send anything.
static char *get_text(int fd, uint64_t bytes)
{
	char *text = bytes <= TEXT_MOST ? malloc(bytes + 1) : NULL;
	if (!text || !get(fd, text, bytes)) {
		free(text);
		return NULL;
	}
	text[bytes] = 0;
	for (char *c = text; c < text + bytes; c++)
		if ((unsigned char)*c < ' ' && *c != '\n' && *c != '\t')
			*c = ' ';
	return text;
}

// Explains how the child ended without an answer.
static bool explain(const char *path, int status, ob_error *e)
{
	const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	if (signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL)
		return ob_fail(e, "%s: MuJoCo's parser needs more than %d s, or more memory than there is", path,
			       SECONDS);
	return ob_fail(e, "%s: MuJoCo's parser broke down (%s): the file is damaged, or needs more than %d MiB", path,
		       signal ? strsignal(signal) : "it ended", (int)(MEMORY >> 20));
}

static bool take(const char *path, int fd, ob_imported *out, bool *answered, ob_error *e)
{
	report r;
	*out = (ob_imported){ NULL, NULL };
	*answered = get(fd, &r, sizeof r);
	if (!*answered)
		return false;
	r.e.text[sizeof r.e.text - 1] = 0;
	ob_utf8_make_plain(r.e.text);
	if (*r.e.text)
		return ob_fail(e, "%s", r.e.text);
	out->scene = get_text(fd, r.scene);
	out->omitted = out->scene ? get_text(fd, r.omitted) : NULL;
	*answered = out->omitted != NULL;
	return *answered;
}

bool ob_import(const char *path, const char *folder, ob_imported *out, ob_error *e)
{
	struct stat file;
	int ends[2], status = 0;
	*out = (ob_imported){ NULL, NULL };
	if (stat(path, &file) != 0)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	if (!S_ISREG(file.st_mode) || file.st_size > FILE_MOST)
		return ob_fail(e, "%s: expected a regular file of at most %d MiB", path, FILE_MOST >> 20);
	if (folder && mkdir(folder, 0777) != 0 && errno != EEXIST)
		return ob_fail(e, "--out %s: %s", folder, strerror(errno));
	if (!ob_part_check("import", MUJOCO, e))
		return false;
	if (pipe(ends) != 0)
		return ob_fail(e, "%s: no pipe: %s", path, strerror(errno));
	fflush(NULL);
	const pid_t parent = getpid(), child = fork();
	if (child == 0) {
		close(ends[0]);
		be_child(path, folder, ends[1], parent);
	}
	close(ends[1]);
	bool answered = false, done = false;
	if (child > 0)
		done = take(path, ends[0], out, &answered, e);
	close(ends[0]);
	if (child < 0)
		return ob_fail(e, "%s: no process to read it: %s", path, strerror(errno));
	while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
	}
	if (!answered) {
		ob_imported_finish(out);
		return explain(path, status, e);
	}
	return done;
}

void ob_imported_finish(ob_imported *i)
{
	free(i->scene);
	free(i->omitted);
	*i = (ob_imported){ NULL, NULL };
}
