// Request of the command line for a run: checked, but not yet merged with the scene.
#ifndef OB_CLI_REQUEST_H
#define OB_CLI_REQUEST_H

#include "checkpoint/saved_run.h"
#include "cli/options.h"
#include "host/host.h"
#include "host/pace.h"
#include "record/record.h"
#include "render/render.h"
#include "scene/scene.h"

enum { OB_STILLS_MAX = 64 };

typedef struct ob_frames_request {
	bool wanted; // any of the three below
	const char *dir, *video, *raw; // by their names; NULL = not requested; raw "-" = standard output
	const char *gpu, *camera; // NULL = the renderer's choice, the scene's first camera
	double fps; // per simulated second
	double still[OB_STILLS_MAX]; // s, ascending: times of single frames instead
	uint32_t stills; // 0 = none
	ob_quality quality;
	int width, height, samples;
	bool aabb, contacts, joints, caption, simulators, reads; // overlays
	char reader[OB_NAME_MAX]; // object whose readings are drawn; "" = all
	ob_colour_key colour_by;
} ob_frames_request;

typedef struct ob_run_request {
	const char *scene; // path; NULL until a resumed run sets it
	ob_scene_options scene_options;
	const char *name; // of the universe; NULL = the host's choice
	ob_isolation isolation;
	bool isolation_given; // else a hardened run has processes
	uint32_t workers; // 0 = one per object
	uint32_t harden; // bits, 1 << ob_harden_measure
	double duration; // s; 0 = the scene's
	double patience; // s, for a step; 0 = the host's choice
	ob_on_death on_death;
	ob_restart_limit limit; // of deaths
	ob_settings asked; // those of the command line
	ob_run_settings run; // after ob_request_resolve
	bool explain;
	bool strict; // a missed tolerance is a failure, and so is an error of a script
	bool check; // checks the simulators' shared state after each step
	ob_frames_request frames;
	double pace; // simulated seconds a second; OB_PACE_MAX
	bool full_report; // for people
	const char *record, *series, *trace, *json; // paths; NULL = not requested; json "-" = standard output
	const char *checkpoint, *resume; // paths; NULL = not requested
	ob_fault_plan fault; // to inject; zeroed = none
	bool is_free; // after ob_request_resolve
	bool free_command; // the command can run free
	ob_setting_word of_free,
		of_lockstep; // an option that was given, and is for one of the two alone; "" = none
	ob_setting_word of_own_step; // the same for runs that take lockstep's own step, free or not
	ob_free_settings free; // of a free run
	uint64_t schedule_digest; // of all that decides a free run, but for its settings and its schedule
} ob_run_request;

// false and e on malformed numbers, values out of range, contradictions, or missing directories.
// The strings stay those of a.
bool ob_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e);

// Reads the settings of a command line; false and e on malformed ones.
bool ob_request_read_settings(ob_settings *to, const ob_arguments *a, ob_error *e);

// Fills duration and settings from the scene where the command line leaves them open. false and e when the result
// cannot be run.
bool ob_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e);

// The same for a run that resumes from a checkpoint and keeps its settings; s is the scene of saved, which must outlive
// r.
bool ob_request_resume(ob_run_request *r, const ob_saved_run *saved, const ob_scene *s, ob_error *e);

// Request to draw a run again from its record; --replay is given.
typedef struct ob_replay_request {
	const char *record; // path
	double duration; // s from the run's start at which to end; 0 = the record's end
	ob_frames_request frames;
} ob_replay_request;

// false and e when there is a scene beside --replay, or an option or a setting that is not allowed (OB_BIT).
bool ob_request_check_replay(const ob_arguments *a, uint64_t options, uint64_t settings, ob_error *e);
// false and e on options that have no meaning for a replay, or other errors.
bool ob_request_read_replay(ob_replay_request *r, const ob_arguments *a, ob_error *e);
// false and e when no camera has the requested name, or a frame is due after the run's duration (s).
bool ob_request_check_frames(const ob_frames_request *f, const ob_scene *s, double duration, ob_error *e);

// The parts of reading and resolving that free running adds.
bool ob_free_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e);
bool ob_free_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e);

// Configuration of the host for a resolved request.
ob_host_config ob_request_host(const ob_run_request *r);

// Creates the recorder of a run of the request, with the facts of its scene and universe. NULL and e: it failed.
ob_recorder *ob_request_record(const ob_run_request *r, const ob_scene *scene, const ob_universe *u, ob_error *e);

// Steps in a duration: the first step boundary at or after its end.
uint64_t ob_request_steps(double duration, double step);

#endif
