#pragma once

#include "patchlight/light/spectrum.h"

#include "base/sampling.h"
#include "verify/surfaces.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

namespace patchlight {

/// A number of (0, 1) that belongs to counters.
inline double uniform(std::initializer_list<std::uint64_t> counters) { return (hash(counters) + 0.5) * 0x1p-32; }

/// What rays meet.
struct Met {
  const Occluder& occluder;
  const Surfaces& surfaces;
  const std::vector<std::uint8_t>& specular;  ///< per polygon: 1 for a clear one, and for a mirror
};

/// The end of a ray, what its light is multiplied with, and the rays that have left mirrors on the way, each with what
/// its light is multiplied with.
struct RayEnd {
  std::optional<Hit> hit;
  Spectrum factor;
  std::vector<Ray> mirrored;
  std::vector<Spectrum> of_mirrored;
};

/// From the first hit of a ray on. It goes through each clear face with the probability of its mean transmittance at
/// this angle, and is reflected with that of its mean reflectance; what it carries changes by the share that goes on
/// over that probability, or by what the face sends out in the ray's direction over what is left.
RayEnd end_of(const Met& met_by, std::optional<Hit> hit, std::uint32_t seed);

}  // namespace patchlight
