#pragma once

#include "patchlight/base/field.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "base/sampling.h"
#include "light/pane.h"
#include "visibility/occluder.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

struct PathReceiver;

/// The optical properties of one side of a polygon.
struct Surface {
  bool kept = false;         ///< false: it absorbs all light and emits none
  bool is_clear = false;     ///< a side of a clear polygon
  bool is_specular = false;  ///< a side of a clear polygon, or of one with a mirror
  Vector normal;             ///< unit, out of this side
  Spectrum reflectance;      ///< the mean where there is a texture
  std::optional<TexturedReflectance> texture;
  TextureMap texture_map;   ///< where there is one
  std::vector<Pane> panes;  ///< per band; none of an opaque side
  Spectrum nonspecular;     ///< of a clear one: the mean share that is absorbed or scattered, per band
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

/// The share kept at this angle relative to the share kept of diffuse light. A pane weights its emitted and its
/// reflected light by this: docs/theory/panes-mirrors-sheets.md.
Spectrum nonspecular_profile(const Surface& surface, double cosine);

/// The sides of a scene's polygons.
struct Surfaces {
  std::vector<Surface> sides;  ///< at 2 * polygon + side

  const Surface& at(PolygonIndex polygon, Side side) const {
    return sides[2 * std::size_t{polygon} + static_cast<std::size_t>(side)];
  }
};

/// An orthonormal frame whose third axis is the normal.
Eigen::Matrix3d frame_around(const Vector& normal);

/// A direction after its reflection at a plane.
inline Vector mirrored_direction(const Vector& normal, const Vector& direction) {
  return direction - 2 * normal.dot(direction) * normal;
}

/// The geometry and the surfaces that paths meet. Immutable; shared by all parts of the path tracer.
class PathScene {
 public:
  PathScene(const Scene& scene, const KeptSides& sides, Reflections reflections);

  /// The transmittance of each segment (row) per band (column). It is 0 if an opaque polygon lies between the ends.
  /// Otherwise it is the product of the transmittances of the clear polygons on the way, each at its angle of
  /// incidence.
  Field transmittance(std::span<const Segment> segments) const;

  /// A point in a unit direction from another, beyond all polygons.
  Point beyond(const Point& from, const Vector& direction) const;

  const Occluder& faces() const { return faces_; }
  const Surfaces& surfaces() const { return surfaces_; }
  Eigen::Index bands() const { return bands_; }

  /// The diagonal of the bounds, meters.
  double extent() const { return bounds_.diagonal().norm(); }

 private:
  Spectrum through_panes(const Segment& segment) const;

  Tracing tracing_;
  const Occluder& faces_;
  Surfaces surfaces_;
  std::shared_ptr<const Occluder> opaque_;
  std::shared_ptr<const Occluder> clear_;  // null if no polygon is clear
  Box bounds_;
  std::size_t polygons_;
  Eigen::Index bands_;
};

/// A random number of (0, 1) for these counters.
inline double uniform(std::initializer_list<std::uint64_t> counters) { return (hash(counters) + 0.5) * 0x1p-32; }

/// The end of a ray that mirrors and clear polygons may have sent on.
struct RayEnd {
  std::optional<Hit> hit;  ///< none if the ray leaves the scene
  Vector direction;        ///< unit, at its end
  Spectrum factor;         ///< of the light from there
};

/// Follows a ray from its first hit through mirrors and clear polygons, one of its ways at each: it goes through, is
/// reflected, or ends to be scattered, in proportion to the mean shares of these.
RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed);

/// For each point of a receiver: 1 if it is exposed, 0 if it is covered, i.e. inside a solid or against another face. A
/// point is covered if another polygon lies over it in its plane. It is also covered if eight cosine-distributed rays
/// and eight around its horizon all meet a side that is not kept, or a face against the receiver.
std::vector<std::uint8_t> exposed(const Occluder& occluder, const Surfaces& surfaces, const PathReceiver& receiver,
                                  std::span<const Point> points, std::uint64_t seed);

}  // namespace patchlight
