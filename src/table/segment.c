#include "table/segment.h"

#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char prefix[] = "/obsim.";
enum { UNFINISHED_AFTER_S = 10 }; // a creator that takes longer to write its header is dead

bool ob_segment_path(char path[OB_SEGMENT_PATH_MAX], const char *name)
{
	size_t n = strlen(name);
	if (n == 0 || n >= OB_NAME_MAX ||
	    n != strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
			      "0123456789._-"))
		return false;
	snprintf(path, OB_SEGMENT_PATH_MAX, "%s%s", prefix, name);
	return true;
}

uint64_t ob_segment_process_start(int32_t pid)
{
	char path[32], text[1024];
	snprintf(path, sizeof path, "/proc/%d/stat", pid);
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return 0;
	ssize_t n = read(fd, text, sizeof text - 1);
	close(fd);
	text[n > 0 ? n : 0] = 0;
	// field 22; field 2 is the program's name in brackets, which may hold anything; a zombie is dead
	const char *at = strrchr(text, ')');
	uint64_t start = 0;
	char state = 0;
	if (!at ||
	    sscanf(at + 1, " %c %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %" SCNu64,
		   &state, &start) != 2)
		return 0;
	return state == 'Z' || state == 'X' ? 0 : start;
}

bool ob_segment_peek(const char *path, ob_header *out, uint64_t *bytes)
{
	int fd = shm_open(path, O_RDONLY | O_CLOEXEC, 0);
	if (fd < 0)
		return false;
	struct stat s;
	ssize_t n = fstat(fd, &s) == 0 ? pread(fd, out, sizeof *out, 0) : -1;
	close(fd);
	*bytes = n == sizeof *out ? (uint64_t)s.st_size : 0;
	return n == sizeof *out;
}

static double age(const char *path)
{
	int fd = shm_open(path, O_RDONLY | O_CLOEXEC, 0);
	if (fd < 0)
		return 0;
	struct stat s;
	struct timespec now;
	clock_gettime(CLOCK_REALTIME, &now);
	double t = fstat(fd, &s) == 0 ? (double)(now.tv_sec - s.st_ctim.tv_sec) : 0;
	close(fd);
	return t;
}

bool ob_segment_stale(const char *path)
{
	ob_header h;
	uint64_t bytes;
	if (!ob_segment_peek(path, &h, &bytes) || h.magic == 0)
		return age(path) > UNFINISHED_AFTER_S;
	if (h.magic != OB_LAYOUT_MAGIC)
		return false; // not ours, whatever its name
	return h.host_pid <= 0 || ob_segment_process_start(h.host_pid) != h.host_start;
}

void ob_segment_remove_stale(void)
{
	DIR *d = opendir("/dev/shm");
	if (!d)
		return;
	for (struct dirent *entry; (entry = readdir(d));) {
		char path[OB_SEGMENT_PATH_MAX];
		size_t skip = strlen(prefix) - 1;
		if (strncmp(entry->d_name, prefix + 1, skip) == 0 && ob_segment_path(path, entry->d_name + skip) &&
		    ob_segment_stale(path))
			shm_unlink(path);
	}
	closedir(d);
}

static int newest_first(const void *a, const void *b)
{
	uint64_t x = ((const ob_header *)a)->created, y = ((const ob_header *)b)->created;
	return (x < y) - (x > y);
}

size_t ob_universe_list(char names[][OB_NAME_MAX], size_t max)
{
	enum { MOST = 256 };
	ob_header *found = calloc(MOST, sizeof *found);
	DIR *d = opendir("/dev/shm");
	size_t n = 0;
	for (struct dirent *entry; found && d && n < MOST && (entry = readdir(d));) {
		char path[OB_SEGMENT_PATH_MAX];
		size_t skip = strlen(prefix) - 1;
		uint64_t bytes;
		if (strncmp(entry->d_name, prefix + 1, skip) == 0 && ob_segment_path(path, entry->d_name + skip) &&
		    ob_segment_peek(path, &found[n], &bytes) && ob_layout_valid(&found[n], bytes) &&
		    !ob_segment_stale(path))
			memcpy(found[n++].name, entry->d_name + skip, strlen(entry->d_name + skip) + 1);
	}
	if (d)
		closedir(d);
	if (found)
		qsort(found, n, sizeof *found, newest_first);
	for (size_t i = 0; i < n && i < max; i++)
		memcpy(names[i], found[i].name, OB_NAME_MAX);
	free(found);
	return n;
}
