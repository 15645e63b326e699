#include "cli/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/spelling.h"
#include "cli/command.h"
#include "cli/output.h"
#include "host/worker.h"
#include "measure/colouring.h"

enum {
	RUN = OB_COMMAND_RUN,
	COMPARE = OB_COMMAND_COMPARE,
	TOP = OB_COMMAND_TOP,
	LAB = OB_COMMAND_LAB,
	PAPER = OB_COMMAND_PAPER,
	INSPECT = OB_COMMAND_INSPECT,
	SERVE = OB_COMMAND_SERVE,
	SEND = OB_COMMAND_SEND,
	EXPORT = OB_COMMAND_EXPORT,
	CONTROL = OB_COMMAND_CONTROL,
	SCENES = OB_COMMAND_SCENES,
	IMPORT = OB_COMMAND_IMPORT,
	STEPPED = RUN | SERVE | CONTROL
};

const ob_option ob_option_table[OB_OPTIONS] = {
#define X(id, group, letter, ...) { group, letter, __VA_ARGS__ },
	OB_OPTION_LIST(X)
#undef X
};

// The setting whose option this is; NULL: it is none's.
static const ob_setting *setting_of(const ob_option *o)
{
	return o->help ? NULL : &ob_setting_table[ob_setting_by_name(o->name)];
}

static const char *argument_of(const ob_option *o)
{
	return o->help || o->argument ? o->argument : setting_of(o)->form;
}

// True if the command takes the setting by --set.
static bool takes(ob_command_bit command, const ob_setting *s)
{
	static const unsigned commands[] = { [OB_SETTING_SOLVED] = STEPPED | COMPARE,
					     [OB_SETTING_FREE] = RUN | SERVE,
					     [OB_SETTING_WATCHED] = STEPPED,
					     [OB_SETTING_RUN] = RUN };
	return !(s->flags & OB_SETTING_OPTION) && commands[s->group] & command;
}

static int unknown(const ob_arguments *a, const char *name, ob_error *e)
{
	static const struct {
		const char *former, *now;
	} outs[] = { { "frames", "DIR" }, { "video", "FILE.mp4" }, { "raw", "FILE.rgb, or -" } };
	ob_spelling s = ob_spelling_start(name);
	char word[64];
	snprintf(word, sizeof word, "%s", name);
	for (char *dash; (dash = strchr(word, '-'));)
		*dash = '_';
	const int id = ob_setting_by_name(word);
	const ob_setting *moved = id < 0 ? NULL : &ob_setting_table[id];
	if (moved && takes(a->command, moved))
		return ob_fail(e, "--%s is now --set %s=%s", name, moved->name, moved->form);
	for (size_t i = 0; a->command == OB_COMMAND_RUN && i < sizeof outs / sizeof *outs; i++)
		if (strcmp(outs[i].former, name) == 0)
			return ob_fail(e, "--%s is now --out %s", name, outs[i].now);
	for (int i = 0; i < OB_OPTIONS; i++) {
		if (ob_option_table[i].commands & a->command)
			ob_spelling_offer(&s, ob_option_table[i].name);
	}
	if (s.best)
		return ob_fail(e, "unknown option --%s: did you mean --%s?", name, s.best);
	return ob_fail(e, "unknown option --%s: --help lists the options", name);
}

// Checks a value against names like "obs|monolith"; upper case in them allows anything. Replaces a word of earlier
// versions by the current one. what: the option with its mark before a value, without dashes.
static bool check_choice(const char *what, const char *names, const char **value, ob_error *e)
{
	if (!names || !strchr(names, '|') || strpbrk(names, "ABCDEFGHIJKLMNOPQRSTUVWXYZ"))
		return true;
	const char *now = ob_setting_renamed(*value);
	char words[64];
	snprintf(words, sizeof words, "%s", names);
	ob_spelling s = ob_spelling_start(*value);
	char *rest = words;
	for (char *word; (word = strsep(&rest, "|"));) {
		if (strcmp(word, *value) == 0)
			return true;
		if (now && strcmp(word, now) == 0) {
			ob_log_note("--%s%s is now called --%s%s", what, *value, what, now);
			*value = now;
			return true;
		}
		ob_spelling_offer(&s, word);
	}
	if (s.best)
		return ob_fail(e, "--%s%s: did you mean %s? (%s)", what, *value, s.best, names);
	return ob_fail(e, "--%s%s: expected one of %s", what, *value, names);
}

// Takes --set NAME=VALUE.
static bool set_setting(ob_arguments *a, const char *text, ob_error *e)
{
	const size_t n = strcspn(text, "=");
	char name[32], what[40];
	snprintf(name, sizeof name, "%.*s", (int)n, text);
	if (strcmp(text, "help") == 0) {
		a->value[OB_OPTION_SET] = text;
		return true;
	}
	const int id = ob_setting_by_name(name);
	const ob_setting *s = id < 0 ? NULL : &ob_setting_table[id];
	if (s && s->flags & OB_SETTING_OPTION)
		return ob_fail(e, "--set %s: it has an option of its own: --%s", text, s->name);
	if (!s || !takes(a->command, s)) {
		ob_spelling near = ob_spelling_start(name);
		for (int i = 0; i < OB_SETTINGS; i++)
			if (takes(a->command, &ob_setting_table[i]))
				ob_spelling_offer(&near, ob_setting_table[i].name);
		return near.best ? ob_fail(e, "--set %s: did you mean %s?", text, near.best)
				 : ob_fail(e, "--set %s: there is no such setting here; --set help lists them", text);
	}
	if (strcmp(name, s->name) != 0)
		ob_log_note("--set %s is now called --set %s", name, s->name);
	if (a->setting[id])
		return ob_fail(e, "--set %s is given twice", s->name);
	if (!text[n] || !text[n + 1])
		return ob_fail(e, "--set %s needs a value: --set %s=%s", s->name, s->name, s->form);
	a->setting[id] = text + n + 1;
	snprintf(what, sizeof what, "set %s=", s->name);
	return check_choice(what, s->form, &a->setting[id], e);
}

static bool add_define(ob_arguments *a, const char *text, ob_error *e)
{
	size_t name = strcspn(text, "=");
	if (!text[name] || name == 0)
		return ob_fail(e, "-D %s: expected NAME=VALUE, as in -D n=100", text);
	for (const char **other = a->define; *other; other++) {
		if (strncmp(*other, text, name + 1) == 0)
			return ob_fail(e, "-D %.*s is given twice: %s and %s", (int)name, text, *other, text);
	}
	a->define[a->defines++] = text;
	return true;
}

// Takes --out of obsim run, once for each kind.
static bool set_out(ob_arguments *a, const char *path, ob_error *e)
{
	ob_out kind;
	if (!ob_output_kind(path, &kind, e))
		return false;
	if (a->out[kind])
		return ob_fail(e, "--out %s and --out %s are of one kind: leave one away", a->out[kind], path);
	a->out[kind] = a->value[OB_OPTION_PICTURES] = path;
	return true;
}

static bool is_optional(const char *argument)
{
	return argument && argument[0] == '[';
}

static bool set(ob_arguments *a, ob_option_id id, const char *value, ob_error *e)
{
	const ob_option *o = &ob_option_table[id];
	const char *argument = argument_of(o);
	const ob_setting *setting = setting_of(o);
	const char **to = setting ? &a->setting[setting - ob_setting_table] : &a->value[id];
	char what[40];
	if (id == OB_OPTION_DEFINE)
		return add_define(a, value, e);
	if (id == OB_OPTION_SET)
		return set_setting(a, value, e);
	if (id == OB_OPTION_PICTURES)
		return set_out(a, value, e);
	if (*to)
		return ob_fail(e, "--%s is given twice", o->name);
	if (argument && !*value && !is_optional(argument))
		return ob_fail(e, "--%s needs a value: --%s %s", o->name, o->name, argument);
	snprintf(what, sizeof what, "%s ", o->name);
	if (!check_choice(what, argument, &value, e) || !ob_output_check(id, o->name, value, e))
		return false;
	*to = value;
	return true;
}

static int find_long(const ob_arguments *a, const char *name, size_t length)
{
	for (int i = 0; i < OB_OPTIONS; i++) {
		const ob_option *o = &ob_option_table[i];
		if ((o->commands & a->command) && strncmp(o->name, name, length) == 0 && !o->name[length])
			return i;
	}
	return -1;
}

static int find_short(const ob_arguments *a, char letter)
{
	for (int i = 0; i < OB_OPTIONS; i++) {
		if ((ob_option_table[i].commands & a->command) && ob_option_table[i].letter == letter)
			return i;
	}
	return -1;
}

// Parses one option at *at; moves *at past a value in an argument of its own.
static bool take_option(ob_arguments *a, int argc, char **argv, int *at, ob_error *e)
{
	const char *text = argv[*at], *value = NULL;
	int id;
	if (text[1] == '-') {
		size_t length = strcspn(text + 2, "=");
		char name[64];
		snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), text + 2);
		id = find_long(a, text + 2, length);
		if (id < 0)
			return unknown(a, name, e);
		value = text[2 + length] ? text + 2 + length + 1 : NULL;
	} else {
		id = find_short(a, text[1]);
		if (id < 0)
			return find_long(a, text + 1, strlen(text + 1)) >= 0
				       ? ob_fail(e, "unknown option %s: did you mean -%s?", text, text)
				       : ob_fail(e, "unknown option %s: --help lists the options", text);
		value = text[2] ? text + 2 : NULL;
	}
	const ob_option *o = &ob_option_table[id];
	const char *argument = argument_of(o);
	if (is_optional(argument))
		return value && !*value ? ob_fail(e, "--%s=: expected a list behind it, or leave the = away", o->name)
					: set(a, id, value ? value : "", e);
	if (!argument)
		return value ? ob_fail(e, "--%s takes no value", o->name) : set(a, id, "", e);
	if (!value) {
		if (*at + 1 >= argc || strncmp(argv[*at + 1], "--", 2) == 0)
			return ob_fail(e, "--%s needs a value: --%s %s", o->name, o->name, argument);
		value = argv[++*at];
	}
	return set(a, id, value, e);
}

// True for -1 and -.5, which are values: no option is a digit.
static bool is_negative(const char *text)
{
	return text[0] == '-' && strchr("0123456789", text[1 + (text[1] == '.')]) && text[1 + (text[1] == '.')];
}

bool ob_options_parse(ob_arguments *a, ob_command_bit command, int argc, char **argv, ob_error *e)
{
	*a = (ob_arguments){ .command = command };
	a->define = calloc((size_t)argc + 1, sizeof *a->define);
	a->operands = calloc((size_t)argc + 1, sizeof *a->operands);
	if (!a->define || !a->operands)
		return ob_fail(e, "out of memory");
	bool only_operands = false;
	int operands = 0;
	for (int i = 0; i < argc; i++) {
		if (!only_operands && strcmp(argv[i], "--") == 0) {
			only_operands = true;
		} else if (!only_operands && argv[i][0] == '-' && argv[i][1] && !is_negative(argv[i])) {
			if (!take_option(a, argc, argv, &i, e))
				return false;
		} else if (a->operand && command != OB_COMMAND_LAB && command != OB_COMMAND_SEND &&
			   !(command == OB_COMMAND_EXPORT && operands < 2)) {
			return ob_fail(e, "unexpected '%s' after '%s': one %s at a time", argv[i], a->operand,
				       command == OB_COMMAND_TOP       ? "universe"
				       : command == OB_COMMAND_INSPECT ? "checkpoint"
				       : command == OB_COMMAND_IMPORT  ? "model"
				       : command == OB_COMMAND_EXPORT  ? "record and one page"
								       : "scene");
		} else {
			a->operands[operands++] = argv[i];
			a->operand = a->operands[0];
		}
	}
	return true;
}

void ob_options_finish(ob_arguments *a)
{
	free(a->define);
	free(a->operands);
	*a = (ob_arguments){ 0 };
}

bool ob_options_define(ob_arguments *own, const ob_arguments *a, const char *define, ob_error *e)
{
	*own = *a;
	own->define = calloc(a->defines + 2, sizeof *own->define);
	if (!own->define)
		return ob_fail(e, "out of memory");
	if (a->defines)
		memcpy(own->define, a->define, a->defines * sizeof *own->define);
	if (*define)
		own->define[own->defines++] = define;
	return true;
}

_Static_assert(OB_OPTIONS <= 64, "each has a bit of a set");

ob_setting_word ob_options_given(const ob_arguments *a, uint64_t options, uint64_t settings)
{
	ob_setting_word found = { "" };
	for (int i = 0; i < OB_SETTINGS; i++)
		if (a->setting[i] && settings >> i & 1)
			found = ob_setting_option((ob_setting_id)i);
	for (int i = 0; i < OB_OPTIONS; i++)
		if ((i == OB_OPTION_DEFINE ? a->defines > 0 : a->value[i] != NULL) && options >> i & 1)
			snprintf(found.text, sizeof found.text, "%s", ob_option_table[i].name);
	return found;
}

bool ob_options_refuse(const ob_arguments *a, uint64_t options, uint64_t settings, const char *why, ob_error *e)
{
	const ob_setting_word given = ob_options_given(a, options, settings);
	return !*given.text || ob_fail(e, "--%s%s", given.text, why);
}

static const struct {
	ob_command_bit command;
	const char *usage, *what;
} commands[] = {
	{ OB_COMMAND_RUN, "obsim run SCENE.lua [OPTION ...]",
	  "Runs a scene, each object a simulator of its own, and reports speed and error." },
	{ OB_COMMAND_SERVE, "obsim serve SCENE.lua [OPTION ...]",
	  "Runs a scene that people look at, and change, from their browsers." },
	{ OB_COMMAND_CONTROL, "obsim control SCENE.lua [OPTION ...]",
	  "Runs a scene that a program leads step by step: Python, or C." },
	{ OB_COMMAND_SCENES, "obsim scenes", "Lists the scenes that come with obsim: obsim run NAME." },
	{ OB_COMMAND_COMPARE, "obsim compare SCENE.lua [OPTION ...]",
	  "Runs a scene as one world, as threads and as processes, and prints one table." },
	{ OB_COMMAND_TOP, "obsim top [NAME] [OPTION ...]",
	  "Looks into a running universe (the newest, unless named) from another terminal." },
	{ OB_COMMAND_SEND, "obsim send NAME REQUEST ...", "Changes objects of a running universe, or sends messages." },
	{ OB_COMMAND_EXPORT, "obsim export FILE.h5 PAGE.html [OPTION ...]",
	  "Makes a page of what was recorded, for any browser, or MCAP (FILE.mcap)." },
	{ OB_COMMAND_IMPORT, "obsim import FILE [--out DIR]",
	  "Makes a scene of a robot, or another model, in MJCF or URDF." },
	{ OB_COMMAND_INSPECT, "obsim inspect FILE [OPTION ...]",
	  "Says what a checkpoint holds, and whether it is whole." },
	{ OB_COMMAND_LAB, "obsim lab [CASE|FILE.lua ...] [OPTION ...]",
	  "Runs hard cases with several engines: error against target and cost." },
	{ OB_COMMAND_PAPER, "obsim paper [OPTION ...]",
	  "Repeats the experiment of the paper behind obsim, and judges its claims." },
};

// Meanings of an option to one command, where another has it with other words.
static const struct {
	ob_option_id id;
	unsigned command;
	const char *help;
} own_help[] = {
	{ OB_OPTION_PACE, SERVE, "simulated seconds a second of the clock (realtime)" },
	{ OB_OPTION_ISOLATION, SERVE, "what a worker is (process)" },
	{ OB_OPTION_ON_DEATH, SERVE, "what a death or failure does: restart, freeze, end, or keep what can be (keep)" },
	{ OB_OPTION_CHECKPOINT, SERVE, "where operators save what the run needs to go on" },
	{ OB_OPTION_ROOM, CONTROL, "objects that the program may add (1000)" },
	{ OB_OPTION_REPEATS, COMPARE, "runs of each; times are their medians (3)" },
	{ OB_OPTION_REPEATS, PAPER, "runs of each; times are their medians (15)" },
	{ OB_OPTION_OUT, LAB, "folder for results, diagrams, report (obsim-lab)" },
	{ OB_OPTION_OUT, PAPER, "folder for results, diagrams, report (obsim-paper)" },
	{ OB_OPTION_OUT, IMPORT, "folder for the scene and its looks (the scene alone, to standard output)" },
};

static const char *help_of(ob_option_id id, ob_command_bit command)
{
	for (size_t i = 0; i < sizeof own_help / sizeof *own_help; i++)
		if (own_help[i].id == id && own_help[i].command == command)
			return own_help[i].help;
	const ob_option *o = &ob_option_table[id];
	return o->help ? o->help : setting_of(o)->help;
}

static void print_line(FILE *f, const char *left, const char *help)
{
	fprintf(f, "  %-32s%s%s\n", left, strlen(left) > 32 ? "\n                                   " : " ", help);
}

void ob_options_help_set(FILE *f, ob_command_bit command)
{
	static const char *const titles[] = { [OB_SETTING_SOLVED] = "How it is solved",
					      [OB_SETTING_FREE] = "With --sync free",
					      [OB_SETTING_WATCHED] = "How simulators are watched",
					      [OB_SETTING_RUN] = "What comes of it" };
	fputs("Settings: --set NAME=VALUE, any number of them. Defaults stand in brackets.\n", f);
	int shown = -1;
	for (int i = 0; i < OB_SETTINGS; i++) {
		const ob_setting *s = &ob_setting_table[i];
		char left[128];
		if (!takes(command, s))
			continue;
		if ((int)s->group != shown)
			fprintf(f, "\n%s:\n", titles[s->group]);
		shown = (int)s->group;
		snprintf(left, sizeof left, "%s=%s", s->name, s->form);
		print_line(f, left, s->help);
	}
}

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
		char left[128];
		const char *argument = argument_of(o);
		snprintf(left, sizeof left, "%s%c%s--%s%s%s", o->letter ? "-" : " ", o->letter ? o->letter : ' ',
			 o->letter ? ", " : "  ", o->name, is_optional(argument) ? "" : " ", argument ? argument : "");
		print_line(f, left, help_of((ob_option_id)i, command));
	}
	if (command == OB_COMMAND_TOP)
		fputs("\nKeys: q quits, w shows workers, n sensors, or objects again, s sorts by id or speed, arrows "
		      "and page keys "
		      "scroll.\n",
		      f);
	if (command == OB_COMMAND_RUN)
		fputs("\nobsim run --resume FILE [OPTION ...] goes on with the scene and the settings of the "
		      "checkpoint.\nobsim run --replay FILE.h5 --out DIR draws what was recorded, with the options "
		      "under Pictures.\n",
		      f);
	if (command == OB_COMMAND_SERVE)
		fputs("\nobsim serve --replay FILE.h5 [--listen ADDR:PORT] shows what was recorded, to each viewer at "
		      "a time of "
		      "their own.\n",
		      f);
	if (command == OB_COMMAND_LAB)
		fputs("\nA CASE is a name, a row of the table (14), or the start or pattern of names (stack, '*-10'); "
		      "without one, all.\nThe same command goes on where it was interrupted.\n",
		      f);
	fprintf(f, "\nDefaults stand in brackets. Exit: 0 done, 1 failed or interrupted, 2 wrong usage%s.\n",
		command == OB_COMMAND_LAB       ? ", 3 a target missed"
		: command & STEPPED             ? " or scene, 4 --check found a fault"
		: command == OB_COMMAND_INSPECT ? ", or no whole checkpoint"
		: command == OB_COMMAND_IMPORT  ? ", or no model"
		: command == OB_COMMAND_EXPORT  ? ", or no whole record"
						: " or scene");
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
	      "Try: obsim run falling_boxes -D n=100\n",
	      f);
}

int ob_command_fail(int code, const char *text)
{
	fprintf(stderr, "obsim: %s\n", text);
	return code;
}
