#include "transport/ray_transport.h"

#include "patchlight/base/large_array.h"

#include "base/parallel.h"
#include "base/target_clones.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// `width` columns, row by row without a gap, and where their irradiance is added.
struct Columns {
  const double* values;
  double* sums;
  Eigen::Index stride;
};

// Starts to read into the second cache: more can be on their way to that than to the first.
PATCHLIGHT_INLINE void fetch(const double* value) { __builtin_prefetch(value, 0, 2); }

// (F B)_i of one half for patches [begin, end), times `factor`, added to the sums. Each hit is one read from anywhere
// in the field: the rows are read by plain pointers, so that nothing else is loaded between these.
template <std::size_t width>
void add_rows(const RayRows& rows, const Columns& columns, double factor, PatchRange patches) {
  using Sum = std::array<double, width>;
  const PatchIndex* const hits = rows.hits.data();
  const double* const field = columns.values;
  for (PatchIndex i = patches.begin; i < patches.end; ++i) {
    Sum of_hits{};
    Sum of_entries{};
    const PatchIndex* const end = hits + rows.first_hit[i + 1];
    // The field is fetched farther ahead than the machine looks by itself.
    const std::uint64_t ahead = std::min<std::uint64_t>(256, rows.hits.size() - rows.first_hit[i + 1]);
    for (const PatchIndex* hit = hits + rows.first_hit[i]; hit != end; ++hit) {
      const double* const soon = field + std::size_t{hit[ahead]} * width;
      fetch(soon);
      if constexpr (width > 1) fetch(soon + width - 1);
      const double* const values = field + std::size_t{*hit} * width;
      for (std::size_t band = 0; band < width; ++band) of_hits[band] += values[band];
    }
    for (const RayEntry& entry : rows.entries_of(i)) {
      const double* const values = field + std::size_t{entry.patch} * width;
      const auto weight = static_cast<double>(entry.form_factor);
      for (std::size_t band = 0; band < width; ++band) of_entries[band] += weight * values[band];
    }
    double* const sums = columns.sums + static_cast<Eigen::Index>(i) * columns.stride;
    for (std::size_t band = 0; band < width; ++band)
      sums[band] += factor * (rows.hit_weight[i] * of_hits[band] + of_entries[band]);
  }
}

double row_sum(const RayRows& rows, PatchIndex i) {
  double of_entries = 0;
  for (const RayEntry& entry : rows.entries_of(i)) of_entries += static_cast<double>(entry.form_factor);
  return rows.hit_weight[i] * static_cast<double>(rows.hit_count(i)) + of_entries;
}

using AddRows = void (*)(const RayRows& rows, const Columns& columns, double factor, PatchRange patches);
// Up to 64 bytes, a cache line.
constexpr std::array<AddRows, 8> add_rows_of_width{add_rows<1>, add_rows<2>, add_rows<3>, add_rows<4>,
                                                   add_rows<5>, add_rows<6>, add_rows<7>, add_rows<8>};

// Some columns of a field, row by row without a gap, in large pages.
LargeArray<double> packed(const FieldView& field, Eigen::Index first, Eigen::Index width) {
  LargeArray<double> values;
  values.reserve(static_cast<std::size_t>(field.rows() * width));
  if (field.outerStride() == width) {
    values.insert(values.end(), field.data(), field.data() + field.rows() * width);
    return values;
  }
  for (Eigen::Index i = 0; i < field.rows(); ++i)
    for (Eigen::Index band = first; band < first + width; ++band) values.push_back(field(i, band));
  return values;
}

// Calls use(range) for all patches, many at once.
void for_ranges(PatchIndex size, const auto& use) {
  constexpr PatchIndex at_once = 1024;
  parallel_for((size + at_once - 1) / at_once, [&](std::size_t task) {
    const auto begin = static_cast<PatchIndex>(task * at_once);
    use(PatchRange{begin, std::min(size, begin + at_once)});
  });
}

// The sum over some halves of their F B, each times `factor`.
Field irradiance_by(std::span<const RayRows> halves, const FieldView& radiosity, double factor) {
  Field irradiance = Field::Zero(radiosity.rows(), radiosity.cols());
  const auto size = static_cast<PatchIndex>(radiosity.rows());
  const auto most = static_cast<Eigen::Index>(add_rows_of_width.size());
  for (Eigen::Index first = 0; first < radiosity.cols(); first += most) {
    const Eigen::Index width = std::min(most, radiosity.cols() - first);
    const LargeArray<double> values = packed(radiosity, first, width);
    const AddRows add = add_rows_of_width[static_cast<std::size_t>(width - 1)];
    const Columns columns{values.data(), irradiance.data() + first, irradiance.cols()};
    for (const RayRows& rows : halves)
      for_ranges(size, [&](PatchRange patches) { add(rows, columns, factor, patches); });
  }
  return irradiance;
}

}  // namespace

Field RayTransport::apply(const FieldView& radiosity) const { return irradiance_by(halves_, radiosity, 0.5); }

Field RayTransport::apply_half(std::size_t half, const FieldView& radiosity) const {
  return irradiance_by(std::span(halves_).subspan(half, 1), radiosity, 1);
}

Eigen::VectorXd RayTransport::row_sums() const {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(size());
  for (const RayRows& rows : halves_) {
    for_ranges(size(), [&](PatchRange patches) {
      for (PatchIndex i = patches.begin; i < patches.end; ++i) sums[i] += 0.5 * row_sum(rows, i);
    });
  }
  return sums;
}

namespace {

// Calls use(i, j, F_ij) for all that the rows of a half have; a pair of patches may come several times.
void for_form_factors(const RayRows& rows, const auto& use) {
  for (PatchIndex i = 0; i + 1 < rows.first_hit.size(); ++i) {
    for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k) use(i, rows.hits[k], rows.hit_weight[i]);
    for (const RayEntry& entry : rows.entries_of(i)) use(i, entry.patch, static_cast<double>(entry.form_factor));
  }
}

// Consecutive entries of one patch are added up.
RayRows adjoint_rows(const RayRows& rows, const Eigen::VectorXd& area) {
  const auto size = static_cast<std::size_t>(area.size());
  // 1. How many entries each row has, and where they begin.
  std::vector<std::uint64_t> next(size + 1, 0);
  for_form_factors(rows, [&](PatchIndex, PatchIndex j, double) { ++next[j + 1]; });
  for (std::size_t j = 0; j < size; ++j) next[j + 1] += next[j];
  const std::vector<std::uint64_t> first = next;

  // 2. The entries, in the order of i.
  LargeArray<RayEntry> entries(first.back());
  std::vector<std::uint64_t> end(first.begin(), first.end() - 1);
  for_form_factors(rows, [&](PatchIndex i, PatchIndex j, double form_factor) {
    if (!(area[j] > 0)) return;
    const auto value = static_cast<float>(area[i] * form_factor / area[j]);
    const bool is_next = end[j] == first[j] || entries[end[j] - 1].patch != i;
    if (is_next)
      entries[end[j]++] = {i, value};
    else
      entries[end[j] - 1].form_factor += value;
  });

  // 3. Without gaps.
  RayRows adjoint;
  adjoint.hit_weight.resize(size);
  adjoint.first_hit.assign(size + 1, 0);
  for (std::size_t j = 0; j < size; ++j) {
    adjoint.first_entry.push_back(adjoint.entries.size());
    for (std::uint64_t k = first[j]; k < end[j]; ++k) adjoint.entries.push_back(entries[k]);
  }
  adjoint.first_entry.push_back(adjoint.entries.size());
  return adjoint;
}

}  // namespace

RayTransport adjoint_of(const RayTransport& rays, const Eigen::VectorXd& area) {
  return RayTransport({adjoint_rows(rays.rows(0), area), adjoint_rows(rays.rows(1), area)});
}

namespace {

// Numbers for classes, in the order in which they are first met.
class NumberedClasses {
 public:
  std::uint32_t number_of(WayClass way_class) {
    std::sort(way_class.begin(), way_class.end());
    const auto [place, is_new] = numbers_.insert({way_class, static_cast<std::uint32_t>(classes_.size())});
    if (is_new) classes_.push_back(std::move(way_class));
    return place->second;
  }
  std::vector<WayClass> taken() { return std::move(classes_); }

 private:
  std::map<WayClass, std::uint32_t> numbers_;
  std::vector<WayClass> classes_;
};

SpecularMeeting meeting_of(const SpecularStop& stop, const Scene& scene) {
  return {material_on(scene.polygons[stop.polygon], stop.side()), stop.step() == RayStep::mirrored};
}

bool goes_on(RayStep step) { return step == RayStep::through || step == RayStep::mirrored || step == RayStep::crossed; }

std::vector<ClassEntry> entries_by_class(const RayRows& rows, const Scene& scene, const SurfaceOptics& faces,
                                         NumberedClasses& numbered) {
  std::vector<ClassEntry> entries;
  for (PatchIndex i = 0; i + 1 < rows.first_stop.size(); ++i) {
    WayClass way;
    tell_form_factors(rows.stops_of(i), faces, [&](const SpecularStop& stop, double form_factor) {
      if (stop.patch < SpecularStop::at_back && form_factor > 0)
        entries.push_back({i, stop.patch, numbered.number_of(way), static_cast<float>(form_factor)});
      if (goes_on(stop.step())) way.push_back(meeting_of(stop, scene));
      if (stop.step() == RayStep::ends || stop.step() == RayStep::kept) way.clear();
    });
  }
  return entries;
}

}  // namespace

std::string name_of(const WayClass& way_class, const Scene& scene) {
  std::string name;
  for (const SpecularMeeting& meeting : way_class) {
    if (!name.empty()) name += " + ";
    name += scene.materials[meeting.material].name + (meeting.is_mirrored ? " mirrored" : "");
  }
  return name.empty() ? "straight" : name;
}

RowsByClass rows_by_class(const TracedRows& rows, const Scene& scene, const SurfaceOptics& faces) {
  NumberedClasses numbered;
  RowsByClass found;
  for (std::size_t half = 0; half < 2; ++half)
    found.halves[half] = entries_by_class(rows.halves[half], scene, faces, numbered);
  found.classes = numbered.taken();
  return found;
}

}  // namespace patchlight
