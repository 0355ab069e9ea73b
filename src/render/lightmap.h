#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/render/image.h"

#include "render/gathered_light.h"
#include "render/lightmap_charts.h"

#include <cstdint>

namespace patchlight {

/// How the light at texels is found.
struct BakeOptions {
  int rays_to_lights = 4;                        ///< from each of sixteen places of a texel
  int gathers = 4;                               ///< so many of these places at which other light is gathered
  HemisphereOptions hemisphere = {.rays = 256};  ///< of each gather
  std::uint32_t seed = 1;
};

/// Bakes the light at the texels of charts: straight from lights by shadow rays, and what patches reflect by a final
/// gather into the solution, as pictures have it. `sent_besides` is what each patch sends out that does not follow from
/// the irradiance on its front: its exitance and what comes through a sheet, W/m^2. Same bits for any number of
/// threads. \throws Cancelled.
Lightmap bake(const SolvedLight& solved, const FieldView& sent_besides, PackedCharts charts, const BakeOptions& options,
              const Observer& observer = {});

}  // namespace patchlight
