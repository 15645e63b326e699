// The table of the part that calls HDF5.
#include "record/part.h"

OB_PART(ob_record_part) = {
	OB_PART_HEAD(ob_record_part),         .create = ob_hdf5_recorder_create,
	.append = ob_hdf5_recorder_append,    .sense = ob_hdf5_recorder_sense,
	.finish = ob_hdf5_recorder_close,     .open = ob_hdf5_recording_open,
	.info = ob_hdf5_recording_get_info,   .close = ob_hdf5_recording_close,
	.next = ob_hdf5_recording_next,       .state = ob_hdf5_recording_state,
	.samples = ob_hdf5_recording_samples, .population = ob_hdf5_recording_population,
};
