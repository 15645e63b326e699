// What a published motion says of the present: where it begins, and of what stays where it is, the bits as published.
// Pure functions, thread-safe.
#ifndef OB_MOTION_PUBLISHED_H
#define OB_MOTION_PUBLISHED_H

#include <ob/motion.h>

// Does the object stand at time t (s) where its motion m begins?
bool ob_published_stands(const ob_motion *m, const ob_passport *p, double t);
// Its state then: ob_motion_at, but for the bits of what stands.
ob_state ob_published_at(const ob_motion *m, const ob_passport *p, double t);

#endif
