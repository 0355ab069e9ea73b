#pragma once

#include "patchlight/base/field.h"
#include "patchlight/scene/scene.h"

#include "light/pane.h"
#include "visibility/occluder.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// The fractions of light, per band, that clear polygons transmit straight, and that these and mirrors reflect
/// specularly, by the material of the side that the light meets.
class PaneSides {
 public:
  explicit PaneSides(const Scene& scene);

  Eigen::Index bands() const { return bands_; }

  /// False when no light goes through a polygon from either side.
  bool is_clear(PolygonIndex polygon) const { return !sides_.empty() && sides_[polygon].is_clear; }

  /// The transmittance of a clear polygon for the light seen in a unit direction.
  Spectrum transmittance(PolygonIndex polygon, const Vector& direction) const;

  /// False if a polygon has no specular reflection.
  bool is_specular(PolygonIndex polygon) const { return !sides_.empty() && sides_[polygon].is_specular; }

  /// The specular reflectance of an is_specular() polygon for the light seen in a unit direction, which meets the side.
  Spectrum specular_reflectance(PolygonIndex polygon, const Vector& direction) const;

 private:
  struct Sides {
    Vector normal = Vector::Zero();  // of the front
    std::array<MaterialIndex, 2> materials{};
    bool is_clear = false;
    bool is_specular = false;
  };
  MaterialIndex material_met(const Sides& sides, const Vector& direction) const;

  Eigen::Index bands_;
  std::vector<std::vector<Pane>> panes_;  // per material and band; none of an opaque one
  std::vector<Spectrum> mirrors_;         // per material: its specular reflectance; empty: none
  std::vector<Sides> sides_;              // per polygon; none where none is clear or a mirror
};

/// A clear opening that a ray crosses.
struct Crossing {
  PolygonIndex polygon = no_polygon;
  double distance = 0;  ///< meters from the ray's origin
};

/// The clear openings on the way of a ray. Empty where something opaque blocks it.
struct Passage {
  Spectrum transmittance;
  std::vector<Crossing> crossings;  ///< in order
};

/// The transmittance of the straight path between two points: 0 if an opaque polygon is in between. Otherwise it is the
/// product of the transmittances of the clear openings on the path, at their angles of incidence; each face counts
/// once. Points may lie outside the scene.
class LightPaths {
 public:
  LightPaths(const Scene& scene, const Tracing& tracing);

  /// Per segment (row) and band (column).
  Field transmittance(std::span<const Segment> segments) const;

  /// The same with the openings on the way.
  std::vector<Passage> passages(std::span<const Segment> segments) const;

  /// 1 for each segment that meets something opaque, else 0.
  std::vector<std::uint8_t> meets_opaque(std::span<const Segment> segments) const;

  /// The first opaque polygon that each ray meets; rays pass clear ones.
  std::vector<std::optional<Hit>> first_opaque_hits(std::span<const Ray> rays) const;

  /// A point far enough from another, in a unit direction, that the whole scene is nearer.
  Point beyond(const Point& from, const Vector& direction) const;

  /// False only if no polygon reaches between the front of a convex patch, or a point, and a ball by more than 1e-6 of
  /// the scene's extent. Then all rays between them are free. `normal` is the receiver's.
  bool may_be_hidden(std::span<const Point> receiver, const Vector& normal, const Point& centre, double radius) const;

  /// True when another polygon lies over this place of a side of a polygon, in one plane with it.
  bool is_covered(PolygonIndex polygon, Side side, const Point& place) const;
  /// True when that is so anywhere on the side.
  bool is_covered_in_part(PolygonIndex polygon, Side side) const;

 private:
  Passage through_openings(const Segment& segment) const;

  Box bounds_;
  std::shared_ptr<const Occluder> opaque_;
  std::shared_ptr<const Occluder> clear_;  // null where there are no openings
  PaneSides panes_;
};

}  // namespace patchlight
