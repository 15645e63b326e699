// Inside the module record only: the used subset of HDF5, with errors as one line for a person.
#ifndef OB_RECORD_HDF5_FILE_H
#define OB_RECORD_HDF5_FILE_H

#include <hdf5.h>

#include <ob/universe.h>

// Meaning of a dataset, stored as its attributes.
typedef struct ob_hdf5_label {
	const char *name, *units, *frame, *description; // frame: NULL where it means nothing
} ob_hdf5_label;

// Silences HDF5's own messages on the terminal from now on (process-wide). This thread's failures before are forgotten.
void ob_hdf5_silence(void);
// Sets e: "doing" failed, and the system's reason of this thread's last call of HDF5 that failed for one. Returns false.
bool ob_hdf5_fail(ob_error *e, const char *path, const char *doing);

// Bytes of the closed file that HDF5 uses; 0 if it cannot be read.
uint64_t ob_hdf5_length(const char *path);

// Type of strings of fixed length, padded with zeros. The caller closes the type.
hid_t ob_hdf5_string_type(size_t length);
bool ob_hdf5_attribute_text(hid_t at, const char *name, const char *text);
bool ob_hdf5_attribute_numbers(hid_t at, const char *name, const double *number, size_t numbers);
bool ob_hdf5_attribute_count(hid_t at, const char *name, uint64_t count);
// Creates a dataset of rank dimensions dims[]. The first grows without limit if chunk_rows > 0, in chunks of that many
// rows, and the second if chunk_ids > 0. Unwritten elements are zero or fill. Negative on failure.
hid_t ob_hdf5_dataset(hid_t in, const ob_hdf5_label *label, hid_t type, int rank, const hsize_t *dims,
		      hsize_t chunk_rows, hsize_t chunk_ids, const void *fill);

#endif
