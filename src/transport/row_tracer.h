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

/// A patch takes no more rays in each of two halves.
inline constexpr std::uint32_t most_rays = 4096;

/// How many rays each patch takes in each of two halves, so that the mean over the patches of both together is about
/// `mean`: in proportion to its area to the power 0.4, rounded to powers of two. Where patches have one size, all have
/// one number, which is then up to 1.42 times more or less than asked for. `areas` are those of the patches, or others
/// in proportion to which patches matter.
std::vector<std::uint32_t> ray_counts(std::span<const double> areas, int mean);

/// Patches from which much of the light is expected, towards which rays are sent on purpose: each with a probability in
/// proportion to its share of their flux. The expected light decides about the error alone, never about the mean.
class BrightPatches {
 public:
  /// Those of which the expected radiosity, one value per patch, is above `threshold` times its mean over the area;
  /// none where rays often meet them by chance, and scatter so little that more of these cost less.
  BrightPatches(const PatchMesh& mesh, const Eigen::VectorXd& expected, double threshold, const Occluder& occluder);

  bool empty() const { return patches_.empty(); }
  std::size_t size() const { return patches_.size(); }
  /// Probability per area of a point of the patch to be chosen, 1/m^2; 0: not a bright one.
  float density(PatchIndex patch) const { return density_[patch]; }
  const std::vector<float>& densities() const { return density_; }
  /// Starts to read the densities of patches that are asked for next.
  void prefetch_densities(std::span<const PatchIndex> patches) const {
    for (const PatchIndex patch : patches) __builtin_prefetch(&density_[patch]);
  }

  /// A patch chosen by u in [0, 1), which is stretched over the patch's share of [0, 1) to be used again.
  struct Chosen {
    PatchIndex patch = 0;
    const SampledPatch* sampled = nullptr;
    float u = 0;
  };
  Chosen at(double u) const;

 private:
  std::vector<PatchIndex> patches_;
  std::vector<double> upto_;          // per bright patch: the probability of it and all before
  std::vector<std::uint32_t> guide_;  // per equal part of [0, 1): the first that may be chosen there
  std::vector<SampledPatch> sampled_;
  std::vector<float> density_;  // per patch of the mesh
};

/// The result of the rays of one patch.
struct PatchRays {
  std::array<std::vector<PatchIndex>, 2> hits;  ///< per half: the patches met that are not bright
  double inverse_lengths = 0;                   ///< summed over its rays, 1/m
  int escaped = 0;
  int unseen = 0;  ///< as unseen() counts; both without rays that are specular on their way
};

/// The entries of some patches in both halves, before they are scaled, one patch after the other.
struct RowEntries {
  std::array<std::vector<RayEntry>, 2> halves;
  std::array<std::vector<SpecularStop>, 2> stops = {};
  std::uint32_t shadow_rays = 0;
};

/// Traces the rays of one patch after the other, as trace_rows() has them. Safe to use from several threads.
class RowTracer {
 public:
  /// Keeps references to the first three.
  RowTracer(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright, const RayOptions& options);

  /// Whether rays can be specular on their way.
  bool is_specular() const { return !occluder_.specular_faces().empty(); }

  /// How many polygons the scene has.
  PolygonIndex polygons() const { return static_cast<PolygonIndex>(mesh_.first_patch.size() / 2); }

  /// Rays of each patch in one half.
  const std::vector<std::uint32_t>& counts() const { return counts_; }

  /// The rays of a patch; its entries are added at the end.
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
