// Control of a run by a program (include/ob/control.h): its steps, snapshots, and changes of its objects. The supervisor
// accepts a caller (ask.h) and hands its socket to the thread that leads the run, which carries out its commands at
// step boundaries and answers them (control/packet.h).
//
//   supervisor           leading thread: ob_control_next .. go .. wait .. ob_control_next ..
//   accepts a caller
//   hello ──> take ───>  answers; then each command: at once, or after the steps it asks for
//                        until the caller leaves: the run ends
//
// Thread-safety: take is the supervisor's; the rest belongs to the thread that leads the run.
#ifndef OB_HOST_CONTROL_H
#define OB_HOST_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/control.h>

#include "control/packet.h"

typedef struct ob_host ob_host;
typedef struct ob_control ob_control;

// Next action of the caller of ob_control_next.
typedef enum ob_control_turn {
	OB_CONTROL_LEFT, // the program has left: ends the run
	OB_CONTROL_GOES_ON,
	OB_CONTROL_SAVES, // saves the run to the path of ob_control_words, and answers
	OB_CONTROL_RESETS, // begins the run anew, with the parameters of ob_control_words, in a new host; or refuses
} ob_control_turn;

// inside: the program is the caller, which gives its commands itself.
ob_control *ob_control_create(bool inside, ob_error *e);
void ob_control_destroy(ob_control *c); // the host has been stopped; NULL is allowed

// Takes over a caller's socket. false and e: another program controls the run.
bool ob_control_take(ob_control *c, int fd, ob_error *e);
// After a wait: answers what is done, carries out commands, and returns the step to go to: the current one while there is
// nothing to do, after a short wait.
ob_control_turn ob_control_next(ob_control *c, ob_host *h, uint64_t last, uint64_t *step);
// Words of the command that the caller is to carry out, each ended by 0; count: how many. seed, for a reset: NULL = the same.
const char *ob_control_words(const ob_control *c, uint32_t *count, const uint64_t **seed);
// Answers that command. why: NULL = done; else the run is as before. A reset that succeeds is answered by the next
// ob_control_next, for the new host.
void ob_control_reply(ob_control *c, ob_host *h, const ob_error *why);
// Inside: gives the next command, of so many bytes; ob_control_next carries it out. answer: NULL until then.
void ob_control_give(ob_control *c, const ob_control_packet *p, size_t bytes);
const ob_control_answer *ob_control_answered(const ob_control *c);
// Tells the program why the run has ended.
void ob_control_end(ob_control *c, const char *why);

// ---- contact events

// Contacts that begin and end while a program leads a run: the pairs that touch after a step, compared with those before.
//
// Thread-safety: the thread that goes and waits, between a wait and the next go.

enum { OB_CONTACT_EVENTS_MAX = 1 << 20 }; // Limit of those waiting to be fetched; later ones are counted as lost

typedef struct ob_contact_events ob_contact_events;

// Begins with the pairs that touch now. NULL: out of memory.
ob_contact_events *ob_contact_events_create(const ob_universe *u);
void ob_contact_events_destroy(ob_contact_events *c); // NULL is allowed
// After a step: adds an event for each pair that began or ended to touch, by ascending ids. silent: adds none, as the
// universe was put back. false: out of memory.
bool ob_contact_events_look(ob_contact_events *c, const ob_universe *u, bool silent);
// Takes the oldest events; returns their number. lost: number of events lost before them.
size_t ob_contact_events_take(ob_contact_events *c, ob_contact_event *out, size_t max, uint64_t *lost);

#endif
