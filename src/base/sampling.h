#pragma once

#include "patchlight/base/geometry.h"

#include <Eigen/Core>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A well-mixed 32-bit hash of a counter.
std::uint32_t hash(std::uint32_t value);

/// The same of several counters in order.
std::uint32_t hash(std::initializer_list<std::uint64_t> values);

/// Owen's nested uniform scrambling of the bits of a Sobol coordinate, by hashing.
/// Burley 2020, Practical Hash-based Owen Scrambling, section 3.
std::uint32_t owen_scramble(std::uint32_t coordinate, std::uint32_t seed);

/// The first `count` points (the zero point included) of a four-dimensional Sobol sequence, scrambled per dimension by
/// `seed`: coordinates in (0, 1). Any power-of-two prefix is a stratified set.
std::vector<std::array<double, 4>> scrambled_sobol(std::uint32_t count, std::uint32_t seed);

/// Which of some probabilities a number of [0, 1) falls into, and where in it.
struct Choice {
  std::size_t index = 0;
  double rest = 0;  ///< in [0, 1]
};

/// An item of a choice.
struct Alternative {
  std::size_t index = 0;
  double probability = 0;  ///< positive
  double up_to = 0;        ///< the sum of all probabilities up to this one
};

/// Chooses among some probabilities whose sum is 1. Where rounding leaves a rest after the last, it chooses the last.
/// O(log n) for n probabilities.
class Chooser {
 public:
  Chooser() = default;
  explicit Chooser(std::span<const double> probabilities);

  bool empty() const { return alternatives_.empty(); }

  /// In the order of their indices.
  std::span<const Alternative> alternatives() const { return alternatives_; }
  std::span<const Alternative> alternatives_from(std::size_t index) const;

  /// 0 for one that may not be chosen.
  double probability_of(std::size_t index) const;

  /// Not for an empty one.
  Choice at(double u) const;

 private:
  std::vector<Alternative> alternatives_;  // those with a probability above 0
};

/// Barycentric weights (b1, b2) of a uniformly distributed point p0 + b1 (p1 - p0) + b2 (p2 - p0) of a triangle.
Eigen::Vector2d square_to_triangle(double u, double v);

/// Uniformly distributed point of a planar convex quadrilateral (or of a triangle, when corners 2 and 3 coincide).
Point square_to_quad(const std::array<Point, 4>& corners, double u, double v);

/// The same for many points of one quadrilateral.
class QuadPoints {
 public:
  explicit QuadPoints(const std::array<Point, 4>& corners);
  Point at(double u, double v) const;

 private:
  Point origin_;
  std::array<Vector, 3> edges_;  // to the other corners
  double first_share_ = 1;       // of the area: that of the triangle of the first two edges
  bool has_second_ = false;
};

/// Direction of the hemisphere around +z with density cos(theta) / pi.
Vector square_to_cosine_hemisphere(double u, double v);

/// The same around another unit normal.
Vector cosine_direction(const Vector& normal, double u, double v);

/// 2^d for each of `size` doublings d; 1 for all where there are none.
inline Eigen::ArrayXd multiples(std::span<const std::uint8_t> doublings, Eigen::Index size) {
  assert(doublings.empty() || doublings.size() == static_cast<std::size_t>(size));
  Eigen::ArrayXd times = Eigen::ArrayXd::Ones(size);
  for (std::size_t i = 0; i < doublings.size(); ++i) times[static_cast<Eigen::Index>(i)] = std::exp2(doublings[i]);
  return times;
}

}  // namespace patchlight
