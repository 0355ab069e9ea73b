#include "base/sampling.h"

#include <algorithm>
#include <bit>
#include <boost/random/sobol.hpp>
#include <cassert>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
  return __builtin_bswap32(x);
}

// Burley 2020, listing 3: a hash in which each bit depends on itself and lower bits only (Laine and Karras 2011).
std::uint32_t laine_karras_permutation(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cU;
  x ^= x * 0xb82f1e52U;
  x ^= x * 0xc7afe638U;
  x ^= x * 0x8d22f6e6U;
  return x;
}

constexpr std::size_t sobol_dimensions = 4;

// Sobol's direction numbers with their bits reversed: those of bit b lead from point k - 1 to point k where k has b
// trailing zeros (Antonov and Saleev 1979).
using SobolDirections = std::array<std::array<std::uint32_t, sobol_dimensions>, 32>;

SobolDirections reversed_directions() {
  SobolDirections directions{};
  for (std::size_t bit = 0; bit < directions.size(); ++bit) {
    // Point 2^b is v_b ^ v_(b - 1). Boost's engine leaves out the zero point.
    boost::random::sobol_engine<std::uint32_t, 32> engine(sobol_dimensions);
    engine.discard(sobol_dimensions * ((std::uintmax_t{1} << bit) - 1));
    for (std::size_t d = 0; d < sobol_dimensions; ++d)
      directions[bit][d] = reverse_bits(engine()) ^ (bit > 0 ? directions[bit - 1][d] : 0);
  }
  return directions;
}

// The center of the interval of width 2^-32 that starts at x 2^-32.
double to_unit_interval(std::uint32_t x) { return (x + 0.5) * 0x1p-32; }

}  // namespace

std::uint32_t hash(std::uint32_t value) {
  // Wellons 2018, lowbias32.
  value ^= value >> 16;
  value *= 0x7feb352dU;
  value ^= value >> 15;
  value *= 0x846ca68bU;
  value ^= value >> 16;
  return value;
}

std::uint32_t hash(std::initializer_list<std::uint64_t> values) {
  std::uint32_t state = 0x9e3779b9U;
  for (const std::uint64_t value : values) {
    state = hash(state ^ static_cast<std::uint32_t>(value)) + 0x9e3779b9U;
    state = hash(state ^ static_cast<std::uint32_t>(value >> 32)) + 0x9e3779b9U;
  }
  return hash(state);
}

std::uint32_t owen_scramble(std::uint32_t coordinate, std::uint32_t seed) {
  return reverse_bits(laine_karras_permutation(reverse_bits(coordinate), seed));
}

std::vector<std::array<double, 4>> scrambled_sobol(std::uint32_t count, std::uint32_t seed) {
  static const SobolDirections directions = reversed_directions();
  std::array<std::uint32_t, sobol_dimensions> seeds{};
  for (std::uint32_t d = 0; d < sobol_dimensions; ++d) seeds[d] = hash({seed, d});

  // Without the zero point a power of two of points would not be stratified.
  std::array<std::uint32_t, sobol_dimensions> reversed{};
  std::vector<std::array<double, sobol_dimensions>> points(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    for (std::size_t d = 0; d < sobol_dimensions; ++d) {
      if (k > 0) reversed[d] ^= directions[static_cast<std::size_t>(std::countr_zero(k))][d];
      points[k][d] = to_unit_interval(reverse_bits(laine_karras_permutation(reversed[d], seeds[d])));
    }
  }
  return points;
}

Eigen::Vector2d square_to_triangle(double u, double v) {
  const double root = std::sqrt(u);
  return {root * (1 - v), root * v};
}

Point square_to_quad(const std::array<Point, 4>& corners, double u, double v) { return QuadPoints(corners).at(u, v); }

QuadPoints::QuadPoints(const std::array<Point, 4>& corners)
    : origin_(corners[0]), edges_{corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]} {
  const double first_area = edges_[0].cross(edges_[1]).norm();
  const double second_area = edges_[1].cross(edges_[2]).norm();
  first_share_ = first_area / (first_area + second_area);
  has_second_ = second_area > 0;
}

// Two triangles, chosen by area; u is stretched to be used again. A triangle has no second one, not even for u = 1, to
// which single precision may round.
Point QuadPoints::at(double u, double v) const {
  const bool in_first = u < first_share_ || !has_second_;
  const double stretched = in_first ? u / first_share_ : (u - first_share_) / (1 - first_share_);
  const Eigen::Vector2d b = square_to_triangle(stretched, v);
  return in_first ? origin_ + b[0] * edges_[0] + b[1] * edges_[1] : origin_ + b[0] * edges_[1] + b[1] * edges_[2];
}

Vector square_to_cosine_hemisphere(double u, double v) {
  // Malley's method: a uniform point of the unit disc, lifted to the hemisphere.
  const double radius = std::sqrt(u);
  const double angle = 2 * std::numbers::pi * v;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - u)};
}

Vector cosine_direction(const Vector& normal, double u, double v) {
  const Vector local = square_to_cosine_hemisphere(u, v);
  const Vector across = normal.unitOrthogonal();
  return local.x() * across + local.y() * normal.cross(across) + local.z() * normal;
}

Chooser::Chooser(std::span<const double> probabilities) {
  double sum = 0;
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    if (!(probabilities[k] > 0)) continue;
    sum += probabilities[k];
    alternatives_.push_back({k, probabilities[k], sum});
  }
}

std::span<const Alternative> Chooser::alternatives_from(std::size_t index) const {
  return {std::ranges::lower_bound(alternatives_, index, {}, &Alternative::index), alternatives_.end()};
}

double Chooser::probability_of(std::size_t index) const {
  const auto from = alternatives_from(index);
  return !from.empty() && from.front().index == index ? from.front().probability : 0;
}

Choice Chooser::at(double u) const {
  assert(!empty());
  auto found = std::ranges::upper_bound(alternatives_, u, {}, &Alternative::up_to);
  if (found == alternatives_.end()) --found;
  const double before = found->up_to - found->probability;
  return {found->index, std::clamp((u - before) / found->probability, 0.0, 1.0)};
}

}  // namespace patchlight
