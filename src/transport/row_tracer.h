#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "form_factor/monte_carlo.h"
#include "form_factor/pair_samples.h"
#include "mesh/patch_lookup.h"
#include "transport/bright_patches.h"
#include "transport/ray_rows.h"
#include "transport/sights.h"
#include "visibility/occluder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// What the rays of one patch tell.
struct PatchRays {
  std::array<std::vector<PatchIndex>, 2> hits;  ///< per half: the patches met that are not bright
  double inverse_lengths = 0;                   ///< summed over its rays, 1/m
  int escaped = 0;
  int unseen = 0;  ///< as unseen() counts
};

/// The entries of some patches in both halves, before they are scaled, one patch after the other.
struct RowEntries {
  std::array<std::vector<RayEntry>, 2> halves;
  std::uint32_t shadow_rays = 0;
};

/// Traces the rays of one patch after the other, as trace_rows() has them. Safe to use from several threads.
class RowTracer {
 public:
  /// Keeps references to the first three.
  RowTracer(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright, const RayOptions& options);

  /// Rays of each patch in one half.
  const std::vector<std::uint32_t>& counts() const { return counts_; }

  /// The rays of a patch; its entries are added at the end.
  PatchRays trace(PatchIndex patch, RowEntries& entries) const;

 private:
  enum class Purpose : std::uint32_t;
  struct TowardBright;
  SampleSet samples(PatchIndex patch, Purpose purpose, std::uint32_t half) const;
  std::vector<Ray> hemisphere_rays(PatchIndex patch) const;
  float entry_of(PatchIndex patch, const Ray& ray, const Hit& hit, PatchIndex met) const;
  RayEntry fill_lane(ShadowPacket& packet, std::size_t lane, const TowardBright& rays, std::size_t k) const;
  void add_toward_bright(const TowardBright& rays, std::vector<RayEntry>& into, std::uint32_t& shadow_rays) const;
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
