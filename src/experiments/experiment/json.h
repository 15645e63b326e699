// JSON as far as reports need it: objects and lists of strings and numbers. A library would be one more package to
// install, to save a hundred lines. By default, none prints a double so that it reads back to the same bits.
#ifndef OB_EXPERIMENT_JSON_H
#define OB_EXPERIMENT_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct ob_json {
	FILE *f;
	int depth;
	bool filled; // the open object has a member
	bool script; // for within a page: on one line, and without "<"
} ob_json;

// Opens an object. key NULL: the outermost object, or a member of a list. Two spaces a level, one member a line.
void ob_json_open(ob_json *j, const char *key);
void ob_json_close(ob_json *j); // ends the file's last line, too
// Opens a list: its members have no key.
void ob_json_open_list(ob_json *j, const char *key);
void ob_json_close_list(ob_json *j);
// Escapes control characters; reads bytes that are not UTF-8 as Latin-1.
void ob_json_string(ob_json *j, const char *key, const char *value);
void ob_json_number(ob_json *j, const char *key, double value); // %.17g; null unless finite
void ob_json_count(ob_json *j, const char *key, uint64_t value);
void ob_json_true(ob_json *j, const char *key, bool value);
void ob_json_null(ob_json *j, const char *key);
void ob_json_text(ob_json *j, const char *key, const char *value); // null for ""

// Reading one flat object, as written above: start of the value of key; NULL = no such member.
const char *ob_json_find(const char *text, const char *key);
// The number that key has; NaN: none.
double ob_json_read_number(const char *text, const char *key);
// Reads the string value at "at", without escapes. Returns false if it is no string, or longer than size bytes.
bool ob_json_read_string(const char *at, char *out, size_t size);

#endif
