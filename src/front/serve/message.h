// Bytes on their way to viewers. One message may be in the queues of many; the last release frees it. Numbers are
// little-endian. One thread at a time.
#ifndef OB_SERVE_MESSAGE_H
#define OB_SERVE_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct ob_message {
	unsigned char *bytes;
	size_t size, room;
	uint32_t holders;
	bool text; // UTF-8; else binary
	bool failed; // out of memory: data is missing
} ob_message;

ob_message *ob_message_new(bool text); // held once; NULL: out of memory
void ob_message_hold(ob_message *m);
void ob_message_release(ob_message *m); // NULL is allowed

void ob_message_put(ob_message *m, const void *bytes, size_t size);
void ob_message_put_u8(ob_message *m, unsigned value);
void ob_message_put_u32(ob_message *m, uint32_t value);
void ob_message_put_f32(ob_message *m, double value);
void ob_message_put_f64(ob_message *m, double value);
void ob_message_set_u32(ob_message *m, size_t at, uint32_t value); // overwrites earlier data
// Like printf; strings from outside must first be escaped by ob_message_put_json.
void ob_message_print(ob_message *m, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ob_message_put_json(ob_message *m, const char *string); // with its quotes

#endif
