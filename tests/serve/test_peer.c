// User of the other end of a connection: by lines as Linux writes them, and by connections of this program.
#include "check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "serve/door.h"

static ob_peer_end end_of(const char *address, unsigned port)
{
	ob_peer_end end = { .port = port };
	CHECK(inet_pton(AF_INET6, address, end.word) == 1);
	return end;
}

// Finds a user in these lines of a table; -1: none.
static long user_in(const char *lines, const char *own, unsigned own_port, const char *other, unsigned other_port)
{
	const ob_peer_end near = end_of(own, own_port), far = end_of(other, other_port);
	unsigned user = 0;
	FILE *f = fmemopen((void *)(uintptr_t)lines, strlen(lines), "r");
	const bool found = f && ob_peer_find_user(f, &near, &far, &user);
	CHECK(f != NULL);
	if (f)
		fclose(f);
	return found ? (long)user : -1;
}

// Lines of a little-endian machine.
static void test_lines(void)
{
	static const char four[] =
		"  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
		"   0: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000        0 4711 1 "
		"0000000000000000 100 0 0 10 0\n"
		"   1: 0100007F:8A3C 0100007F:1F90 01 00000000:00000000 00:00000000 00000000  1000        0 4712 1 "
		"0000000000000000 20 4 30 10 -1\n"
		"   2: 0100007F:8A3D 0100007F:1F90 05 00000000:00000000 00:00000000 00000000     0        0 0 1 "
		"0000000000000000 20 4 30 10 -1\n"
		"   3: 0100007F:8A3E 0100007F:1F90 06 00000000:00000000 03:00001234 00000000     0        0 0 3 "
		"0000000000000000\n"
		"   4: 0100007F:8A3F 0100007F:1F90 01 00000000:00000000 00:00000000 00000000     0        0 4713 1 "
		"0000000000000000 20 4 30 10 -1\n"
		"   5: 0100007F:8A40 0100007F:1F90 01 00000000:00000000 00:00000000 00000000";
	static const char six[] =
		"  sl  local_address                         remote_address                        st tx_queue "
		"rx_queue "
		"tr tm->when retrnsmt   uid  timeout inode\n"
		"   0: 00000000000000000000000001000000:8A3C 00000000000000000000000001000000:1F90 01 "
		"00000000:00000000 00:00000000 00000000  1001        0 4714 1 0000000000000000 20 4 30 10 -1\n"
		"   1: 0000000000000000FFFF00000100007F:8A3D 0000000000000000FFFF00000100007F:1F90 01 "
		"00000000:00000000 00:00000000 00000000  1002        0 4715 1 0000000000000000 20 4 30 10 -1\n"
		"   2: 00000000000000000000000001000000:8A3E 00000000000000000000000001000000:1F90 04 "
		"00000000:00000000 00:00000000 00000000     0        0 0 1 0000000000000000 20 4 30 10 -1\n";
	static const char v4[] = "::ffff:127.0.0.1", v6[] = "::1";
	CHECK(user_in(four, v4, 0x8a3c, v4, 8080) == 1000);
	CHECK(user_in(four, v4, 0x8a3d, v4, 8080) == -1); // closed by its program
	CHECK(user_in(four, v4, 0x8a3e, v4, 8080) == -1); // waits for stray packets
	CHECK(user_in(four, v4, 0x8a3f, v4, 8080) == 0);
	CHECK(user_in(four, v4, 0x8a40, v4, 8080) == -1); // cut off
	CHECK(user_in(four, v4, 8080, v4, 0x8a3c) == -1);
	CHECK(user_in(four, v4, 0x8a3c, "::ffff:127.0.0.2", 8080) == -1);
	CHECK(user_in(four, v6, 0x8a3c, v6, 8080) == -1);
	CHECK(user_in(six, v6, 0x8a3c, v6, 8080) == 1001);
	CHECK(user_in(six, v4, 0x8a3d, v4, 8080) == 1002);
	CHECK(user_in(six, v6, 0x8a3e, v6, 8080) == -1);
	CHECK(user_in("", v4, 0x8a3c, v4, 8080) == -1);
}

static int socket_at(const char *address, struct sockaddr_in6 *at)
{
	struct sockaddr_in *four = (struct sockaddr_in *)at;
	memset(at, 0, sizeof *at);
	const bool six = strchr(address, ':');
	at->sin6_family = six ? AF_INET6 : AF_INET;
	CHECK(inet_pton(at->sin6_family, address, six ? (void *)&at->sin6_addr : (void *)&four->sin_addr) == 1);
	const int s = socket(at->sin6_family, SOCK_STREAM, 0), all = 0;
	if (six)
		setsockopt(s, IPPROTO_IPV6, IPV6_V6ONLY, &all, sizeof all);
	return s;
}

// A connection from one address to another, of whichever kinds their sockets are: this user's while it is open, nobody's
// when its program has closed it.
static void test_connection(const char *server, const char *client)
{
	struct sockaddr_in6 at, to;
	socklen_t n = sizeof at;
	const int listening = socket_at(server, &at), own = socket_at(client, &to);
	const bool bound = bind(listening, (struct sockaddr *)&at, sizeof at) == 0;
	if (own < 0 || (!bound && strchr(server, ':'))) {
		printf("no IPv6 here\n");
	} else {
		CHECK(listen(listening, 1) == 0 && getsockname(listening, (struct sockaddr *)&at, &n) == 0);
		to.sin6_port = at.sin6_port; // sockaddr_in has it at the same place
		CHECK(connect(own, (struct sockaddr *)&to, sizeof to) == 0);
		const int accepted = accept(listening, NULL, NULL);
		CHECK(ob_peer_is_ours(accepted));
		close(own);
		CHECK(!ob_peer_is_ours(accepted));
		close(accepted);
	}
	close(listening);
}

int main(void)
{
	if (htonl(1) != 1)
		test_lines();
	test_connection("127.0.0.1", "127.0.0.1");
	test_connection("127.0.0.1", "::ffff:127.0.0.1");
	test_connection("::1", "::1");
	test_connection("::ffff:127.0.0.1", "127.0.0.1");
	test_connection("::", "127.0.0.1");
	test_connection("::", "::1");
	CHECK(!ob_peer_is_ours(-1));
	return check_end();
}
