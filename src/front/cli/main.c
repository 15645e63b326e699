// obsim: the command line. Finds the command, reads its options, and leaves the rest to it.
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "base/spelling.h"
#include "cli/command.h"
#include "cli/version.h"
#include "ranks/ranks.h"
#include "table/table.h"

static const struct {
	const char *name;
	ob_command_bit bit;
	int (*main)(const ob_arguments *);
} commands[] = {
	{ "run", OB_COMMAND_RUN, ob_command_run },          { "compare", OB_COMMAND_COMPARE, ob_command_compare },
	{ "top", OB_COMMAND_TOP, ob_command_top },          { "lab", OB_COMMAND_LAB, ob_command_lab },
	{ "paper", OB_COMMAND_PAPER, ob_command_paper },    { "inspect", OB_COMMAND_INSPECT, ob_command_inspect },
	{ "serve", OB_COMMAND_SERVE, ob_command_serve },    { "send", OB_COMMAND_SEND, ob_command_send },
	{ "export", OB_COMMAND_EXPORT, ob_command_export }, { "control", OB_COMMAND_CONTROL, ob_command_control },
	{ "scenes", OB_COMMAND_SCENES, ob_command_scenes }, { "import", OB_COMMAND_IMPORT, ob_command_import },
};
enum { COMMANDS = sizeof commands / sizeof *commands };

static int find(const char *name)
{
	for (int i = 0; i < COMMANDS; i++) {
		if (strcmp(commands[i].name, name) == 0)
			return i;
	}
	return -1;
}

static int unknown_command(const char *name)
{
	ob_spelling s = ob_spelling_start(name);
	for (int i = 0; i < COMMANDS; i++)
		ob_spelling_offer(&s, commands[i].name);
	ob_error e;
	size_t n = strlen(name);
	if (s.best)
		ob_fail(&e, "unknown command '%s': did you mean 'obsim %s'?", name, s.best);
	else if (n > 4 && strcmp(name + n - 4, ".lua") == 0)
		ob_fail(&e, "'%s' is a scene, not a command: obsim run %s", name, name);
	else
		ob_fail(&e, "unknown command '%s': obsim --help lists the commands", name);
	return ob_command_fail(OB_EXIT_USAGE, e.text);
}

// The output is the purpose of a command. A closed pipe is no error: its reader left on purpose.
static int close_output(int code)
{
	ob_error e;
	bool whole = !ferror(stdout);
	errno = 0;
	if ((fclose(stdout) == 0 && whole) || errno == EPIPE)
		return code;
	ob_fail(&e, "standard output cannot be written: %s", errno ? strerror(errno) : "some of it was not taken");
	return code ? code : ob_command_fail(OB_EXIT_FAILED, e.text);
}

static void print_help(ob_command_bit command)
{
	ob_options_help(stdout, command);
	if (command == OB_COMMAND_SEND)
		ob_send_help(stdout);
}

// Only rank 0 prints the line and fails: a launcher ends the others then.
static int refuse_ranks(const char *command)
{
	ob_error e;
	ob_fail(&e, "%s has a single rank: start it without mpirun or srun, or use obsim run, which has several",
		command);
	return ob_ranks_started().rank == 0 ? ob_command_fail(OB_EXIT_USAGE, e.text) : OB_EXIT_OK;
}

static int carry_out(int argc, char **argv)
{
	const char *word = argc > 1 ? argv[1] : NULL;
	if (!word) {
		ob_options_overview(stderr);
		return OB_EXIT_USAGE;
	}
	if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0) {
		ob_version_print(stdout);
		return OB_EXIT_OK;
	}
	if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0) {
		int topic = argc > 2 ? find(argv[2]) : -1;
		if (topic >= 0)
			print_help(commands[topic].bit);
		else if (argc > 2)
			return unknown_command(argv[2]);
		else
			ob_options_overview(stdout);
		return OB_EXIT_OK;
	}
	int command = find(word);
	if (command < 0)
		return unknown_command(word);

	ob_arguments a;
	ob_error e;
	int code = OB_EXIT_OK;
	if (!ob_options_parse(&a, commands[command].bit, argc - 2, argv + 2, &e))
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	else if (a.value[OB_OPTION_HELP])
		print_help(commands[command].bit);
	else if (a.value[OB_OPTION_SET])
		ob_options_help_set(stdout, commands[command].bit);
	else if (ob_ranks_started().ranks > 1 &&
		 (commands[command].bit & (OB_COMMAND_SERVE | OB_COMMAND_CONTROL) || a.value[OB_OPTION_LIVE]))
		code = refuse_ranks(word);
	else
		code = commands[command].main(&a);
	ob_options_finish(&a);
	return code;
}

int main(int argc, char **argv)
{
	ob_pages_guard(NULL); // memory that is not there is an error with the universe's name, ..
	signal(SIGXFSZ, SIG_IGN); // .. and a file that may not grow is an error with its name, not a death
	return close_output(carry_out(argc, argv));
}
