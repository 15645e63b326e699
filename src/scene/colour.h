// Colours as people write them: sRGB, as numbers or in hexadecimal; inside, linear RGB and alpha.
#ifndef OB_SCENE_COLOUR_H
#define OB_SCENE_COLOUR_H

#include <stdbool.h>

// sRGB components (0..1) to linear; alpha stays.
void ob_colour_from_srgb(const double rgba[4], float linear[4]);
// "#rrggbb" or "#rrggbbaa"
bool ob_colour_from_hex(const char *text, float linear[4]);

#endif
