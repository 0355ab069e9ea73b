#pragma once

#include "patchlight/render/image.h"

#include "mesh/patch_lookup.h"
#include "render/gathered_light.h"

namespace patchlight {

/// The map with the light of coplanar neighbours at the texels around each chart: where another chart goes on in its
/// plane, and no wall stands between, what is interpolated at their common edge is the same from both. Of a map with
/// padding.
Lightmap with_neighbours(Lightmap map, const SolvedLight& solved, const PatchLookup& lookup);

}  // namespace patchlight
