// Frames through a pipe into ffmpeg.
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/sink.h"

typedef struct video {
	pid_t pid;
	int pipe; // to ffmpeg's standard input
	FILE *messages; // ffmpeg's messages
	char path[4096];
} video;

// First line of ffmpeg's messages: with -loglevel error the reason of a failure. Removes the "[part @ address]" before
// it.
static bool read_reason(FILE *f, char *line, int size)
{
	rewind(f);
	bool any = fgets(line, size, f);
	if (!any)
		snprintf(line, (size_t)size, "it gave no reason");
	line[strcspn(line, "\n")] = 0;
	char *end = line[0] == '[' ? strstr(line, "] ") : NULL;
	if (end)
		memmove(line, end + 2, strlen(end + 2) + 1);
	return any;
}

static bool fail_with_reason(const video *v, const char *reason, ob_error *e)
{
	return ob_fail(e, "%.400s: ffmpeg failed: %s", v->path, reason);
}

static void close_pipe(video *v)
{
	if (v->pipe >= 0)
		close(v->pipe);
	v->pipe = -1;
}

// If ffmpeg accepts no more, it has ended or will, with its reason in the messages.
static bool write_video(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e)
{
	video *v = state;
	if (ob_pipe_write(v->pipe, w, h, frame->rgba, v->path, e))
		return true;
	close_pipe(v);
	siginfo_t ended;
	while (waitid(P_PID, (id_t)v->pid, &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR)
		;
	char reason[512];
	if (read_reason(v->messages, reason, sizeof reason))
		fail_with_reason(v, reason, e);
	return false;
}

static bool finish_video(void *state, bool good, ob_error *e)
{
	video *v = state;
	int status = 0;
	close_pipe(v);
	while (waitpid(v->pid, &status, 0) < 0 && errno == EINTR)
		;
	char reason[512];
	// Success: no messages, and status 0. The status alone is 0 even if the last bytes, written at the end, find no
	// room.
	bool ended_well =
		!read_reason(v->messages, reason, sizeof reason) && WIFEXITED(status) && WEXITSTATUS(status) == 0;
	if (!ended_well)
		fail_with_reason(v, reason, e);
	fclose(v->messages);
	free(v);
	return ended_well;
}

// Starts ffmpeg in a process group of its own: Ctrl-C is for obsim, which then closes the pipe, and the file is
// complete.
static int spawn(video *v, const char *const argv[], int input)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	sigset_t none, defaults;
	sigemptyset(&none);
	sigemptyset(&defaults);
	sigaddset(&defaults, SIGPIPE);
	posix_spawn_file_actions_init(&files);
	posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
	posix_spawn_file_actions_adddup2(&files, fileno(v->messages), STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&files, fileno(v->messages), STDERR_FILENO);
	posix_spawnattr_init(&attributes);
	posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &defaults);
	int error = posix_spawnp(&v->pid, argv[0], &files, &attributes, (char *const *)argv, environ);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&files);
	return error;
}

// Most players need 4:2:0 colour, which requires an even width and height: odd ones are padded.
static int start_ffmpeg(video *v, int input, int w, int h, double fps)
{
	char size[32], rate[32], target[sizeof v->path + 8];
	snprintf(size, sizeof size, "%dx%d", w, h);
	snprintf(rate, sizeof rate, "%.9g", fps);
	snprintf(target, sizeof target, "file:%s", v->path);
	const char *const argv[] = { "ffmpeg",    "-nostdin",   "-loglevel",
				     "error",     "-y",         "-f",
				     "rawvideo",  "-pix_fmt",   "rgb24",
				     "-s",        size,         "-r",
				     rate,        "-i",         "pipe:0",
				     "-an",       "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p",
				     "-c:v",      "libx264",    "-preset",
				     "veryfast",  "-crf",       "18",
				     "-movflags", "+faststart", "-bitexact",
				     target,      NULL };
	return spawn(v, argv, input);
}

static void discard(video *v)
{
	if (v && v->messages)
		fclose(v->messages);
	free(v);
}

// Looks through PATH as posix_spawnp does.
bool ob_video_check(ob_error *e)
{
	const char *path = getenv("PATH");
	char file[4096];
	for (path = path ? path : "/bin:/usr/bin"; *path; path += *path == ':') {
		const size_t n = strcspn(path, ":");
		snprintf(file, sizeof file, "%.*s/ffmpeg", (int)n, n ? path : ".");
		if (access(file, X_OK) == 0)
			return true;
		path += n;
	}
	return ob_fail(e, "--out: ffmpeg is missing: install ffmpeg for videos, or write PNG files (--out DIR)");
}

ob_sink *ob_sink_video(const char *path, int w, int h, double fps, ob_error *e)
{
	static const ob_sink_kind kind = { write_video, finish_video };
	int ends[2];
	video *v = calloc(1, sizeof *v);
	if (!v || strlen(path) >= sizeof v->path || !(v->messages = tmpfile()) || pipe2(ends, O_CLOEXEC) != 0) {
		ob_fail(e, "%.200s: cannot start a video: %s", path, strerror(v && errno ? errno : ENAMETOOLONG));
		discard(v);
		return NULL;
	}
	snprintf(v->path, sizeof v->path, "%s", path);
	int error = start_ffmpeg(v, ends[0], w, h, fps);
	close(ends[0]);
	v->pipe = ends[1];
	if (error) {
		close(ends[1]);
		ob_fail(e, "%.400s: cannot start ffmpeg: %s", path, strerror(error));
		discard(v);
		return NULL;
	}
	return ob_sink_start(&kind, v, w, h, 1, e);
}
