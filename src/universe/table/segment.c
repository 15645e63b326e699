#include "table/segment.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char folder[] = "/dev/shm", prefix[] = "obsim.";
enum { ATTEMPTS = 3 }; // tries, as another process may be removing the name at this moment
enum { HOW = O_NONBLOCK | O_NOFOLLOW | O_NOCTTY | O_CLOEXEC };

bool ob_segment_path(char path[OB_SEGMENT_PATH_MAX], const char *name)
{
	size_t n = strlen(name);
	if (n == 0 || n >= OB_NAME_MAX ||
	    n != strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
			      "0123456789._-"))
		return false;
	snprintf(path, OB_SEGMENT_PATH_MAX, "%s/%s%s", folder, prefix, name);
	return true;
}

// Lock bytes of the file: its owner locks the first, its readers the second.
enum { OWNER, READERS };

static struct flock lock_of(short type, off_t byte)
{
	return (struct flock){ .l_type = type, .l_whence = SEEK_SET, .l_start = byte, .l_len = 1 };
}

static bool lock(int fd)
{
	struct flock owner = lock_of(F_WRLCK, OWNER);
	return fcntl(fd, F_OFD_SETLK, &owner) == 0;
}

bool ob_segment_is_owned(int fd)
{
	struct flock found = lock_of(F_RDLCK, OWNER);
	return fcntl(fd, F_OFD_GETLK, &found) == 0 && found.l_type != F_UNLCK;
}

void ob_segment_read(int fd)
{
	struct flock reader = lock_of(F_RDLCK, READERS);
	fcntl(fd, F_OFD_SETLK, &reader);
}

bool ob_segment_is_read(int fd)
{
	struct flock found = lock_of(F_WRLCK, READERS);
	return fcntl(fd, F_OFD_GETLK, &found) == 0 && found.l_type != F_UNLCK;
}

int ob_segment_create(ob_error *e)
{
	int fd = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
	if (fd >= 0 && lock(fd))
		return fd;
	ob_fail(e, "cannot create shared memory in %s: %s", folder, strerror(errno));
	if (fd >= 0)
		close(fd);
	return -1;
}

// Opens the file of this path without waiting, if it is a regular one.
static int open_file(const char *path, int access_mode)
{
	struct stat s;
	int fd = open(path, access_mode | HOW);
	if (fd >= 0 && fstat(fd, &s) == 0 && S_ISREG(s.st_mode))
		return fd;
	if (fd >= 0)
		close(fd);
	return -1;
}

int ob_segment_open(const char *name)
{
	char path[OB_SEGMENT_PATH_MAX];
	return ob_segment_path(path, name) ? open_file(path, O_RDONLY) : -1;
}

bool ob_segment_peek(int fd, ob_header *out, uint64_t *bytes)
{
	struct stat s;
	*bytes = 0;
	if (fstat(fd, &s) != 0 || pread(fd, out, sizeof *out, 0) != sizeof *out)
		return false;
	*bytes = (uint64_t)s.st_size;
	return true;
}

// The caller holds the lock: if the path leads to this file now, it does so until the caller removes it.
static void unlink_file(int fd, const char *path)
{
	struct stat file, named;
	if (fstat(fd, &file) == 0 && lstat(path, &named) == 0 && file.st_dev == named.st_dev &&
	    file.st_ino == named.st_ino)
		unlink(path);
}

void ob_segment_unlink(int fd, const char *name)
{
	char path[sizeof folder + sizeof prefix + OB_NAME_MAX];
	size_t n = strnlen(name, OB_NAME_MAX - 1), at = sizeof folder - 1;
	memcpy(path, folder, at); // snprintf is not allowed in a signal handler
	path[at++] = '/';
	memcpy(path + at, prefix, sizeof prefix - 1);
	memcpy(path + at + sizeof prefix - 1, name, n);
	path[at + sizeof prefix - 1 + n] = 0;
	unlink_file(fd, path);
}

static void remove_if_stale(const char *path)
{
	ob_header h;
	uint64_t bytes;
	struct stat s;
	int fd = open_file(path, O_RDWR);
	if (fd < 0)
		return;
	if (fstat(fd, &s) == 0 && s.st_uid == geteuid() && ob_segment_peek(fd, &h, &bytes) &&
	    h.magic == OB_LAYOUT_MAGIC && lock(fd))
		unlink_file(fd, path);
	close(fd);
}

// Next name in the folder that could be a universe's; NULL: no more.
static const char *next_name(DIR *d)
{
	const size_t skip = sizeof prefix - 1;
	char path[OB_SEGMENT_PATH_MAX];
	for (struct dirent *entry; (entry = readdir(d));)
		if (strncmp(entry->d_name, prefix, skip) == 0 && ob_segment_path(path, entry->d_name + skip))
			return entry->d_name + skip;
	return NULL;
}

void ob_segment_remove_stale(void)
{
	char path[OB_SEGMENT_PATH_MAX];
	DIR *d = opendir(folder);
	if (!d)
		return;
	for (const char *name; (name = next_name(d));)
		if (ob_segment_path(path, name))
			remove_if_stale(path);
	closedir(d);
}

static bool refuse_name(const char *name, const char *path, ob_error *e)
{
	int fd = open_file(path, O_RDONLY);
	bool owned = fd >= 0 && ob_segment_is_owned(fd);
	if (fd >= 0)
		close(fd);
	return owned ? ob_fail(e, "universe \"%s\" already runs on this machine; give this one another name", name)
		     : ob_fail(e, "%s is there and is no universe of yours: remove it, or give this run another name",
			       path);
}

bool ob_segment_publish(int fd, const char *name, ob_error *e)
{
	char path[OB_SEGMENT_PATH_MAX], open_path[40];
	if (!ob_segment_path(path, name))
		return ob_fail(e, "\"%.60s\" cannot be a universe's name: 1 to %d of A-Z a-z 0-9 . _ -", name,
			       OB_NAME_MAX - 1);
	snprintf(open_path, sizeof open_path, "/proc/self/fd/%d", fd);
	for (int attempt = 0;; attempt++) {
		if (linkat(AT_FDCWD, open_path, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0)
			return true;
		if (errno != EEXIST)
			return ob_fail(e, "cannot give shared memory the name %s: %s", path, strerror(errno));
		if (attempt == ATTEMPTS)
			return refuse_name(name, path, e);
		remove_if_stale(path);
	}
}

static int newest_first(const void *a, const void *b)
{
	uint64_t x = ((const ob_header *)a)->created, y = ((const ob_header *)b)->created;
	return (x < y) - (x > y);
}

static bool is_running(const char *name, ob_header *h)
{
	uint64_t bytes;
	int fd = ob_segment_open(name);
	bool runs = fd >= 0 && ob_segment_peek(fd, h, &bytes) && ob_layout_valid(h, bytes) && ob_segment_is_owned(fd);
	if (fd >= 0)
		close(fd);
	return runs;
}

size_t ob_universe_list(char names[][OB_NAME_MAX], size_t max)
{
	enum { MOST = 256 };
	ob_header *found = calloc(MOST, sizeof *found);
	DIR *d = opendir(folder);
	size_t n = 0;
	for (const char *name; found && d && n < MOST && (name = next_name(d));)
		if (is_running(name, &found[n]))
			memcpy(found[n++].name, name, strlen(name) + 1);
	if (d)
		closedir(d);
	if (found)
		qsort(found, n, sizeof *found, newest_first);
	for (size_t i = 0; i < n && i < max; i++)
		memcpy(names[i], found[i].name, OB_NAME_MAX);
	free(found);
	return n;
}
