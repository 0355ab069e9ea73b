#include "form_factor/monte_carlo.h"

#include "base/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr std::uint32_t most_scrambles = 256;
constexpr std::uint32_t most_entries = 1U << 22;  // of the table, so that it stays below 150 MB
constexpr std::size_t coordinates = 4;

}  // namespace

SampleTable::SampleTable(std::uint32_t samples, std::uint64_t seed)
    : samples_(samples), scrambles_(std::clamp(most_entries / samples, 16U, most_scrambles)), seed_(seed) {
  table_.resize(std::size_t{scrambles_} * coordinates * samples);
  for (std::uint32_t scramble = 0; scramble < scrambles_; ++scramble) {
    const auto points = scrambled_sobol(samples, hash({seed, scramble}));
    std::uint32_t* const rows = table_.data() + std::size_t{scramble} * coordinates * samples;
    for (std::size_t k = 0; k < samples; ++k) {
      for (std::size_t d = 0; d < coordinates; ++d)
        rows[d * samples + k] = static_cast<std::uint32_t>(points[k][d] * 0x1p32);
    }
  }
}

SampleSet SampleTable::of_pair(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t replicate) const {
  const std::uint32_t key = hash(first_key ^ hash(second_key ^ hash(static_cast<std::uint32_t>(seed_))));
  const std::uint32_t scramble = (key % scrambles_ + replicate) % scrambles_;
  SampleSet set{table_.data() + std::size_t{scramble} * coordinates * samples_, samples_, {}};
  std::uint32_t state = hash(key + replicate);
  for (std::uint32_t& shift : set.shift) shift = state = hash(state + 0x9e3779b9U);
  return set;
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
