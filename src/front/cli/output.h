// Names of files that commands write: one that ends as files of another kind do is refused.
#ifndef OB_CLI_OUTPUT_H
#define OB_CLI_OUTPUT_H

#include <stdbool.h>

#include "cli/options.h"

// Kinds of files that are known by the end of their name.
typedef enum ob_output {
	OB_OUTPUT_RECORD = 1,
	OB_OUTPUT_VIDEO = 2,
	OB_OUTPUT_PICTURE = 4,
	OB_OUTPUT_JSON = 8,
	OB_OUTPUT_CSV = 16,
	OB_OUTPUT_PAGE = 32,
	OB_OUTPUT_MCAP = 64,
	OB_OUTPUT_SCENE = 128,
	OB_OUTPUT_RAW = 256,
} ob_output;

// Finds what --out of obsim run writes: raw frames to -, a device, a pipe or a name that ends in .rgb; frames into a folder
// that exists, or a name without an end; else a video. false and e on the end of another kind.
bool ob_output_kind(const char *path, ob_out *kind, ob_error *e);

// True if the name fits a file of one of these kinds: it ends as theirs do, or as none does that is known. what: for the
// message.
bool ob_output_fits(const char *what, const char *path, unsigned kinds, ob_error *e);

// The same for the value of an option, by its name; true for one that names no output.
bool ob_output_check(ob_option_id id, const char *name, const char *path, ob_error *e);

#endif
