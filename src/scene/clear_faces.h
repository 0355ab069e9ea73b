#pragma once

#include "patchlight/scene/scene.h"

#include "light/pane.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// A clear polygon as light between patches meets it: one number for all bands and both ways, the mean of its two
/// sides, each weighted as luminance is. Cosines are those of the angle to its normal, in [0, 1].
class ClearFace {
 public:
  /// Of a polygon that is_opening().
  ClearFace(const Scene& scene, PolygonIndex polygon);

  /// The share that goes straight through.
  double transmittance(double cosine) const;

  /// The share that is kept of light from all directions alike, weighted as irradiance is.
  double held() const { return held_; }

  /// The share that is kept at an angle, over held(): its mean over the hemisphere, weighted as irradiance is, is 1.
  double relative_held(double cosine) const;

  /// The cosine that belongs to a number of [0, 1) if directions are distributed as what is kept of light from all
  /// directions alike.
  double held_cosine(double u) const;

 private:
  struct Part {
    double weight = 0;
    Pane pane;
  };
  std::vector<Part> parts_;        // each pane once
  std::vector<double> held_upto_;  // the share of what is kept that comes at cosines up to k / cosine_steps
  double held_ = 1;
};

/// The clear polygons of a scene; all others are opaque. Directions are unit vectors.
class ClearFaces {
 public:
  /// None.
  ClearFaces() = default;
  explicit ClearFaces(const Scene& scene);

  bool empty() const { return faces_.empty(); }

  /// ClearFace::transmittance() of a polygon; 0 of an opaque one.
  double transmittance(PolygonIndex polygon, const Vector& direction) const;

  /// ClearFace::held() of a polygon; 1 of an opaque one.
  double held(PolygonIndex polygon) const;

  /// ClearFace::relative_held() of a polygon; 1 of an opaque one.
  double relative_held(PolygonIndex polygon, const Vector& direction) const;

  /// The direction, in a frame whose third axis is the polygon's normal, that belongs to (u, v) of the unit square if
  /// directions are distributed as what the polygon keeps of light from all directions alike: of an opaque one
  /// square_to_cosine_hemisphere().
  Vector held_direction(PolygonIndex polygon, double u, double v) const;

 private:
  const ClearFace* at(PolygonIndex polygon) const;  // null: opaque

  std::vector<ClearFace> faces_;           // each pair of materials once
  std::vector<std::uint32_t> of_polygon_;  // none where no polygon is clear, as normals
  std::vector<Vector> normals_;
};

}  // namespace patchlight
