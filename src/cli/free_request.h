// Options of a free run (obsim run --sync free).
#ifndef OB_CLI_FREE_REQUEST_H
#define OB_CLI_FREE_REQUEST_H

#include "cli/request.h"

// Reads the options; false and e on malformed ones.
bool ob_free_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e);
// Chooses lockstep or free, and completes the settings, once those of the run are resolved. false and e: an option does
// not go with the choice.
bool ob_free_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e);

#endif
