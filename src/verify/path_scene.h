#pragma once

#include "patchlight/base/field.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "verify/surfaces.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <memory>
#include <span>

namespace patchlight {

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

  /// The diagonal of the bounds, metres.
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

}  // namespace patchlight
