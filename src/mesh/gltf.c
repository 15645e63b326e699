// The table of the part that reads glTF.
#include "mesh/gltf.h"

OB_PART(ob_gltf_part) = { OB_PART_HEAD(ob_gltf_part), .read = ob_gltf_read };
