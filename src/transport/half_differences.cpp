#include "patchlight/transport/half_differences.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

constexpr int largest_code = 127;
constexpr double steps_per_octave = 4;

std::size_t offset(PatchIndex i, PatchIndex j) {
  if (i > j) std::swap(i, j);
  return static_cast<std::size_t>(j) * (j - 1) / 2 + i;
}

}  // namespace

std::uint32_t sampling_effort(double form_factor) {
  std::uint32_t effort = 1;
  for (double largest = 1.0 / 4096; effort < most_effort && form_factor > largest; largest *= 2) effort *= 2;
  return effort;
}

HalfDifferences::HalfDifferences(std::span<const double> area) {
  for (const double a : area) root_of_area_.push_back(std::sqrt(a));
  const std::size_t n = area.size();
  codes_.assign(n * (n - 1) / 2, 0);
}

HalfDifferences::HalfDifferences(std::span<const double> area, std::span<const std::int8_t> codes)
    : HalfDifferences(area) {
  assert(codes.size() == codes_.size());
  codes_.assign(codes.begin(), codes.end());
}

double HalfDifferences::at(PatchIndex i, PatchIndex j) const {
  const int code = i == j ? 0 : codes_[offset(i, j)];
  if (code == 0) return 0;
  const double size = std::exp2((std::abs(code) - largest_code) / steps_per_octave);
  return std::copysign(root_of_area_[i] * root_of_area_[j] * size, code);
}

void HalfDifferences::set(PatchIndex i, PatchIndex j, double difference) {
  assert(std::isfinite(difference) && root_of_area_[i] > 0 && root_of_area_[j] > 0);
  const double octaves = std::log2(std::abs(difference) / (root_of_area_[i] * root_of_area_[j]));
  const double steps = largest_code + std::round(steps_per_octave * std::max(octaves, -1e3));
  const double code = std::copysign(std::clamp(steps, 0.0, double{largest_code}), difference);
  codes_[offset(i, j)] = static_cast<std::int8_t>(code);
}

void HalfDifferences::copy(PatchIndex i, PatchIndex j, const HalfDifferences& other, std::array<PatchIndex, 2> there) {
  const std::int8_t code = other.codes_[offset(there[0], there[1])];
  codes_[offset(i, j)] = code;
}

}  // namespace patchlight
