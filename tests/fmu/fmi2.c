// A model as an FMU of FMI 2.0, co-simulation.
#include <stdlib.h>
#include <string.h>

#include "model.h"

typedef struct component {
	double value[MODEL_VALUES];
	const ob_fmi2_callbacks *callbacks;
} component;

EXPORT ob_fmi2_instantiate fmi2Instantiate;
EXPORT ob_fmi_free fmi2FreeInstance;
EXPORT ob_fmi2_setup fmi2SetupExperiment;
EXPORT ob_fmi2_enter fmi2EnterInitializationMode;
EXPORT ob_fmi_exit_initialization fmi2ExitInitializationMode;
EXPORT ob_fmi2_set fmi2SetReal;
EXPORT ob_fmi2_get fmi2GetReal;
EXPORT ob_fmi2_step fmi2DoStep;
EXPORT ob_fmi_get_state fmi2GetFMUstate, fmi2FreeFMUstate;
EXPORT ob_fmi_set_state fmi2SetFMUstate;
EXPORT ob_fmi_state_size fmi2SerializedFMUstateSize;
EXPORT ob_fmi_serialize fmi2SerializeFMUstate;
EXPORT ob_fmi_deserialize fmi2DeSerializeFMUstate;

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
		      const ob_fmi2_callbacks *functions, int visible, int logging)
{
	component *c = strcmp(guid, "{obsim}") == 0 ? functions->allocate(1, sizeof *c) : NULL;
	if (!c) {
		functions->logger(functions->environment, name, OB_FMI_ERROR, "error", "unknown key %s", guid);
		return NULL;
	}
	memcpy(c->value, model_start, sizeof c->value);
	model_pass("instantiate");
	c->callbacks = functions;
	return c;
}

void fmi2FreeInstance(void *p)
{
	component *c = p;
	model_pass("free");
	c->callbacks->free(c);
}

int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop)
{
	return OB_FMI_OK;
}

int fmi2EnterInitializationMode(void *c)
{
	model_pass("initialize");
	return OB_FMI_OK;
}

int fmi2ExitInitializationMode(void *c)
{
	return OB_FMI_OK;
}

int fmi2SetReal(void *p, const uint32_t *reference, size_t n, const double *value)
{
	component *c = p;
	for (size_t i = 0; i < n; i++) {
		if (reference[i] >= MODEL_VALUES)
			return OB_FMI_ERROR;
		c->value[reference[i]] = value[i];
	}
	return OB_FMI_OK;
}

int fmi2GetReal(void *p, const uint32_t *reference, size_t n, double *value)
{
	const component *c = p;
	for (size_t i = 0; i < n; i++) {
		if (reference[i] >= MODEL_VALUES)
			return OB_FMI_ERROR;
		value[i] = c->value[reference[i]];
	}
	return OB_FMI_OK;
}

int fmi2DoStep(void *p, double time, double length, int no_state_before)
{
	component *c = p;
	if (model_step(c->value, time, length))
		return OB_FMI_OK;
	c->callbacks->logger(c->callbacks->environment, "test", OB_FMI_ERROR, "error", "no step from %g s", time);
	return OB_FMI_ERROR;
}

int fmi2GetFMUstate(void *p, void **state)
{
	const component *c = p;
	if (model_give_state)
		model_give_state(c->value);
	*state = *state ? *state : malloc(sizeof c->value);
	memcpy(*state, c->value, sizeof c->value);
	return OB_FMI_OK;
}

int fmi2SetFMUstate(void *p, void *state)
{
	component *c = p;
	memcpy(c->value, state, sizeof c->value);
	return OB_FMI_OK;
}

int fmi2FreeFMUstate(void *c, void **state)
{
	free(*state);
	*state = NULL;
	return OB_FMI_OK;
}

int fmi2SerializedFMUstateSize(void *p, void *state, size_t *size)
{
	*size = sizeof((component *)p)->value;
	return OB_FMI_OK;
}

int fmi2SerializeFMUstate(void *c, void *state, unsigned char *bytes, size_t size)
{
	memcpy(bytes, state, size);
	return OB_FMI_OK;
}

int fmi2DeSerializeFMUstate(void *c, const unsigned char *bytes, size_t size, void **state)
{
	fmi2GetFMUstate(c, state);
	memcpy(*state, bytes, size);
	return OB_FMI_OK;
}
