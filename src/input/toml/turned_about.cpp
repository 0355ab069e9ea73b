#include "input/toml/turned_about.h"

#include <array>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

// Cosine and sine of an angle in degrees, exact for quarter turns.
std::array<double, 2> cosine_and_sine(double degrees) {
  const double turn = std::remainder(degrees, 360);
  if (turn == 0) return {1, 0};
  if (turn == 90) return {0, 1};
  if (turn == -90) return {0, -1};
  if (std::abs(turn) == 180) return {-1, 0};
  const double angle = turn * std::numbers::pi / 180;
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

// R = c I + s [k]_x + (1 - c) k k^T: Rodrigues' formula.
Eigen::Matrix3d turned_about(const Vector& axis, double degrees) {
  const auto [c, s] = cosine_and_sine(degrees);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return c * Eigen::Matrix3d::Identity() + s * cross + (1 - c) * axis * axis.transpose();
}

}  // namespace patchlight
