#pragma once

#include "patchlight/base/geometry.h"

#include "lighting/lamp_faces.h"
#include "lighting/lighting.h"
#include "lighting/mirror_paths.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// What one sample of a source gives a place if nothing is in the way.
struct MirroredArrival {
  Segment segment;  ///< from the place to the source
  Spectrum irradiance;
};

/// Light that arrives at the image of a place from one direction, for each sample of a source.
using ArrivalAtImage = std::function<std::optional<MirroredArrival>(const SurfacePoint& at, const SurfacePoint& image,
                                                                    const Eigen::Vector2d& uv)>;

/// Where a source is: in a ball, or in a direction.
struct SourceExtent {
  std::optional<Vector> direction;
  Ball ball;
};

/// A source and how its light arrives by way of mirrors.
struct MirroredSource {
  std::uint32_t id = 0;  ///< the same for a source in every list of one lighting; faces of one polygon share theirs
  ArrivalAtImage arrival;
  SourceExtent extent;
  Vector axis = -Vector::UnitZ();  ///< unit; narrow beams lie around it
};

/// Luminaires and sun of a lighting, and lamps; both have to live as long.
std::vector<MirroredSource> mirrored_sources(const Lighting& lighting, std::span<const LampFace> lamps);

}  // namespace patchlight
