// A saved universe: the state that determines how it goes on, as plain arrays, to be written to a file and put into a
// universe of other capacity, workers and isolation.
//
//                     saved                                 put back
//   passports         of those that exist                   the same bytes
//   motions           the newest of each                    published: the first version
//   schedule, bounds  of those that exist                   the same bytes
//   neighbours        how many the last query found         the same: flights are computed so far ahead (step/flight.c)
//   pairs, planes     all, in their order                   the same bytes; a record's number is that of its pair
//   pair records      the newest version                    the first of two versions
//   scripts           cells, texts                      the same bytes; texts are compared
//   sensors           what was taken of each, samples       the same bytes; the scene has the sensors
//   grid, islands,    not: they follow from these           the caller's (ob_sim_restore)
//   gate, workers
//
// The steps that follow are the same to the bit. Numbers have fixed widths and there is no pointer in an array, so the
// bytes mean the same on every machine of the same byte order.
//
// Thread-safety: one thread, the host's, while the universe is paused (save) or starting (load).
#ifndef OB_TABLE_SAVED_H
#define OB_TABLE_SAVED_H

#include "table/table.h"

// State of a pair that is kept from step to step, in its newest version.
typedef struct ob_saved_record {
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS]; // impulse on body b, if the two do not agree on one
	uint32_t stamp; // 1 + steps that were complete when it came to hold
	uint32_t zero;
} ob_saved_record;

// State of a joint.
typedef struct ob_saved_joint {
	ob_joint_passport passport;
	ob_joint_state state;
} ob_saved_joint;

// The arrays belong to their creator.
typedef struct ob_saved_universe {
	uint64_t step; // complete
	uint32_t checked; // ob_step_counts.checked
	uint32_t ids, planes, pairs, records; // lengths of the arrays
	ob_passport *passport; // [ids], all 0 for absent objects; so are the next four
	ob_motion *motion;
	ob_schedule *schedule;
	float (*bounds)[6];
	uint32_t *neighbours; // UINT32_MAX: a query is pending
	uint32_t *plane; // [planes] ids
	ob_pair_key *pair; // [pairs]
	ob_saved_record *record; // [records], in the order of their pairs
	uint32_t script_cells; // length of the next two
	ob_script_turn *script_turn;
	ob_script_cell *script_cell;
	uint32_t script_bytes; // size of the texts, with their directory; must be the same when resumed
	char *script_text;
	uint32_t joints; // length of the next one
	ob_saved_joint *joint;
	uint32_t sensors, sensor_numbers; // lengths of the next two
	ob_sensor_cell *sensor_cell;
	double *sensor_value;
} ob_saved_universe;

// Sets step, checked and the lengths, for allocating the arrays.
void ob_universe_count_saved(const ob_universe *u, ob_saved_universe *out);
// Fills arrays of these lengths.
void ob_universe_save(const ob_universe *u, ob_saved_universe *out);
// True if arrays from outside are plausible for a universe: ids, counts, kinds, finite numbers. Returns false and e,
// naming the first that is not.
bool ob_saved_universe_check(const ob_saved_universe *s, ob_error *e);
// Loads it into a new universe, with a capacity of at least ids. Returns false and e if it has no room for the pairs.
bool ob_universe_load(ob_universe *u, const ob_saved_universe *s, ob_error *e);

#endif
