// Inside the module mesh only: PNG and JPEG pictures of glTF files.
#ifndef OB_MESH_IMAGE_H
#define OB_MESH_IMAGE_H

#include "mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

// Reads a picture. Ignores its profiles and gammas, as glTF demands (2.0, 3.8.3). most: pixels. false and e, and
// nothing in "out": another format, too large, or damaged. rgba comes from malloc.
bool ob_image_read(ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most, ob_error *e);

#ifdef __cplusplus
}
#endif

#endif
