// Inside the module record only: members of a record's compound datasets, for the recorder that writes them and the
// recording that reads them. HDF5 finds members by name: a member that an older file lacks reads as zero, and an
// unknown one is skipped.
#ifndef OB_RECORD_LAYOUT_H
#define OB_RECORD_LAYOUT_H

#include <hdf5.h>

#include <ob/hull.h>
#include <ob/joint.h>
#include <ob/universe.h>

#include "scene/scene.h"

// ---- hdf5 file

// Inside the module record only: the used subset of HDF5, with errors as one line for a person.

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

// ---- layout

// Increase it when an older program, or this one with an older file, would misread data.
enum { OB_RECORD_VERSION = 2 };
// While a record is read, the times of all its states are in memory.
enum { OB_RECORD_STATES_MAX = 1 << 24 };
#define OB_RECORD_FORMAT "obsim record"

typedef enum ob_record_event_kind { OB_RECORD_CREATED = 1, OB_RECORD_CHANGED, OB_RECORD_REMOVED } ob_record_event_kind;

// An object was added, changed, or removed.
typedef struct ob_record_event {
	uint64_t step;
	double time; // s
	uint32_t kind; // ob_record_event_kind
	uint32_t zero;
	ob_passport passport; // its passport from then on, or until then
} ob_record_event;

// A joint was added, has broken (OB_RECORD_CHANGED), or was removed.
typedef struct ob_record_joint {
	uint64_t step;
	double time; // s
	uint32_t kind; // ob_record_event_kind
	uint32_t number;
	ob_joint_passport passport; // what acts along its axis and its strength are 0
} ob_record_joint;

typedef enum ob_record_type {
	OB_RECORD_U8,
	OB_RECORD_U16,
	OB_RECORD_U32,
	OB_RECORD_U64,
	OB_RECORD_FLAG, // uint8_t, 0 or 1
	OB_RECORD_F32,
	OB_RECORD_F64,
	OB_RECORD_VEC3,
	OB_RECORD_QUAT, // w x y z
	OB_RECORD_PAIR, // float[2]
	OB_RECORD_RGB, // float[3], linear; also positions and directions
	OB_RECORD_RGBA,
	OB_RECORD_NAME, // char[OB_NAME_MAX], UTF-8, padded with zeros
	OB_RECORD_EDGE, // ob_hull_edge
	OB_RECORD_POSE, // ob_pose: p, then q, w x y z
} ob_record_type;

typedef struct ob_record_member {
	const char *name;
	ob_record_type type;
	size_t offset; // in the structure
	size_t length; // of an array; 0: not an array
} ob_record_member;

typedef struct ob_record_table {
	ob_hdf5_label label;
	size_t size; // of the structure
	int members;
	const ob_record_member *member;
} ob_record_table;

// Motion of an object from then on.
typedef struct ob_record_motion {
	uint32_t id;
	uint32_t island; // as in the motion, which may hold a frequency in its place
	ob_motion motion;
} ob_record_motion;

// Some values of a sample. A picture has one: the row of its first pixel in /pixels.
enum { OB_RECORD_VALUES = 6 };
typedef struct ob_record_sample {
	uint32_t sensor, first; // first: index of the first of these values
	uint64_t number;
	double time; // s
	double value[OB_RECORD_VALUES]; // NaN beyond the last
} ob_record_sample;

// A hull, and its number in passports.
typedef struct ob_record_hull {
	uint32_t number, zero;
	ob_hull hull;
} ob_record_hull;

extern const ob_record_table ob_record_events; // ob_record_event
extern const ob_record_table ob_record_joints; // ob_record_joint
extern const ob_record_table ob_record_motions; // ob_record_motion: only the members that determine the pose
extern const ob_record_table ob_record_hulls; // ob_record_hull
extern const ob_record_table ob_record_sensors; // ob_sensor_passport
extern const ob_record_table ob_record_samples; // ob_record_sample
extern const ob_record_table ob_record_pixels; // ob_pixel
extern const ob_record_table ob_record_cameras; // ob_camera_def
extern const ob_record_table ob_record_look; // ob_look_def
extern const ob_record_table ob_record_mesh_vertices; // ob_mesh_vertex
extern const ob_record_table ob_record_mesh_triangles; // uint32_t[3]
extern const ob_record_table ob_record_mesh_parts; // ob_mesh_part

// The compound type of a table's structure in memory, and, packed, in a file. The caller closes it.
hid_t ob_record_type_in_memory(const ob_record_table *t);
hid_t ob_record_type_in_file(const ob_record_table *t);

#endif
