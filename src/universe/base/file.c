#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/budget.h"

static int check(int fd, uint64_t most, uint64_t *size, ob_error *e)
{
	struct stat st;
	if (fstat(fd, &st) != 0)
		return ob_fail(e, "%s", strerror(errno));
	if (S_ISDIR(st.st_mode))
		return ob_fail(e, "it is no file, but a directory");
	if (!S_ISREG(st.st_mode))
		return ob_fail(e, "it is no file, but a pipe or a device");
	*size = (uint64_t)st.st_size;
	if (*size <= most)
		return 1;
	return most >> 20 ? ob_fail(e, "it is larger than %" PRIu64 " MiB", most >> 20)
			  : ob_fail(e, "it is larger than %" PRIu64 " KiB", most >> 10);
}

int ob_file_open(const char *path, uint64_t most, uint64_t *size, ob_error *e)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
	if (fd < 0) {
		ob_fail(e, "%s", strerror(errno));
		return -1;
	}
	if (check(fd, most, size, e))
		return fd;
	close(fd);
	return -1;
}

int ob_file_read(int fd, void *to, size_t size, ob_error *e)
{
	char *at = to;
	while (size > 0) {
		const ssize_t n = read(fd, at, size);
		if (n == 0)
			return ob_fail(e, "it became shorter");
		if (n < 0 && errno != EINTR)
			return ob_fail(e, "%s", strerror(errno));
		at += n > 0 ? n : 0;
		size -= n > 0 ? (size_t)n : 0;
	}
	return 1;
}

char *ob_file_load(const char *path, size_t most, size_t *size, ob_error *e)
{
	uint64_t bytes = 0;
	const int fd = ob_file_open(path, most, &bytes, e);
	if (fd < 0)
		return NULL;
	const bool allowed = ob_budget_allows(bytes, e);
	char *text = allowed ? malloc(bytes + 1) : NULL;
	if (allowed && !text)
		ob_fail(e, "no memory");
	const bool good = text && ob_file_read(fd, text, bytes, e);
	close(fd);
	if (good) {
		text[bytes] = 0;
		*size = bytes;
		return text;
	}
	free(text);
	return NULL;
}
