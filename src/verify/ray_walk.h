#pragma once

#include "patchlight/light/spectrum.h"

#include "base/sampling.h"
#include "verify/path_scene.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <initializer_list>
#include <optional>

namespace patchlight {

/// A number of (0, 1) that belongs to counters.
inline double uniform(std::initializer_list<std::uint64_t> counters) { return (hash(counters) + 0.5) * 0x1p-32; }

/// The direction of a ray after its reflection at a plane.
inline Vector mirrored_direction(const Vector& normal, const Vector& direction) {
  return direction - 2 * normal.dot(direction) * normal;
}

/// The end of a ray that mirrors and clear polygons may have sent on.
struct RayEnd {
  std::optional<Hit> hit;  ///< none if the ray leaves the scene
  Vector direction;        ///< unit, at its end
  Spectrum factor;         ///< of the light from there
};

/// Follows a ray from its first hit through mirrors and clear polygons, one of its ways at each: it goes through, is
/// reflected, or ends to be scattered, in proportion to the mean shares of these.
RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed);

}  // namespace patchlight
