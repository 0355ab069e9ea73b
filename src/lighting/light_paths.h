#pragma once

#include "patchlight/base/field.h"
#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

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

  /// The optics of the scene's clear faces and mirrors.
  const std::shared_ptr<const SurfaceOptics>& optics() const { return optics_; }

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

  /// True if one opaque polygon surely blocks all segments between the convex hulls of two groups of points.
  bool hides(std::span<const Point> from, std::span<const Point> to) const;

  /// True when another polygon lies over this place of a side of a polygon, in one plane with it.
  bool is_covered(PolygonIndex polygon, Side side, const Point& place) const;
  /// True when that is so anywhere on the side.
  bool is_covered_in_part(PolygonIndex polygon, Side side) const;

 private:
  Box bounds_;
  std::shared_ptr<const Occluder> opaque_;
  std::shared_ptr<const Occluder> clear_;  // null where there are no openings
  std::shared_ptr<const SurfaceOptics> optics_;
};

}  // namespace patchlight
