#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "form_factor/pair_samples.h"
#include "mesh/patch_lookup.h"
#include "transport/ray_rows.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The largest number of rays of a patch in each of two halves.
inline constexpr std::uint32_t most_rays = 4096;

/// The number of rays per patch in each of two halves, so that the mean over the patches of both together is about
/// `mean`. It is proportional to the area to the power 0.4, rounded to a power of two. Patches of one size all get the
/// same number, up to 1.42 times above or below the requested one. `areas` are those of the patches, or other weights.
std::vector<std::uint32_t> ray_counts(std::span<const double> areas, int mean);

/// Patches that are expected to send much of the light, and that rays therefore sample directly. Each is chosen with a
/// probability proportional to its share of their flux. The expected light affects the noise only, never the mean.
class BrightPatches {
 public:
  /// Selects patches whose expected radiosity (one value per patch) is above `threshold` times its area-weighted mean.
  /// Selects none if hemisphere rays often hit them by chance with so little scatter that more such rays cost less.
  BrightPatches(const PatchMesh& mesh, const Eigen::VectorXd& expected, double threshold, const Occluder& occluder);

  bool empty() const { return patches_.empty(); }
  std::size_t size() const { return patches_.size(); }
  /// Probability density of choosing a point of the patch, 1/m^2; 0: not a bright patch.
  float density(PatchIndex patch) const { return density_[patch]; }
  const std::vector<float>& densities() const { return density_; }
  /// Prefetches the densities of patches that will be read next.
  void prefetch_densities(std::span<const PatchIndex> patches) const {
    for (const PatchIndex patch : patches) __builtin_prefetch(&density_[patch]);
  }

  /// A patch chosen by u in [0, 1). The rest of u is stretched over [0, 1) for reuse.
  struct Chosen {
    PatchIndex patch = 0;
    const SampledPatch* sampled = nullptr;
    float u = 0;
  };
  Chosen at(double u) const;

 private:
  std::vector<PatchIndex> patches_;
  std::vector<double> upto_;          // per bright patch: cumulative probability
  std::vector<std::uint32_t> guide_;  // per equal part of [0, 1): the first possible choice
  std::vector<SampledPatch> sampled_;
  std::vector<float> density_;  // per patch of the mesh
};

/// The result of the rays of one patch.
struct PatchRays {
  std::array<std::vector<PatchIndex>, 2> hits;  ///< per half: the patches hit that are not bright
  double inverse_lengths = 0;                   ///< summed over its rays, 1/m
  int escaped = 0;
  int unseen = 0;  ///< counted as in unseen(); both without rays on specular paths
};

/// The entries of some patches in both halves, unscaled, in the order of the patches.
struct RowEntries {
  std::array<std::vector<RayEntry>, 2> halves;
  std::array<std::vector<SpecularStop>, 2> stops = {};
  std::uint32_t shadow_rays = 0;
};

/// Traces the rays of single patches for trace_rows(). Thread-safe.
class RowTracer {
 public:
  /// Keeps references to the first three.
  RowTracer(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright, const RayOptions& options);

  /// Whether rays can have specular paths.
  bool is_specular() const { return !occluder_.optics().empty(); }

  /// The number of polygons in the scene.
  PolygonIndex polygons() const { return static_cast<PolygonIndex>(mesh_.first_patch.size() / 2); }

  /// Rays of each patch in one half.
  const std::vector<std::uint32_t>& counts() const { return counts_; }

  /// Traces the rays of a patch; appends its entries.
  PatchRays trace(PatchIndex patch, RowEntries& entries) const;

 private:
  struct TowardBright;
  PatchRays trace_plain(PatchIndex patch, RowEntries& entries) const;
  PatchRays trace_specular(PatchIndex patch, RowEntries& entries) const;
  struct PlainHit {
    std::size_t ray;
    const Hit* hit;
  };
  void add_hits(PatchIndex patch, std::span<const Ray> rays, std::span<const PlainHit> hits, PatchRays& told,
                RowEntries& entries) const;
  bool starts_clear(PatchIndex patch) const;
  SpecularStop stop_at(PatchIndex patch, const Ray& ray, const WayStop& at) const;
  void add_stops(PatchIndex patch, const Ray& ray, const SeenWay& seen, std::vector<SpecularStop>& stops) const;
  void add_arriving(const ShadowPacket& packet, PatchIndex patch, std::span<const RayEntry> entries, std::size_t half,
                    RowEntries& into) const;
  std::vector<SpecularStop> crossing_stops(const ShadowPacket& packet, std::size_t lane, PatchIndex patch,
                                           const RayEntry& entry, std::span<const PolygonIndex> crossed) const;
  SampleSet samples(PatchIndex patch, std::uint32_t purpose, std::uint32_t half) const;
  std::vector<Ray> hemisphere_rays(PatchIndex patch) const;
  float entry_of(PatchIndex patch, const Ray& ray, const Hit& hit, PatchIndex met) const;
  RayEntry fill_lane(ShadowPacket& packet, std::size_t lane, const TowardBright& rays, std::size_t k) const;
  void add_toward_bright(const TowardBright& rays, PatchIndex patch, std::size_t half, RowEntries& into) const;
  void add_toward_bright(PatchIndex patch, RowEntries& entries) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  const BrightPatches& bright_;
  std::uint64_t seed_;
  std::uint32_t toward_bright_;  // m: in one half
  Sights sights_;
  PatchLookup lookup_;
  std::vector<std::uint32_t> keys_;
  std::vector<std::uint32_t> counts_;
  SampleTable table_;
};

}  // namespace patchlight
