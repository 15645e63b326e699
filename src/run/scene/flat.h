// Flat values as bytes: numbers, text, true and false, objects, and tables of such values, without nested tables. In
// this form they are kept in the universe and sent between objects.
//
//   n 8 bytes    a number                   t, f         true, false
//   i 8 bytes    a whole number             o 4 + 4      an object: id, generation
//   s 2 + bytes  text
//
// A table is its keys (text or whole numbers) and values in turn. Data is checked when read: it may come from outside.
#ifndef OB_SCENE_FLAT_H
#define OB_SCENE_FLAT_H

#include <stdbool.h>
#include <stdint.h>

#include <lua.h>

#define OB_FLAT_OBJECT "object" // name of the metatable of objects, which are userdata:
typedef struct ob_flat_object {
	uint32_t id, generation;
} ob_flat_object;

typedef struct ob_flat {
	unsigned char *bytes;
	uint32_t size, room;
} ob_flat;

// Appends a value, or a table's keys and values. what: for the error about a value that is not flat, or does not fit.
void ob_flat_put(lua_State *L, int index, ob_flat *f, const char *what);
void ob_flat_put_table(lua_State *L, int index, ob_flat *f, const char *what);
// Pushes the value that begins there, and returns its bytes; 0: none or invalid, and nothing is pushed.
uint32_t ob_flat_push(lua_State *L, const unsigned char *bytes, uint32_t size);
// Pushes a table. Skips invalid entries.
void ob_flat_push_table(lua_State *L, const unsigned char *bytes, uint32_t size);

// Access to a table in its byte form: pushes the value of a key (nil if missing); and sets a value, nil to remove it.
void ob_flat_get(lua_State *L, const ob_flat *f, int key);
void ob_flat_set(lua_State *L, ob_flat *f, int key, int value, const char *what);

#endif
