// List of all cases, in the order of their rows. Each is in a file of its group in this folder.
#ifndef OB_LAB_CASES_CASES_H
#define OB_LAB_CASES_CASES_H

#include "lab/case.h"

#define OB_CASES(X) \
	X(stack_10) \
	X(stack_20) \
	X(stack_40) \
	X(heavy_100) \
	X(heavy_1000) \
	X(heavy_on_stack) \
	X(pyramid_10) \
	X(pyramid_15) \
	X(pile) \
	X(pile_elastic) \
	X(falling_100) \
	X(thin_wall) \
	X(bullets) \
	X(spin) \
	X(overhang) \
	X(overhang_over) \
	X(a_frame_stands) \
	X(a_frame_slides) \
	X(hit_wall) \
	X(plates_plane) \
	X(plates_box) \
	X(discs_plane) \
	X(discs_box) \
	X(drops_plane) \
	X(drops_box) \
	X(drops_round) \
	X(break_smooth) \
	X(break_rough) \
	X(oblique) \
	X(rocking_blocks) \
	X(rocking_cylinders) \
	X(rolling_disk) \
	X(near_spin) \
	X(spinning_rods) \
	X(seams_slide) \
	X(seams_roll) \
	X(crib_tower) \
	X(touching_pyramid) \
	X(unbalanced_pull) \
	X(unbalanced_incline) \
	X(unbalanced_brick) \
	X(round_rest) \
	X(cylinder_stack) \
	X(round_incline) \
	X(mixed_pile) \
	X(random_heaps) \
	X(shaking_tables) \
	X(belts) \
	X(turntables) \
	X(shaken_stack) \
	X(shaken_pile) \
	X(arch_stands) \
	X(arch_falls) \
	X(pendulum_90) \
	X(pendulum_179) \
	X(double_pendulum) \
	X(spherical_pendulum) \
	X(top) \
	X(chain_100) \
	X(four_bar) \
	X(slider_crank) \
	X(furuta) \
	X(bricard) \
	X(breaking_door) \
	X(plank_bridge) \
	X(ragdoll) \
	X(car)

#define OB_CASE_DECLARE(name) extern const ob_case ob_case_##name;
OB_CASES(OB_CASE_DECLARE)
#undef OB_CASE_DECLARE

#endif
