// The options of all commands, as one table: the parser, the help and the checks of the shell completions read it.
#ifndef OB_CLI_OPTIONS_H
#define OB_CLI_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <ob/error.h>

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

// In the order of the help.
typedef enum ob_option_id {
	OB_OPTION_DEFINE,
	OB_OPTION_VARY,
	OB_OPTION_DURATION,
	OB_OPTION_STEP,
	OB_OPTION_SEED,
	OB_OPTION_ARCH,
	OB_OPTION_ISOLATION,
	OB_OPTION_WORKERS,
	OB_OPTION_HARDEN,
	OB_OPTION_TOLERANCE,
	OB_OPTION_STRICT,
	OB_OPTION_VERIFY,
	OB_OPTION_SUBSTEPS,
	OB_OPTION_ITERATIONS,
	OB_OPTION_SOLVER,
	OB_OPTION_LAG,
	OB_OPTION_INTEGRATOR,
	OB_OPTION_SLEEPING,
	OB_OPTION_NARROW,
	OB_OPTION_LOAD,
	OB_OPTION_PATIENCE,
	OB_OPTION_ON_DEATH,
	OB_OPTION_RESTARTS,
	OB_OPTION_NAME,
	OB_OPTION_PACE,
	OB_OPTION_SYNC,
	OB_OPTION_UPDATE_RATE,
	OB_OPTION_COUPLING,
	OB_OPTION_MAX_LAG,
	OB_OPTION_JITTER,
	OB_OPTION_DELAY,
	OB_OPTION_RECORD_SCHEDULE,
	OB_OPTION_REPLAY_SCHEDULE,
	OB_OPTION_LIVE,
	OB_OPTION_LISTEN,
	OB_OPTION_PAUSED,
	OB_OPTION_READONLY,
	OB_OPTION_VIEWERS,
	OB_OPTION_ROOM,
	OB_OPTION_FRAMES,
	OB_OPTION_VIDEO,
	OB_OPTION_RAW,
	OB_OPTION_FPS,
	OB_OPTION_STILL,
	OB_OPTION_SIZE,
	OB_OPTION_QUALITY,
	OB_OPTION_SAMPLES,
	OB_OPTION_CAMERA,
	OB_OPTION_OVERLAY,
	OB_OPTION_COLOUR_BY,
	OB_OPTION_GPU,
	OB_OPTION_RECORD,
	OB_OPTION_SERIES,
	OB_OPTION_REPORT,
	OB_OPTION_JSON,
	OB_OPTION_MEASURE,
	OB_OPTION_EXPLAIN,
	OB_OPTION_TRACE,
	OB_OPTION_CHECKPOINT,
	OB_OPTION_EVERY,
	OB_OPTION_RESUME,
	OB_OPTION_REPLAY,
	OB_OPTION_LOG_REQUESTS,
	OB_OPTION_REPLAY_REQUESTS,
	OB_OPTION_FAULT,
	OB_OPTION_CHECK,
	OB_OPTION_LIST,
	OB_OPTION_QUICK,
	OB_OPTION_OBJECTS,
	OB_OPTION_ENGINES,
	OB_OPTION_SWEEP,
	OB_OPTION_AUDIT,
	OB_OPTION_REPEATS,
	OB_OPTION_SEEDS,
	OB_OPTION_LIMIT,
	OB_OPTION_OUT,
	OB_OPTION_FRESH,
	OB_OPTION_JSON_OUT,
	OB_OPTION_CHECK_TARGETS,
	OB_OPTION_ONCE,
	OB_OPTION_INTERVAL,
	OB_OPTION_HELP,
	OB_OPTIONS,
} ob_option_id;

typedef struct ob_option {
	const char *group; // heading in the help; NULL = under the one before
	const char *name; // without the dashes
	// NULL = a flag; "[=WHAT]" = an optional value, only after "="; lower-case words with | between them are the
	// only values allowed
	const char *argument;
	const char *help;
	unsigned commands; // ob_command_bit
	char letter; // short form; 0 = none
} ob_option;

extern const ob_option ob_option_table[OB_OPTIONS];

typedef struct ob_arguments {
	ob_command_bit command;
	const char *value[OB_OPTIONS]; // as on the command line; NULL = not given, "" = a flag that was given
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

// Help of one command (a line for each of its options), and of obsim as a whole.
void ob_options_help(FILE *f, ob_command_bit command);
void ob_options_overview(FILE *f);

#endif
