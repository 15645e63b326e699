// Requests of scripts to the host, as they lie in a universe, which is not trusted. Thread-safety: the host's thread, at a pause.
#ifndef OB_HOST_SCRIPT_REQUEST_H
#define OB_HOST_SCRIPT_REQUEST_H

#include "host/request.h"
#include "table/table.h"

// Makes a request from a script's post to steer its object. false: it makes no sense.
bool ob_script_request_read(const ob_script_post *post, ob_request *r);
// Stops the script of a cell after an invalid request at this line, with an error that explains it.
void ob_script_request_refuse(ob_universe *u, uint32_t cell, uint32_t line, const char *why);

#endif
