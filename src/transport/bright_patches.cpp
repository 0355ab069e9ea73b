#include "transport/bright_patches.h"

#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <algorithm>

namespace patchlight {

BrightPatches::BrightPatches(const PatchMesh& mesh, const Eigen::VectorXd& expected, double threshold,
                             const Occluder& occluder)
    : density_(mesh.size(), 0) {
  // 1. Those above the threshold.
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  const double least = threshold * expected.dot(area) / area.sum();
  double flux = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (!(expected[i] > least)) continue;
    flux += area[i] * expected[i];
    patches_.push_back(i);
    upto_.push_back(flux);
  }

  // 2. Their probabilities.
  for (std::size_t k = 0; k < patches_.size(); ++k) {
    const PatchIndex i = patches_[k];
    upto_[k] /= flux;
    density_[i] = static_cast<float>(expected[i] / flux);
    sampled_.push_back(sampled_patch(patch_shape(mesh, i), mesh.polygon[i], occluder.frame()));
  }
  if (!patches_.empty()) upto_.back() = 1;

  // 3. Where to begin to look: as many parts as patches.
  for (std::size_t part = 0; part < patches_.size(); ++part) {
    const double begin = static_cast<double>(part) / static_cast<double>(patches_.size());
    guide_.push_back(static_cast<std::uint32_t>(std::upper_bound(upto_.begin(), upto_.end(), begin) - upto_.begin()));
  }
}

BrightPatches::Chosen BrightPatches::at(double u) const {
  std::size_t k = guide_[static_cast<std::size_t>(u * static_cast<double>(patches_.size()))];
  while (k + 1 < upto_.size() && upto_[k] <= u) ++k;
  const double before = k == 0 ? 0 : upto_[k - 1];
  const auto stretched = static_cast<float>(std::clamp((u - before) / (upto_[k] - before), 0.0, 1 - 0x1p-24));
  return {patches_[k], &sampled_[k], stretched};
}

}  // namespace patchlight
