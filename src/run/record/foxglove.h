// Messages of Foxglove's schemas, as protocol buffers, made of a run's states and samples: for files (mcap.h) and live viewers.
//
//   channel              schema                      message
//   /scene               foxglove.SceneUpdate        looks of objects that come, change or go
//   /poses               foxglove.FrameTransforms    places of those that have moved: object/ID in world, camera/NAME in object/ID
//   /NAME of a sensor    obsim.Sample                its values
//     lidar              foxglove.LaserScan, or with several rows foxglove.PointCloud
//     camera             foxglove.RawImage /NAME/colour, /NAME/depth (m), /NAME/objects; foxglove.CameraCalibration /NAME/calibration
//
// Formats: https://docs.foxglove.dev/docs/visualization/message-schemas. Thread-safety: one thread at a time for each object.
#ifndef OB_RECORD_FOXGLOVE_H
#define OB_RECORD_FOXGLOVE_H

#include "measure/measure.h"
#include "scene/scene.h"

// A growing buffer. Starts zeroed; the caller frees bytes.
typedef struct ob_bytes {
	char *bytes;
	size_t size, room;
	bool failed; // no memory
} ob_bytes;
void ob_bytes_put(ob_bytes *b, const void *bytes, size_t n);

// Description of all schemas: a FileDescriptorSet.
void ob_foxglove_describe(ob_bytes *to);

typedef enum ob_channel_kind {
	OB_CHANNEL_SCENE,
	OB_CHANNEL_POSES,
	OB_CHANNEL_VALUES,
	OB_CHANNEL_SCAN,
	OB_CHANNEL_CLOUD,
	OB_CHANNEL_COLOUR,
	OB_CHANNEL_DEPTH,
	OB_CHANNEL_OBJECTS,
	OB_CHANNEL_CALIBRATION,
} ob_channel_kind;

typedef struct ob_channel {
	ob_channel_kind kind;
	uint32_t sensor; // of the scene; the first two have none
	const char *schema; // "foxglove.SceneUpdate"
	char topic[OB_NAME_MAX + 16]; // "/scene"
} ob_channel;

// Channel i of a run with these sensors; false: it has no more.
bool ob_channel_get(const ob_sensor_passport *sensor, uint32_t sensors, uint32_t i, ob_channel *out);

// Memory of what a reader has seen. Starts zeroed.
typedef struct ob_foxglove_view {
	uint32_t ids;
	ob_passport *shown; // [ids]
	ob_pose *placed; // [ids]
} ob_foxglove_view;
// Makes room for the snapshot's objects; false: no memory.
bool ob_foxglove_view_fit(ob_foxglove_view *v, const ob_snapshot *s);
void ob_foxglove_view_finish(ob_foxglove_view *v);

// Write what a reader has not seen, of the time ns. Return false, and write nothing, if that is nothing.
bool ob_foxglove_scene(ob_bytes *to, ob_foxglove_view *v, const ob_scene *scene, const ob_snapshot *s, uint64_t ns);
bool ob_foxglove_poses(ob_bytes *to, ob_foxglove_view *v, const ob_scene *scene, const ob_snapshot *s, uint64_t ns);
// Writes a sample of the channel's sensor p, taken at time ns.
void ob_foxglove_sample(ob_bytes *to, const ob_channel *c, const ob_sensor_passport *p, uint64_t ns,
			const double *value);

#endif
