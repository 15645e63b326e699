#include "solver/methods.h"

#include "solver/bodies.h"
#include "solver/boxes.h"
#include "solver/contacts.h"
#include "solver/ghost.h"
#include "solver/narrowphase.h"

static void show_nothing(ob_solver *s) {}

static bool read_nothing(ob_solver *s, ob_body_row *rows, uint32_t iteration)
{
	return false;
}

ob_methods ob_methods_of(const ob_run_settings *run)
{
	const bool ghosts = ob_solver_is_two_sided(run->solver), boxes = run->narrow_phase == OB_NARROW_AABB,
		   exact = run->integrator == OB_INTEGRATOR_EXACT;
	return (ob_methods){ .find = boxes ? ob_boxes_find : ob_shapes_find,
			     .load = ghosts ? ob_ghosts_load : ob_contact_load,
			     .follow = ghosts ? ob_ghosts_follow : show_nothing,
			     .read = ghosts ? ob_ghosts_read : read_nothing,
			     .move = exact ? ob_body_move : ob_ode_bodies_move,
			     .sides = ghosts ? 2 : 1,
			     .jacobi = run->solver == OB_SOLVER_JACOBI,
			     .restless = ghosts,
			     .exact = exact,
			     .boxes = boxes,
			     .instants = exact && !boxes && !ghosts };
}
