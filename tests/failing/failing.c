// Loaded before a program (LD_PRELOAD), makes one of its calls fail, as any may: FAIL_CALL=KIND:N, the Nth call of a
// kind in the program or in one of its processes, counted on through fork; with N = 0 none. FAIL_MARK=PATH: a file that
// gets a line when the call fails, and one with the number of calls when a process ends.
//
//   alloc   malloc, calloc, realloc, aligned_alloc: no memory
//   fork    fork, pthread_create: no room for a task
//   mmap    mmap: no address space
//   open    open, fopen, shm_open, opendir, socketpair, eventfd, signalfd: no descriptor left
//   write   write, pwrite, ftruncate, posix_fallocate: no space left
#undef _FILE_OFFSET_BITS // otherwise open would be another name of open64
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#pragma GCC visibility push(default) // replacements of libc's functions

enum kind { ALLOC, FORK, MMAP, OPEN, WRITE, KINDS };
static const char *const names[KINDS] = { "alloc", "fork", "mmap", "open", "write" };

static atomic_long calls[KINDS];
static long chosen_call;
static int chosen_kind = -1;
static char mark[256];

static void note(const char *what, long n)
{
	char line[64];
	int size = snprintf(line, sizeof line, "%s %ld\n", what, n), fd;
	if (!*mark ||
	    (fd = (int)syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600)) < 0)
		return;
	syscall(SYS_write, fd, line, size);
	syscall(SYS_close, fd);
}

__attribute__((constructor)) static void begin(void)
{
	const char *call = getenv("FAIL_CALL"), *path = getenv("FAIL_MARK");
	snprintf(mark, sizeof mark, "%s", path ? path : "");
	for (int k = 0; call && k < KINDS; k++)
		if (strncmp(call, names[k], strlen(names[k])) == 0) {
			chosen_call = atol(call + strlen(names[k]) + 1);
			chosen_kind = k;
		}
	for (int k = 0; k < KINDS; k++)
		calls[k] = 0; // the loader's own
}

__attribute__((destructor)) static void end(void)
{
	if (chosen_kind >= 0)
		note("calls", calls[chosen_kind]);
}

static int fails(enum kind k, int error)
{
	if ((int)k != chosen_kind || atomic_fetch_add(&calls[k], 1) + 1 != chosen_call)
		return 0;
	note("failed", chosen_call);
	errno = error;
	return 1;
}

#define NEXT(f) ((__typeof__(&f))next(#f))

static void *next(const char *name)
{
	return dlsym(RTLD_NEXT, name);
}

// ---- memory: glibc's own under their other names, as dlsym itself allocates

void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);

void *malloc(size_t n)
{
	return fails(ALLOC, ENOMEM) ? NULL : __libc_malloc(n);
}

void *calloc(size_t n, size_t size)
{
	return fails(ALLOC, ENOMEM) ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t n)
{
	return fails(ALLOC, ENOMEM) ? NULL : __libc_realloc(old, n);
}

void *reallocarray(void *old, size_t n, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(n, size, &bytes))
		return NULL;
	return fails(ALLOC, ENOMEM) ? NULL : __libc_realloc(old, bytes);
}

void *aligned_alloc(size_t to, size_t n)
{
	return fails(ALLOC, ENOMEM) ? NULL : __libc_memalign(to, n);
}

// ---- tasks

pid_t fork(void)
{
	return fails(FORK, EAGAIN) ? -1 : NEXT(fork)();
}

int pthread_create(pthread_t *t, const pthread_attr_t *a, void *(*f)(void *), void *x)
{
	return fails(FORK, EAGAIN) ? EAGAIN : NEXT(pthread_create)(t, a, f, x);
}

// ---- address space

void *mmap(void *at, size_t n, int protection, int flags, int fd, off_t from)
{
	return fails(MMAP, ENOMEM) ? MAP_FAILED : (void *)syscall(SYS_mmap, at, n, protection, flags, fd, from);
}

void *mmap64(void *at, size_t n, int protection, int flags, int fd, off64_t from)
{
	return mmap(at, n, protection, flags, fd, from);
}

// ---- descriptors

int open(const char *path, int flags, ...)
{
	va_list args;
	va_start(args, flags);
	mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, mode_t) : 0;
	va_end(args);
	return fails(OPEN, EMFILE) ? -1 : (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
	va_list args;
	va_start(args, flags);
	mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, mode_t) : 0;
	va_end(args);
	return open(path, flags, mode);
}

FILE *fopen(const char *path, const char *mode)
{
	return fails(OPEN, EMFILE) ? NULL : NEXT(fopen)(path, mode);
}

FILE *fopen64(const char *path, const char *mode)
{
	return fopen(path, mode);
}

int shm_open(const char *name, int flags, mode_t mode)
{
	return fails(OPEN, EMFILE) ? -1 : NEXT(shm_open)(name, flags, mode);
}

DIR *opendir(const char *path)
{
	return fails(OPEN, EMFILE) ? NULL : NEXT(opendir)(path);
}

int socketpair(int domain, int type, int protocol, int fd[2])
{
	return fails(OPEN, EMFILE) ? -1 : (int)syscall(SYS_socketpair, domain, type, protocol, fd);
}

int eventfd(unsigned count, int flags)
{
	return fails(OPEN, EMFILE) ? -1 : (int)syscall(SYS_eventfd2, count, flags);
}

int signalfd(int fd, const sigset_t *mask, int flags)
{
	return fails(OPEN, EMFILE) ? -1 : (int)syscall(SYS_signalfd4, fd, mask, 8, flags);
}

// ---- space

ssize_t write(int fd, const void *from, size_t n)
{
	return fails(WRITE, ENOSPC) ? -1 : syscall(SYS_write, fd, from, n);
}

ssize_t pwrite(int fd, const void *from, size_t n, off_t at)
{
	return fails(WRITE, ENOSPC) ? -1 : syscall(SYS_pwrite64, fd, from, n, at);
}

ssize_t pwrite64(int fd, const void *from, size_t n, off64_t at)
{
	return pwrite(fd, from, n, at);
}

int ftruncate(int fd, off_t n)
{
	return fails(WRITE, ENOSPC) ? -1 : (int)syscall(SYS_ftruncate, fd, n);
}

int ftruncate64(int fd, off64_t n)
{
	return ftruncate(fd, n);
}

int posix_fallocate(int fd, off_t at, off_t n)
{
	return fails(WRITE, ENOSPC) ? ENOSPC : NEXT(posix_fallocate)(fd, at, n);
}

int posix_fallocate64(int fd, off64_t at, off64_t n)
{
	return posix_fallocate(fd, at, n);
}
