#include "mesh/gltf.h"

bool ob_gltf_read(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e)
{
	(void)m, (void)bytes, (void)size;
	return ob_fail(e, "this obsim was built without tinygltf, which reads such files");
}

bool ob_gltf_is_there(void)
{
	return false;
}
