#include "input/round_shapes.h"

#include <array>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr double step = 2 * std::numbers::pi / round_sides;

// The k-th corner of a unit circle around the z axis; k counts steps of 2 pi / round_sides.
Vector on_circle(std::uint32_t k) { return {std::cos(step * k), std::sin(step * k), 0}; }

// x and y such that x, y and the axis are right-handed.
Eigen::Matrix3d frame_of(const Vector& axis) {
  Eigen::Matrix3d frame;
  frame.col(2) = axis.normalized();
  frame.col(0) = frame.col(2).unitOrthogonal();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// Faces between two circles of corners; either circle may be a single point.
void add_belt(FacetedShape& shape, std::uint32_t low, bool low_is_point, std::uint32_t high, bool high_is_point) {
  for (std::uint32_t k = 0; k < round_sides; ++k) {
    const std::uint32_t next = (k + 1) % round_sides;
    std::vector<std::uint32_t> face = {low_is_point ? low : low + k};
    if (!low_is_point) face.push_back(low + next);
    face.push_back(high_is_point ? high : high + next);
    if (!high_is_point) face.push_back(high + k);
    shape.faces.push_back(std::move(face));
  }
}

double facets_area(const FacetedShape& shape) {
  double area = 0;
  for (const std::vector<std::uint32_t>& face : shape.faces) {
    std::vector<Point> corners;
    for (const std::uint32_t corner : face) corners.push_back(shape.points[corner]);
    area += area_vector(corners).norm();
  }
  return area;
}

// A sphere around the origin with its corners at distance 1.
FacetedShape unit_sphere() {
  constexpr std::uint32_t belts = round_sides / 2;
  FacetedShape shape;
  shape.points.emplace_back(0, 0, -1);
  for (std::uint32_t belt = 1; belt < belts; ++belt) {
    const double polar = std::numbers::pi * belt / belts;
    for (std::uint32_t k = 0; k < round_sides; ++k)
      shape.points.push_back(std::sin(polar) * on_circle(k) - std::cos(polar) * Vector::UnitZ());
  }
  const auto top = static_cast<std::uint32_t>(shape.points.size());
  shape.points.emplace_back(0, 0, 1);
  for (std::uint32_t belt = 0; belt < belts; ++belt) {
    const std::uint32_t low = belt == 0 ? 0 : 1 + (belt - 1) * round_sides;
    const std::uint32_t high = belt + 1 == belts ? top : 1 + belt * round_sides;
    add_belt(shape, low, belt == 0, high, belt + 1 == belts);
  }
  return shape;
}

// Factor f for the radii of a truncated cone with n sides, such that its area equals that of the round cone. With d =
// r_a - r_b, the slant height of a side is sqrt(h^2 + (f d cos(pi / n))^2). The faceted area is n sin(pi / n) (r_a +
// r_b) f times that; the round area is pi (r_a + r_b) sqrt(h^2 + d^2). Equality is a quadratic equation in f^2.
double cone_factor(double height, double difference) {
  const double sides = round_sides * std::sin(step / 2) / std::numbers::pi;
  const double inclined = std::pow(difference * std::cos(step / 2), 2);
  const double h2 = height * height;
  const double target = (h2 + difference * difference) / (sides * sides);
  // Solves inclined u^2 + h^2 u = target in the form that is stable for small `inclined`.
  return std::sqrt(2 * target / (h2 + std::sqrt(h2 * h2 + 4 * inclined * target)));
}

// Factor f for the radius of an n-gon with the area of the circle: n / 2 sin(2 pi / n) f^2 = pi.
double disk_factor() { return std::sqrt(2 * std::numbers::pi / (round_sides * std::sin(step))); }

// Adds a circle of corners, or one point for radius 0, and returns the index of the first.
std::uint32_t add_circle(FacetedShape& shape, const Point& centre, const Eigen::Matrix3d& frame, double radius) {
  const auto first = static_cast<std::uint32_t>(shape.points.size());
  const std::uint32_t corners = radius == 0 ? 1 : round_sides;
  for (std::uint32_t k = 0; k < corners; ++k) shape.points.push_back(centre + radius * (frame * on_circle(k)));
  return first;
}

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

FacetedShape faceted_sphere(const Point& centre, double radius) {
  static const FacetedShape unit = unit_sphere();
  static const double factor = std::sqrt(4 * std::numbers::pi / facets_area(unit));
  FacetedShape shape = unit;
  for (Point& point : shape.points) point = centre + factor * radius * point;
  return shape;
}

FacetedShape faceted_cone(const Point& a, const Point& b, double radius_a, double radius_b) {
  const Vector axis = b - a;
  FacetedShape shape;
  if (!(axis.norm() > 0) || !(radius_a > 0 || radius_b > 0)) return shape;
  const double factor = cone_factor(axis.norm(), radius_a - radius_b);
  const Eigen::Matrix3d frame = frame_of(axis);
  const std::uint32_t low = add_circle(shape, a, frame, factor * radius_a);
  const std::uint32_t high = add_circle(shape, b, frame, factor * radius_b);
  add_belt(shape, low, radius_a == 0, high, radius_b == 0);
  return shape;
}

FacetedShape faceted_ring(const Point& centre, const Vector& normal, double inner, double outer) {
  FacetedShape shape;
  if (!(normal.norm() > 0) || !(outer > inner)) return shape;
  const Eigen::Matrix3d frame = frame_of(normal);
  const std::uint32_t far = add_circle(shape, centre, frame, disk_factor() * outer);
  if (inner > 0) {
    const std::uint32_t near = add_circle(shape, centre, frame, disk_factor() * inner);
    add_belt(shape, far, false, near, false);
    return shape;
  }
  std::vector<std::uint32_t> disk;
  for (std::uint32_t k = 0; k < round_sides; ++k) disk.push_back(far + k);
  shape.faces.push_back(std::move(disk));
  return shape;
}

// R = c I + s [k]_x + (1 - c) k k^T: Rodrigues' formula.
Eigen::Matrix3d turned_about(const Vector& axis, double degrees) {
  const auto [c, s] = cosine_and_sine(degrees);
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return c * Eigen::Matrix3d::Identity() + s * cross + (1 - c) * axis * axis.transpose();
}

}  // namespace patchlight
