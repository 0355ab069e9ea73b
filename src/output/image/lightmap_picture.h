#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/render/image.h"

#include <string>
#include <vector>

namespace patchlight {

/// A radiance of a lightmap as colours for a display, W/(m^2 sr) times the exposure, row by row: no field in double
/// precision of the whole map is made.
DisplayImage picture_of_map(const Lightmap& map, const TexelField& radiance, double exposure, const Bands& bands);

}  // namespace patchlight
