#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"

#include "lighting/light_paths.h"
#include "lighting/mirror_paths.h"
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

/// Finds the patches above `limit` that a sensor may see: sensor and patch lie before each other, and no single polygon
/// surely hides the patch. No side of a polygon on which a sensor lies counts. O(patches), with one or
/// two rays for each bright patch before the sensor.
Sources sources_before(const Sensor& sensor, const PatchMesh& mesh, const FieldView& radiosity, const Spectrum& limit,
                       const Occluder& occluder);

/// The estimate by shadow rays to a source, weighted by geometry terms.
struct VisibleShare {
  Eigen::Vector4d moments = Eigen::Vector4d::Zero();     ///< the share that arrives, and its first moments about the
                                                         ///< patch's centroid, meters
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of these
  double visible = 0;                                    ///< the share that nothing opaque hides
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

/// A patch that a path from a sensor meets.
struct HemisphereHit {
  PatchIndex patch = 0;
  std::uint32_t replicate = 0;
  Point point;
  double distance = 0;       ///< meters, along the path
  double form_factor = 0;    ///< the ray's share of the irradiance by a radiosity of 1 if the way is free
  Spectrum weight;           ///< the same after clear faces and mirrors on the way, per band
  bool is_mirrored = false;  ///< the path has a reflection
};

struct HemisphereHits {
  std::vector<HemisphereHit> all;
  double rays = 0;  ///< from the sensor
};

/// Rays from sensors over the hemisphere, in most_replicates independent replicates. They are distributed as the
/// cosine, or by SpecularAim, with twice as many rays. Paths continue through clear faces and mirrors.
class HemisphereRays {
 public:
  /// `aim` may be null. If `bands` differs from the bands of the optics, all bands have the mean throughput.
  HemisphereRays(const PatchMesh& mesh, const Occluder& occluder, const SurfaceOptics& optics, Eigen::Index bands,
                 std::uint64_t seed, const SpecularAim* aim);

  /// The hits of `each` rays of every replicate, or twice as many with targets of the aim.
  HemisphereHits hits(const Sensor& sensor, std::uint32_t each, std::uint32_t stage) const;

 private:
  Spectrum by_band(const Spectrum& throughput) const;
  std::vector<std::array<double, 2>> samples(std::uint64_t key, std::uint32_t replicate, std::uint32_t count) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  const SurfaceOptics& optics_;
  Eigen::Index bands_;
  const SpecularAim* aim_;
  std::uint64_t seed_;
  PatchLookup lookup_;
  std::vector<std::array<double, 4>> points_;
};

/// Shadow rays from sensors to patches.
class ShadowRays {
 public:
  /// `coloured` has the paths of each band; null if all bands are alike.
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
