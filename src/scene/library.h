// What the sandbox offers of Lua's own libraries: a list of what is known to be harmless, guards where one call could
// run without end, and a clear word where a scene asks for something else.
#ifndef OB_SCENE_LIBRARY_H
#define OB_SCENE_LIBRARY_H

#include <lua.h>

// lua_CFunction, no arguments: builds the globals of a fresh state.
int ob_library_open(lua_State *L);

// lua_CFunction: pairs(t) in a fixed order, numbers before strings before booleans. Lua's own order depends on where
// things lie in memory, and differs from run to run. Upvalue 1: table.sort.
int ob_library_pairs(lua_State *L);

#endif
