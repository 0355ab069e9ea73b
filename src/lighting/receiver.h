#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "lighting/lighting.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace patchlight {

/// Points of a four-dimensional Sobol sequence: two numbers for a place of the receiver, two for one of the source.
using SamplePoints = std::span<const std::array<double, 4>>;

/// The points of one estimate of a receiver's irradiance.
struct ReceiverSamples {
  SamplePoints rays;    ///< choose the places that get a shadow ray, shifted for this receiver and source alone
  SamplePoints places;  ///< choose those that find the share of a patch that is not covered
};

/// Sample points moved by a digital shift that follows from a key, so that no two receivers have the same: errors of
/// several lamps add up as independent ones do.
std::vector<std::array<double, 4>> shifted(SamplePoints points, std::uint32_t key);

/// The mean of several estimates.
struct Estimate {
  Spectrum mean;
  Spectrum variance;  ///< of the mean
};

/// From the spread of one or more independent estimates (rows). One estimate has an error as large as itself.
Estimate estimate_of(const Field& replicates);

/// A patch or a point that receives light: a place of it for each point of the unit square.
struct Receiver {
  std::function<SurfacePoint(double, double)> place;
  Side side = Side::front;     ///< of the places' polygon
  std::vector<Point> corners;  ///< of a patch, counter-clockwise from its front; none: a point

  bool is_point() const { return corners.empty(); }
};

/// The receiver that a patch of a mesh is. The mesh must outlive it.
Receiver receiver_of(const PatchMesh& mesh, PatchIndex patch);

/// The receiver that a point is. The point must outlive it.
Receiver receiver_of(const SurfacePoint& point);

/// True when another polygon lies over this place of the receiver.
bool is_covered(const Lighting& lighting, const Receiver& receiver, const SurfacePoint& at);

}  // namespace patchlight
