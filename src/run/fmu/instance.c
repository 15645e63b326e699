#include "fmu/instance.h"

#include <dlfcn.h>
#include <errno.h>
#include <fenv.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fmu/fmi.h"

typedef enum function {
	INSTANTIATE,
	FREE,
	SETUP, // FMI 2 only
	ENTER,
	EXIT,
	SET,
	GET,
	STEP,
	GET_STATE,
	SET_STATE,
	FREE_STATE,
	STATE_SIZE,
	SERIALIZE,
	DESERIALIZE,
	FUNCTIONS
} function;

static const char *const fmi2_name[FUNCTIONS] = {
	[INSTANTIATE] = "fmi2Instantiate",
	[FREE] = "fmi2FreeInstance",
	[SETUP] = "fmi2SetupExperiment",
	[ENTER] = "fmi2EnterInitializationMode",
	[EXIT] = "fmi2ExitInitializationMode",
	[SET] = "fmi2SetReal",
	[GET] = "fmi2GetReal",
	[STEP] = "fmi2DoStep",
	[GET_STATE] = "fmi2GetFMUstate",
	[SET_STATE] = "fmi2SetFMUstate",
	[FREE_STATE] = "fmi2FreeFMUstate",
	[STATE_SIZE] = "fmi2SerializedFMUstateSize",
	[SERIALIZE] = "fmi2SerializeFMUstate",
	[DESERIALIZE] = "fmi2DeSerializeFMUstate",
};
static const char *const fmi3_name[FUNCTIONS] = {
	[INSTANTIATE] = "fmi3InstantiateCoSimulation",
	[FREE] = "fmi3FreeInstance",
	[ENTER] = "fmi3EnterInitializationMode",
	[EXIT] = "fmi3ExitInitializationMode",
	[SET] = "fmi3SetFloat64",
	[GET] = "fmi3GetFloat64",
	[STEP] = "fmi3DoStep",
	[GET_STATE] = "fmi3GetFMUState",
	[SET_STATE] = "fmi3SetFMUState",
	[FREE_STATE] = "fmi3FreeFMUState",
	[STATE_SIZE] = "fmi3SerializedFMUStateSize",
	[SERIALIZE] = "fmi3SerializeFMUState",
	[DESERIALIZE] = "fmi3DeserializeFMUState",
};

struct ob_fmu {
	ob_fmu_model model;
	void *function[FUNCTIONS];
	void *instance; // NULL: none yet, or the last one has failed
	ob_fmi2_callbacks callbacks;
	ob_error said; // its last message of a failure
};

// ---- messages

static void keep_message(ob_fmu *f, int status, const char *text)
{
	if (status >= OB_FMI_DISCARD)
		ob_fail(&f->said, "%s", text);
}

__attribute__((format(printf, 5, 6))) static void log_fmi2(void *environment, const char *instance, int status,
							   const char *category, const char *message, ...)
{
	char text[200];
	va_list list;
	va_start(list, message);
	vsnprintf(text, sizeof text, message, list);
	va_end(list);
	keep_message(environment, status, text);
}

static void log_fmi3(void *environment, int status, const char *category, const char *message)
{
	keep_message(environment, status, message);
}

// ---- loading

static bool load(ob_fmu *f, const unsigned char *bytes, ob_error *e)
{
	char path[64];
	const size_t size = f->model.library_bytes;
	const int file = memfd_create("fmu", MFD_CLOEXEC);
	if (file < 0 || write(file, bytes, size) != (ssize_t)size)
		return ob_fail(e, "no memory for its library: %s", strerror(errno));
	snprintf(path, sizeof path, "/proc/self/fd/%d", file);
	void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	close(file);
	if (!library)
		return ob_fail(e, "its library cannot be loaded: %s", dlerror());
	const char *const *name = f->model.standard == 2 ? fmi2_name : fmi3_name;
	for (int i = 0; i < FUNCTIONS; i++) {
		f->function[i] = name[i] ? dlsym(library, name[i]) : NULL;
		if (name[i] && !f->function[i])
			return ob_fail(e, "its library has no %s", name[i]);
	}
	return true;
}

bool ob_fmu_model_read(const void *model, size_t size, ob_fmu_model *m, ob_error *e)
{
	if (size >= sizeof *m)
		memcpy(m, model, sizeof *m);
	return (size >= sizeof *m && m->library_bytes == size - sizeof *m && (m->standard == 2 || m->standard == 3) &&
		m->inputs <= OB_FMU_INPUTS_MAX && m->outputs <= OB_FMU_OUTPUTS_MAX &&
		memchr(m->token, 0, sizeof m->token)) ||
	       ob_fail(e, "its data is damaged");
}

ob_fmu *ob_fmu_open(const void *model, size_t size, ob_error *e)
{
	ob_fmu *f = calloc(1, sizeof *f);
	if (!f) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	f->callbacks = (ob_fmi2_callbacks){ .logger = log_fmi2, .allocate = calloc, .free = free, .environment = f };
	return ob_fmu_model_read(model, size, &f->model, e) &&
			       load(f, (const unsigned char *)model + sizeof f->model, e)
		       ? f
		       : NULL;
}

#define CALL(f, which, type) ((type *)(f)->function[which])

// ---- steps

// True if a call was good.
static bool check(ob_fmu *f, int status, const char *call, ob_error *e)
{
	static const char *const names[] = { "OK", "Warning", "Discard", "Error", "Fatal", "Pending" };
	if (status == OB_FMI_OK || status == OB_FMI_WARNING)
		return true;
	const bool known = status >= 0 && status < (int)(sizeof names / sizeof *names);
	ob_fail(e, "%s: %s%s%.120s", call, known ? names[status] : "unknown status", *f->said.text ? ": " : "",
		f->said.text);
	return false;
}

static bool set(ob_fmu *f, uint32_t reference, double value, ob_error *e)
{
	const int status = f->model.standard == 2 ? CALL(f, SET, ob_fmi2_set)(f->instance, &reference, 1, &value)
						  : CALL(f, SET, ob_fmi3_set)(f->instance, &reference, 1, &value, 1);
	return check(f, status, "setting a variable", e);
}

static bool get(ob_fmu *f, uint32_t reference, double *value, ob_error *e)
{
	const int status = f->model.standard == 2 ? CALL(f, GET, ob_fmi2_get)(f->instance, &reference, 1, value)
						  : CALL(f, GET, ob_fmi3_get)(f->instance, &reference, 1, value, 1);
	return check(f, status, "reading a variable", e);
}

static bool set_inputs(ob_fmu *f, const ob_fmu_turn *t, ob_error *e)
{
	for (int i = 0; i < f->model.inputs; i++)
		if (!set(f, f->model.input[i].reference, t->input[i], e))
			return false;
	return true;
}

static bool instantiate(ob_fmu *f, ob_error *e)
{
	const char *key = f->model.token;
	f->instance = f->model.standard == 2
			      ? CALL(f, INSTANTIATE, ob_fmi2_instantiate)("obsim", OB_FMI2_CO_SIMULATION, key, "",
									  &f->callbacks, 0, 0)
			      : CALL(f, INSTANTIATE, ob_fmi3_instantiate)("obsim", key, NULL, false, false, false,
									  false, NULL, 0, f, log_fmi3, NULL);
	return f->instance || ob_fail(e, "it cannot be instantiated%s%.120s", *f->said.text ? ": " : "", f->said.text);
}

// Gives an object a new instance, with these values from the start.
static bool begin(ob_fmu *f, const ob_fmu_turn *t, ob_error *e)
{
	if (f->instance)
		CALL(f, FREE, ob_fmi_free)(f->instance);
	if (!instantiate(f, e))
		return false;
	const bool second = f->model.standard == 2;
	if (second && !check(f, CALL(f, SETUP, ob_fmi2_setup)(f->instance, 0, 0, t->time, 0, 0), "setup", e))
		return false;
	for (uint32_t at = 0; t->first && at + sizeof(ob_fmu_start) <= t->state_bytes; at += sizeof(ob_fmu_start)) {
		ob_fmu_start start;
		memcpy(&start, t->state + at, sizeof start);
		if (!set(f, start.reference, start.value, e))
			return false;
	}
	const int status = second ? CALL(f, ENTER, ob_fmi2_enter)(f->instance)
				  : CALL(f, ENTER, ob_fmi3_enter)(f->instance, false, 0, t->time, false, 0);
	return check(f, status, "initialization", e) && set_inputs(f, t, e) &&
	       check(f, CALL(f, EXIT, ob_fmi_exit_initialization)(f->instance), "initialization", e);
}

static bool put_state(ob_fmu *f, const ob_fmu_turn *t, ob_error *e)
{
	void *state = NULL;
	if (!check(f, CALL(f, DESERIALIZE, ob_fmi_deserialize)(f->instance, t->state, t->state_bytes, &state),
		   "its state", e))
		return false;
	const int status = CALL(f, SET_STATE, ob_fmi_set_state)(f->instance, state);
	CALL(f, FREE_STATE, ob_fmi_get_state)(f->instance, &state);
	return check(f, status, "its state", e);
}

static bool take_state(ob_fmu *f, ob_fmu_turn *t, ob_error *e)
{
	void *state = NULL;
	size_t size = 0;
	if (!check(f, CALL(f, GET_STATE, ob_fmi_get_state)(f->instance, &state), "its state", e))
		return false;
	bool good = check(f, CALL(f, STATE_SIZE, ob_fmi_state_size)(f->instance, state, &size), "its state", e);
	if (good && size > sizeof t->state)
		good = ob_fail(e, "its state takes %zu bytes, and there is room for %zu", size, sizeof t->state);
	if (good)
		good = check(f, CALL(f, SERIALIZE, ob_fmi_serialize)(f->instance, state, t->state, size), "its state",
			     e);
	if (good)
		t->state_bytes = (uint32_t)size;
	CALL(f, FREE_STATE, ob_fmi_get_state)(f->instance, &state);
	return good;
}

static bool advance(ob_fmu *f, const ob_fmu_turn *t, ob_error *e)
{
	bool event = false, terminate = false, early = false;
	double reached = 0;
	if (f->model.standard == 2)
		return check(f, CALL(f, STEP, ob_fmi2_step)(f->instance, t->time, t->length, 1), "step", e);
	const int status = CALL(f, STEP, ob_fmi3_step)(f->instance, t->time, t->length, true, &event, &terminate,
						       &early, &reached);
	return check(f, status, "step", e) && (!terminate || ob_fail(e, "it has ended by itself"));
}

static bool run(ob_fmu *f, ob_fmu_turn *t, ob_error *e)
{
	if ((t->first || !f->instance) && !begin(f, t, e))
		return false;
	if (!t->first && !put_state(f, t, e))
		return false;
	if (!set_inputs(f, t, e) || !advance(f, t, e))
		return false;
	for (int i = 0; i < f->model.outputs; i++)
		if (!get(f, f->model.output[i].reference, &t->output[i], e))
			return false;
	return take_state(f, t, e);
}

bool ob_fmu_run(ob_fmu *f, ob_fmu_turn *t, ob_error *e)
{
	fenv_t usual; // the next object starts from it
	*f->said.text = 0;
	fegetenv(&usual);
	const bool good = run(f, t, e);
	fesetenv(&usual);
	if (!good) // a failed instance may not be used or freed: the next object gets a new one
		f->instance = NULL;
	return good;
}
