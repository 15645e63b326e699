// A record as MCAP (mcap.dev, version 0), for Foxglove and other tools of robotics. Messages are JSON, by the schemas of
// Foxglove: what each object looks like when it comes or changes (topic /scene, foxglove.SceneUpdate), and where it is at
// each recorded instant (topic /poses, foxglove.FrameTransforms): frame "object/ID" in frame "world", metres, z up.
#ifndef OB_RECORD_MCAP_H
#define OB_RECORD_MCAP_H

#include "record/recording.h"

// Writes the states of a recording that has just been opened, in some seconds of this process's CPU time. false and e, which
// begins with the path of the record or of the file: unreadable, too long for that time, or not written. The file is then
// incomplete. One thread at a time.
bool ob_mcap_write(ob_recording *r, const char *record, const char *path, double seconds, ob_error *e);

#endif
