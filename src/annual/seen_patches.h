#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/scene/sensor.h"

#include "gather/planes.h"
#include "gather/sources.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// How the radiosity at a point of a patch follows from that of the patches around: B_j + d . sum_i a_i (B_i - B_j), d
/// the way from the centroid. Geometry alone decides it, so that readings are linear in radiosity.
struct PatchPlane {
  std::vector<PatchIndex> around;
  Eigen::Matrix3Xd slopes;  ///< a_i, 1/m
};

/// Those of all patches; patches between which something stands do not count. \throws Canceled.
std::vector<PatchPlane> planes_of(const PatchMesh& mesh, const Occluder& occluder, const Observer& observer);

/// How sensors look at patches.
struct SeenBy {
  HemisphereRays hemisphere;
  const PatchMesh& mesh;
  std::vector<PatchPlane> planes;
  Eigen::Index bands = 1;
  double tolerance = 0;  ///< a sensor nearer to the plane of a patch lies in it, m
};

/// The irradiance at each sensor by a radiosity of 1 on each patch, straight or through panes and mirrors: a row for
/// each patch, for each sensor one column after the other for its bands. `each` rays in each of most_replicates.
Field seen_patches(const SeenBy& by, std::span<const Sensor> sensors, std::uint32_t each);

}  // namespace patchlight
