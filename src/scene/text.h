// Text between a scene and a person: what a value looks like in a message, and what may be a name.
#ifndef OB_SCENE_TEXT_H
#define OB_SCENE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include <lua.h>

#define OB_TEXT_VALUE 96 // bytes, the longest description of a value with its final 0

// "nothing", "-3", "nan", "\"wood\"", "{1, 0, -2}", "a table", "a function"
void ob_text_of_value(lua_State *L, int index, char out[OB_TEXT_VALUE]);

// Valid UTF-8 without control characters; text[size] is 0.
bool ob_text_is_clean(const char *text, size_t size);

#endif
