#include "patchlight/form_factor/monte_carlo.h"

#include "patchlight/base/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr std::uint32_t most_scrambles = 256;
constexpr std::uint32_t most_entries = 1U << 22;  // of the table, so that it stays below 150 MB
constexpr std::size_t coordinates = 8;

}  // namespace

SampleTable::SampleTable(std::uint32_t samples, std::uint64_t seed)
    : samples_(samples), scrambles_(std::clamp(most_entries / samples, 16U, most_scrambles)), seed_(seed) {
  table_.resize(std::size_t{scrambles_} * coordinates * samples);
  for (std::uint32_t scramble = 0; scramble < scrambles_; ++scramble) {
    const auto points = scrambled_sobol(samples, hash({seed, scramble}));
    float* const rows = table_.data() + std::size_t{scramble} * coordinates * samples;
    for (std::size_t k = 0; k < samples; ++k) {
      const auto& [u, v, s, t] = points[k];
      const Eigen::Vector2d b = square_to_triangle(u, v);
      const Eigen::Vector2d c = square_to_triangle(s, t);
      const std::array<double, coordinates> values{u, v, s, t, b[0], b[1], c[0], c[1]};
      for (std::size_t d = 0; d < coordinates; ++d) rows[d * samples + k] = static_cast<float>(values[d]);
    }
  }
}

SampleSet SampleTable::of_pair(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t replicate) const {
  const std::uint32_t key = hash(first_key ^ hash(second_key ^ hash(static_cast<std::uint32_t>(seed_))));
  const std::uint32_t scramble = (key % scrambles_ + replicate) % scrambles_;
  const float* const rows = table_.data() + std::size_t{scramble} * coordinates * samples_;
  return {rows, rows + 4 * std::size_t{samples_}, samples_};
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
