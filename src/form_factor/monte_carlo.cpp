#include "patchlight/form_factor/monte_carlo.h"

#include "patchlight/base/sampling.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr std::uint32_t scrambles = 256;

}  // namespace

SamplePairs::SamplePairs(std::uint32_t samples, std::uint64_t seed) : samples_(samples), seed_(seed) {
  table_.reserve(static_cast<std::size_t>(scrambles) * samples);
  for (std::uint32_t k = 0; k < scrambles; ++k) {
    const auto points = scrambled_sobol(samples, hash({seed, k}));
    table_.insert(table_.end(), points.begin(), points.end());
  }
}

const std::array<double, 4>& SamplePairs::at(std::uint32_t first_key, std::uint32_t second_key,
                                             std::uint32_t sample) const {
  assert(sample < samples_);
  const std::uint32_t scramble =
      hash(first_key ^ hash(second_key ^ hash(static_cast<std::uint32_t>(seed_)))) % scrambles;
  return table_[static_cast<std::size_t>(scramble) * samples_ + sample];
}

double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y) {
  // G = (n_x . d)(-n_y . d) / (pi |d|^4), d = y - x
  const Vector d = y - x;
  const double cosine_x = normal_x.dot(d);
  const double cosine_y = -normal_y.dot(d);
  const double squared = d.squaredNorm();
  if (!(cosine_x > 0 && cosine_y > 0)) return 0;
  return cosine_x * cosine_y / (std::numbers::pi * squared * squared);
}

}  // namespace patchlight
