// Inside the module mesh only: pictures of glTF files, which are PNG or JPEG.
#ifndef OB_MESH_IMAGE_H
#define OB_MESH_IMAGE_H

#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// Profiles and gammas in it are ignored, as glTF asks (2.0, 3.8.3). most: pixels. false and e, and nothing in "out": it
// is neither, larger, or damaged. rgba comes from malloc.
bool ob_image_read(ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most, ob_error *e);

#ifdef __cplusplus
}
#endif

#endif
