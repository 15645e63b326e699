// Vectors and rotations as values of Lua: vector(x, y, z), rotation(v), with the operations and the bits of ob/vec.h.
#ifndef OB_SCENE_VECTOR_H
#define OB_SCENE_VECTOR_H

#include <lua.h>
#include <ob/vec.h>

void ob_vector_push(lua_State *L, ob_vec3 v);
void ob_rotation_push(lua_State *L, ob_quat q);
// NULL: another value.
const ob_vec3 *ob_vector_at(lua_State *L, int index);
const ob_quat *ob_rotation_at(lua_State *L, int index);
// Offers both constructors to the table at the top of the stack.
void ob_vector_open(lua_State *L);

#endif
