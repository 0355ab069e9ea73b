#pragma once

#include "patchlight/render/image.h"

namespace patchlight {

/// The map with light at so many texels around each chart, and around its holes: beside a texel that is known as the
/// light goes on linearly from it and the one behind it, within 0 and twice what it is there, so that what is
/// interpolated at the edge of a chart is what there is; farther out the mean of what is beside.
Lightmap with_padding(Lightmap map, int texels);

}  // namespace patchlight
