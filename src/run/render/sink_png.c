// Frames as PNG files: runs of equal differences between neighbours (9 times faster than libpng's defaults, for a third
// more in size), complete or absent, and the same bytes for the same frame.
#include <dirent.h>
#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/cpu.h"
#include "base/log.h"
#include "render/sink.h"

enum { PATH_BYTES = 4096 };

typedef struct png_state {
	char dir[PATH_BYTES - 64];
} png_state;

typedef struct png_target {
	FILE *file;
	int error; // errno of the first failed write
} png_target;

static void write_bytes(png_structp png, png_bytep data, size_t size)
{
	png_target *t = png_get_io_ptr(png);
	if (fwrite(data, 1, size, t->file) != size) {
		t->error = errno;
		png_error(png, "write");
	}
}

static void flush_bytes(png_structp png) {}
static void quiet(png_structp png, png_const_charp text) {}
static void give_up(png_structp png, png_const_charp text)
{
	png_longjmp(png, 1);
}

static void write_info(png_structp png, png_infop info, int w, int h, double time)
{
	char seconds[32];
	snprintf(seconds, sizeof seconds, "%.9g s", time);
	png_text text = { .compression = PNG_TEXT_COMPRESSION_NONE, .key = (char *)"Simulated time", .text = seconds };
	png_set_compression_level(png, 1);
	png_set_compression_strategy(png, Z_RLE);
	png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
	png_set_IHDR(png, info, (png_uint_32)w, (png_uint_32)h, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
		     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
	png_set_text(png, info, &text, 1);
	png_write_info(png, info);
	png_set_filler(png, 0, PNG_FILLER_AFTER); // skips alpha
}

// Returns false with the reason in t->error, or 0 there if memory ran out.
static bool encode(png_target *t, int w, int h, const ob_sink_frame *frame)
{
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, give_up, quiet);
	png_infop info = png ? png_create_info_struct(png) : NULL;
	bool done = false;
	if (info && !setjmp(png_jmpbuf(png))) {
		png_set_write_fn(png, t, write_bytes, flush_bytes);
		write_info(png, info, w, h, frame->time);
		for (int y = 0; y < h; y++)
			png_write_row(png, frame->rgba + 4 * (size_t)w * (size_t)y);
		png_write_end(png, NULL);
		done = true;
	}
	png_destroy_write_struct(&png, &info);
	return done;
}

// Uses a temporary name until it is complete: programs that watch the directory see complete frames only.
static bool write_png(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e)
{
	const png_state *s = state;
	char path[PATH_BYTES], part[PATH_BYTES + 8];
	snprintf(path, sizeof path, "%s/frame-%06llu.png", s->dir, (unsigned long long)frame->number);
	snprintf(part, sizeof part, "%s.part", path);
	png_target t = { .file = fopen(part, "wbe") };
	if (!t.file)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	bool good = encode(&t, w, h, frame);
	if (fclose(t.file) != 0 && good) {
		t.error = errno;
		good = false;
	}
	if (good && rename(part, path) != 0) {
		t.error = errno;
		good = false;
	}
	if (good)
		return true;
	unlink(part);
	return ob_fail(e, "%s: frame not written: %s", path, t.error ? strerror(t.error) : "out of memory");
}

static bool finish_png(void *state, bool good, ob_error *e)
{
	free(state);
	return true;
}

// Like mkdir -p.
static bool make_directory(const char *dir)
{
	char path[PATH_BYTES];
	snprintf(path, sizeof path, "%s", dir);
	for (char *at = path + 1; *at; at++) {
		if (*at != '/')
			continue;
		*at = 0;
		if (mkdir(path, 0777) != 0 && errno != EEXIST)
			return false;
		*at = '/';
	}
	struct stat is;
	if (mkdir(path, 0777) != 0 && errno != EEXIST)
		return false;
	if (stat(path, &is) == 0 && S_ISDIR(is.st_mode))
		return access(path, W_OK | X_OK) == 0;
	errno = ENOTDIR;
	return false;
}

// True for "frame-", six digits or more, ".png", as this sink names them, and for temporary files of a killed run; from
// "first" on.
static bool is_frame(const char *name, uint64_t first)
{
	if (strncmp(name, "frame-", 6) != 0)
		return false;
	size_t digits = strspn(name + 6, "0123456789");
	const char *end = name + 6 + digits;
	return digits >= 6 && strtoull(name + 6, NULL, 10) >= first &&
	       (strcmp(end, ".png") == 0 || strcmp(end, ".png.part") == 0);
}

// Removes frames of an earlier run: if that was longer, they would mix with the new ones.
static void remove_old_frames(const char *dir, uint64_t first)
{
	DIR *d = opendir(dir);
	int removed = 0;
	for (const struct dirent *entry; d && (entry = readdir(d));)
		if (is_frame(entry->d_name, first) && unlinkat(dirfd(d), entry->d_name, 0) == 0)
			removed++;
	if (d)
		closedir(d);
	if (removed)
		ob_log_note("%s: replacing the %d frames of an earlier run", dir, removed);
}

ob_sink *ob_sink_png(const char *dir, int w, int h, uint64_t first, ob_error *e)
{
	static const ob_sink_kind kind = { write_png, finish_png };
	png_state *s = malloc(sizeof *s);
	if (!s || strlen(dir) >= sizeof s->dir) {
		ob_fail(e, "%.200s: %s", dir, s ? strerror(ENAMETOOLONG) : "out of memory");
		free(s);
		return NULL;
	}
	snprintf(s->dir, sizeof s->dir, "%s", dir);
	if (!make_directory(dir)) {
		ob_fail(e, "%.900s: cannot write frames into it: %s", dir, strerror(errno));
		free(s);
		return NULL;
	}
	remove_old_frames(dir, first);
	return ob_sink_start(&kind, s, w, h, ob_cpu_count(), e);
}
