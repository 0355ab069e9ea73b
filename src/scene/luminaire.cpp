#include "patchlight/scene/luminaire.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace patchlight {

double spot_profile(const SpotLight& spot, double cosine) {
  assert(0 < spot.beam_half_angle && spot.beam_half_angle < spot.field_half_angle);
  // 2^-(field / beam)^p = 1 / 10
  const double exponent = std::log(std::log2(10.0)) / std::log(spot.field_half_angle / spot.beam_half_angle);
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  return std::exp2(-std::pow(angle / spot.beam_half_angle, exponent));
}

double spot_solid_angle(const SpotLight& spot) {
  // 2 pi integral of the profile over cos, by the midpoint rule in the angle: 400 steps across the beam's half angle.
  const int steps = static_cast<int>(400 * 180 / spot.beam_half_angle);
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double angle = std::numbers::pi * (k + 0.5) / steps;
    sum += spot_profile(spot, std::cos(angle)) * std::sin(angle);
  }
  return 2 * std::numbers::pi * sum * std::numbers::pi / steps;
}

}  // namespace patchlight
