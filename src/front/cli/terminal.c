#include "cli/terminal.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static struct termios before;
static volatile sig_atomic_t resized, ended;
static const int watched[] = { SIGWINCH, SIGINT, SIGTERM, SIGHUP };
enum { WATCHED = sizeof watched / sizeof *watched };
static struct sigaction actions_before[WATCHED];
static sigset_t mask_before;

static void on_signal(int number)
{
	if (number == SIGWINCH)
		resized = 1;
	else
		ended = 1;
}

static void say(const char *text, size_t length)
{
	while (length > 0) {
		ssize_t n = write(STDOUT_FILENO, text, length);
		if (n < 0 && errno != EINTR) {
			ended = 1;
			return;
		}
		text += n > 0 ? n : 0;
		length -= n > 0 ? (size_t)n : 0;
	}
}

bool ob_terminal_enter(void)
{
	if (tcgetattr(STDIN_FILENO, &before) != 0)
		return false;
	// signals come only while the terminal waits for a key, so that none is missed
	struct sigaction action = { .sa_handler = on_signal };
	sigset_t mask;
	sigemptyset(&mask);
	for (int i = 0; i < WATCHED; i++)
		sigaddset(&mask, watched[i]);
	sigprocmask(SIG_BLOCK, &mask, &mask_before);
	for (int i = 0; i < WATCHED; i++)
		sigaction(watched[i], &action, &actions_before[i]);
	struct termios raw = before;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	raw.c_cc[VMIN] = 0;
	raw.c_cc[VTIME] = 0;
	tcsetattr(STDIN_FILENO, TCSANOW, &raw);
	static const char enter[] = "\033[?1049h\033[?25l\033[2J"; // alternate screen, no cursor, clear
	say(enter, sizeof enter - 1);
	return true;
}

void ob_terminal_leave(void)
{
	static const char leave[] = "\033[?25h\033[?1049l";
	say(leave, sizeof leave - 1);
	tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
	for (int i = 0; i < WATCHED; i++)
		sigaction(watched[i], &actions_before[i], NULL);
	sigprocmask(SIG_SETMASK, &mask_before, NULL);
}

void ob_terminal_size(int *columns, int *lines)
{
	struct winsize w = { 0 };
	bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) == 0 && w.ws_col > 0 && w.ws_row > 0;
	*columns = known ? w.ws_col : 80;
	*lines = known ? w.ws_row : 24;
}

void ob_terminal_show(const char *text, size_t length)
{
	static const char home[] = "\033[H", clear_line[] = "\033[K", clear_rest[] = "\033[J";
	say(home, sizeof home - 1);
	while (length > 0) {
		const char *end = memchr(text, '\n', length);
		size_t n = end ? (size_t)(end - text) : length;
		bool last = !end || n + 1 == length;
		say(text, n);
		say(clear_line, sizeof clear_line - 1);
		if (!last)
			say("\r\n", 2); // not after the last line, or the screen would scroll
		text += end ? n + 1 : n;
		length -= end ? n + 1 : n;
	}
	say(clear_rest, sizeof clear_rest - 1);
}

static ob_key name_key(const char *bytes)
{
	static const struct {
		const char *bytes;
		ob_key key;
	} keys[] = {
		{ "q", OB_KEY_QUIT },      { "Q", OB_KEY_QUIT },          { "\003", OB_KEY_QUIT },
		{ "k", OB_KEY_UP },        { "j", OB_KEY_DOWN },          { " ", OB_KEY_PAGE_DOWN },
		{ "w", OB_KEY_WORKERS },   { "s", OB_KEY_SORT },          { "n", OB_KEY_SENSORS },
		{ "\033[A", OB_KEY_UP },   { "\033[B", OB_KEY_DOWN },     { "\033OA", OB_KEY_UP },
		{ "\033OB", OB_KEY_DOWN }, { "\033[5~", OB_KEY_PAGE_UP }, { "\033[6~", OB_KEY_PAGE_DOWN },
		{ "\033[H", OB_KEY_HOME }, { "\033[F", OB_KEY_END },      { "\033[1~", OB_KEY_HOME },
		{ "\033[4~", OB_KEY_END },
	};
	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
		if (strcmp(keys[i].bytes, bytes) == 0)
			return keys[i].key;
	}
	return OB_KEY_NONE;
}

// Reads one key: a character, or a whole escape sequence, which a terminal sends in one piece
static ob_key read_key(void)
{
	char bytes[8] = "";
	ssize_t n = read(STDIN_FILENO, bytes, 1);
	if (n == 0 || (n < 0 && errno != EINTR))
		return OB_KEY_QUIT;
	if (bytes[0] == '\033') {
		for (size_t i = 1; i + 1 < sizeof bytes && read(STDIN_FILENO, &bytes[i], 1) == 1; i++) {
			if (i > 1 && bytes[i] >= '@')
				break;
		}
	}
	return name_key(bytes);
}

ob_key ob_terminal_key(double timeout)
{
	struct pollfd p = { .fd = STDIN_FILENO, .events = POLLIN };
	struct timespec t = { (time_t)timeout, (long)((timeout - (double)(time_t)timeout) * 1e9) };
	int n = ppoll(&p, 1, &t, &mask_before);
	if (ended)
		return OB_KEY_QUIT;
	if (resized) {
		resized = 0;
		return OB_KEY_RESIZE;
	}
	return n > 0 ? read_key() : OB_KEY_NONE;
}
