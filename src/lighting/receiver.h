#pragma once

#include "lighting/lighting.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace patchlight {

/// Points of a four-dimensional Sobol sequence: two numbers for a place of the receiver, two for one of the source.
using SamplePoints = std::span<const std::array<double, 4>>;

/// The points of one estimate of what a receiver gets.
struct ReceiverSamples {
  SamplePoints rays;    ///< choose the places that get a shadow ray, shifted for this receiver and source alone
  SamplePoints places;  ///< choose those that find the share of a patch that is not covered
};

/// A patch or a point that receives light: a place of it for each point of the unit square.
struct Receiver {
  std::function<SurfacePoint(double, double)> place;
  Side side = Side::front;     ///< of the places' polygon
  std::vector<Point> corners;  ///< of a patch, counter-clockwise from its front; none: a point

  bool is_point() const { return corners.empty(); }
};

/// True when another polygon lies over this place of the receiver.
inline bool is_covered(const Lighting& lighting, const Receiver& receiver, const SurfacePoint& at) {
  return at.polygon != no_polygon && lighting.paths.is_covered(at.polygon, receiver.side, at.point);
}

}  // namespace patchlight
