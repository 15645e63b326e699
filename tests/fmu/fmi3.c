// A model as an FMU of FMI 3.0, co-simulation.
#include <stdlib.h>
#include <string.h>

#include "model.h"

typedef struct component {
	double value[MODEL_VALUES];
	ob_fmi3_log *log;
	void *environment;
} component;

EXPORT ob_fmi3_instantiate fmi3InstantiateCoSimulation;
EXPORT ob_fmi_free fmi3FreeInstance;
EXPORT ob_fmi3_enter fmi3EnterInitializationMode;
EXPORT ob_fmi_exit_initialization fmi3ExitInitializationMode;
EXPORT ob_fmi3_set fmi3SetFloat64;
EXPORT ob_fmi3_get fmi3GetFloat64;
EXPORT ob_fmi3_step fmi3DoStep;
EXPORT ob_fmi_get_state fmi3GetFMUState, fmi3FreeFMUState;
EXPORT ob_fmi_set_state fmi3SetFMUState;
EXPORT ob_fmi_state_size fmi3SerializedFMUStateSize;
EXPORT ob_fmi_serialize fmi3SerializeFMUState;
EXPORT ob_fmi_deserialize fmi3DeserializeFMUState;

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
				  bool logging, bool event_mode, bool early_return, const uint32_t *intermediate,
				  size_t intermediates, void *environment, ob_fmi3_log *log, void *intermediate_update)
{
	component *c = strcmp(token, "{obsim}") == 0 ? calloc(1, sizeof *c) : NULL;
	if (!c) {
		log(environment, OB_FMI_ERROR, "error", "unknown token");
		return NULL;
	}
	memcpy(c->value, model_start, sizeof c->value);
	model_pass("instantiate");
	c->log = log;
	c->environment = environment;
	return c;
}

void fmi3FreeInstance(void *c)
{
	model_pass("free");
	free(c);
}

int fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance, double start, bool has_stop, double stop)
{
	model_pass("initialize");
	return OB_FMI_OK;
}

int fmi3ExitInitializationMode(void *c)
{
	return OB_FMI_OK;
}

int fmi3SetFloat64(void *p, const uint32_t *reference, size_t n, const double *value, size_t values)
{
	component *c = p;
	if (values != n)
		return OB_FMI_ERROR;
	for (size_t i = 0; i < n; i++) {
		if (reference[i] >= MODEL_VALUES)
			return OB_FMI_ERROR;
		c->value[reference[i]] = value[i];
	}
	return OB_FMI_OK;
}

int fmi3GetFloat64(void *p, const uint32_t *reference, size_t n, double *value, size_t values)
{
	const component *c = p;
	if (values != n)
		return OB_FMI_ERROR;
	for (size_t i = 0; i < n; i++) {
		if (reference[i] >= MODEL_VALUES)
			return OB_FMI_ERROR;
		value[i] = c->value[reference[i]];
	}
	return OB_FMI_OK;
}

int fmi3DoStep(void *p, double time, double length, bool no_state_before, bool *event, bool *terminate, bool *early,
	       double *reached)
{
	component *c = p;
	*event = *terminate = *early = false;
	*reached = time + length;
	if (model_step(c->value, time, length))
		return OB_FMI_OK;
	c->log(c->environment, OB_FMI_ERROR, "error", "no step");
	return OB_FMI_ERROR;
}

int fmi3GetFMUState(void *p, void **state)
{
	const component *c = p;
	if (model_give_state)
		model_give_state(c->value);
	*state = *state ? *state : malloc(sizeof c->value);
	memcpy(*state, c->value, sizeof c->value);
	return OB_FMI_OK;
}

int fmi3SetFMUState(void *p, void *state)
{
	component *c = p;
	memcpy(c->value, state, sizeof c->value);
	return OB_FMI_OK;
}

int fmi3FreeFMUState(void *c, void **state)
{
	free(*state);
	*state = NULL;
	return OB_FMI_OK;
}

int fmi3SerializedFMUStateSize(void *p, void *state, size_t *size)
{
	*size = sizeof((component *)p)->value;
	return OB_FMI_OK;
}

int fmi3SerializeFMUState(void *c, void *state, unsigned char *bytes, size_t size)
{
	memcpy(bytes, state, size);
	return OB_FMI_OK;
}

int fmi3DeserializeFMUState(void *c, const unsigned char *bytes, size_t size, void **state)
{
	fmi3GetFMUState(c, state);
	memcpy(*state, bytes, size);
	return OB_FMI_OK;
}
