#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// What one side of a polygon is to light.
struct Surface {
  bool kept = false;  ///< false: it absorbs all light and emits none
  Vector normal;      ///< unit, out of this side
  Spectrum reflectance;
  Spectrum transmittance;  ///< 0 for an opaque side
  Spectrum exitance;       ///< W/m^2; 0 for a side that does not emit
};

/// The sides of a scene's polygons.
struct Surfaces {
  std::vector<Surface> sides;  ///< at 2 * polygon + side

  const Surface& at(PolygonIndex polygon, Side side) const {
    return sides[2 * std::size_t{polygon} + static_cast<std::size_t>(side)];
  }
};

Surfaces surfaces_of(const Scene& scene, const KeptSides& kept);

/// An orthonormal frame whose third axis is the normal.
Eigen::Matrix3d frame_around(const Vector& normal);

}  // namespace patchlight
