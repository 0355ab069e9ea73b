#include "patchlight/gather/doubtful_sensors.h"

#include "patchlight/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace patchlight {
namespace {

constexpr std::size_t rays = 64;
constexpr double relative_distance = 1e-6;
constexpr std::size_t most_sentences = 5;

// Directions spread over the sphere: a spiral with the golden angle between one and the next.
std::vector<Vector> directions() {
  std::vector<Vector> all;
  for (std::size_t k = 0; k < rays; ++k) {
    const double z = 1 - (2.0 * static_cast<double>(k) + 1) / rays;
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
    const double radius = std::sqrt(1 - z * z);
    all.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return all;
}

bool is_inside_wall(const Point& point, const KeptSides& sides, const Occluder& occluder) {
  static const std::vector<Vector> around = directions();
  std::vector<Ray> all;
  for (const Vector& direction : around) all.push_back({point, direction});
  const std::vector<std::optional<Hit>> hits = occluder.first_hits(all);
  return std::all_of(hits.begin(), hits.end(), [&](const std::optional<Hit>& hit) {
    return hit && (hit->side == Side::front ? sides.front : sides.back)[hit->polygon] == 0;
  });
}

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Winding number of the outline around the point by the angles under which its edges are seen; seams cancel.
bool is_over(const Point& point, const std::vector<Point>& outline, const Vector& normal) {
  double angle = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector a = outline[k] - point;
    const Vector b = outline[(k + 1) % outline.size()] - point;
    angle += std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

struct Plane {
  Point point;
  Vector normal;
};

// Is the sensor in the surface of a polygon that it does not face along?
bool is_too_close(const Scene& scene, const std::vector<Plane>& planes, const Sensor& sensor, double tolerance) {
  constexpr double parallel = 1 - 1e-6;
  for (PolygonIndex p = 0; p < planes.size(); ++p) {
    const Vector& normal = planes[p].normal;
    if (std::abs(normal.dot(sensor.point - planes[p].point)) > tolerance) continue;
    if (std::abs(normal.dot(sensor.normal)) > parallel) continue;
    const std::vector<Point> outline = corner_points(scene, p);
    if (is_over(sensor.point, outline, normal)) return true;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      if (distance_to_segment(sensor.point, outline[k], outline[(k + 1) % outline.size()]) <= tolerance) return true;
    }
  }
  return false;
}

std::string sentence(const SensorGroup& group, std::size_t k, bool inside) {
  std::ostringstream text;
  const Point& point = group.sensors[k].point;
  text << place_of(group, k) << " at " << point.x() << ", " << point.y() << ", " << point.z() << " m "
       << (inside
               ? "lies inside a wall: it sees nothing but sides that take no part, and reads 0. Move it into the room"
               : "lies in a surface: rounding decides on which side of it. Move it away, by a millimetre or more");
  return text.str();
}

}  // namespace

std::vector<std::string> doubtful_sensors(const Scene& scene, const KeptSides& sides, const Occluder& occluder) {
  const double tolerance = relative_distance * bounds(scene).diagonal().norm();
  std::vector<Plane> planes;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    planes.push_back({corner_points(scene, p)[0], front_normal(scene, p)});
  }
  std::vector<std::string> sentences;
  std::size_t doubtful = 0;
  for (const SensorGroup& group : scene.sensors) {
    std::vector<std::uint8_t> inside(group.sensors.size());
    std::vector<std::uint8_t> close(group.sensors.size());
    parallel_for(group.sensors.size(), [&](std::size_t k) {
      inside[k] = is_inside_wall(group.sensors[k].point, sides, occluder);
      close[k] = !inside[k] && is_too_close(scene, planes, group.sensors[k], tolerance);
    });
    for (std::size_t k = 0; k < group.sensors.size(); ++k) {
      if (!inside[k] && !close[k]) continue;
      if (++doubtful <= most_sentences) sentences.push_back(sentence(group, k, inside[k] != 0));
    }
  }
  if (doubtful > most_sentences) {
    sentences.push_back(std::to_string(doubtful - most_sentences) + " more sensors lie inside walls or in surfaces");
  }
  return sentences;
}

}  // namespace patchlight
