// Paths that requests have given to kinematic objects while a universe runs. The scene's own paths stay in the scene.
//
//   at     | id 4: 2..4 | id 9: 0..1 |        ascending ids, one path for each object
//   point  | 9 | 9 | 4 | 4 | 4 |              points of all paths
//
// Both arrays are flat, so that they are copied and saved as they are. Thread-safety: the host's thread, at a pause; checks are
// pure.
#ifndef OB_HOST_GIVEN_PATHS_H
#define OB_HOST_GIVEN_PATHS_H

#include "host/request.h"

enum { OB_GIVEN_PATHS_MAX = 1 << 20, OB_GIVEN_POINTS_MAX = 1 << 24 };

// 24 bytes, saved as they are.
typedef struct ob_given_path {
	uint32_t id; // of the object
	uint32_t born; // step at which the path begins
	uint32_t first, points; // its points in the array of all
	uint32_t loop, turns; // 0 or 1, as in ob_path
} ob_given_path;

typedef struct ob_given_paths {
	ob_given_path *at; // [count]
	uint32_t count, room;
	ob_path_point *point; // [points]
	uint32_t points, point_room;
} ob_given_paths;

// Checks a requested path of an object with this state, in steps of step_length (s).
bool ob_given_path_check(const ob_request_path *r, const ob_passport *pass, const ob_state *now, double step_length,
			 ob_error *e);
// Checks saved paths: they begin at `step` at the latest, and ids ascend.
bool ob_given_paths_check(const ob_given_paths *p, uint64_t step, double step_length, ob_error *e);
// Gives an object, which is in this state now, the requested path in place of any other. false: no memory, and it has none.
bool ob_given_paths_ask(ob_given_paths *p, uint32_t id, uint32_t born, const ob_request_path *r, const ob_state *now);
void ob_given_paths_drop(ob_given_paths *p, uint32_t id);
// Finds the path of an object, and the step at which it begins. false: it has none. *path is valid until the next change.
bool ob_given_paths_find(const ob_given_paths *p, uint32_t id, ob_path *path, uint32_t *born);
// Copies all. false: no memory, and `to` keeps what it had.
bool ob_given_paths_copy(ob_given_paths *to, const ob_given_paths *from);
void ob_given_paths_finish(ob_given_paths *p);

#endif
