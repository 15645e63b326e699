#include <ob/sensor.h>

const char *ob_sensor_kind_name(uint32_t kind)
{
	static const char *const name[OB_SENSOR_KINDS] = {
		[OB_SENSOR_IMU] = "imu",     [OB_SENSOR_ENCODER] = "encoder", [OB_SENSOR_FORCE_TORQUE] = "force_torque",
		[OB_SENSOR_TOUCH] = "touch", [OB_SENSOR_LIDAR] = "lidar",     [OB_SENSOR_CAMERA] = "camera",
	};
	return kind < OB_SENSOR_KINDS ? name[kind] : NULL;
}
