#include "transport/bright_patches.h"

#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <limits>

namespace patchlight {
namespace {

// Rays towards bright patches, half as many as over the hemisphere, cost three quarters of these: 37 against 48 CPU s
// in the room with spheres of scripts/make_large_rooms.py. So many more rays over the hemisphere divide the variance by
// this.
constexpr double least_gain = 1.75;

// Rays of 32 neighbours, 64 each, have to meet bright patches some 16 times, so that halves tell how much these
// scatter.
constexpr double least_share_by_chance = 1.0 / 128;

// The variance of radiosity over the area, of those values that are not above a limit; the others are 0.
double variance_up_to(const Eigen::VectorXd& radiosity, const Eigen::Map<const Eigen::VectorXd>& area, double limit) {
  const Eigen::ArrayXd kept = (radiosity.array() > limit).select(0, radiosity.array());
  const double mean = (area.array() * kept).sum() / area.sum();
  return (area.array() * (kept - mean).square()).sum() / area.sum();
}

// The share of the area that is brighter.
double share_above(const Eigen::VectorXd& radiosity, const Eigen::Map<const Eigen::VectorXd>& area, double limit) {
  return (radiosity.array() > limit).select(area.array(), 0).sum() / area.sum();
}

}  // namespace

BrightPatches::BrightPatches(const PatchMesh& mesh, const Eigen::VectorXd& expected, double threshold,
                             const Occluder& occluder)
    : density_(mesh.size(), 0) {
  // 1. Those above the threshold, if rays towards them are worth it.
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), static_cast<Eigen::Index>(mesh.size()));
  const double least = threshold * expected.dot(area) / area.sum();
  const double all = variance_up_to(expected, area, std::numeric_limits<double>::infinity());
  const bool meets_by_chance = share_above(expected, area, least) >= least_share_by_chance;
  if (meets_by_chance && all < least_gain * variance_up_to(expected, area, least)) return;
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
