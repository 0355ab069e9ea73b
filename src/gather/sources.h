#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"

#include "lighting/light_paths.h"
#include "visibility/occluder.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A patch that a sensor may see.
struct Source {
  PatchIndex patch = 0;
  std::vector<Point> outline;  ///< the part above the sensor's horizon
  double form_factor = 0;      ///< unoccluded, from the sensor's point
  double light_share = 0;      ///< of the sensor's unoccluded irradiance, mean of the bands that have any
};

/// The patches that a sensor may see: sensor and patch lie before each other by more than `tolerance`, in meters. In
/// the order of the mesh, with light from the given radiosity. No side of a polygon on which a sensor lies counts.
std::vector<Source> sources_before(const Sensor& sensor, const PatchMesh& mesh, const FieldView& radiosity,
                                   double tolerance);

/// The estimate by shadow rays to a source, weighted by geometry terms.
struct VisibleShare {
  Eigen::Vector4d moments = Eigen::Vector4d::Zero();     ///< the share that is visible, and its first moments about the
                                                         ///< patch's centroid, meters
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of these
  double rays = 0;
  Spectrum colour = {};  ///< times which each band of the mean arrives; empty: 1

  double mean() const { return moments[0]; }
};

/// Shadow rays to a source: so many replicates of so many.
struct RayCounts {
  std::uint32_t replicates = 0;
  std::uint32_t each = 0;
};

/// The most replicates of rays from a sensor.
inline constexpr std::uint32_t most_replicates = 8;

/// At least two replicates, so that they have a scatter.
RayCounts ray_counts(double rays);

/// Shadow rays from sensors to patches.
class ShadowRays {
 public:
  /// `coloured` as GatherOptions has it.
  ShadowRays(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t seed, const LightPaths* coloured = nullptr);

  /// The visible shares of the sources. Stages of one sensor have unrelated random numbers.
  std::vector<VisibleShare> visible_shares(const Sensor& sensor, std::span<const Source> sources,
                                           std::span<const RayCounts> counts, std::uint32_t stage) const;

 private:
  struct Rays {
    std::vector<Segment> segments;
    std::vector<double> weights;
  };
  Rays rays(const Sensor& sensor, std::span<const Source> sources, std::span<const RayCounts> counts,
            std::uint32_t stage) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  const LightPaths* coloured_;
  std::uint64_t seed_;
  std::vector<std::array<double, 4>> points_;
};

}  // namespace patchlight
