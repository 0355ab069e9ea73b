#include "lighting/shadow_outlines.h"

#include <algorithm>

namespace patchlight {
namespace {

// What is nearer to a point of light than this share of its height throws no shadow but at grazing angles.
constexpr double beside_light = 1 - 1e-9;

// The part of an outline where `signed_distance` is positive.
template <typename Distance>
std::vector<Point> part_before(const std::vector<Point>& outline, Distance signed_distance) {
  std::vector<Point> before;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = outline[(k + 1) % outline.size()];
    const double at_a = signed_distance(a);
    const double at_b = signed_distance(b);
    if (at_a > 0) before.push_back(a);
    if ((at_a > 0) != (at_b > 0)) before.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return before;
}

}  // namespace

ShadowFrame shadow_frame_of(const Receiver& patch) {
  const SurfacePoint middle = patch.place(0.5, 0.5);
  const Vector u = middle.normal.unitOrthogonal();
  return {middle.point, u, middle.normal.cross(u), middle.normal};
}

Outline outline_of(std::span<const Point> corners, const ShadowFrame& frame) {
  Outline outline;
  for (const Point& corner : corners) outline.push_back(frame.in_plane(corner));
  if (area_of(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

bool holds(const Outline& outline, const Outline& region) {
  if (outline.size() < 3) return false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d& a = outline[k];
    const Eigen::Vector2d along = outline[(k + 1) % outline.size()] - a;
    const auto is_right = [&](const Eigen::Vector2d& p) {
      return along.x() * (p.y() - a.y()) - along.y() * (p.x() - a.x()) < 0;
    };
    if (std::any_of(region.begin(), region.end(), is_right)) return false;
  }
  return true;
}

std::vector<Point> part_above(const std::array<Point, 3>& triangle, const ShadowFrame& frame, double least,
                              const LightPlace& light) {
  const auto height = [&](const Point& point) { return frame.normal.dot(point - frame.origin); };
  if (std::none_of(triangle.begin(), triangle.end(), [&](const Point& point) { return height(point) > least; }))
    return {};
  const auto above = part_before({triangle.begin(), triangle.end()}, height);
  if (light.weight == 0) return above;
  const double highest = beside_light * height(light.at);
  return part_before(above, [&](const Point& point) { return highest - height(point); });
}

std::vector<HalfSpace> shaft_of(const Receiver& patch, const ShadowFrame& frame, const LightPlace& light) {
  std::vector<HalfSpace> outside{{frame.normal, frame.normal.dot(frame.origin)}};
  if (light.weight > 0) outside.push_back({-frame.normal, -frame.normal.dot(light.at)});
  std::vector<Point> corners = patch.corners;
  if (area_vector(corners).dot(frame.normal) < 0) std::reverse(corners.begin(), corners.end());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector inward = light.way_from(corners[k]).cross(corners[(k + 1) % corners.size()] - corners[k]);
    outside.push_back({inward, inward.dot(corners[k])});
  }
  return outside;
}

}  // namespace patchlight
