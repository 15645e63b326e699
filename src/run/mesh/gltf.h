// The part of obsim that reads binary glTF files (base/part.h): obsim-gltf.so, in C++ for tinygltf's sake (gltf.cpp).
#ifndef OB_MESH_GLTF_H
#define OB_MESH_GLTF_H

#include "base/part.h"
#include "mesh/mesh.h"

typedef struct ob_gltf_part {
	ob_part_head head;
	// Reads a binary glTF file of version 2, whose headers have been checked. The arrays come from malloc; the radius
	// is not set. false and e, and nothing in m: no triangles, too many, or invalid data.
	bool (*read)(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e);
} ob_gltf_part;

#endif
