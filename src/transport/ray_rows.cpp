#include "transport/ray_rows.h"

#include "base/parallel.h"
#include "transport/row_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// Patches of one task.
constexpr PatchIndex patches_at_once = 64;

// The rows of one half with room for every ray, before they are put together and scaled.
struct RawHalf {
  LargeArray<PatchIndex> hits;           // of patch i from room[i] on
  std::vector<std::uint32_t> hit_count;  // per patch
  std::vector<std::uint32_t> entry_count;
};

struct RawRows {
  std::vector<std::uint64_t> room;  // per patch; one more
  std::array<RawHalf, 2> halves;
  std::vector<RowEntries> tasks;
  LostShare lost;
  std::vector<std::uint8_t> sees_backs;  // per patch
  std::vector<float> distance;
};

RawRows room_for(const std::vector<std::uint32_t>& counts) {
  const std::size_t size = counts.size();
  RawRows raw;
  raw.room.assign(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i) raw.room[i + 1] = raw.room[i] + counts[i];
  for (RawHalf& half : raw.halves) {
    half.hits.resize(raw.room.back());
    half.hit_count.resize(size);
    half.entry_count.resize(size);
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
  raw.lost = {zero, zero, zero, 0, zero, {}, zero};
  raw.sees_backs.resize(size);
  raw.distance.resize(size);
  raw.tasks.resize((size + patches_at_once - 1) / patches_at_once);
  return raw;
}

// All rays. Lost shares are those of the patches that see no backs.
RawRows traced(const RowTracer& tracer, const Observer& observer) {
  RawRows raw = room_for(tracer.counts());
  parallel_for(raw.tasks.size(), Stage::form_factors, observer, [&](std::size_t t) {
    RowEntries& task = raw.tasks[t];
    const std::size_t end = std::min((t + 1) * patches_at_once, tracer.counts().size());
    for (std::size_t i = t * patches_at_once; i < end; ++i) {
      const std::array<std::size_t, 2> before{task.halves[0].size(), task.halves[1].size()};
      const PatchRays told = tracer.trace(static_cast<PatchIndex>(i), task);
      for (std::size_t half = 0; half < 2; ++half) {
        RawHalf& rows = raw.halves[half];
        std::copy(told.hits[half].begin(), told.hits[half].end(),
                  rows.hits.begin() + static_cast<std::ptrdiff_t>(raw.room[i]));
        rows.hit_count[i] = static_cast<std::uint32_t>(told.hits[half].size());
        rows.entry_count[i] = static_cast<std::uint32_t>(task.halves[half].size() - before[half]);
      }
      const double rays = 2.0 * tracer.counts()[i];
      raw.lost.escaped[static_cast<Eigen::Index>(i)] = told.escaped / rays;
      raw.sees_backs[i] = told.unseen > 0 ? 1 : 0;
      raw.distance[i] = static_cast<float>(told.inverse_lengths > 0 ? rays / told.inverse_lengths : 0);
    }
  });
  return raw;
}

// Row by row without gaps; raw entries are let go.
RayRows put_together(RawRows& raw, std::size_t half, const std::vector<std::uint32_t>& counts) {
  RawHalf& from = raw.halves[half];
  const std::size_t size = counts.size();
  RayRows rows;
  rows.first_hit.assign(size + 1, 0);
  rows.first_entry.assign(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i) {
    rows.first_hit[i + 1] = rows.first_hit[i] + from.hit_count[i];
    rows.first_entry[i + 1] = rows.first_entry[i] + from.entry_count[i];
    const auto begin = from.hits.begin() + static_cast<std::ptrdiff_t>(raw.room[i]);
    std::copy(begin, begin + from.hit_count[i], from.hits.begin() + static_cast<std::ptrdiff_t>(rows.first_hit[i]));
    rows.hit_weight.push_back(1.0 / counts[i]);
  }
  from.hits.resize(rows.first_hit.back());
  rows.hits = std::move(from.hits);
  rows.entries.reserve(rows.first_entry.back());
  for (RowEntries& task : raw.tasks) {
    rows.entries.insert(rows.entries.end(), task.halves[half].begin(), task.halves[half].end());
    task.halves[half] = {};
  }
  return rows;
}

// Each row as a whole times what makes its sum that of `wanted`. Where there are hits their weight, in double
// precision, takes what entries lose by rounding.
void scale(RayRows& rows, const Eigen::VectorXd& wanted) {
  parallel_for(rows.hit_weight.size(), [&](std::size_t i) {
    const auto hits = static_cast<double>(rows.first_hit[i + 1] - rows.first_hit[i]);
    double sum = 0;
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
      sum += static_cast<double>(rows.entries[k].form_factor);
    const double all = sum + hits * rows.hit_weight[i];
    if (!(all > 0)) return;
    const double factor = wanted[static_cast<Eigen::Index>(i)] / all;
    double stored = 0;
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k) {
      float& entry = rows.entries[k].form_factor;
      entry = static_cast<float>(factor * static_cast<double>(entry));
      stored += static_cast<double>(entry);
    }
    rows.hit_weight[i] = hits > 0 ? (wanted[static_cast<Eigen::Index>(i)] - stored) / hits : 0;
  });
}

struct MeasureBy {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const RayOptions& options;
  const Observer& observer;
};

// Those of patches that see backs are measured with groups of rays, the others are known.
LostShare with_backs(LostShare lost, const std::vector<std::uint8_t>& sees_backs, const MeasureBy& by) {
  std::vector<PatchIndex> place(sees_backs.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = sees_backs[i] != 0 ? no_patch : static_cast<PatchIndex>(i);
  lost.rays_per_patch = by.options.lost_share_rays;
  return measure_lost_share(by.mesh, by.occluder, KnownShares{lost, place}, by.options.seed, by.observer);
}

}  // namespace

TracedRows trace_rows(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright,
                      const RayOptions& options, const Observer& observer) {
  const RowTracer tracer(mesh, occluder, bright, options);
  RawRows raw = traced(tracer, observer);
  TracedRows rows;
  rows.lost = with_backs(std::move(raw.lost), raw.sees_backs, {mesh, occluder, options, observer});
  rows.area = exposed_area(mesh, rows.lost, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size())));
  rows.distance = std::move(raw.distance);
  rows.rays = 2 * raw.room.back();
  for (PatchIndex i = 0; i < mesh.size(); ++i) rows.directed.push_back(bright.density(i) > 0 ? 1 : 0);
  for (const RowEntries& task : raw.tasks) rows.shadow_rays += task.shadow_rays;
  const Eigen::VectorXd wanted = expected_row_sum(rows.lost);
  for (std::size_t half = 0; half < 2; ++half) {
    rows.halves[half] = put_together(raw, half, tracer.counts());
    scale(rows.halves[half], wanted);
  }
  return rows;
}

}  // namespace patchlight
