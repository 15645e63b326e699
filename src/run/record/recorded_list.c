#include "record/recorded.h"

#include <stdlib.h>
#include <string.h>

enum { BYTES_AT_ONCE = 1 << 18 };

bool ob_recording_damaged(const ob_recording *r, const char *what, ob_error *e)
{
	return ob_fail(e, "%s: this record is damaged: %s", r->path, what);
}

// ---- links

// Nothing in a record may name another file, or load code: links lead to objects in the file itself, datasets lie
// there, too, and no filter has to be loaded.

bool ob_recording_find(const ob_recording *r, const char *name, bool *there, ob_error *e)
{
	char what[96], part[64];
	H5L_info_t link;
	*there = true;
	for (size_t n = 1; *there && n <= strlen(name); n++) {
		if (name[n] && name[n] != '/')
			continue;
		snprintf(part, sizeof part, "%.*s", (int)n, name);
		*there = H5Lexists(r->file, part, H5P_DEFAULT) > 0;
		if (*there && (H5Lget_info(r->file, part, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)) {
			snprintf(what, sizeof what, "/%s is a link to something else", part);
			return ob_recording_damaged(r, what, e);
		}
	}
	return true;
}

// ---- datasets

// True if the dataset's elements are stored unfiltered in the file. Checked before all else: for a virtual dataset,
// even a query of its size opens the files that it names.
static bool lies_in_file(hid_t set)
{
	hid_t how = H5Dget_create_plist(set);
	const H5D_layout_t layout = H5Pget_layout(how);
	const bool here = (layout == H5D_CHUNKED || layout == H5D_CONTIGUOUS) && H5Pget_external_count(how) == 0 &&
			  H5Pget_nfilters(how) == 0;
	H5Pclose(how);
	return here;
}

hid_t ob_recorded_set_open(const ob_recording *r, const char *name, H5T_class_t kind, int rank, uint64_t *count,
			   ob_error *e)
{
	char what[80];
	bool there = false;
	if (!ob_recording_find(r, name, &there, e))
		return H5I_INVALID_HID;
	hid_t set = there ? H5Dopen2(r->file, name, H5P_DEFAULT) : H5I_INVALID_HID;
	if (set >= 0 && !lies_in_file(set)) {
		H5Dclose(set);
		set = H5I_INVALID_HID;
	}
	if (set >= 0) {
		hid_t type = H5Dget_type(set), space = H5Dget_space(set);
		hssize_t points = H5Sget_simple_extent_npoints(space);
		uint64_t bytes = 0, stored = H5Dget_storage_size(set);
		bool fits = H5Tget_class(type) == kind && H5Sget_simple_extent_ndims(space) == rank && points >= 0 &&
			    !__builtin_mul_overflow((uint64_t)points, (uint64_t)H5Tget_size(type), &bytes) &&
			    bytes <= stored && stored <= r->file_bytes;
		*count = (uint64_t)points;
		H5Sclose(space);
		H5Tclose(type);
		if (fits)
			return set;
		H5Dclose(set);
	}
	snprintf(what, sizeof what, "/%s is not as it should be", name);
	ob_recording_damaged(r, what, e);
	return H5I_INVALID_HID;
}

ob_recorded_list ob_recorded_list_of(const ob_record_table *table)
{
	return (ob_recorded_list){ .table = table, .set = H5I_INVALID_HID, .type = H5I_INVALID_HID };
}

bool ob_recorded_list_open(ob_recording *r, ob_recorded_list *l, ob_error *e)
{
	l->set = ob_recorded_set_open(r, l->table->label.name, H5T_COMPOUND, 1, &l->total, e);
	if (l->set < 0)
		return false;
	l->type = ob_record_type_in_memory(l->table);
	l->room = BYTES_AT_ONCE / l->table->size;
	l->item = calloc(l->room, l->table->size);
	return l->item ? true : ob_fail(e, "%s: no memory", r->path);
}

void ob_recorded_list_close(ob_recorded_list *l)
{
	if (l->set >= 0)
		H5Dclose(l->set);
	if (l->type >= 0)
		H5Tclose(l->type);
	free(l->item);
}

const void *ob_recorded_item(ob_recorded_list *l, uint64_t i)
{
	if (i < l->first || i >= l->first + l->held) {
		hsize_t from = i, count = l->total - i < l->room ? l->total - i : l->room;
		hid_t in_file = H5Dget_space(l->set), in_memory = H5Screate_simple(1, &count, NULL);
		memset(l->item, 0, l->room * l->table->size);
		bool ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, &from, NULL, &count, NULL) >= 0 &&
			  H5Dread(l->set, l->type, in_memory, in_file, H5P_DEFAULT, l->item) >= 0;
		H5Sclose(in_memory);
		H5Sclose(in_file);
		l->first = i;
		l->held = ok ? count : 0;
		if (!ok)
			return NULL;
	}
	return l->item + (i - l->first) * l->table->size;
}
