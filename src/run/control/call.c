#include "control/call.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

socklen_t ob_call_address(const char *universe, struct sockaddr_un *a)
{
	*a = (struct sockaddr_un){ .sun_family = AF_UNIX };
	const int n = snprintf(a->sun_path + 1, sizeof a->sun_path - 1, "obsim.%s", universe);
	return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)n);
}

// True if the universe's host itself listens there: any process may bind a free address.
static bool is_host(int fd, const ob_universe_info *info, ob_error *e)
{
	struct ucred who;
	socklen_t n = sizeof who;
	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &n) == 0 && (who.uid == geteuid() || geteuid() == 0) &&
	    (who.pid == info->host_pid || who.pid == 0)) // 0: in a PID namespace that is not visible here
		return true;
	return ob_fail(e,
		       "universe \"%s\" gets no request: process %d of user %u listens at its address, not its host %d",
		       info->name, (int)who.pid, (unsigned)who.uid, (int)info->host_pid);
}

int ob_call_host(const ob_universe *u, ob_error *e)
{
	const struct timeval patience = { .tv_sec = OB_CALL_PATIENCE_MS / 1000 };
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	ob_universe_info info;
	struct sockaddr_un a;
	if (fd < 0)
		return ob_fail(e, "no socket: %s", strerror(errno)) - 1;
	setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience); // limit of connect and send
	ob_universe_get_info(u, &info);
	const socklen_t n = ob_call_address(info.name, &a);
	const bool reached = connect(fd, (struct sockaddr *)&a, n) == 0 ||
			     ob_fail(e, "universe \"%s\" takes no requests: %s", info.name, strerror(errno));
	if (reached && is_host(fd, &info, e))
		return fd;
	close(fd);
	return -1;
}
