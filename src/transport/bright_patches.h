#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "form_factor/pair_samples.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class Occluder;

/// Patches from which much of the light is expected, towards which rays are sent on purpose: each with a probability in
/// proportion to its share of their flux. What is expected decides about the error alone, never about the mean.
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

}  // namespace patchlight
