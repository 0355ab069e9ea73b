#include "render/lens.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/scene.h"

#include "base/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

namespace patchlight {
namespace {

constexpr std::uint32_t log2_points = 12;
constexpr std::uint32_t point_count = 1U << log2_points;
constexpr std::uint32_t seed_of_points = 0x70697873;

// A scrambled sequence that is scrambled anew is a scrambled sequence.
const std::vector<std::array<std::uint32_t, 4>>& base_points() {
  static const auto all = [] {
    std::vector<std::array<std::uint32_t, 4>> bits(point_count);
    const auto sequence = scrambled_sobol(point_count, seed_of_points);
    for (std::uint32_t k = 0; k < point_count; ++k) {
      for (std::size_t d = 0; d < 4; ++d) bits[k][d] = static_cast<std::uint32_t>(sequence[k][d] * 0x1p32);
    }
    return bits;
  }();
  return all;
}

template <std::size_t count>
std::array<double, count> coordinates(std::uint32_t index, std::uint32_t seed) {
  constexpr std::uint32_t unused = 32 - log2_points;
  const std::uint32_t place = owen_scramble((index % point_count) << unused, hash(seed)) >> unused;
  const std::array<std::uint32_t, 4>& bits = base_points()[place];
  std::array<double, count> sample{};
  for (std::uint32_t d = 0; d < count; ++d)
    sample[d] = (owen_scramble(bits[d], hash(seed + 0x9e3779b9U * (d + 1))) + 0.5) * 0x1p-32;
  return sample;
}

}  // namespace

std::array<double, 4> pixel_sample(std::uint32_t index, std::uint32_t seed) { return coordinates<4>(index, seed); }

std::array<double, 2> pixel_sample_2d(std::uint32_t index, std::uint32_t seed) { return coordinates<2>(index, seed); }

double tent(double u) { return u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u); }

namespace {

void require_view(const Camera& camera) {
  const std::string projection = name_of(camera.projection);
  if (!has_extent(camera) && camera.projection == Projection::orthographic)
    throw InputError("camera", "an orthographic picture of height " + std::to_string(camera.height) +
                                   " m; expected a height above 0");
  if (!has_extent(camera)) {
    throw InputError("camera", "the field of view is " + std::to_string(camera.vertical_field_of_view) +
                                   " degrees; expected more than 0 and, for the projection " + projection +
                                   (camera.projection == Projection::perspective ? ", less than " : ", at most ") +
                                   std::to_string(std::lround(largest_field_of_view(camera.projection))));
  }
  const Vector sight = camera.target - camera.eye;
  if (!(sight.norm() > 0) || !sight.allFinite())
    throw InputError("camera", "there is no direction from eye to target; expected two different points");
}

// What a pixel is wide: in the plane at distance 1, in the unit disc, radians, or metres.
double pixel_scale(const Camera& camera, int height) {
  const double half_angle = camera.vertical_field_of_view * std::numbers::pi / 360;
  switch (camera.projection) {
    case Projection::perspective:
      return 2 * std::tan(half_angle) / height;
    case Projection::orthographic:
      return camera.height / height;
    case Projection::hemispherical:
      return 2 * std::sin(half_angle) / height;
    case Projection::angular:
    case Projection::panorama:
      break;
  }
  return 2 * half_angle / height;
}

}  // namespace

Vector picture_up(const Camera& camera, const Vector& up, const Vector& north) {
  const Vector sight = (camera.target - camera.eye).normalized();
  return sight.cross(up).norm() > 1e-9 ? up : north;
}

Lens::Lens(const Camera& camera, const Vector& up, int width, int height)
    : projection_(camera.projection),
      width_(width),
      height_(height),
      eye_(camera.eye),
      scale_(pixel_scale(camera, height)),
      half_angle_(camera.vertical_field_of_view * std::numbers::pi / 360) {
  require_view(camera);
  forward_ = (camera.target - camera.eye).normalized();
  // Where the camera looks along `up`, any direction may be upward in the picture.
  right_ = forward_.cross(up.normalized());
  if (!(right_.norm() > 1e-9)) right_ = forward_.unitOrthogonal();
  right_.normalize();
  up_ = right_.cross(forward_);
}

double Lens::pixel_width(double distance) const {
  return projection_ == Projection::orthographic ? scale_ : scale_ * distance;
}

Vector Lens::direction_of(double across, double above) const {
  if (projection_ == Projection::perspective) return forward_ + across * right_ + above * up_;
  if (projection_ == Projection::panorama) {
    // Azimuth by altitude, about the picture's upright axis.
    return std::cos(above) * (std::cos(across) * forward_ + std::sin(across) * right_) + std::sin(above) * up_;
  }
  // Fisheye: at the distance r from the middle the angle is r, or its sine is r.
  const double r = std::hypot(across, above);
  if (!(r > 0)) return forward_;
  const double angle = projection_ == Projection::angular ? r : std::asin(std::min(1.0, r));
  return std::cos(angle) * forward_ + std::sin(angle) / r * (across * right_ + above * up_);
}

std::optional<Ray> Lens::ray(double x, double y) const {
  const double across = (x - 0.5 * width_) * scale_;
  const double above = (0.5 * height_ - y) * scale_;
  if (projection_ == Projection::orthographic) return Ray{eye_ + across * right_ + above * up_, forward_};
  const double r = std::hypot(across, above);
  if (projection_ == Projection::angular && r > half_angle_) return std::nullopt;
  if (projection_ == Projection::hemispherical && r > std::sin(half_angle_)) return std::nullopt;
  const bool is_all_around = projection_ == Projection::panorama;
  if (is_all_around && (std::abs(across) > std::numbers::pi || std::abs(above) > std::numbers::pi / 2))
    return std::nullopt;
  return Ray{eye_, direction_of(across, above).normalized()};
}

}  // namespace patchlight
