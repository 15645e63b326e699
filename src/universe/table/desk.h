// Desks: shared memory at which a worker exchanges data with a process that runs foreign code for it, an FMU. Each worker has
// a desk for each foreign code of the universe. A third process, the owner (host/foreign.h), starts the processes at desks,
// and sees their ends and hangs. Only this memory is shared: the process at a desk sees its data, and nothing else.
//
//   worker                      owner                          process at the desk
//   call ------- bell (pipe) ---> starts it, number k --------> waits for a question
//   writes data, asks n shares ------------ futex ------------> answers the shares in order
//   waits   <------------------------------ futex ------------- done
//   waits   <------- number k has ended, and how ---- SIGCHLD - ends instead
//
// A slip of each desk, which the process does not see, holds the words of worker and owner. A worker trusts nothing in the
// desk's data. Worker and owner may be killed at any time: the next worker calls a new process.
//
// Thread-safety: one worker, one owner and one process per desk.
#ifndef OB_TABLE_DESK_H
#define OB_TABLE_DESK_H

#include "table/table.h"

enum { OB_DESK_BYTES = 48 << 10 }; // data of a desk; pages that are never used cost nothing

typedef struct ob_desk {
	struct ob_desk_slip *slip; // NULL: the universe has no such desk
	struct ob_desk_page *page;
	uint32_t index;
	int bell;
} ob_desk;

// End of a process.
typedef struct ob_desk_end {
	int32_t status; // of waitpid
	int32_t error; // errno: it could not be started; else 0
	uint32_t hung; // the owner has ended it because it took too long
} ob_desk_end;

// Host: makes desks for each worker and each of so many foreign codes, before processes are forked that use them. The owner
// reads numbers of desks from "bell", and workers write them; -1 until the call of ob_desks_set_bell.
bool ob_desks_create(ob_universe *u, uint32_t foreign, ob_error *e);
void ob_desks_destroy(ob_universe *u);
void ob_desks_set_bell(ob_universe *u, int bell);
uint32_t ob_desks_count(const ob_universe *u); // 0: none
// True if a process owes its worker an answer. Any thread.
bool ob_desks_await_answers(const ob_universe *u);
ob_desk ob_desk_at(const ob_universe *u, uint32_t index);
// Desk of a worker for foreign code of this number, from 0.
ob_desk ob_desk_of(const ob_universe *u, uint32_t worker, uint32_t foreign);
uint32_t ob_desk_foreign(const ob_universe *u, const ob_desk *d);
void *ob_desk_data(const ob_desk *d); // OB_DESK_BYTES
// A contained worker: unmaps the desks of all others. The process at a desk: unmaps the universe and all other desks.
bool ob_desks_keep_own(const ob_universe *u, uint32_t worker);
bool ob_desk_keep_alone(const ob_universe *u, const ob_desk *d);

// ---- the worker

// True if a process is at the desk, and has not been left in the midst of an exchange.
bool ob_desk_is_ready(const ob_desk *d);
// Calls a new process, which takes the place of any that is there. Returns its number, for the next functions.
uint32_t ob_desk_call(const ob_desk *d);
// Waits some ms until it has been started. Returns true if it has, also if it has ended since.
bool ob_desk_is_here(const ob_desk *d, uint32_t number, int ms);
uint32_t ob_desk_number(const ob_desk *d); // of the newest process
void ob_desk_ask(const ob_desk *d, uint32_t shares); // at most UINT8_MAX
typedef enum ob_desk_state { OB_DESK_WAITS, OB_DESK_ANSWERED, OB_DESK_ENDED } ob_desk_state;
// Waits some ms for the answer of that process, or for its end, which is reported.
ob_desk_state ob_desk_wait(const ob_desk *d, uint32_t number, int ms, ob_desk_end *end);
uint32_t ob_desk_done(const ob_desk *d); // shares of the question that are answered, as the process says

// ---- the process at the desk

// Waits for the next question. seen: that of the last call, at first ob_desk_seen.
uint32_t ob_desk_seen(const ob_desk *d);
uint32_t ob_desk_next(const ob_desk *d, uint32_t seen);
void ob_desk_set_done(const ob_desk *d, uint32_t done);
void ob_desk_answer(const ob_desk *d, uint32_t question);

// ---- the owner

// Before the process starts: leaves the last question unanswered no more. Returns the number of the process.
uint32_t ob_desk_open(const ob_desk *d);
void ob_desk_close(const ob_desk *d, uint32_t number, const ob_desk_end *end);
// Question that the worker waits for, and its shares; 0: it waits for none.
uint32_t ob_desk_question(const ob_desk *d, uint32_t *shares);

#endif
