#include "scene/photometric_web.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

// Rounding of an angle; degrees.
constexpr double angle_tolerance = 1e-6;

struct Angles {
  double vertical = 0;
  double horizontal = 0;
};

// The formulas of PhotometricType the other way round.
Angles angles_of(PhotometricType type, const LuminaireFrame& frame, const Vector& direction) {
  const double ahead = frame.aim.dot(direction);
  const double along = frame.zero_plane.dot(direction);
  const double aside = frame.zero_plane.cross(frame.aim).dot(direction);
  const auto arc = [](double y, double x) { return std::atan2(y, x) * degrees_per_radian; };
  if (type == PhotometricType::a) return {arc(along, std::hypot(ahead, aside)), arc(-aside, ahead)};
  if (type == PhotometricType::b) return {arc(along, ahead), arc(-aside, std::hypot(ahead, along))};
  return {arc(std::hypot(along, aside), ahead), arc(aside, along)};
}

// A horizontal angle between -180 and 180 as the one of the table that is alike.
double by_symmetry(const PhotometricWeb& web, double angle) {
  const double first = web.horizontal.front();
  const double last = web.horizontal.back();
  if (web.type != PhotometricType::c) return first >= 0 ? std::abs(angle) : angle;
  const bool about_quarter = first > 90 - angle_tolerance && last > 180;
  if (about_quarter) {
    // The halves on both sides of the plane through 90 and 270 degrees are alike.
    const double from_quarter = std::abs(angle - 90) <= 180 ? std::abs(angle - 90) : 360 - std::abs(angle - 90);
    return 90 + from_quarter;
  }
  if (last > 180 + angle_tolerance) return angle < 0 ? angle + 360 : angle;
  const double half = std::abs(angle);
  return last > 90 + angle_tolerance ? half : std::min(half, 180 - half);
}

// Where an angle lies in ascending ones: between `index` and the next, at `share` of the way.
struct Position {
  std::size_t index = 0;
  double share = 0;
  bool inside = true;
};

Position position_of(const std::vector<double>& angles, double angle) {
  const bool inside = angle >= angles.front() - angle_tolerance && angle <= angles.back() + angle_tolerance;
  if (angles.size() < 2) return {0, 0, inside};
  const auto above = std::upper_bound(angles.begin() + 1, angles.end() - 1, angle);
  const auto index = static_cast<std::size_t>(above - angles.begin()) - 1;
  return {index, std::clamp((angle - angles[index]) / (angles[index + 1] - angles[index]), 0.0, 1.0), inside};
}

}  // namespace

double candela(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction) {
  const Angles angles = angles_of(web.type, frame, direction);
  const Position v = position_of(web.vertical, angles.vertical);
  // With one horizontal angle the intensity is the same all around.
  const bool round = web.horizontal.size() == 1;
  const Position h = round ? Position{} : position_of(web.horizontal, by_symmetry(web, angles.horizontal));
  if (!v.inside || !h.inside) return 0;
  const auto at = [&](std::size_t column) {
    const auto row = web.candela.begin() + static_cast<std::ptrdiff_t>(column * web.vertical.size() + v.index);
    return v.share > 0 ? (1 - v.share) * row[0] + v.share * row[1] : row[0];
  };
  return h.share > 0 ? (1 - h.share) * at(h.index) + h.share * at(h.index + 1) : at(h.index);
}

double tilt_factor(const PhotometricWeb& web, double tilt_degrees) {
  if (web.tilt.empty()) return 1;
  const Position at = position_of(web.tilt, tilt_degrees);
  const double below = web.tilt_factor[at.index];
  return at.share > 0 ? below + at.share * (web.tilt_factor[at.index + 1] - below) : below;
}

double luminous_flux(const PhotometricWeb& web) {
  const LuminaireFrame frame{-Vector::UnitZ(), Vector::UnitX()};
  constexpr int rings = 360;
  double flux = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const double polar = std::numbers::pi * (ring + 0.5) / rings;
    double sum = 0;
    for (int k = 0; k < 2 * rings; ++k) {
      const double turn = std::numbers::pi * (k + 0.5) / rings;
      sum += candela(web, frame,
                     Vector(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), -std::cos(polar)));
    }
    flux += sum * std::sin(polar);
  }
  constexpr double step = std::numbers::pi / rings;
  return flux * step * step;
}

}  // namespace patchlight
