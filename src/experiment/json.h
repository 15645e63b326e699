// JSON, as much as reports need: objects and lists of strings and numbers. A library for it would be one more package
// to install for a hundred lines, and none prints a double so that it reads back to the same bits unless told how.
#ifndef OB_EXPERIMENT_JSON_H
#define OB_EXPERIMENT_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct ob_json {
	FILE *f;
	int depth;
	bool filled; // something stands in the object that is open
} ob_json;

// key NULL: the outermost object, or a member of a list. Two spaces a level, one member a line.
void ob_json_open(ob_json *j, const char *key);
void ob_json_close(ob_json *j); // ends the file's last line, too
// A list: its members have no key
void ob_json_open_list(ob_json *j, const char *key);
void ob_json_close_list(ob_json *j);
// Control characters are escaped; bytes that are no UTF-8 are taken as Latin-1.
void ob_json_string(ob_json *j, const char *key, const char *value);
void ob_json_number(ob_json *j, const char *key, double value); // %.17g; null unless finite
void ob_json_count(ob_json *j, const char *key, uint64_t value);
void ob_json_true(ob_json *j, const char *key, bool value);
void ob_json_null(ob_json *j, const char *key);

// Readers of one flat object, as written above: where the value of key begins; NULL = no such member.
const char *ob_json_find(const char *text, const char *key);
// The string value at "at", without escapes; false: no string, or size bytes are too few.
bool ob_json_read_string(const char *at, char *out, size_t size);

#endif
