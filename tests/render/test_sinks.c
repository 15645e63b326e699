// Sinks: every frame once, whole, in order, the same bytes; and errors if the disk, the reader or ffmpeg fails.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../check.h"
#include "render/render.h"

enum { W = 64, H = 36, FRAMES = 600 };

static char base[64];

static void paint(uint8_t *rgba, int frame)
{
	for (int i = 0; i < W * H; i++) {
		rgba[4 * i] = (uint8_t)frame;
		rgba[4 * i + 1] = (uint8_t)(frame >> 8);
		rgba[4 * i + 2] = (uint8_t)(i * 7);
		rgba[4 * i + 3] = 255;
	}
}

static bool put_frames(ob_sink *s, int count, ob_error *e)
{
	uint8_t rgba[4 * W * H];
	for (int i = 0; i < count; i++) {
		paint(rgba, i);
		if (!ob_sink_put(s, (uint64_t)i, i / 60., rgba, e))
			return false;
	}
	return true;
}

static int files_in(const char *dir)
{
	DIR *d = opendir(dir);
	int n = 0;
	for (const struct dirent *entry; d && (entry = readdir(d));)
		n += entry->d_name[0] != '.';
	if (d)
		closedir(d);
	return n;
}

static size_t slurp(const char *path, uint8_t *data, size_t most)
{
	FILE *f = fopen(path, "rb");
	size_t n = f ? fread(data, 1, most, f) : 0;
	if (f)
		fclose(f);
	return n;
}

// The file has the frame's number and row order, and the time in its text chunk.
static void check_png(const char *path, int frame)
{
	FILE *f = fopen(path, "rb");
	CHECK(f != NULL);
	if (!f)
		return;
	png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png_create_info_struct(png);
	png_init_io(png, f);
	png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
	png_bytepp row = png_get_rows(png, info);
	png_textp text;
	CHECK(png_get_image_width(png, info) == W && png_get_image_height(png, info) == H);
	CHECK(png_get_color_type(png, info) == PNG_COLOR_TYPE_RGB);
	CHECK(row[0][0] == frame % 256 && row[0][1] == frame / 256);
	CHECK(row[0][2] == 0 && row[1][2] == (uint8_t)(W * 7)); // the top row first
	CHECK(png_get_text(png, info, &text, NULL) == 1 && strcmp(text[0].key, "Simulated time") == 0);
	CHECK_NEAR(strtod(text[0].text, NULL), frame / 60., 1e-7);
	png_destroy_read_struct(&png, &info, NULL);
	fclose(f);
}

static void png_is_complete(void)
{
	ob_error e = { "" };
	char dir[2][128], path[256];
	static uint8_t data[2][4 * W * H];
	for (int run = 0; run < 2; run++) {
		snprintf(dir[run], sizeof dir[run], "%s/deep/run%d", base, run);
		ob_sink *s = ob_sink_png(dir[run], W, H, 0, &e);
		CHECK(s && put_frames(s, FRAMES, &e) && ob_sink_close(s, &e));
		CHECK(files_in(dir[run]) == FRAMES);
	}
	int same = 0;
	for (int i = 0; i < FRAMES; i++) {
		snprintf(path, sizeof path, "%s/frame-%06d.png", dir[0], i);
		size_t n = slurp(path, data[0], sizeof data[0]);
		snprintf(path, sizeof path, "%s/frame-%06d.png", dir[1], i);
		same += n > 0 && slurp(path, data[1], sizeof data[1]) == n && memcmp(data[0], data[1], n) == 0;
	}
	CHECK(same == FRAMES);
	check_png(path, FRAMES - 1);
	// A shorter run into the same directory removes the longer one's frames, and no file of the user.
	snprintf(path, sizeof path, "%s/frame-notes.txt", dir[0]);
	fclose(fopen(path, "w"));
	ob_sink *s = ob_sink_png(dir[0], W, H, 0, &e);
	CHECK(s && put_frames(s, 7, &e) && ob_sink_close(s, &e));
	CHECK(files_in(dir[0]) == 8);
}

static void png_errors(void)
{
	ob_error e = { "" };
	char dir[128];
	snprintf(dir, sizeof dir, "%s/file", base);
	fclose(fopen(dir, "w"));
	CHECK(!ob_sink_png(dir, W, H, 0, &e) && strstr(e.text, dir) && strstr(e.text, "Not a directory"));
	CHECK(!ob_sink_png("/proc/no-such-place/frames", W, H, 0, &e) && strstr(e.text, "/proc/no-such-place/frames"));
	CHECK(!ob_sink_png(base, 0, H, 0, &e) && strstr(e.text, "0x36"));

	// A full disk, in small: files may not grow beyond 200 bytes.
	struct rlimit before, small;
	getrlimit(RLIMIT_FSIZE, &before);
	small = before;
	small.rlim_cur = 200;
	signal(SIGXFSZ, SIG_IGN);
	snprintf(dir, sizeof dir, "%s/full", base);
	ob_sink *s = ob_sink_png(dir, W, H, 0, &e);
	setrlimit(RLIMIT_FSIZE, &small);
	bool put = put_frames(s, 100, &e), closed = ob_sink_close(s, &e);
	setrlimit(RLIMIT_FSIZE, &before);
	CHECK(!put && !closed);
	CHECK(strstr(e.text, "full/frame-0000") && strstr(e.text, "File too large"));
	CHECK(files_in(dir) == 0); // no partial file stays
}

typedef struct reader {
	int fd;
	size_t bytes;
	int wrong;
} reader;

static void *read_frames(void *context)
{
	reader *r = context;
	uint8_t got[3 * W * H], want[4 * W * H];
	size_t have = 0;
	int frame = 0;
	for (ssize_t n; (n = read(r->fd, got + have, sizeof got - have)) > 0;) {
		have += (size_t)n;
		r->bytes += (size_t)n;
		if (have < sizeof got)
			continue;
		have = 0;
		paint(want, frame++);
		for (int i = 0; i < W * H; i++)
			r->wrong += memcmp(got + 3 * i, want + 4 * i, 3) != 0;
	}
	return NULL;
}

static void raw_is_ordered(void)
{
	int ends[2];
	ob_error e = { "" };
	pthread_t thread;
	CHECK(pipe(ends) == 0);
	fcntl(ends[1], F_SETFL, O_NONBLOCK); // as a shell or an event loop may have left it
	reader r = { ends[0], 0, 0 };
	pthread_create(&thread, NULL, read_frames, &r);
	ob_sink *s = ob_sink_raw(ends[1], "the pipe", W, H, &e);
	CHECK(s && put_frames(s, FRAMES, &e) && ob_sink_close(s, &e));
	close(ends[1]);
	pthread_join(thread, NULL);
	close(ends[0]);
	CHECK(r.bytes == (size_t)FRAMES * 3 * W * H);
	CHECK(r.wrong == 0);
}

// A reader that leaves is an error, not a death by SIGPIPE (whose default action is in force here).
static void raw_reader_leaves(void)
{
	int ends[2];
	ob_error e = { "" };
	CHECK(pipe(ends) == 0);
	ob_sink *s = ob_sink_raw(ends[1], "the pipe", W, H, &e);
	close(ends[0]);
	CHECK(s != NULL);
	put_frames(s, 50, NULL);
	CHECK(!ob_sink_close(s, &e) && strstr(e.text, "the pipe: the reader of the frames has gone"));
	close(ends[1]);
}

static int frames_of_video(const char *path)
{
	char command[400], line[64] = "";
	snprintf(command, sizeof command,
		 "ffprobe -v error -count_packets -show_entries stream=nb_read_packets -of csv=p=0 '%s'", path);
	FILE *p = popen(command, "r");
	bool read = p && fgets(line, sizeof line, p);
	if (p)
		pclose(p);
	return read ? atoi(line) : -1;
}

// The disk has room for all but the last bytes, which ffmpeg writes as it closes the file.
static void video_without_its_end(const char *whole)
{
	ob_error e = { "" };
	char path[128];
	struct stat is;
	struct rlimit before, less;
	snprintf(path, sizeof path, "%s/cut.mp4", base);
	CHECK(stat(whole, &is) == 0 && getrlimit(RLIMIT_FSIZE, &before) == 0);
	less = (struct rlimit){ (rlim_t)is.st_size - 10, before.rlim_max };
	signal(SIGXFSZ, SIG_IGN);
	setrlimit(RLIMIT_FSIZE, &less);
	ob_sink *s = ob_sink_video(path, W, H, 60, &e);
	CHECK(s && put_frames(s, 90, &e) && !ob_sink_close(s, &e) && strstr(e.text, "ffmpeg failed"));
	setrlimit(RLIMIT_FSIZE, &before);
}

static void video(void)
{
	ob_error e = { "" };
	char path[128];
	if (system("ffmpeg -version >/dev/null 2>&1 && ffprobe -version >/dev/null 2>&1") == 0) {
		snprintf(path, sizeof path, "%s/out.mp4", base);
		ob_sink *s = ob_sink_video(path, W, H, 60, &e);
		CHECK(s && put_frames(s, 90, &e) && ob_sink_close(s, &e));
		CHECK(frames_of_video(path) == 90);
		video_without_its_end(path);
		snprintf(path, sizeof path, "%s/no/such/dir/out.mp4", base);
		s = ob_sink_video(path, W, H, 60, &e);
		CHECK(s != NULL);
		put_frames(s, 90, NULL);
		CHECK(!ob_sink_close(s, &e) && strstr(e.text, "No such file or directory"));
	}
	char *search = strdup(getenv("PATH"));
	setenv("PATH", base, 1);
	CHECK(!ob_video_check(&e) && strstr(e.text, "install ffmpeg"));
	CHECK(!ob_sink_video(path, W, H, 60, &e) && strstr(e.text, "cannot start ffmpeg"));
	setenv("PATH", search, 1);
	free(search);
}

int main(void)
{
	snprintf(base, sizeof base, "/tmp/obsim-test-sinks-XXXXXX");
	CHECK(mkdtemp(base) != NULL);
	png_is_complete();
	png_errors();
	raw_is_ordered();
	raw_reader_leaves();
	video();
	char command[128];
	snprintf(command, sizeof command, "rm -rf %s", base);
	CHECK(system(command) == 0);
	return check_end();
}
