// A record as MCAP (mcap.dev, version 0), for Foxglove, Rerun and other tools of robotics: the messages of foxglove.h, logged at
// the recorded states.
#ifndef OB_RECORD_MCAP_H
#define OB_RECORD_MCAP_H

#include "record/recording.h"

// Writes the states of a recording that has just been opened, in some seconds of this process's CPU time. false and e, which
// begins with the path of the record or of the file: unreadable, too long for that time, or not written. The file is then
// incomplete. One thread at a time.
bool ob_mcap_write(ob_recording *r, const char *record, const char *path, double seconds, ob_error *e);

#endif
