// The table of requests: for each its words, its fields with units and bounds, and the role that it takes. All ways in read it:
//
//   obsim send       push OBJECT X Y Z [POINT-X POINT-Y POINT-Z]                            src/front/cli/send.c
//   the page         {"do": "push", "id": 3, "generation": 1, "force": [0, 0, 9]}           src/front/serve/command.c
//   obsim control    OB_CONTROL_PUSH, and the numbers of the fields in a row (ob_change)    src/run/host/control.c
//   scripts          posts of their objects                                                 src/run/host/script_log.c
//
// Help, completions and the tables of docs/control.md follow from it. A new request is a row here, and a function that
// carries it out (population.c for objects, request.c for all else).
//
// Pure; any thread.
#ifndef OB_HOST_REQUEST_TABLE_H
#define OB_HOST_REQUEST_TABLE_H

#include <stdbool.h>

#include <ob/error.h>

#include "control/packet.h"
#include "host/request.h"

// ---- role

// Roles: permissions of visitors of a universe, whichever way the request comes: the socket of `obsim send` and of programs
// that control a run, the page, or a script that talks to the server.
//
//   watch       reads: objects, motions, contacts, figures
//   take part   also creates objects, removes those of its own, sends messages, drags and pushes
//   operate     also pauses, edits, removes, kills simulators, and puts the universe back
//
// Users of the same name as the run's operate. The server decides for others (serve/serve.h); the socket refuses them.
// Pure; any thread.

typedef enum ob_role {
	OB_ROLE_WATCH,
	OB_ROLE_TAKE_PART,
	OB_ROLE_OPERATE,
	OB_ROLES
} ob_role; // each includes those before

const char *ob_role_name(ob_role role); // "watch", "take part", "operate"
// False and e, for the visitor, if its role does not include the one needed.
bool ob_role_check(ob_role role, ob_role needed, ob_error *e);

// ---- request table

// Way in which a field fills in its member of ob_request.
typedef enum ob_request_type {
	OB_AS_REALS, // double [count]
	OB_AS_FLOATS, // float [count]
	OB_AS_COLOUR, // float [4]: obsim send has "#rrggbb", viewers three numbers
	OB_AS_ATTITUDE, // ob_quat
	OB_AS_ID, // uint32_t
	OB_AS_WHOLE, // uint64_t
	OB_AS_FLAG, // uint32_t: 0 or 1
	OB_AS_SHAPE, // ob_passport.shape, by name
	OB_AS_TEXT, // char [count]
	OB_AS_ASSIGNED, // behind a text: "=" and a number
	OB_AS_WORDS, // values of a message
	OB_AS_PATH, // points
} ob_request_type;

typedef struct ob_request_field {
	const char *name; // as viewers and documents have it
	const char *words; // in a line of help
	const char *unit; // "": none
	double least, most; // equal: bounds depend on the object
	double otherwise; // value if it is not given
	bool optional;
	uint8_t type; // ob_request_type
	uint8_t count;
	uint16_t at; // offset in ob_request
} ob_request_field;

typedef enum ob_request_target {
	OB_TO_RUN, // the run as a whole
	OB_TO_OBJECT,
	OB_TO_SOME, // an object; viewers may mean all objects
	OB_TO_JOINT, // by its name
	OB_TARGETS
} ob_request_target;

// Rows of one kind are neighbours: parts that viewers and programs fill in together. A command of viewers with several rows takes
// those of which it has a field.
typedef struct ob_request_row {
	const char *verb; // of obsim send; NULL: none
	const char *command; // of viewers; NULL: none
	const char *what; // in a line of help
	const ob_request_field *field; // to one without a name
	uint8_t kind; // ob_request_kind, ob_look_kind
	uint8_t to; // ob_request_target
	uint8_t role; // the ob_role that it needs
	uint8_t control; // ob_control_command; OB_CONTROL_HELLO: none
} ob_request_row;

extern const ob_request_row ob_request_rows[]; // to one of the kind OB_REQUEST_ROWS_END
enum { OB_REQUEST_ROWS_END = 255 };

// Fields by which viewers name a target, to one without a name.
const ob_request_field *ob_request_target_fields(ob_request_target to);
// The first row of a kind, and of a command of control. NULL: none.
const ob_request_row *ob_request_row_of(uint32_t kind);
const ob_request_row *ob_request_row_of_control(uint32_t command);
// Makes a request of a kind, with the values of what is not given.
void ob_request_begin(ob_request *r, const ob_request_row *row);
// Sets the i-th number of a field; one that its member cannot hold becomes the largest.
void ob_request_put(ob_request *r, const ob_request_field *f, uint32_t i, double value);
// Reads a field from words, which NULL ends, and returns the next one. NULL and e, which begins with `what`: they are wrong.
typedef const char *const *ob_words;
ob_words ob_request_read_field(ob_request *r, const ob_request_field *f, ob_words word, const char *what, ob_error *e);
// Sets the numbers of all fields of the request's kind, as programs and scripts have them: in the order of the table. A zero leaves
// an optional field as it is. Returns how many there are, whichever are given.
uint32_t ob_request_put_numbers(ob_request *r, const double *value, uint32_t n);
// Checks fields of a row that have bounds: e is as "rate: expected from 0 to 1000000, got -1".
bool ob_request_check_bounds(const ob_request *r, const ob_request_row *row, ob_error *e);
// Writes a row as a line of help has it: "push OBJECT X Y Z [POINT-X POINT-Y POINT-Z]".
void ob_request_usage(const ob_request_row *row, char *to, size_t size);

#endif
