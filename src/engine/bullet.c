// The table of the part that calls Bullet, whose C++ is in bullet.cpp.
#include "engine/bullet.h"
#include "engine/part.h"

OB_PART(ob_engine_part) = { OB_PART_HEAD(ob_engine_part), .create = ob_bullet_create, .step = ob_bullet_step,
			    .get = ob_bullet_get, .destroy = ob_bullet_destroy };
