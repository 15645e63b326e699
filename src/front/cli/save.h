// Saves a run that a program or visitors lead as a checkpoint file, from which obsim run --resume goes on.
#ifndef OB_CLI_SAVE_H
#define OB_CLI_SAVE_H

#include "cli/request.h"

// Between a wait and the next go; the request is resolved, the scene its own. false and e: nothing is written.
bool ob_save_led_run(const ob_run_request *r, const ob_scene *s, ob_host *h, const char *path, ob_error *e);

#endif
