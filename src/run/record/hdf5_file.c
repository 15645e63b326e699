#include "record/hdf5_file.h"

#include <stdio.h>
#include <string.h>

static _Thread_local char reason[128]; // the system's, of the last call that failed for one

// Finds the system's reason in HDF5's error: "..., errno = 28, error message = 'No space left on device', ..."
static herr_t find_reason(unsigned depth, const H5E_error2_t *error, void *data)
{
	(void)depth, (void)data;
	const char *mark = "error message = '";
	const char *from = error->desc ? strstr(error->desc, mark) : NULL;
	if (!from)
		return 0;
	from += strlen(mark);
	snprintf(reason, sizeof reason, "%.*s", (int)strcspn(from, "'"), from);
	return 0;
}

// HDF5 calls this when a call fails. Later calls, those that close what is open included, forget its errors.
static herr_t keep_reason(hid_t errors, void *data)
{
	return H5Ewalk2(errors, H5E_WALK_DOWNWARD, find_reason, data);
}

// Disables HDF5's own cleanup when the process exits, too: after a failed write it crashes (1.10.8). We close all that
// we open.
void ob_hdf5_silence(void)
{
	H5dont_atexit();
	H5Eset_auto2(H5E_DEFAULT, keep_reason, NULL);
	reason[0] = '\0';
}

bool ob_hdf5_fail(ob_error *e, const char *path, const char *doing)
{
	return ob_fail(e, "%s: cannot %s: %s", path, doing, reason[0] ? reason : "HDF5 gives no reason");
}

uint64_t ob_hdf5_length(const char *path)
{
	haddr_t end = 0;
	hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	if (file < 0 || H5Fget_eoa(file, &end) < 0)
		end = 0;
	if (file >= 0)
		H5Fclose(file);
	return end;
}

hid_t ob_hdf5_string_type(size_t length)
{
	hid_t type = H5Tcopy(H5T_C_S1);
	H5Tset_size(type, length);
	H5Tset_strpad(type, H5T_STR_NULLPAD);
	return type;
}

static bool write_attribute(hid_t at, const char *name, hid_t type, hid_t space, const void *data)
{
	hid_t id = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = id >= 0 && H5Awrite(id, type, data) >= 0;
	return (id < 0 || H5Aclose(id) >= 0) && ok;
}

bool ob_hdf5_attribute_text(hid_t at, const char *name, const char *text)
{
	hid_t type = ob_hdf5_string_type(text[0] ? strlen(text) : 1), space = H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, type, space, text);
	H5Sclose(space);
	H5Tclose(type);
	return ok;
}

bool ob_hdf5_attribute_numbers(hid_t at, const char *name, const double *number, size_t numbers)
{
	hsize_t n = numbers;
	hid_t space = numbers > 1 ? H5Screate_simple(1, &n, NULL) : H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, H5T_NATIVE_DOUBLE, space, number);
	H5Sclose(space);
	return ok;
}

bool ob_hdf5_attribute_count(hid_t at, const char *name, uint64_t count)
{
	hid_t space = H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, H5T_NATIVE_UINT64, space, &count);
	H5Sclose(space);
	return ok;
}

static bool add_label(hid_t set, const ob_hdf5_label *label)
{
	return ob_hdf5_attribute_text(set, "units", label->units) &&
	       (!label->frame || ob_hdf5_attribute_text(set, "frame", label->frame)) &&
	       ob_hdf5_attribute_text(set, "description", label->description);
}

enum { CACHE_SLOTS = 4001, CACHE_BYTES = 1 << 24 };

hid_t ob_hdf5_dataset(hid_t in, const ob_hdf5_label *label, hid_t type, int rank, const hsize_t *dims,
		      hsize_t chunk_rows, hsize_t chunk_ids, const void *fill)
{
	hsize_t most[4], chunk[4];
	memcpy(most, dims, (size_t)rank * sizeof *dims);
	memcpy(chunk, dims, (size_t)rank * sizeof *dims);
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	if (fill)
		H5Pset_fill_value(how, type, fill);
	if (chunk_rows) {
		most[0] = H5S_UNLIMITED;
		chunk[0] = chunk_rows;
		if (rank > 1 && chunk_ids) {
			most[1] = H5S_UNLIMITED;
			chunk[1] = chunk_ids;
		}
		H5Pset_chunk(how, rank, chunk);
	}
	hid_t space = H5Screate_simple(rank, dims, most);
	// an append writes one chunk for each chunk_ids ids, and all of these should stay in memory
	hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
	H5Pset_chunk_cache(access, CACHE_SLOTS, CACHE_BYTES, 1);
	hid_t set = H5Dcreate2(in, label->name, type, space, H5P_DEFAULT, how, access);
	H5Pclose(access);
	H5Sclose(space);
	H5Pclose(how);
	if (set >= 0 && !add_label(set, label)) {
		H5Dclose(set);
		return H5I_INVALID_HID;
	}
	return set;
}
