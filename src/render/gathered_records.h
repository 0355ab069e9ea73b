#pragma once

#include "patchlight/base/progress.h"

#include "render/gathered_light.h"
#include "render/irradiance_cache.h"
#include "render/lens.h"
#include "render/seen.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// What a picture sees of a solved scene.
struct PictureView {
  const SolvedLight& solved;
  const GatheredLight& gather;
  const std::vector<SeenSphere>& spheres;
  const Lens& lens;
};

/// Of how many pixels the picture is, and how the records are gathered.
struct RecordOptions {
  int width = 0, height = 0;
  HemisphereOptions hemisphere = {};
  std::uint32_t seed = 1;
};

/// Records of the light from other patches where a picture sees patches that reflect: first far from each other, then
/// closer where those that are there serve too little. Same bits for any number of threads. \throws Cancelled.
IrradianceCache gathered_records(const PictureView& view, const RecordOptions& options, const Observer& observer);

}  // namespace patchlight
