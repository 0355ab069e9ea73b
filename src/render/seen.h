#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include "mesh/patch_lookup.h"
#include "visibility/occluder.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {

/// A sphere that emits evenly and hides what is behind it.
struct SeenSphere {
  Point centre;
  double radius = 0;  ///< metres
  Spectrum radiance;  ///< W/(m^2 sr)
};

/// A patch that a ray sees, behind clear faces or not; none where it meets nothing.
struct SeenPatch {
  std::size_t ray = 0;
  std::optional<PatchIndex> patch;
  Point point = Point::Zero();  ///< on the patch
  Vector direction;
  double share = 1;                    ///< of its light that gets through what is before it
  bool outlook = false;                ///< behind a clear face, or nothing is met
  double distance = 0;                 ///< along the way from the ray's origin, metres
  const SeenSphere* sphere = nullptr;  ///< that is seen in place of a patch
};

/// The luminaires that are spheres.
std::vector<SeenSphere> spheres_of(const std::vector<Luminaire>& luminaires);

/// What rays see: the first patch that each meets and, as long as that is clear or a mirror, what is behind it and in
/// it. Rays pass sides without patches: they go on from there. They end on spheres.
std::vector<SeenPatch> seen_by(const Occluder& occluder, const PatchLookup& lookup, const std::vector<Ray>& rays,
                               const std::vector<SeenSphere>& spheres = {});

}  // namespace patchlight
