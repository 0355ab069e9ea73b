#include "patchlight/transport/entry_errors.h"

#include "base/parallel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Codes below this one are kinds of entries without a standard error; those above are logarithms.
constexpr int first_logarithm = 3;
constexpr int last_logarithm = 255;
constexpr double steps_per_octave = 6;

std::size_t offset(PatchIndex i, PatchIndex j) {
  if (i > j) std::swap(i, j);
  return static_cast<std::size_t>(j) * (j - 1) / 2 + i;
}

}  // namespace

EntryErrors::EntryErrors(std::span<const double> area) {
  for (const double a : area) root_of_area_.push_back(std::sqrt(a));
  const std::size_t n = area.size();
  codes_.assign(n * (n - 1) / 2, static_cast<std::uint8_t>(EntryKind::exact));
}

EntryErrors::EntryErrors(std::span<const double> area, std::vector<std::uint8_t> codes) : EntryErrors(area) {
  assert(codes.size() == codes_.size());
  codes_ = std::move(codes);
}

EntryKind EntryErrors::kind(PatchIndex i, PatchIndex j) const {
  if (i == j) return EntryKind::exact;
  return static_cast<EntryKind>(std::min<int>(codes_[offset(i, j)], first_logarithm));
}

double EntryErrors::standard_error(PatchIndex i, PatchIndex j) const {
  if (kind(i, j) != EntryKind::estimated) return 0;
  return root_of_area_[i] * root_of_area_[j] * std::exp2((codes_[offset(i, j)] - last_logarithm) / steps_per_octave);
}

void EntryErrors::set(PatchIndex i, PatchIndex j, EntryKind kind, double standard_error) {
  int code = static_cast<int>(kind);
  if (kind == EntryKind::estimated) {
    const double octaves = std::log2(std::max(standard_error, 1e-300) / (root_of_area_[i] * root_of_area_[j]));
    const double steps = std::round(std::max(steps_per_octave * octaves, -300.0));
    code = std::clamp(last_logarithm + static_cast<int>(steps), first_logarithm, last_logarithm);
  }
  codes_[offset(i, j)] = static_cast<std::uint8_t>(code);
}

void EntryErrors::copy(PatchIndex i, PatchIndex j, const EntryErrors& other, std::array<PatchIndex, 2> there) {
  codes_[offset(i, j)] = other.codes_[offset(there[0], there[1])];
}

EntryErrors with_sampling_error(EntryErrors unoccluded, const ExchangeAreas& S, const SamplingError& error,
                                std::span<const double> area) {
  EntryErrors errors = std::move(unoccluded);
  parallel_for(errors.size(), [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    for (PatchIndex i = 0; i < j; ++i) {
      if (errors.kind(i, j) != EntryKind::estimated) continue;
      const double U = errors.standard_error(i, j);
      const double visible_share = static_cast<double>(S.at(i, j)) / U;
      const std::uint32_t effort = sampling_effort(U / std::min(area[i], area[j]));
      errors.set(i, j, EntryKind::estimated, U * standard_error(error, visible_share, effort));
    }
  });
  return errors;
}

}  // namespace patchlight
