#include "host/foreign.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/utf8.h"
#include "host/accounting.h"
#include "host/confine.h"
#include "script/foreign.h"

enum { WORDS_MOST = 8 << 10 }; // bytes of an FMU's text that are handed on

// Text of that number among those that are foreign code.
static uint32_t text_of(const ob_script_directory *d, uint32_t foreign)
{
	uint32_t i = 0;
	for (uint32_t seen = 0; i < d->scripts; i++)
		if (ob_script_is_foreign(d, i + 1) && seen++ == foreign)
			break;
	return i;
}

static bool confine(void *u, ob_error *e)
{
	return ob_confine_loaded(u, e);
}

_Noreturn static void run(const ob_foreign_owner *o, const ob_foreign_process *p, pid_t parent)
{
	const ob_script_directory *d = ob_universe_step_data(o->u)->script_text;
	const uint32_t i = text_of(d, p->foreign), size = d->text[i].size;
	void *model = malloc(size);
	static char output[4096]; // the C library would look for a size, which a hardened process may not
	sigset_t none;
	ob_error e;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent || !model)
		_exit(EXIT_FAILURE);
	setsid();
	prctl(PR_SET_NAME, "obsim-fmu");
	for (int s = 1; s < NSIG; s++)
		signal(s, SIG_DFL);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	dup2(o->words, STDERR_FILENO);
	close_range(STDERR_FILENO + 1, ~0U, 0);
	setvbuf(stdout, output, _IOFBF, sizeof output);
	memcpy(model, (const char *)d + d->text[i].offset, size);
	if (!ob_desk_keep_alone(o->u, &p->desk) || !ob_confine_foreign(o->u, &e))
		_exit(EXIT_FAILURE);
	ob_script_serve_foreign(&p->desk, p->number, model, size, confine, o->u);
}

static void start(ob_foreign_owner *o, const ob_desk *d)
{
	int error = ENOMEM;
	ob_foreign_process p = { .desk = *d, .foreign = ob_desk_foreign(o->u, d) };
	p.number = ob_desk_open(d);
	if (OB_MAKE_ROOM(o->process, o->processes, o->room)) {
		const pid_t self = getpid();
		p.pid = fork();
		if (p.pid == 0)
			run(o, &p, self);
		error = errno;
	}
	if (p.pid > 0)
		o->process[o->processes++] = p;
	else
		ob_desk_close(d, p.number, &(ob_desk_end){ .error = error });
}

static ob_foreign_process *process_at(const ob_foreign_owner *o, uint32_t index)
{
	for (uint32_t i = 0; i < o->processes; i++)
		if (o->process[i].desk.index == index)
			return &o->process[i];
	return NULL;
}

void ob_foreign_answer_calls(ob_foreign_owner *o)
{
	uint32_t call[2]; // desk, number of the new process
	while (read(o->bell, call, sizeof call) == sizeof call) {
		const ob_desk d = ob_desk_at(o->u, call[0]);
		if (!d.slip || call[1] != ob_desk_number(&d) + 1)
			continue;
		ob_foreign_process *p = process_at(o, call[0]);
		if (!p) {
			start(o, &d);
			continue;
		}
		p->again = true;
		kill(p->pid, SIGKILL);
	}
}

// ---- words

static void hand_on(ob_foreign_owner *o, ob_foreign_process *p)
{
	const ob_script_directory *d = ob_universe_step_data(o->u)->script_text;
	uint32_t *written = &o->written[p->foreign];
	char line[sizeof p->line + 2 * OB_NAME_MAX];
	p->line[p->line_bytes] = 0;
	ob_utf8_make_plain(p->line);
	if (*written <= WORDS_MOST) {
		*written += p->line_bytes + 1;
		const int n =
			snprintf(line, sizeof line, "%.*s: %s\n", OB_NAME_MAX, d->text[text_of(d, p->foreign)].name,
				 *written <= WORDS_MOST ? p->line : "(the rest of its output is left out)");
		ob_words_hand_on(line, (size_t)n);
	}
	p->line_bytes = 0;
}

bool ob_foreign_take_words(ob_foreign_owner *o, pid_t pid, const char *text, size_t n)
{
	ob_foreign_process *p = NULL;
	for (uint32_t i = 0; i < o->processes && !p; i++)
		p = o->process[i].pid == pid ? &o->process[i] : NULL;
	if (p)
		p->wrote = true;
	for (size_t i = 0; p && i < n; i++) {
		if (text[i] != '\n')
			p->line[p->line_bytes++] = text[i] ? text[i] : '?';
		if (text[i] == '\n' || p->line_bytes == sizeof p->line - 1)
			hand_on(o, p);
	}
	return p;
}

// ---- ends

bool ob_foreign_reap(ob_foreign_owner *o, pid_t pid, int status)
{
	uint32_t i = 0;
	while (i < o->processes && o->process[i].pid != pid)
		i++;
	if (i == o->processes)
		return false;
	ob_foreign_process *p = &o->process[i];
	const ob_desk d = p->desk;
	const bool again = p->again;
	if (p->line_bytes)
		hand_on(o, p);
	ob_desk_close(&d, p->number, &(ob_desk_end){ .status = status, .hung = p->hung });
	*p = o->process[--o->processes];
	if (again)
		start(o, &d);
	return true;
}

void ob_foreign_watch(ob_foreign_owner *o)
{
	static const double interval = .05; // s
	const double now = ob_clock_wall();
	if (now - o->looked < interval)
		return;
	o->looked = now;
	for (uint32_t i = 0; i < o->processes; i++) {
		ob_foreign_process *p = &o->process[i];
		uint32_t shares;
		const uint32_t question = ob_desk_question(&p->desk, &shares), done = ob_desk_done(&p->desk);
		const bool further = question != p->question || (done > p->done && done <= shares);
		if (question && further)
			p->count = ob_hang_count_start(ob_clock_cpu_of_process(p->pid));
		if (further)
			p->done = question == p->question ? done : 0;
		p->question = question;
		if (!question || further || p->hung)
			continue;
		const bool denied = p->wrote || ob_state_of_thread(p->pid, p->pid) == 'R';
		p->wrote = false;
		p->hung = ob_hang_count_is_over(&p->count, ob_clock_cpu_of_process(p->pid), denied, o->patience);
		if (p->hung)
			kill(p->pid, SIGKILL);
	}
}

void ob_foreign_kill_all(const ob_foreign_owner *o)
{
	for (uint32_t i = 0; i < o->processes; i++)
		kill(o->process[i].pid, SIGKILL);
}

// ---- words

void ob_words_hand_on(const char *text, size_t n)
{
	enum { PAGE = 4096 }; // a pipe that is ready takes so much
	while (n > 0) {
		struct pollfd p = { .fd = STDERR_FILENO, .events = POLLOUT };
		if (poll(&p, 1, 0) <= 0 || p.revents & (POLLERR | POLLNVAL))
			return;
		const ssize_t written = write(STDERR_FILENO, text, n < PAGE ? n : PAGE);
		if (written <= 0)
			return;
		text += written;
		n -= (size_t)written;
	}
}
