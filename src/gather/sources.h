#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"

#include "lighting/light_paths.h"
#include "mesh/patch_lookup.h"
#include "visibility/occluder.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A bright patch that a sensor may see. Shadow rays find how much of it is visible.
struct Source {
  PatchIndex patch = 0;
  std::vector<Point> outline;  ///< the part above the sensor's horizon
  double form_factor = 0;      ///< unoccluded, from the sensor's point
  double light_share = 0;      ///< of the sensor's unoccluded irradiance, mean of the bands that have any
};

/// The part of a patch above a sensor's horizon; empty where there is none.
std::vector<Point> outline_above_horizon(const PatchMesh& mesh, PatchIndex patch, const Sensor& sensor);

/// The patches that may send light to a sensor, by their radiosity.
struct Sources {
  std::vector<Source> bright;  ///< the radiosity exceeds a limit in some band; in the order of the mesh
  Spectrum unoccluded;         ///< irradiance by these if nothing hides them, W/m^2
  bool is_rest_lit = false;    ///< some other patch sends light as well
};

/// Finds the patches above `limit` that a sensor may see: sensor and patch lie before each other by more than
/// `tolerance`, in meters. No side of a polygon on which a sensor lies counts. O(patches).
Sources sources_before(const Sensor& sensor, const PatchMesh& mesh, const FieldView& radiosity, const Spectrum& limit,
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

/// A bright patch that gets rays, with the probability that it does.
struct ChosenSource {
  const Source* source = nullptr;
  RayCounts rays;
  double probability = 1;
};

/// A key of random numbers for a sensor, by its place and direction. Stages of one sensor have unrelated keys.
std::uint64_t key_of(const Sensor& sensor, const TracingFrame& frame, std::uint64_t seed, std::uint32_t stage);

/// Where a ray from a sensor meets a patch.
struct HemisphereHit {
  PatchIndex patch = 0;
  std::uint32_t replicate = 0;
  Point point;
  double arriving = 1;    ///< share of the light that gets through clear polygons
  Spectrum by_band = {};  ///< the same of each band; empty where it is equal in all
};

/// Rays from sensors, distributed as the cosine over the hemisphere, in most_replicates independent replicates. They
/// pass clear polygons, and meet the patches of these as well.
class HemisphereRays {
 public:
  /// `coloured` as GatherOptions has it.
  HemisphereRays(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t seed, const LightPaths* coloured);

  /// The hits of `each` rays of every replicate.
  std::vector<HemisphereHit> hits(const Sensor& sensor, std::uint32_t each, std::uint32_t stage) const;

 private:
  std::vector<Ray> rays(const Sensor& sensor, std::uint32_t each, std::uint32_t stage) const;
  std::vector<HemisphereHit> attenuated(std::vector<HemisphereHit> hits, const Sensor& sensor,
                                        std::span<const std::size_t> behind_panes) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  const LightPaths* coloured_;
  std::uint64_t seed_;
  PatchLookup lookup_;
  std::vector<std::array<double, 4>> points_;
};

/// Shadow rays from sensors to patches.
class ShadowRays {
 public:
  /// `coloured` as GatherOptions has it.
  ShadowRays(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t seed, const LightPaths* coloured = nullptr);

  /// The visible shares of the sources.
  std::vector<VisibleShare> visible_shares(const Sensor& sensor, std::span<const ChosenSource> sources,
                                           std::uint32_t stage) const;

 private:
  struct Rays {
    std::vector<Segment> segments;
    std::vector<double> weights;
  };
  Rays rays(const Sensor& sensor, std::span<const ChosenSource> sources, std::uint32_t stage) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  const LightPaths* coloured_;
  std::uint64_t seed_;
  std::vector<std::array<double, 4>> points_;
};

}  // namespace patchlight
