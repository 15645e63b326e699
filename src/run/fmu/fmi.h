// The C interface of FMI 2.0 and 3.0 co-simulation, as far as it is used here: types, and functions that an FMU exports.
// Written from the standards (fmi-standard.org), whose names are kept. FMI 2 and 3 differ in names and in a few
// arguments; types that have the same representation are declared once.
#ifndef OB_FMU_FMI_H
#define OB_FMU_FMI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum ob_fmi_status { OB_FMI_OK, OB_FMI_WARNING, OB_FMI_DISCARD, OB_FMI_ERROR, OB_FMI_FATAL } ob_fmi_status;

// ---- FMI 2.0

typedef void ob_fmi2_logger(void *environment, const char *instance, int status, const char *category,
			    const char *message, ...);

typedef struct ob_fmi2_callbacks {
	ob_fmi2_logger *logger;
	void *(*allocate)(size_t count, size_t size);
	void (*free)(void *memory);
	void (*step_finished)(void *environment, int status); // NULL: steps are synchronous
	void *environment;
} ob_fmi2_callbacks;

enum { OB_FMI2_CO_SIMULATION = 1 };

typedef void *ob_fmi2_instantiate(const char *name, int type, const char *guid, const char *resources,
				  const ob_fmi2_callbacks *functions, int visible, int logging);
typedef int ob_fmi2_setup(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop);
typedef int ob_fmi2_enter(void *c);
typedef int ob_fmi2_set(void *c, const uint32_t *reference, size_t n, const double *value);
typedef int ob_fmi2_get(void *c, const uint32_t *reference, size_t n, double *value);
typedef int ob_fmi2_step(void *c, double time, double length, int no_state_before);

// ---- FMI 3.0

typedef void ob_fmi3_log(void *environment, int status, const char *category, const char *message);

typedef void *ob_fmi3_instantiate(const char *name, const char *token, const char *resources, bool visible,
				  bool logging, bool event_mode, bool early_return, const uint32_t *intermediate,
				  size_t intermediates, void *environment, ob_fmi3_log *log, void *intermediate_update);
typedef int ob_fmi3_enter(void *c, bool has_tolerance, double tolerance, double start, bool has_stop, double stop);
typedef int ob_fmi3_set(void *c, const uint32_t *reference, size_t n, const double *value, size_t values);
typedef int ob_fmi3_get(void *c, const uint32_t *reference, size_t n, double *value, size_t values);
typedef int ob_fmi3_step(void *c, double time, double length, bool no_state_before, bool *event, bool *terminate,
			 bool *early, double *reached);

// ---- both

typedef void ob_fmi_free(void *c);
typedef int ob_fmi_exit_initialization(void *c);
typedef int ob_fmi_get_state(void *c, void **state);
typedef int ob_fmi_set_state(void *c, void *state);
typedef int ob_fmi_state_size(void *c, void *state, size_t *size);
typedef int ob_fmi_serialize(void *c, void *state, unsigned char *bytes, size_t size);
typedef int ob_fmi_deserialize(void *c, const unsigned char *bytes, size_t size, void **state);

#endif
