#include "transport/ray_rows.h"

#include "base/parallel.h"
#include "transport/row_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// With which probability a ray was mirrored; where no ray is now, nothing goes on whatever it was.
double mirrored_rays(const SurfaceOptics& faces, const SpecularStop& stop) {
  const SpecularSurface* const face = faces.at(stop.polygon);
  return face ? face->mirrored_rays(stop.side(), stop.cosine()) : 1;
}

// The share of light left after a stop, over the probability that the ray went this way.
double onward_share(const SpecularShares& shares, const SurfaceOptics& faces, const SpecularStop& stop) {
  if (stop.step() == RayStep::crossed) return shares.transmitted;
  if (stop.step() == RayStep::sent) return shares.nonspecular_profile;
  const bool is_mirrored = stop.step() == RayStep::mirrored;
  const double share = is_mirrored ? shares.mirrored : shares.transmitted;
  if (share == 0) return 0;
  const double p = mirrored_rays(faces, stop);
  return share / (is_mirrored ? p : 1 - p);
}

// Patches of one task.
constexpr PatchIndex patches_at_once = 64;

// The rows of one half with room for every ray, before they are put together and scaled.
struct RawHalf {
  LargeArray<PatchIndex> hits;           // of patch i from room[i] on
  std::vector<std::uint32_t> hit_count;  // per patch
  std::vector<std::uint32_t> entry_count;
  std::vector<std::uint32_t> stop_count;  // empty where nothing is specular
};

struct RawRows {
  std::vector<std::uint64_t> room;  // per patch; one more
  std::array<RawHalf, 2> halves;
  std::vector<RowEntries> tasks;
  std::vector<std::uint32_t> escaped;     // per patch: rays
  std::vector<std::uint32_t> sees_backs;  // per patch: 0 or 1
  std::vector<float> distance;
  PolygonIndex polygons = 0;  // of the scene
};

RawRows room_for(const std::vector<std::uint32_t>& counts, bool is_specular, PolygonIndex polygons) {
  const std::size_t size = counts.size();
  RawRows raw;
  raw.polygons = polygons;
  raw.room.assign(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i) raw.room[i + 1] = raw.room[i] + counts[i];
  for (RawHalf& half : raw.halves) {
    half.hits.resize(raw.room.back());
    half.hit_count.resize(size);
    half.entry_count.resize(size);
    if (is_specular) half.stop_count.resize(size);
  }
  raw.escaped.resize(size);
  raw.sees_backs.resize(size);
  raw.distance.resize(size);
  raw.tasks.resize((size + patches_at_once - 1) / patches_at_once);
  return raw;
}

void trace_task(const RowTracer& tracer, std::size_t t, RawRows& raw) {
  RowEntries& task = raw.tasks[t];
  const std::size_t end = std::min((t + 1) * patches_at_once, tracer.counts().size());
  for (std::size_t i = t * patches_at_once; i < end; ++i) {
    const std::array<std::size_t, 2> before{task.halves[0].size(), task.halves[1].size()};
    const std::array<std::size_t, 2> stops_before{task.stops[0].size(), task.stops[1].size()};
    const PatchRays told = tracer.trace(static_cast<PatchIndex>(i), task);
    for (std::size_t half = 0; half < 2; ++half) {
      RawHalf& rows = raw.halves[half];
      std::copy(told.hits[half].begin(), told.hits[half].end(),
                rows.hits.begin() + static_cast<std::ptrdiff_t>(raw.room[i]));
      rows.hit_count[i] = static_cast<std::uint32_t>(told.hits[half].size());
      rows.entry_count[i] = static_cast<std::uint32_t>(task.halves[half].size() - before[half]);
      if (tracer.is_specular())
        rows.stop_count[i] = static_cast<std::uint32_t>(task.stops[half].size() - stops_before[half]);
    }
    const double rays = 2.0 * tracer.counts()[i];
    raw.escaped[i] = static_cast<std::uint32_t>(told.escaped);
    raw.sees_backs[i] = told.unseen > 0 ? 1 : 0;
    raw.distance[i] = static_cast<float>(told.inverse_lengths > 0 ? rays / told.inverse_lengths : 0);
  }
}

// Tasks of one block.
constexpr std::size_t tasks_of_a_block = RowBlocks::patches_of_a_block / patches_at_once;

struct PatchSpan {
  std::size_t begin, end;
};

// A form factor of one ray, with room for rounding. False for numbers that are not finite.
bool is_form_factor(float value) { return value >= 0 && value <= 1.001F; }

// The stops of a block in one half, likewise.
template <class Show>
bool show_stops(RawHalf& rows, std::vector<SpecularStop>& stops, const PatchSpan& patches, PolygonIndex polygons,
                const Show& show) {
  std::size_t count = 0;
  for (std::size_t i = patches.begin; i < patches.end; ++i) {
    show(rows.stop_count[i]);
    count += rows.stop_count[i];
  }
  if (!show.has_room_for(4 * count)) return false;
  stops.resize(count);
  for (SpecularStop& stop : stops) {
    show(stop.patch), show(stop.form_factor), show(stop.polygon), show(stop.bits);
    const bool is_patch = stop.patch < rows.stop_count.size() || stop.patch >= SpecularStop::at_back;
    const bool has_polygon = stop.step() == RayStep::ends || stop.polygon < polygons;
    if (!is_patch || !has_polygon || static_cast<std::uint32_t>(stop.step()) >= ray_steps) return false;
    if (!is_form_factor(stop.form_factor)) return false;
  }
  // Rays end in their own row.
  auto row_end = stops.begin();
  for (std::size_t i = patches.begin; i < patches.end; ++i) {
    row_end += rows.stop_count[i];
    if (rows.stop_count[i] == 0) continue;
    const RayStep last = (row_end - 1)->step();
    if (last != RayStep::ends && last != RayStep::kept) return false;
  }
  return true;
}

// Shows all numbers that are known of a block, of 32 bits each, its entries all in its first task. Returns false when
// show() has put a number there that cannot be.
template <class Show>
bool show_block(RawRows& raw, std::size_t block, const Show& show) {
  const std::size_t patches = raw.escaped.size();
  const std::size_t begin = block * RowBlocks::patches_of_a_block;
  const std::size_t end = std::min(begin + RowBlocks::patches_of_a_block, patches);
  RowEntries& first = raw.tasks[block * tasks_of_a_block];
  for (std::size_t i = begin; i < end; ++i) {
    show(raw.escaped[i]), show(raw.sees_backs[i]), show(raw.distance[i]);
    const bool can_be = raw.escaped[i] <= 2 * (raw.room[i + 1] - raw.room[i]) && raw.sees_backs[i] <= 1 &&
                        raw.distance[i] >= 0 && std::isfinite(raw.distance[i]);
    if (!can_be) return false;
  }
  show(first.shadow_rays);
  for (std::size_t half = 0; half < 2; ++half) {
    RawHalf& rows = raw.halves[half];
    std::size_t entries = 0;
    for (std::size_t i = begin; i < end; ++i) {
      show(rows.hit_count[i]), show(rows.entry_count[i]);
      if (rows.hit_count[i] > raw.room[i + 1] - raw.room[i]) return false;
      entries += rows.entry_count[i];
      for (std::size_t k = raw.room[i]; k < raw.room[i] + rows.hit_count[i]; ++k) {
        show(rows.hits[k]);
        if (rows.hits[k] >= patches) return false;
      }
    }
    if (!show.has_room_for(2 * entries)) return false;
    first.halves[half].resize(entries);
    for (RayEntry& entry : first.halves[half]) {
      show(entry.patch), show(entry.form_factor);
      if (entry.patch >= patches || !is_form_factor(entry.form_factor)) return false;
    }
    if (!rows.stop_count.empty() && !show_stops(rows, first.stops[half], {begin, end}, raw.polygons, show))
      return false;
  }
  return true;
}

struct Writer {
  std::vector<std::int32_t>& words;

  template <class Number>
  void operator()(const Number& number) const {
    static_assert(sizeof(Number) == sizeof(std::int32_t));
    words.push_back(std::bit_cast<std::int32_t>(number));
  }
  bool has_room_for(std::size_t) const { return true; }
};

// Gives 0 after the end.
struct Reader {
  const std::vector<std::int32_t>& words;
  std::size_t& at;

  template <class Number>
  void operator()(Number& number) const {
    number = at < words.size() ? std::bit_cast<Number>(words[at]) : Number{0};
    ++at;
  }
  bool has_room_for(std::size_t numbers) const { return at + numbers <= words.size(); }
};

// Moves all values to the end of others.
void append(auto& into, auto& values) {
  into.insert(into.end(), values.begin(), values.end());
  values = {};
}

// Moves the entries of a block into its first task.
void gather_entries(RawRows& raw, std::size_t block) {
  const std::size_t first = block * tasks_of_a_block;
  RowEntries& into = raw.tasks[first];
  for (std::size_t t = first + 1; t < std::min(first + tasks_of_a_block, raw.tasks.size()); ++t) {
    for (std::size_t half = 0; half < 2; ++half) {
      append(into.halves[half], raw.tasks[t].halves[half]);
      append(into.stops[half], raw.tasks[t].stops[half]);
    }
    into.shadow_rays += std::exchange(raw.tasks[t].shadow_rays, 0);
  }
}

// Per block 1 when it was kept, and is there now.
std::vector<std::uint8_t> taken_blocks(RawRows& raw, const RowBlocks* blocks) {
  std::vector<std::uint8_t> taken((raw.tasks.size() + tasks_of_a_block - 1) / tasks_of_a_block, 0);
  if (blocks == nullptr) return taken;
  for (std::size_t block = 0; block < taken.size(); ++block) {
    const auto words = blocks->read(block);
    if (!words) continue;
    std::size_t at = 0;
    taken[block] = show_block(raw, block, Reader{*words, at}) && at == words->size() ? 1 : 0;
    if (taken[block] == 0) raw.tasks[block * tasks_of_a_block] = {};
  }
  return taken;
}

// All rays.
RawRows traced(const RowTracer& tracer, const RowBlocks* blocks, const Observer& observer) {
  RawRows raw = room_for(tracer.counts(), tracer.is_specular(), tracer.polygons());
  const std::vector<std::uint8_t> taken = taken_blocks(raw, blocks);
  std::vector<std::atomic<std::size_t>> done(taken.size());
  parallel_for(raw.tasks.size(), Stage::form_factors, observer, [&](std::size_t t) {
    const std::size_t block = t / tasks_of_a_block;
    if (taken[block] != 0) return;
    trace_task(tracer, t, raw);
    if (blocks == nullptr) return;
    const std::size_t tasks = std::min(tasks_of_a_block, raw.tasks.size() - block * tasks_of_a_block);
    if (++done[block] < tasks) return;
    gather_entries(raw, block);
    std::vector<std::int32_t> words;
    show_block(raw, block, Writer{words});
    blocks->keep(block, words);
  });
  return raw;
}

// The shares of the rays of each patch that escape; backs are not among them.
LostShare escaped_shares(const RawRows& raw, const std::vector<std::uint32_t>& counts) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(counts.size()));
  LostShare lost{zero, zero, zero, 0, zero, {}, zero};
  for (std::size_t i = 0; i < counts.size(); ++i)
    lost.escaped[static_cast<Eigen::Index>(i)] = raw.escaped[i] / (2.0 * counts[i]);
  return lost;
}

void put_stops_together(RawRows& raw, std::size_t half, RayRows& rows) {
  rows.first_stop.push_back(0);
  for (const std::uint32_t count : raw.halves[half].stop_count)
    rows.first_stop.push_back(rows.first_stop.back() + count);
  rows.stops.reserve(rows.first_stop.back());
  for (RowEntries& task : raw.tasks) append(rows.stops, task.stops[half]);
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
  for (RowEntries& task : raw.tasks) append(rows.entries, task.halves[half]);
  if (!from.stop_count.empty()) put_stops_together(raw, half, rows);
  return rows;
}

struct MeasureBy {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const RayOptions& options;
  const Observer& observer;
};

// All rays of clear patches have stops; the light that these let through has their color.
LostShare without_clear(LostShare lost, const PatchMesh& mesh, const Occluder& occluder) {
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const SpecularSurface* const face = occluder.optics().at(mesh.polygon[i]);
    if (face && face->is_clear()) lost.escaped[i] = lost.at_backs[i] = 0;
  }
  lost.clear = {};
  return lost;
}

// Those of patches that see backs are measured with groups of rays, the others are known.
LostShare with_backs(LostShare lost, const std::vector<std::uint32_t>& sees_backs, const MeasureBy& by) {
  std::vector<PatchIndex> place(sees_backs.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = sees_backs[i] != 0 ? no_patch : static_cast<PatchIndex>(i);
  lost.rays_per_patch = by.options.lost_share_rays;
  const bool is_specular = !by.occluder.optics().empty();
  return measure_lost_share(by.mesh, by.occluder, KnownShares{lost, place, is_specular, true, by.options.doublings},
                            by.options.seed, by.observer);
}

}  // namespace

void SpecularStop::set(RayStep step, Side on, double of_angle) {
  const double steps = std::clamp(of_angle * 0x1p28, 0.0, 0x1p28 - 1);
  bits =
      static_cast<std::uint32_t>(step) | static_cast<std::uint32_t>(on) << 3U | static_cast<std::uint32_t>(steps) << 4U;
}

void tell_form_factors(std::span<const SpecularStop> stops, const SurfaceOptics& faces,
                       const std::function<void(const SpecularStop& stop, double form_factor)>& tell) {
  double left = 1;
  for (const SpecularStop& stop : stops) {
    const auto counted = static_cast<double>(stop.form_factor);
    if (stop.step() == RayStep::ends) {
      tell(stop, left * counted);
      left = 1;
      continue;
    }
    const SpecularShares shares = faces.shares(stop.polygon, stop.side(), stop.cosine());
    const bool goes_on = stop.step() != RayStep::kept;
    tell(stop, left * shares.nonspecular * counted);
    left = goes_on ? left * onward_share(shares, faces, stop) : 1;
  }
}

TracedRows trace_rows(const PatchMesh& mesh, const Occluder& occluder, const BrightPatches& bright,
                      const RayOptions& options, const Observer& observer, const RowBlocks* blocks) {
  const RowTracer tracer(mesh, occluder, bright, options);
  RawRows raw = traced(tracer, blocks, observer);
  TracedRows rows;
  rows.lost = with_backs(escaped_shares(raw, tracer.counts()), raw.sees_backs, {mesh, occluder, options, observer});
  if (tracer.is_specular()) rows.lost = without_clear(std::move(rows.lost), mesh, occluder);
  rows.area = exposed_area(mesh, rows.lost, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size())));
  rows.distance = std::move(raw.distance);
  rows.rays = 2 * raw.room.back();
  for (PatchIndex i = 0; i < mesh.size(); ++i) rows.directed.push_back(bright.density(i) > 0 ? 1 : 0);
  for (const RowEntries& task : raw.tasks) rows.shadow_rays += task.shadow_rays;
  const Eigen::VectorXd wanted = expected_row_sum(rows.lost);
  for (std::size_t half = 0; half < 2; ++half) {
    rows.halves[half] = put_together(raw, half, tracer.counts());
    if (!tracer.is_specular()) scale(rows.halves[half], wanted);
  }
  return rows;
}

namespace {

// One row for one color, by rays that are specular on their way.
struct WeighedRow {
  std::vector<RayEntry> entries;
  double open = 0;      // form factors to the open
  double at_backs = 0;  // and to sides without patches
};

WeighedRow weighed_row(const RayRows& rows, std::size_t i, const SurfaceOptics& faces) {
  WeighedRow row;
  tell_form_factors(rows.stops_of(i), faces, [&row](const SpecularStop& stop, double form_factor) {
    if (stop.patch == SpecularStop::in_the_open) {
      row.open += form_factor;
    } else if (stop.patch == SpecularStop::at_back) {
      row.at_backs += form_factor;
    } else if (form_factor > 0) {
      row.entries.push_back({stop.patch, static_cast<float>(form_factor)});
    }
  });
  return row;
}

// The entries of plain rays, and after them those of the others, row by row; the stops are let go.
RayRows with_entries(RayRows rows, const std::vector<WeighedRow>& weighed) {
  LargeArray<RayEntry> all;
  std::size_t count = rows.entries.size();
  for (const WeighedRow& row : weighed) count += row.entries.size();
  all.reserve(count);
  std::vector<std::uint64_t> first{0};
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    const std::span<const RayEntry> plain = rows.entries_of(i);
    all.insert(all.end(), plain.begin(), plain.end());
    all.insert(all.end(), weighed[i].entries.begin(), weighed[i].entries.end());
    first.push_back(all.size());
  }
  rows.entries = std::move(all);
  rows.first_entry = std::move(first);
  rows.first_stop = {};
  rows.stops = {};
  return rows;
}

// The shares of both halves, of the exposed part. From the covered part rays see nothing but sides without patches; all
// rays of a clear patch have stops, these too.
void add_lost(LostShare& lost, Eigen::Index i, const std::array<std::vector<WeighedRow>, 2>& halves, bool is_clear) {
  const double exposed = 1 - lost.covered[i];
  if (!(exposed > 0)) return;
  const auto row = static_cast<std::size_t>(i);
  const double open = 0.5 * (halves[0][row].open + halves[1][row].open);
  const double at_backs = 0.5 * (halves[0][row].at_backs + halves[1][row].at_backs);
  const double in_cover = is_clear ? lost.covered[i] : 0;
  lost.escaped[i] = std::min(1.0, lost.escaped[i] + open / exposed);
  lost.at_backs[i] = std::min(1 - lost.escaped[i], lost.at_backs[i] + std::max(0.0, at_backs - in_cover) / exposed);
}

}  // namespace

// Where there are hits their weight, in double precision, takes the loss of entries by rounding.
void scale(RayRows& rows, const Eigen::VectorXd& wanted) {
  parallel_for(rows.hit_weight.size(), [&](std::size_t i) {
    const auto hits = static_cast<double>(rows.hit_count(i));
    double sum = 0;
    for (const RayEntry& entry : rows.entries_of(i)) sum += static_cast<double>(entry.form_factor);
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

TracedRows weighed_rows(TracedRows rows, const PatchMesh& mesh, const Occluder& occluder) {
  if (rows.halves[0].first_stop.empty()) return rows;
  const SurfaceOptics& faces = occluder.optics();
  std::array<std::vector<WeighedRow>, 2> weighed;
  for (std::size_t half = 0; half < 2; ++half) {
    weighed[half].resize(mesh.size());
    parallel_for(mesh.size(), [&](std::size_t i) { weighed[half][i] = weighed_row(rows.halves[half], i, faces); });
    rows.halves[half] = with_entries(std::move(rows.halves[half]), weighed[half]);
  }
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const SpecularSurface* const face = faces.at(mesh.polygon[i]);
    add_lost(rows.lost, i, weighed, face && face->is_clear());
  }
  rows.lost.clear = clear_shares(mesh, occluder);
  rows.area = exposed_area(mesh, rows.lost, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size())));
  const Eigen::VectorXd wanted = expected_row_sum(rows.lost);
  for (RayRows& half : rows.halves) scale(half, wanted);
  return rows;
}

}  // namespace patchlight
