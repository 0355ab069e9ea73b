#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "light/pane.h"
#include "scene/specular_faces.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {

/// What one side of a polygon is to light.
struct Surface {
  bool kept = false;         ///< false: it absorbs all light and emits none
  bool is_clear = false;     ///< a side of a clear polygon
  bool is_specular = false;  ///< a side of a clear polygon, or of one with a mirror
  Vector normal;             ///< unit, out of this side
  Spectrum reflectance;      ///< the mean where there is a texture
  std::optional<TexturedReflectance> texture;
  TextureMap texture_map;   ///< where there is one
  std::vector<Pane> panes;  ///< per band; none of an opaque side
  Spectrum held;            ///< of a clear one: the share of light from all directions alike that is kept, per band
  Spectrum mirrored;  ///< the share of light that is reflected as by a mirror at all angles; 0 of a clear one, and
                      ///< where reflections are not followed
  Reflections reflections = Reflections::kept;
  Spectrum scattered_through;  ///< the share of light that is scattered out of the other side; 0 unless both are kept
  Spectrum exitance;           ///< W/m^2; 0 for a side that does not emit
};

/// The reflectance at one of its points.
Spectrum reflectance_at(const Surface& surface, const Point& point);

/// The share that a side lets straight through at an angle to its normal with this cosine, per band.
Spectrum transmittance(const Surface& surface, double cosine);

/// The share that is reflected there as by a mirror, per band; 0 where reflections are not followed.
Spectrum specular_reflectance(const Surface& surface, double cosine);

/// The share that it keeps there over that which it keeps of light from all directions alike. A pane sends out, and
/// weighs what it reflects, by this: docs/theory/panes-mirrors-sheets.md.
Spectrum relative_held(const Surface& surface, double cosine);

/// The sides of a scene's polygons.
struct Surfaces {
  std::vector<Surface> sides;  ///< at 2 * polygon + side

  const Surface& at(PolygonIndex polygon, Side side) const {
    return sides[2 * std::size_t{polygon} + static_cast<std::size_t>(side)];
  }
};

Surfaces surfaces_of(const Scene& scene, const KeptSides& kept, Reflections reflections = Reflections::kept);

/// An orthonormal frame whose third axis is the normal.
Eigen::Matrix3d frame_around(const Vector& normal);

}  // namespace patchlight
