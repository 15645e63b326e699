#include "cli/options.h"

#include <string.h>

static const struct {
	ob_command_bit command;
	const char *usage, *what;
} commands[] = {
	{ OB_COMMAND_RUN, "obsim run SCENE.lua [OPTION ...]",
	  "Runs a scene, each object a simulator of its own, and reports speed and error." },
	{ OB_COMMAND_COMPARE, "obsim compare SCENE.lua [OPTION ...]",
	  "Runs a scene as one world, as threads and as processes, and prints one table." },
	{ OB_COMMAND_TOP, "obsim top [NAME] [OPTION ...]",
	  "Looks into a running universe (the newest, unless named) from another terminal." },
	{ OB_COMMAND_LAB, "obsim lab [CASE ...] [OPTION ...]",
	  "Runs hard cases with several engines: error against target and against cost." },
	{ OB_COMMAND_PAPER, "obsim paper [OPTION ...]",
	  "Repeats the experiment of the paper behind obsim, and judges its claims." },
};

void ob_options_help(FILE *f, ob_command_bit command)
{
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		if (commands[i].command == command)
			fprintf(f, "Usage: %s\n%s\n", commands[i].usage, commands[i].what);
	}
	const char *group = NULL, *shown = NULL;
	for (int i = 0; i < OB_OPTIONS; i++) {
		const ob_option *o = &ob_option_table[i];
		group = o->group ? o->group : group;
		if (!(o->commands & command))
			continue;
		if (group != shown)
			fprintf(f, "\n%s:\n", group);
		shown = group;
		char left[64];
		snprintf(left, sizeof left, "%s%c%s--%s %s", o->letter ? "-" : " ", o->letter ? o->letter : ' ',
			 o->letter ? ", " : "  ", o->name, o->argument ? o->argument : "");
		fprintf(f, "  %-32s %s\n", left, o->help);
	}
	if (command == OB_COMMAND_TOP)
		fputs("\nKeys: q quits, w shows workers or objects, s sorts by id or speed, arrows and page keys "
		      "scroll.\n",
		      f);
	if (command == OB_COMMAND_LAB)
		fputs("\nA CASE is a name, a row of the table (14), or the start or pattern of names (stack, '*-10'); "
		      "without one, all.\nThe same command goes on where it was interrupted.\n",
		      f);
	fprintf(f, "\nDefaults stand in brackets. Exit: 0 done, 1 failed or interrupted, 2 wrong usage%s.\n",
		command == OB_COMMAND_LAB ? ", 3 a target missed" : " or scene");
}

void ob_options_overview(FILE *f)
{
	fputs("Usage: obsim COMMAND [OPTION ...]\n"
	      "Emulates object-based simulators: every object of a scene is a simulator of its own.\n\n",
	      f);
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
		fprintf(f, "  %-38s %s\n", commands[i].usage, commands[i].what);
	fputs("\n  obsim COMMAND --help                   The options of a command.\n"
	      "  obsim --version                        Version, commit and libraries.\n\n"
	      "Try: obsim run scenes/falling_boxes.lua -D n=100\n",
	      f);
}
