// The options of all commands, as one table: the parser, the help and the checks of the shell completions read it.
#ifndef OB_CLI_OPTIONS_H
#define OB_CLI_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <ob/error.h>

#include "settings/settings.h"

typedef enum ob_command_bit {
	OB_COMMAND_RUN = 1,
	OB_COMMAND_COMPARE = 2,
	OB_COMMAND_TOP = 4,
	OB_COMMAND_LAB = 8,
	OB_COMMAND_PAPER = 16,
	OB_COMMAND_INSPECT = 32,
	OB_COMMAND_SERVE = 64,
	OB_COMMAND_SEND = 128,
	OB_COMMAND_EXPORT = 256,
	OB_COMMAND_CONTROL = 512,
	OB_COMMAND_SCENES = 1024,
	OB_COMMAND_IMPORT = 2048,
} ob_command_bit;

// The table of options, in the order of the help: id, heading of those from here on, short form, name, argument, help,
// commands.
#define OB_OPTION_LIST(X) \
	X(DEFINE, "The scene", 'D', "define", "NAME=VALUE", "set a parameter of the scene", STEPPED | COMPARE) \
	X(VARY, NULL, 0, "vary", "NAME=VALUE,..", "compare at each of these values of a parameter", COMPARE) \
	X(DURATION, NULL, 0, "duration", "S", "simulated seconds (the scene says how many)", STEPPED | COMPARE) \
	X(STEP, NULL, 0, "step", NULL, NULL, STEPPED | COMPARE) \
	X(SEED, NULL, 0, "seed", "N", "seed of the scene's random numbers (the scene's)", STEPPED | COMPARE) \
	X(SET, NULL, 0, "set", "NAME=VALUE|help", "set what experiments vary: --set help lists it", STEPPED | COMPARE) \
	X(ARCH, "How it runs", 0, "arch", NULL, NULL, STEPPED) \
	X(ISOLATION, NULL, 0, "isolation", "thread|process", "what a worker is (thread)", STEPPED) \
	X(WORKERS, NULL, 0, "workers", "N|objects", "workers in the pool, or one for each object (one per core)", \
	  STEPPED | COMPARE) \
	X(HARDEN, NULL, 0, "harden", "[=LIST]", \
	  "processes that can write their own results alone, and do little else", STEPPED | COMPARE) \
	X(TOLERANCE, NULL, 0, "tolerance", NULL, NULL, STEPPED | COMPARE) \
	X(STRICT, NULL, 0, "strict", NULL, "exit with 1 where the tolerance is missed, or a script fails", RUN) \
	X(PATIENCE, NULL, 0, "patience", "S", "seconds that the page may take to make (10)", EXPORT) \
	X(ON_DEATH, NULL, 0, "on-death", OB_ON_DEATH_NAMES, \
	  "what a death or failure does: restart, freeze, end, or keep what can be (restart)", STEPPED) \
	X(NAME, NULL, 0, "name", "NAME", "name of the universe, for obsim top (obsim-PID)", STEPPED) \
	X(PACE, NULL, 0, "pace", "realtime|RATE|max", "simulated seconds a second of the clock (max)", RUN | SERVE) \
	X(SYNC, NULL, 0, "sync", OB_SYNC_NAMES "|lockstep,free", NULL, RUN | SERVE | COMPARE) \
	X(LIVE, "The server", 0, "live", NULL, \
	  "one world, threads and processes, or both ways, side by side on one page", COMPARE) \
	X(LISTEN, "The server", 0, "listen", "ADDR:PORT", \
	  "where viewers come to; port 0 is a free one (127.0.0.1:8080)", SERVE | COMPARE) \
	X(PAUSED, NULL, 0, "paused", NULL, "stand still until a viewer lets it run", SERVE) \
	X(FOXGLOVE, NULL, 0, "foxglove", NULL, \
	  "lets Foxglove connect at the same address (ws://..), from any origin, to watch", SERVE) \
	X(READONLY, NULL, 0, "readonly", NULL, "viewers may look, and change nothing", SERVE) \
	X(VIEWERS, NULL, 0, "viewers", "N", "viewers at a time (64)", SERVE) \
	X(ROOM, NULL, 0, "room", "N", "objects that viewers may add (1000)", SERVE | CONTROL) \
	X(PICTURES, "Pictures", 0, "out", "DIR|FILE", \
	  "PNG frames into a folder, a video (a.mp4), raw rgb24 frames (a.rgb, -)", RUN) \
	X(FPS, NULL, 0, "fps", "F", "frames per simulated second (60)", RUN) \
	X(STILL, NULL, 0, "still", "S,..", "write frames of these times (s) alone", RUN) \
	X(SIZE, NULL, 0, "size", "WxH", "pixels (1280x720)", RUN) \
	X(QUALITY, NULL, 0, "quality", "draft|fine", \
	  "fine: soft shadows, light of the sky; takes some 20 times as long (draft)", RUN) \
	X(CAMERA, NULL, 0, "camera", "NAME", "which of the scene's cameras (the first)", RUN) \
	X(OVERLAY, NULL, 0, "overlay", "LIST", \
	  "draw over it: aabb, contacts, joints, reads, simulators, caption; several with commas", RUN) \
	X(COLOUR_BY, NULL, 0, "colour-by", OB_COLOUR_KEY_NAMES, "colour objects by who simulates them, and how (own)", \
	  RUN) \
	X(RECORD, "What is kept", 0, "record", "FILE", \
	  "trajectories, and all that it takes to draw them again, as HDF5", RUN | SERVE | CONTROL) \
	X(SERIES, NULL, 0, "series", "FILE", "energy, momentum, penetration of each step, as CSV", RUN) \
	X(REPORT, NULL, 0, "report", "short|full", "five lines, or all that was measured (short)", RUN) \
	X(JSON, NULL, 0, "json", "FILE", "the report, as JSON; - = standard output", RUN | COMPARE) \
	X(EXPLAIN, NULL, 0, "explain", NULL, "what was modelled, what was left out and why, and what each part cost", \
	  RUN) \
	X(TRACE, NULL, 0, "trace", "FILE", "what each worker did when, for ui.perfetto.dev", RUN) \
	X(CHECKPOINT, NULL, 0, "checkpoint", "FILE", \
	  "what the run needs to go on, replaced as it goes, and at its end", RUN | SERVE) \
	X(RESUME, NULL, 0, "resume", "FILE", "go on from a checkpoint, instead of a scene", RUN | CONTROL) \
	X(REPLAY, NULL, 0, "replay", "FILE", "show what was recorded, instead of a scene", RUN | SERVE) \
	X(LOG_REQUESTS, NULL, 0, "log-requests", "FILE", \
	  "what viewers and programs ask for, and the state every second", SERVE) \
	X(REPLAY_REQUESTS, NULL, 0, "replay-requests", "FILE", "carry out what serve has logged, and compare states", \
	  RUN) \
	X(FAULT, "To test with", 0, "fault", "KINDS:p=P,..", \
	  "simulators that kill, stop, exit ..., as kill+exit:p=.001,seed=7", RUN) \
	X(CHECK, NULL, 0, "check", NULL, "check what simulators share after each step; exit with 4 where it is wrong", \
	  STEPPED) \
	X(LIST, "What is run", 0, "list", NULL, "print the cases and end", LAB) \
	X(QUICK, NULL, 0, "quick", NULL, "only a quick subset", LAB | PAPER) \
	X(OBJECTS, NULL, 0, "objects", "N", "boxes in each experiment (64)", PAPER) \
	X(ENGINES, NULL, 0, "engines", "LIST", "engines by name, with commas (all)", LAB) \
	X(SWEEP, NULL, 0, "sweep", "LISTS|none", "as substeps=1,2,4,tolerance=5mm,.5mm (what suits each engine)", LAB) \
	X(AUDIT, NULL, 0, "audit", NULL, "whether obsim's errors fall with its tolerance and its substeps", LAB) \
	X(REPEATS, NULL, 0, "repeats", "N", "runs of each; times are their medians (1)", LAB | COMPARE | PAPER) \
	X(SEEDS, NULL, 0, "seeds", "N", "seeds, from the scene's on; repeats of each (1)", COMPARE) \
	X(LIMIT, NULL, 0, "limit", "S", "seconds of CPU that a run may take (150)", LAB) \
	X(OUT, "What comes of it", 0, "out", "DIR", "folder for results, diagrams, report (none)", \
	  LAB | PAPER | COMPARE | IMPORT) \
	X(FRESH, NULL, 0, "fresh", NULL, "run again what DIR has already", LAB | PAPER | COMPARE) \
	X(JSON_OUT, NULL, 0, "json", NULL, "print it as JSON", LAB | PAPER | INSPECT) \
	X(CHECK_TARGETS, NULL, 0, "check", NULL, "exit with 3 when obsim misses a target", LAB) \
	X(ONCE, "The view", 0, "once", NULL, "print once, for pipes, and end", TOP) \
	X(INTERVAL, NULL, 0, "interval", "S", "seconds between looks (1)", TOP) \
	X(HELP, "Other", 'h', "help", NULL, "print this and end", \
	  STEPPED | COMPARE | TOP | LAB | PAPER | INSPECT | SEND | EXPORT | SCENES | IMPORT)

typedef enum ob_option_id {
#define X(id, ...) OB_OPTION_##id,
	OB_OPTION_LIST(X)
#undef X
		OB_OPTIONS,
} ob_option_id;

typedef struct ob_option {
	const char *group; // heading in the help; NULL = under the one before
	char letter; // short form; 0 = none
	const char *name; // without the dashes
	// NULL = a flag; "[=WHAT]" = an optional value, only after "="; lower-case words with | between them are the
	// only values allowed
	const char *argument;
	const char *help; // NULL = name, argument unless given, and help are of the setting of the name
	unsigned commands; // ob_command_bit
} ob_option;

extern const ob_option ob_option_table[OB_OPTIONS];

// Kinds of what --out of obsim run writes, known by its name.
typedef enum ob_out {
	OB_OUT_FOLDER, // of PNG frames
	OB_OUT_VIDEO,
	OB_OUT_RAW, // rgb24
	OB_OUTS
} ob_out;

typedef struct ob_arguments {
	ob_command_bit command;
	const char *value[OB_OPTIONS]; // as on the command line; NULL = not given, "" = a flag that was given
	const char *setting[OB_SETTINGS]; // the same, by --set or an option of its own
	const char *out[OB_OUTS]; // obsim run; NULL = not given
	const char **define; // every -D, in order; NULL ends
	uint32_t defines;
	const char *operand; // the scene file or the universe's name: the first of all; NULL = none
	const char **operands; // all, in order: only lab, send and export take more than one; NULL ends
} ob_arguments;

// Parses argv[0 .. argc-1] (after the command's name). The strings stay argv's. false and e on misuse. Free with
// ob_options_finish in either case.
bool ob_options_parse(ob_arguments *a, ob_command_bit command, int argc, char **argv, ob_error *e);
void ob_options_finish(ob_arguments *a);
// The same arguments with one more -D, unless define is "". Only own->define is its own: release that with free.
bool ob_options_define(ob_arguments *own, const ob_arguments *a, const char *define, ob_error *e);

// Sets of options and settings are bits, OB_BIT(id).
#define OB_BIT(id) (1ull << (id))
enum { OB_LOCKSTEP_BITS = (1 << OB_RUN_SETTINGS) - 1 };
// One of these that is given, as in ob_setting_option; "": none is.
ob_setting_word ob_options_given(const ob_arguments *a, uint64_t options, uint64_t settings);
// False and e if one of these is given: "--NAME", and why it is refused.
bool ob_options_refuse(const ob_arguments *a, uint64_t options, uint64_t settings, const char *why, ob_error *e);

// Help of one command (a line for each of its options), and of obsim as a whole.
void ob_options_help(FILE *f, ob_command_bit command);
// The settings that a command takes by --set, and their values: --set help.
void ob_options_help_set(FILE *f, ob_command_bit command);
void ob_options_overview(FILE *f);

#endif
