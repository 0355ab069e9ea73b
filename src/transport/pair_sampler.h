#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A pair of patches that face each other, and what its shadow rays have met so far.
struct Pair {
  PatchIndex first = 0;  ///< rays are sampled from here
  PatchIndex second = 0;
  SampleSet set;
  float unoccluded = 0;             ///< exchange area without occluders, m^2; -1 when not yet computed
  float weight = 0;                 ///< summed weights of its samples: geometry terms, 1/m^2
  float seen_weight = 0;            ///< the same, each times what its shadow ray lets through (Occluder::transmittance)
  float seen = 0;                   ///< summed shares that the rays of samples with a weight let through
  float idle_seen = 0;              ///< of samples without: one end lies behind the other patch
  std::uint32_t weighted_rays = 0;  ///< of samples with a weight
  std::uint32_t idle_rays = 0;      ///< of samples without
  std::uint32_t effort = 1;         ///< times the usual number of samples
  bool is_adjacent = false;         ///< sampled by solid angle

  std::uint32_t rays() const { return weighted_rays + idle_rays; }
  /// The share of its rays that get through; where none carries weight, all count alike.
  double visible_share() const;
};

/// Finds by shadow rays how much of each other the patches of pairs see.
class PairSampler {
 public:
  PairSampler(const PatchMesh& mesh, const std::vector<PatchShape>& shapes, const Occluder& occluder,
              const AssemblyOptions& options);

  /// `unoccluded` is -1 where it takes exact() to find it, which happens when a ray is free.
  Pair new_pair(PatchIndex i, PatchIndex j, float unoccluded) const;

  /// The share of the light between two patches that counts as exchanged: of what arrives at a clear one, that it
  /// holds back.
  float held(PatchIndex i, PatchIndex j) const { return held_[i] * held_[j]; }

  /// The exchange area without occluders, by closed form or quadrature in double precision, times held().
  float exact(PatchIndex i, PatchIndex j) const;

  /// Traces as many rays for every pair as its form factor calls for, whatever they meet: were it to depend on what the
  /// first of them meet, the estimate would be biased. The pairs come out in another order.
  std::vector<Pair> sampled(std::vector<Pair> pairs) const;

  /// All samples of one pair anew, independent of those before.
  Pair sampled_again(const Pair& pair) const;

  /// The estimate from the pair's rays, m^2: docs/theory/occluded-form-factors.md, formula (5).
  double exchange_area(const Pair& pair) const;

 private:
  void trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  void trace_packets(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  void trace_adjacent(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t effort_for(const Pair& pair) const;

  const PatchMesh& mesh_;
  const std::vector<PatchShape>& shapes_;
  const Occluder& occluder_;
  FarRule far_rule_;
  std::uint32_t samples_;
  double scale_;
  std::vector<std::uint32_t> keys_;
  std::vector<SampledPatch> patches_;
  std::vector<float> held_;
  SampleTable table_;
};

}  // namespace patchlight
