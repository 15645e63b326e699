// Colours that show the architecture in a picture: an object's colour by its simulator, worker, process, rank, island,
// rest, cost or lag. The page has the same functions (src/front/serve/page/colouring.js). Pure functions.
#ifndef OB_MEASURE_COLOURING_H
#define OB_MEASURE_COLOURING_H

#include "measure/measure.h"

typedef enum ob_colour_key {
	OB_COLOUR_OWN, // as the scene has it
	OB_COLOUR_SIMULATOR, // each object its own
	OB_COLOUR_WORKER, // home worker of its simulator
	OB_COLOUR_PROCESS, // process of that worker
	OB_COLOUR_RANK, // rank of that worker
	OB_COLOUR_ISLAND, // bodies solved together; grey: alone
	OB_COLOUR_REST, // orange: touches; cyan: flies; green: in equilibrium; blue: asleep
	OB_COLOUR_COST, // dark to bright: substeps that its island needs, by their logarithm; grey: not solved
	OB_COLOUR_LAG, // dark to bright: lead of its own time over the common time, to 1 s, by its logarithm; grey: lockstep
} ob_colour_key;
#define OB_COLOUR_KEY_NAMES "own|simulator|worker|process|rank|island|rest|cost|lag"

// Process and rank of a worker
typedef struct ob_worker_place {
	int32_t pid;
	uint32_t rank;
} ob_worker_place;

typedef struct ob_colouring {
	ob_colour_key key;
	const ob_worker_place *place; // [workers]
	uint32_t workers;
} ob_colouring;

// State of a body: it rests, touches something, or does neither. The page of a server knows them by these numbers.
typedef enum ob_rest {
	OB_REST_TOUCHES,
	OB_REST_FLIES,
	OB_REST_EQUILIBRIUM,
	OB_REST_ASLEEP,
} ob_rest;

ob_rest ob_rest_of(const ob_motion *m);
// Place on a scale, 0 to 1, of a lead (s) of an own time over the common time. NaN stays NaN.
double ob_share_of_lead(double lead);

// Colours, linear RGB: a number's, with a hue of its own; a share's (0 to 1; NaN: none), from dark blue by red to yellow.
void ob_colour_of_number(uint32_t number, float out[3]);
void ob_colour_of_share(double share, float out[3]);
// Colour, linear RGB, of a present object. Objects without a simulator are grey, except for OB_COLOUR_OWN.
void ob_colouring_of(const ob_colouring *c, const ob_snapshot *s, uint32_t id, float colour[3]);

#endif
