// Inside the module mesh only: the one file that speaks to tinygltf, in C++ (gltf.cpp), or what stands in for it where
// that is missing (gltf_null.c).
#ifndef OB_MESH_GLTF_H
#define OB_MESH_GLTF_H

#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// bytes: a binary glTF file of version 2, whose headers are right. The arrays come from malloc; the radius is not set.
// false and e, and nothing in m: it has no triangles, too many, or makes no sense.
bool ob_gltf_read(ob_mesh *m, const unsigned char *bytes, size_t size, ob_error *e);
bool ob_gltf_is_there(void);

#ifdef __cplusplus
}
#endif

#endif
