// Ownership of a segment's name: files of that name are refused or removed, two processes never own one name, and none
// waits.
#include "../check.h"

#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "table/segment.h"

static char name[OB_NAME_MAX], file[OB_SEGMENT_PATH_MAX];

static ob_universe *create(const char *as, ob_error *e)
{
	ob_universe_setup setup = { .name = as, .capacity = 10, .workers = 1, .isolation = "thread" };
	setup.run = (ob_run_settings){ .step_length = .01, .substeps = 4 };
	return ob_universe_create(&setup, e);
}

// Another kind of file has the name: other names are not affected, this one is refused, and the file stays.
static void check_stranger(const char *what)
{
	ob_error e = { "" };
	struct stat before, after;
	char other[OB_NAME_MAX];
	snprintf(other, sizeof other, "%.40s-other", name);
	CHECK(lstat(file, &before) == 0);
	ob_universe *u = create(other, &e);
	CHECK(u && ob_universe_list(NULL, 0) >= 1);
	ob_universe_destroy(u, true);
	CHECK(!create(name, &e) && strstr(e.text, file));
	CHECK(!ob_universe_attach(name, &e));
	CHECK(lstat(file, &after) == 0 && before.st_ino == after.st_ino);
	printf("%s: %s\n", what, e.text);
	unlink(file);
}

static void make_file(const char *path, size_t bytes)
{
	char text[8192] = "not a universe";
	int fd = open(path, O_CREAT | O_EXCL | O_WRONLY, 0600);
	CHECK(fd >= 0 && write(fd, text, bytes) == (ssize_t)bytes);
	close(fd);
}

static void test_strangers(void)
{
	CHECK(mkfifo(file, 0666) == 0);
	check_stranger("FIFO");
	CHECK(mkdir(file, 0700) == 0);
	check_stranger("directory");
	CHECK(rmdir(file) == 0);
	CHECK(symlink("/dev/zero", file) == 0);
	check_stranger("link");
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	memcpy(address.sun_path, file, strlen(file) + 1);
	int s = socket(AF_UNIX, SOCK_STREAM, 0);
	CHECK(s >= 0 && bind(s, (const struct sockaddr *)&address, sizeof address) == 0);
	check_stranger("socket");
	close(s);
	make_file(file, 0);
	check_stranger("empty file");
	make_file(file, 8192);
	check_stranger("other file");
}

// A link to a running universe is not the universe's name.
static void test_link_to_universe(void)
{
	ob_error e = { "" };
	char link[OB_SEGMENT_PATH_MAX + 8];
	ob_universe *u = create(name, &e);
	snprintf(link, sizeof link, "%s-link", file);
	CHECK(u && symlink(file, link) == 0);
	CHECK(!ob_universe_attach(link + strlen("/dev/shm/obsim."), &e));
	unlink(link);
	ob_universe_destroy(u, true);
}

static bool is_read(ob_universe *u)
{
	ob_universe_look_for_readers(u);
	return ob_universe_is_read(u);
}

// The owner can tell if there are readers, and readers do not block each other, or the next owner.
static void test_readers(void)
{
	ob_error e;
	ob_universe *u = create(name, &e);
	CHECK(u && !is_read(u));
	ob_universe *first = ob_universe_attach(name, &e), *second = ob_universe_attach(name, &e);
	CHECK(first && second && is_read(u) && ob_universe_is_hosted(first));
	ob_universe_detach(first);
	CHECK(is_read(u));
	ob_universe_detach(second);
	CHECK(!is_read(u));
	ob_universe_destroy(u, true);
}

// The owner removes its name, and never the name of a later universe.
static void test_unlink(void)
{
	ob_error e;
	ob_universe *first = create(name, &e);
	ob_universe *reader = ob_universe_attach(name, &e);
	CHECK(first && reader && ob_universe_is_hosted(reader));
	ob_universe_unlink(first);
	ob_universe *second = create(name, &e);
	CHECK(second);
	ob_universe_destroy(first, true);
	CHECK(access(file, F_OK) == 0 && !ob_universe_is_hosted(reader));
	ob_universe_destroy(second, true);
	CHECK(access(file, F_OK) != 0);
	ob_universe_detach(reader);
}

// In a process: takes the name, holds it for a moment, and gives it back or dies with it. Exit 1: another one had it,
// too.
_Noreturn static void contend(unsigned seed)
{
	for (int got = 0; got < 50;) {
		ob_error e;
		ob_universe *u = create(name, &e);
		if (!u)
			continue;
		got++;
		for (int i = 0; i < 5; i++) {
			struct stat named, own;
			if (stat(file, &named) != 0 || fstat(ob_universe_fd(u), &own) != 0 ||
			    named.st_ino != own.st_ino)
				_exit(1);
			sched_yield();
		}
		seed = seed * 1664525u + 1013904223u;
		ob_universe_destroy(u, seed >> 16 & 1); // else it leaves a stale one
	}
	_exit(0);
}

static void test_contention(void)
{
	enum { CONTENDERS = 4 };
	ob_error e;
	for (unsigned i = 0; i < CONTENDERS; i++)
		if (fork() == 0)
			contend(i);
	for (int i = 0; i < CONTENDERS; i++) {
		int status;
		CHECK(wait(&status) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0);
	}
	ob_universe *u = create(name, &e); // the last one's leftover is no obstacle
	CHECK(u);
	ob_universe_destroy(u, true);
	CHECK(access(file, F_OK) != 0);
}

// A run in another pid namespace is as alive as any.
static void test_other_pid_namespace(void)
{
	int ready[2], end[2];
	char byte = 0;
	ob_error e;
	CHECK(pipe(ready) == 0 && pipe(end) == 0);
	pid_t child = fork();
	if (child == 0) {
		if (unshare(CLONE_NEWPID) != 0)
			_exit(0);
		pid_t inner = fork();
		if (inner == 0) {
			ob_universe *u = create(name, &e);
			close(end[1]);
			_exit(write(ready[1], u ? "y" : "n", 1) != 1 || read(end[0], &byte, 1) != 0);
		}
		close(end[1]);
		waitpid(inner, NULL, 0);
		_exit(0);
	}
	close(ready[1]);
	close(end[0]);
	if (read(ready[0], &byte, 1) == 1) {
		CHECK(byte == 'y');
		ob_universe *other = create(NULL, &e); // clears away what is stale
		CHECK(other && access(file, F_OK) == 0 && !create(name, &e) && strstr(e.text, "already runs"));
		ob_universe_destroy(other, true);
	} else {
		puts("no pid namespaces here");
	}
	close(end[1]);
	CHECK(waitpid(child, NULL, 0) == child);
	close(ready[0]);
	ob_universe_destroy(create(name, &e), true);
	CHECK(access(file, F_OK) != 0);
}

int main(void)
{
	snprintf(name, sizeof name, "test-segment-%d", (int)getpid());
	CHECK(ob_segment_path(file, name));
	test_strangers();
	test_link_to_universe();
	test_unlink();
	test_readers();
	test_contention();
	test_other_pid_namespace();
	return check_end();
}
