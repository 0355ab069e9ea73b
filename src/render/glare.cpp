#include "render/glare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace patchlight {
namespace {

constexpr double radian = std::numbers::pi / 180;

// Of H metres below the line of sight and Y beside it at the distance D: 1 + 0.8 R / D, from R = 0.6 D on 1 + 1.2 R /
// D.
double index_below(double tangent) {
  constexpr double farthest = 3;  // what is farther to the side counts like this
  const double ratio = std::min(tangent, farthest);
  return 1 + (ratio < 0.6 ? 0.8 : 1.2) * ratio;
}

}  // namespace

double position_index(const Vector& direction, const Vector& forward, const Vector& upward) {
  const double ahead = std::clamp(direction.dot(forward), -1.0, 1.0);
  const Vector aside = direction - ahead * forward;
  if (!(aside.norm() > 1e-9)) return 1;
  if (direction.dot(upward) < 0)
    return index_below(ahead > 0 ? aside.norm() / ahead : std::numeric_limits<double>::infinity());
  const double sigma = std::acos(ahead) / radian;
  const double tau = std::acos(std::clamp(aside.dot(upward) / aside.norm(), -1.0, 1.0)) / radian;
  return std::exp((35.2 - 0.31889 * tau - 1.22 * std::exp(-2 * tau / 9)) * 1e-3 * sigma +
                  (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigma * sigma);
}

std::optional<double> unified_glare_rating(std::span<const GlareSource> sources, double background) {
  double sum = 0;
  for (const GlareSource& source : sources)
    sum += std::pow(source.luminance / source.position_index, 2) * source.solid_angle;
  if (!(sum > 0 && background > 0)) return std::nullopt;
  return 8 * std::log10(0.25 / background * sum);
}

}  // namespace patchlight
