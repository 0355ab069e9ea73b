#include "patchlight/transport/sampling_error.h"

#include "base/parallel.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

template <std::size_t n>
AuditedPairs total(const std::array<AuditedPairs, n>& kinds) {
  AuditedPairs sum;
  for (const AuditedPairs& kind : kinds) sum += kind;
  return sum;
}

// This many pairs estimate a variance to about 25 %.
bool are_enough(const AuditedPairs& audited) { return audited.pairs >= 30; }

double root_mean(const AuditedPairs& audited) {
  return audited.weight > 0 ? std::sqrt(audited.squares / audited.weight) : 0;
}

// The error of pairs with this effort by those that were audited, of each effort: where they are too few by all, if
// variances fall as one over the samples; `unknown` without any.
double pooled_error(const std::array<AuditedPairs, sampling_efforts>& by_effort, std::uint32_t effort, double unknown) {
  const AuditedPairs& with_effort = by_effort[effort_index(effort)];
  if (are_enough(with_effort)) return root_mean(with_effort);
  AuditedPairs all;
  for (std::size_t k = 0; k < sampling_efforts; ++k) {
    AuditedPairs usual = by_effort[k];
    usual.squares *= static_cast<double>(std::uint64_t{1} << k);
    all += usual;
  }
  return all.pairs > 0 ? root_mean(all) / std::sqrt(effort) : unknown;
}

}  // namespace

AuditedPairs& AuditedPairs::operator+=(const AuditedPairs& other) {
  pairs += other.pairs;
  squares += other.squares;
  weight += other.weight;
  return *this;
}

std::uint64_t SamplingError::Unanimous::pairs() const { return total(audited).pairs; }

SamplingError& SamplingError::operator+=(const SamplingError& other) {
  for (std::size_t effort = 0; effort < sampling_efforts; ++effort) {
    for (std::size_t bin = 0; bin < bins; ++bin) partial[effort][bin] += other.partial[effort][bin];
  }
  for (const auto kind : {&SamplingError::visible, &SamplingError::occluded}) {
    (this->*kind).missed += (other.*kind).missed;
    for (std::size_t effort = 0; effort < sampling_efforts; ++effort)
      (this->*kind).audited[effort] += (other.*kind).audited[effort];
    for (std::size_t step = 0; step < Unanimous::steps; ++step) {
      (this->*kind).by_share[step] += (other.*kind).by_share[step];
    }
  }
  return *this;
}

AuditedPairs with_visible_share(const SamplingError& error, std::size_t bin) {
  AuditedPairs sum;
  for (const auto& of_effort : error.partial) sum += of_effort[bin];
  return sum;
}

bool was_audited(const SamplingError& error) {
  std::uint64_t pairs = error.visible.pairs() + error.occluded.pairs();
  for (const auto& of_effort : error.partial) pairs += total(of_effort).pairs;
  return pairs > 0;
}

std::size_t effort_index(std::uint32_t effort) { return static_cast<std::size_t>(std::countr_zero(effort)); }

std::uint32_t sampling_effort(double form_factor) {
  std::uint32_t effort = 1;
  for (double largest = 1.0 / 4096; effort < most_effort && form_factor > largest; largest *= 2) effort *= 2;
  return effort;
}

double standard_error(const SamplingError& error, double visible_share, std::uint32_t effort) {
  const auto bin = static_cast<std::size_t>(
      std::clamp(visible_share * SamplingError::bins, 0.0, static_cast<double>(SamplingError::bins - 1)));
  const AuditedPairs& alike = error.partial[effort_index(effort)][bin];
  if (are_enough(alike)) return root_mean(alike);
  std::array<AuditedPairs, sampling_efforts> by_effort;
  for (std::size_t k = 0; k < sampling_efforts; ++k) by_effort[k] = total(error.partial[k]);
  return pooled_error(by_effort, effort, 1);
}

double standard_error(const SamplingError::Unanimous& unanimous, std::uint32_t effort) {
  return pooled_error(unanimous.audited, effort, 0);
}

double bound_on_miss(const SamplingError::Unanimous& unanimous) {
  const std::uint64_t pairs = unanimous.pairs();
  if (pairs < 100) return 1;
  std::uint64_t below = 0;
  std::size_t step = 0;
  while (step < SamplingError::Unanimous::steps && static_cast<double>(below) < 0.97 * static_cast<double>(pairs)) {
    below += unanimous.by_share[step++];
  }
  return static_cast<double>(step) / SamplingError::Unanimous::steps;
}

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
