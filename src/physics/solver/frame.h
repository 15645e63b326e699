// Frame of reference in which an island is solved. Bodies that fall together do not feel their common acceleration;
// bodies on a lift feel its acceleration as weight. So an island is solved in a frame that accelerates with the bodies
// that hold it; the motion of the frame is added at the end.
#ifndef OB_SOLVER_FRAME_H
#define OB_SOLVER_FRAME_H

#include "solver/solver.h"

// Enters the frame. Bodies are loaded, in world coordinates: finds the bodies that hold them, and makes accelerations
// relative to the frame. Sets max_acceleration (m/s^2), the largest one felt.
void ob_frame_enter(ob_solver *s, const ob_island_input *in);
// Returns to the world frame, after the last substep.
void ob_frame_leave(ob_solver *s);

#endif
