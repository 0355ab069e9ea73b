#include "render/gathered_records.h"

#include "base/parallel.h"
#include "base/part_of_stage.h"
#include "base/sampling.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace patchlight {
namespace {

// Records are wanted at every so many pixels, first far from each other; where the weights around are less than enough.
constexpr int first_stride = 32;
constexpr int last_stride = 2;
constexpr double enough_weight = 0.35;

// A record serves as many pixels around it, at least and at most.
constexpr double least_pixels = 3;
constexpr double most_pixels = 64;

struct Candidate {
  PatchPoint at;
  double pixel_width = 0;
};

// Points of every so many pixels of a row.
std::vector<Candidate> seen_in_row(const PictureView& view, int width, int y, int stride) {
  std::vector<Ray> rays;
  for (int x = stride / 2; x < width; x += stride) {
    const auto ray = view.lens.ray(x + 0.5, y + 0.5);
    if (ray) rays.push_back(*ray);
  }
  std::vector<Candidate> all;
  for (const SeenPatch& seen : seen_by(view.solved.occluder, view.gather.lookup(), rays, view.spheres)) {
    if (!seen.patch || !is_plain(view.solved, *seen.patch)) continue;
    const double pixel_width = view.lens.pixel_width(seen.distance);
    all.push_back({{seen.point, *seen.patch}, pixel_width});
    if (const auto other = behind(view.solved, *seen.patch)) all.push_back({{seen.point, *other}, pixel_width});
  }
  return all;
}

// Those that the records there are do not serve.
std::vector<Candidate> not_served(std::vector<Candidate> candidates, const SolvedLight& solved,
                                  const IrradianceCache& records) {
  std::erase_if(candidates, [&](const Candidate& one) {
    return (solved.reflectance.row(one.at.patch) == 0).all() ||
           records.weight_at(one.at.point, solved.mesh.normal[one.at.patch]) >= enough_weight;
  });
  return candidates;
}

// Of several that would serve the same pixels the first.
std::vector<Candidate> apart(const std::vector<Candidate>& all, const SolvedLight& solved) {
  // Only where these would serve counts.
  const Eigen::Index bands = solved.luminous_weights.size();
  const Spectrum no_light = Spectrum::Zero(bands);
  const Field no_slope = Field::Zero(3, bands);
  IrradianceCache taken(solved.luminous_weights);
  std::vector<Candidate> some;
  for (const Candidate& one : all) {
    const Vector& normal = solved.mesh.normal[one.at.patch];
    if (taken.weight_at(one.at.point, normal) > 0) continue;
    taken.add({one.at.point, normal, least_pixels * one.pixel_width / 2, no_light, no_slope, 0});
    some.push_back(one);
  }
  return some;
}

std::vector<Candidate> candidates(const PictureView& view, const RecordOptions& options, int stride,
                                  const IrradianceCache& records) {
  const int rows = (options.height - stride / 2 + stride - 1) / stride;
  std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(std::max(0, rows)));
  parallel_for(found.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row) * stride + stride / 2;
    found[row] = not_served(seen_in_row(view, options.width, y, stride), view.solved, records);
  });
  std::vector<Candidate> all;
  for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
  return apart(all, view.solved);
}

}  // namespace

IrradianceCache gathered_records(const PictureView& view, const RecordOptions& options, const Observer& observer) {
  IrradianceCache records(view.solved.luminous_weights);
  const int strides = std::countr_zero(static_cast<unsigned>(first_stride / last_stride)) + 1;
  for (int k = 0; k < strides; ++k) {
    const int stride = first_stride >> k;
    const std::vector<Candidate> wanted = candidates(view, options, stride, records);
    std::vector<IrradianceRecord> gathered(wanted.size());
    const double part = 1.0 / strides;
    parallel_for(wanted.size(), Stage::render, part_of_stage(observer, k * part, (k + 1) * part), [&](std::size_t n) {
      const Candidate& one = wanted[n];
      gathered[n] =
          view.gather.record_at(one.at, hash({options.seed, static_cast<std::uint64_t>(stride), n}),
                                least_pixels * one.pixel_width, most_pixels * one.pixel_width, options.hemisphere);
    });
    records.add_graded(gathered);
  }
  return records;
}

}  // namespace patchlight
