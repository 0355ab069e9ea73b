#include "transport/ray_transport.h"

#include "patchlight/base/large_array.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>

namespace patchlight {
namespace {

// Rows of one task.
constexpr PatchIndex rows_of_task = 1024;

// `width` columns, row by row without a gap, and where what they irradiate is added.
struct Columns {
  const double* values;
  double* sums;
  Eigen::Index stride;
};

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
    for (const PatchIndex* hit = hits + rows.first_hit[i]; hit != end; ++hit) {
      const double* const values = field + std::size_t{*hit} * width;
      for (std::size_t band = 0; band < width; ++band) of_hits[band] += values[band];
    }
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k) {
      const double* const values = field + std::size_t{rows.entries[k].patch} * width;
      const auto weight = static_cast<double>(rows.entries[k].form_factor);
      for (std::size_t band = 0; band < width; ++band) of_entries[band] += weight * values[band];
    }
    double* const sums = columns.sums + static_cast<Eigen::Index>(i) * columns.stride;
    for (std::size_t band = 0; band < width; ++band)
      sums[band] += factor * (rows.hit_weight[i] * of_hits[band] + of_entries[band]);
  }
}

using AddRows = void (*)(const RayRows& rows, const Columns& columns, double factor, PatchRange patches);
constexpr std::array<AddRows, 4> add_rows_of_width{add_rows<1>, add_rows<2>, add_rows<3>, add_rows<4>};

void add_half(const RayRows& rows, const FieldView& radiosity, double factor, Field& irradiance) {
  const auto size = static_cast<PatchIndex>(rows.hit_weight.size());
  const auto most = static_cast<Eigen::Index>(add_rows_of_width.size());
  for (Eigen::Index first = 0; first < radiosity.cols(); first += most) {
    const Eigen::Index width = std::min(most, radiosity.cols() - first);
    LargeArray<double> packed(static_cast<std::size_t>(radiosity.rows() * width));
    Eigen::Map<Field>(packed.data(), radiosity.rows(), width) = radiosity.middleCols(first, width);
    const AddRows add = add_rows_of_width[static_cast<std::size_t>(width - 1)];
    const Columns columns{packed.data(), irradiance.data() + first, irradiance.cols()};
    parallel_for((size + rows_of_task - 1) / rows_of_task, [&](std::size_t task) {
      const auto begin = static_cast<PatchIndex>(task * rows_of_task);
      add(rows, columns, factor, {begin, std::min(size, begin + rows_of_task)});
    });
  }
}

}  // namespace

Field RayTransport::apply(const FieldView& radiosity) const {
  Field irradiance = Field::Zero(radiosity.rows(), radiosity.cols());
  for (const RayRows& rows : halves_) add_half(rows, radiosity, 0.5, irradiance);
  return irradiance;
}

Field RayTransport::apply_half(std::size_t half, const FieldView& radiosity) const {
  Field irradiance = Field::Zero(radiosity.rows(), radiosity.cols());
  add_half(halves_[half], radiosity, 1, irradiance);
  return irradiance;
}

}  // namespace patchlight
