#include "input/radiance_sources.h"

#include "patchlight/base/error.h"

#include "base/rounded.h"
#include "input/left_out.h"

#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr double most_degrees_of_a_sun = 5;

// A half sphere around the vertical, or all of it.
bool is_sky(const FarSource& source) {
  const bool is_half = source.degrees >= 179.9 && std::abs(source.direction.z()) > 0.999;
  return !source.has_pattern && (is_half || source.degrees >= 359);
}

// E = L pi sin^2(a / 2) across the direction to a disk of angle a: 6.7967e-5 sr for the sun's .533 degrees.
Sun far_sun(const FarSource& source) {
  const double radius = source.degrees * std::numbers::pi / 360;
  return {source.direction, source.radiance * std::numbers::pi * std::pow(std::sin(radius), 2)};
}

Sky with_half(Sky sky, const FarSource& source) {
  const bool is_all = source.degrees >= 359;
  if (is_all || source.direction.z() > 0) sky.zenith_radiance = source.radiance;
  if (is_all || source.direction.z() < 0) sky.ground_radiance = source.radiance;
  return sky;
}

}  // namespace

FarSource far_source(const RadiancePrimitive& primitive, const Eigen::Matrix3d& turn, const std::string& where) {
  if (primitive.numbers.size() != 4)
    throw InputError(where, "source " + primitive.name + " has " + std::to_string(primitive.numbers.size()) +
                                " numbers; expected a direction and an angle in degrees, 4");
  const Vector direction = turn * Vector(primitive.numbers[0], primitive.numbers[1], primitive.numbers[2]);
  const double degrees = primitive.numbers[3];
  if (!(direction.stableNorm() > 0) || !std::isfinite(direction.stableNorm()) || !(degrees > 0 && degrees <= 360))
    throw InputError(where, "source " + primitive.name + " has no direction, or no angle above 0 up to 360 degrees");
  return {primitive.name, direction.stableNormalized(), degrees};
}

Scene with_far_sources(Scene scene, const std::vector<FarSource>& sources) {
  LeftOut left_out;
  for (const FarSource& source : sources) {
    const std::string name = "source " + source.name;
    if (source.degrees <= most_degrees_of_a_sun && !source.has_pattern && !scene.sun) {
      scene.sun = far_sun(source);
      scene.notes.push_back(name + " of " + rounded(source.degrees) + " degrees is the sun");
    } else if (is_sky(source)) {
      scene.sky =
          with_half(scene.sky.value_or(Sky{.zenith_radiance = rgb(0, 0, 0), .ground_radiance = rgb(0, 0, 0)}), source);
    } else if (source.degrees > most_degrees_of_a_sun) {
      left_out.lose(
          "sources of light that varies, or that are no half sphere, are left out: --sky gives a sky, e.g. --sky "
          "overcast:10000lx",
          name + " of " + rounded(source.degrees) + " degrees");
    } else {
      left_out.lose("sources are left out beside a sun, or with a pattern", name);
    }
  }
  return left_out.on(std::move(scene));
}

}  // namespace patchlight
