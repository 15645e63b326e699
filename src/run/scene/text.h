// Text between a scene and a person: values in messages, and rules of names.
#ifndef OB_SCENE_TEXT_H
#define OB_SCENE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include <lua.h>

#include "base/spelling.h"

#define OB_TEXT_VALUE 112 // bytes, the longest description of a value with its final 0

// "nothing", "-3", "nan", "\"wood\"", "{1, 0, -2}", "a table", "a function"
void ob_text_of_value(lua_State *L, int index, char out[OB_TEXT_VALUE]);

// Offers a word of scenes for correction. American spelling and words of other simulators differ in letters, but are
// near in meaning.
void ob_text_offer(ob_spelling *s, const char *known);

// Valid UTF-8 of plain characters alone (base/utf8.h); text[size] is 0.
bool ob_text_is_clean(const char *text, size_t size);

#endif
