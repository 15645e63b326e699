// The part of obsim that reads binary glTF files (base/part.h): obsim-gltf.so, in C++ for tinygltf's sake (gltf.cpp).
#ifndef OB_MESH_GLTF_H
#define OB_MESH_GLTF_H

#include "base/part.h"
#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ob_gltf_part {
	ob_part_head head;
	bool (*read)(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e); // ob_gltf_read
} ob_gltf_part;

// Reads a binary glTF file of version 2, whose headers have been checked. The arrays come from malloc; the radius is
// not set. false and e, and nothing in m: no triangles, too many, or invalid data.
bool ob_gltf_read(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e);

#ifdef __cplusplus
}
#endif

#endif
