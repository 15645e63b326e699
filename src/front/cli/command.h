// The commands of obsim, and their exit codes.
#ifndef OB_CLI_COMMAND_H
#define OB_CLI_COMMAND_H

#include "cli/options.h"

enum ob_exit {
	OB_EXIT_OK,
	OB_EXIT_FAILED, // the run failed, or was interrupted
	OB_EXIT_USAGE, // the command line, the scene, the checkpoint or the record is wrong
	OB_EXIT_MISSED, // lab --check: a target was missed
	OB_EXIT_BROKEN, // run, serve --check: the simulators' shared state broke an invariant
};

// Each takes parsed arguments and returns an ob_exit; it has printed errors on standard error.
int ob_command_run(const ob_arguments *a);
int ob_command_compare(const ob_arguments *a);
int ob_command_compare_sync(const ob_arguments *a); // with --sync lockstep,free
int ob_command_compare_live(const ob_arguments *a); // with --live
int ob_command_top(const ob_arguments *a);
int ob_command_lab(const ob_arguments *a);
int ob_command_paper(const ob_arguments *a);
int ob_command_inspect(const ob_arguments *a);
int ob_command_serve(const ob_arguments *a);
int ob_command_control(const ob_arguments *a);
int ob_command_scenes(const ob_arguments *a);
int ob_command_import(const ob_arguments *a);
int ob_command_send(const ob_arguments *a);
// Lists all requests, for the help.
void ob_send_help(FILE *f);
int ob_command_export(const ob_arguments *a);
int ob_command_draw_replay(const ob_arguments *a); // run with --replay: draws a record instead of a scene
int ob_command_rerun(const ob_arguments *a); // run with --replay-requests

// One line on standard error, "obsim: ..."; returns code.
int ob_command_fail(int code, const char *text);

#endif
