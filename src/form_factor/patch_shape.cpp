#include "form_factor/patch_shape.h"

#include "base/sampling.h"
#include "base/tolerances.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace patchlight {
namespace {

struct Edge {
  Point start;
  Vector direction;  // unit
  double length = 0;
};

std::vector<Edge> edges_of(std::span<const Point> polygon) {
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector along = polygon[(k + 1) % polygon.size()] - polygon[k];
    const double length = along.norm();
    if (length > 0) edges.push_back({polygon[k], along / length, length});
  }
  return edges;
}

// Antiderivative of ln sqrt(t^2 + h^2).
double log_integral(double t, double h) {
  const double squared = t * t + h * h;
  if (squared == 0) return 0;
  return 0.5 * t * std::log(squared) - t + (h > 0 ? h * std::atan(t / h) : 0);
}

// int over the points y of `edge` of ln |x - y|, exact.
double inner_integral(const Point& x, const Edge& edge) {
  const Vector offset = x - edge.start;
  const double foot = offset.dot(edge.direction);
  const double h = (offset - foot * edge.direction).norm();
  return log_integral(edge.length - foot, h) - log_integral(-foot, h);
}

// int int ln sqrt((s - t)^2 + h^2) ds dt over s between s0 and s1 and t in [0, length]: two parallel edges at distance
// h, exact by the second antiderivative (x^2 - h^2) / 4 ln(x^2 + h^2) - 3/4 x^2 + h x atan(x / h).
double parallel_integral(double s0, double s1, double length, double h) {
  const auto g = [h](double x) {
    const double squared = x * x + h * h;
    if (squared == 0) return 0.0;
    return 0.25 * (x * x - h * h) * std::log(squared) - 0.75 * x * x + (h > 0 ? h * x * std::atan(x / h) : 0);
  };
  const double lower = std::min(s0, s1);
  const double upper = std::max(s0, s1);
  return g(upper) - g(lower) - g(upper - length) + g(lower - length);
}

// Gauss-Legendre over [lower, upper]; `graded` draws the points toward both ends, where the integrand may have a
// logarithmic edge: s = z^2 (3 - 2 z).
template <int points, typename Integrand>
double quadrature(double lower, double upper, bool graded, const Integrand& integrand) {
  const auto mapped = [&](double z) {
    if (!graded) return integrand(lower + z * (upper - lower));
    return 6 * z * (1 - z) * integrand(lower + z * z * (3 - 2 * z) * (upper - lower));
  };
  return (upper - lower) * boost::math::quadrature::gauss<double, points>::integrate(mapped, 0.0, 1.0);
}

// int int ln |x(s) - y(t)| ds dt over two edges.
double double_log_integral(const Edge& a, const Edge& b) {
  // 1. Where the ends of a lie along b, and how far from its line.
  const Vector start = a.start - b.start;
  const Vector end = start + a.length * a.direction;
  const double along_start = start.dot(b.direction);
  const double along_end = end.dot(b.direction);
  const double h_start = (start - along_start * b.direction).norm();
  const double h_end = (end - along_end * b.direction).norm();
  if (std::max(h_start, h_end) <= tolerance_of_arithmetic * (a.length + b.length))
    return parallel_integral(along_start, along_end, b.length, 0);
  if (b.direction.cross(a.direction).norm() <= tolerance_of_arithmetic)
    return parallel_integral(along_start, along_end, b.length, 0.5 * (h_start + h_end));

  // 2. Far apart the integrand is smooth.
  const auto integrand = [&](double s) { return inner_integral(a.start + s * a.direction, b); };
  const double distance = (start + 0.5 * a.length * a.direction - 0.5 * b.length * b.direction).norm();
  if (distance > 1.5 * (a.length + b.length)) return quadrature<7>(0, a.length, false, integrand);

  // 3. Near, it has edges where a passes the ends of b: cut there.
  std::vector<double> cuts{0, a.length};
  for (const double t : {0.0, b.length}) {
    const double s = (b.start + t * b.direction - a.start).dot(a.direction);
    if (s > 0 && s < a.length) cuts.push_back(s);
  }
  std::sort(cuts.begin(), cuts.end());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) sum += quadrature<15>(cuts[k], cuts[k + 1], true, integrand);
  return sum;
}

}  // namespace

double contour_exchange_area(std::span<const Point> first, std::span<const Point> second) {
  // Each polygon sends and receives only before the other's plane.
  const std::vector<Point> first_seen = clip_to_half_space(first, second[0], area_vector(second));
  const std::vector<Point> second_seen = clip_to_half_space(second, first[0], area_vector(first));
  if (first_seen.empty() || second_seen.empty()) return 0;

  // A_1 F_12 = 1/(2 pi) sum_i sum_j (e_i . f_j) int int ln |x_i(s) - y_j(t)| ds dt
  double sum = 0;
  for (const Edge& a : edges_of(first_seen)) {
    for (const Edge& b : edges_of(second_seen)) {
      const double cosine = a.direction.dot(b.direction);
      if (std::abs(cosine) > 1e-14) sum += cosine * double_log_integral(a, b);
    }
  }
  return std::max(0.0, sum / (2 * std::numbers::pi));
}

namespace {

template <int capacity>
void add_point(Quadrature<capacity>& rule, const Point& point, double weight) {
  const auto k = static_cast<std::size_t>(rule.count++);
  rule.x[k] = point.x();
  rule.y[k] = point.y();
  rule.z[k] = point.z();
  rule.weight[k] = weight;
}

// Symmetric Gaussian rules for triangles of degree 2 and 4; Dunavant 1985.
Quadrature<4> coarse_triangle(const Point& a, const Point& b, const Point& c, double area) {
  Quadrature<4> rule{};
  for (int k = 0; k < 3; ++k) {
    const std::array<double, 3> w{k == 0 ? 2.0 / 3 : 1.0 / 6, k == 1 ? 2.0 / 3 : 1.0 / 6, k == 2 ? 2.0 / 3 : 1.0 / 6};
    add_point(rule, w[0] * a + w[1] * b + w[2] * c, area / 3);
  }
  return rule;
}

Quadrature<9> fine_triangle(const Point& a, const Point& b, const Point& c, double area) {
  struct Orbit {
    double single, pair, weight;
  };
  constexpr std::array<Orbit, 2> orbits{Orbit{0.816847572980459, 0.091576213509771, 0.109951743655322},
                                        Orbit{0.108103018168070, 0.445948490915965, 0.223381589678011}};
  Quadrature<9> rule{};
  for (const Orbit& orbit : orbits) {
    add_point(rule, orbit.single * a + orbit.pair * (b + c), orbit.weight * area);
    add_point(rule, orbit.single * b + orbit.pair * (c + a), orbit.weight * area);
    add_point(rule, orbit.single * c + orbit.pair * (a + b), orbit.weight * area);
  }
  return rule;
}

// Tensor Gauss-Legendre rule on the bilinear map of a quadrilateral.
template <int capacity, std::size_t n>
Quadrature<capacity> quadrilateral(const PatchCorners& corners, const Vector& normal,
                                   const std::array<double, n>& nodes, const std::array<double, n>& weights) {
  const auto& p = corners.points;
  Quadrature<capacity> rule{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double u = 0.5 * (1 + nodes[i]);
      const double v = 0.5 * (1 + nodes[j]);
      const Point point = (1 - u) * (1 - v) * p[0] + u * (1 - v) * p[1] + u * v * p[2] + (1 - u) * v * p[3];
      const Vector along_u = (1 - v) * (p[1] - p[0]) + v * (p[2] - p[3]);
      const Vector along_v = (1 - u) * (p[3] - p[0]) + u * (p[2] - p[1]);
      add_point(rule, point, 0.25 * weights[i] * weights[j] * normal.dot(along_u.cross(along_v)));
    }
  }
  return rule;
}

// With the centroid, the normal and the area as they are.
PatchShape finished(PatchShape shape) {
  const auto& p = shape.corners.points;
  for (const Point& corner : std::span<const Point>(shape.corners))
    shape.radius = std::max(shape.radius, (corner - shape.centroid).norm());
  if (shape.corners.count == 3) {
    shape.coarse = coarse_triangle(p[0], p[1], p[2], shape.area);
    shape.fine = fine_triangle(p[0], p[1], p[2], shape.area);
  } else {
    const double two = std::sqrt(1.0 / 3);
    const double three = std::sqrt(0.6);
    shape.coarse = quadrilateral<4, 2>(shape.corners, shape.normal, {-two, two}, {1, 1});
    shape.fine = quadrilateral<9, 3>(shape.corners, shape.normal, {-three, 0, three}, {5.0 / 9, 8.0 / 9, 5.0 / 9});
  }
  return shape;
}

// int int cos cos' / (pi r^2): the sum over all pairs of quadrature points.
template <typename Rule>
double product_quadrature(const Rule& first, const Vector& n, const Rule& second, const Vector& m) {
  double sum = 0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(first.count); ++a) {
    double inner = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(second.count); ++b) {
      const double x = second.x[b] - first.x[a];
      const double y = second.y[b] - first.y[a];
      const double z = second.z[b] - first.z[a];
      const double squared = x * x + y * y + z * z;
      const double cosine_first = std::max(0.0, n.x() * x + n.y() * y + n.z() * z);
      const double cosine_second = std::max(0.0, -(m.x() * x + m.y() * y + m.z() * z));
      inner += second.weight[b] * cosine_first * cosine_second / (squared * squared);
    }
    sum += first.weight[a] * inner;
  }
  return sum / std::numbers::pi;
}

// The fine rules of the fan triangles of a convex polygon.
std::vector<Quadrature<9>> fan_rules(std::span<const Point> polygon) {
  std::vector<Quadrature<9>> rules;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const std::array<Point, 3> triangle{polygon[0], polygon[k], polygon[k + 1]};
    rules.push_back(fine_triangle(triangle[0], triangle[1], triangle[2], area_vector(triangle).norm()));
  }
  return rules;
}

// Quadrature over the parts that lie before each other's plane: there the integrand is smooth.
double clipped_quadrature(const PatchShape& first, const PatchShape& second) {
  const auto first_seen = clip_to_half_space(first.corners, second.centroid, second.normal);
  const auto second_seen = clip_to_half_space(second.corners, first.centroid, first.normal);
  double sum = 0;
  for (const auto& a : fan_rules(first_seen)) {
    for (const auto& b : fan_rules(second_seen)) sum += product_quadrature(a, first.normal, b, second.normal);
  }
  return sum;
}

// Lowest and highest corner of `patch` over the plane of `plane`.
std::array<double, 2> heights(const PatchShape& patch, const PatchShape& plane) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Point& corner : std::span<const Point>(patch.corners)) {
    const double height = plane.normal.dot(corner - plane.centroid);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return {lowest, highest};
}

bool closer_than(const PatchShape& first, const PatchShape& second, double diameters) {
  // The same result for distances that are equal up to rounding.
  const double limit = (1 - tolerance_of_shapes) * 2 * diameters * std::max(first.radius, second.radius);
  return (second.centroid - first.centroid).squaredNorm() < limit * limit;
}

}  // namespace

PatchShape patch_shape(const PatchMesh& mesh, PatchIndex patch) {
  return finished({mesh.corner_points(patch), mesh.centroid[patch], mesh.normal[patch], mesh.area[patch], 0, {}, {}});
}

PatchShape patch_shape(const PatchCorners& corners) {
  const Vector area = area_vector(corners);
  return finished({corners, area_centroid(corners), area.normalized(), area.norm(), 0, {}, {}});
}

std::vector<PatchShape> patch_shapes(const PatchMesh& mesh) {
  std::vector<PatchShape> shapes;
  shapes.reserve(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) shapes.push_back(patch_shape(mesh, i));
  return shapes;
}

Orientation orientation(const PatchShape& first, const PatchShape& second) {
  const double tolerance = height_tolerance * (first.radius + second.radius);
  const auto [first_lowest, first_highest] = heights(first, second);
  if (first_highest <= tolerance) return Orientation::averted;
  const auto [second_lowest, second_highest] = heights(second, first);
  if (second_highest <= tolerance) return Orientation::averted;
  return first_lowest < -tolerance || second_lowest < -tolerance ? Orientation::straddling : Orientation::facing;
}

bool is_near(const PatchShape& first, const PatchShape& second) { return closer_than(first, second, near_diameters); }

bool is_adjacent(const PatchShape& first, const PatchShape& second) { return closer_than(first, second, 1); }

double unoccluded_exchange_area(const PatchShape& first, const PatchShape& second, FarRule far) {
  if (is_near(first, second)) return contour_exchange_area(first.corners, second.corners);
  const auto by_quadrature = [&] {
    if (orientation(first, second) == Orientation::straddling) return clipped_quadrature(first, second);
    if (far == FarRule::fine || closer_than(first, second, far_diameters))
      return product_quadrature(first.fine, first.normal, second.fine, second.normal);
    return product_quadrature(first.coarse, first.normal, second.coarse, second.normal);
  };
  // Strips as narrow as the rounding of their corners may have points that look away.
  return std::max(0.0, by_quadrature());
}

namespace {

// The frame of a scene: coordinates in it are `axes^T (x - centre) / size`.
struct Frame {
  Point centre;
  Eigen::Matrix3d axes;
  double size = 1;
};

// The principal axes of the second moments; the axes of the file where two moments are equal.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& moments) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  const Eigen::Vector3d& values = solver.eigenvalues();
  const double smallest_gap = std::min(values[1] - values[0], values[2] - values[1]);
  return smallest_gap > tolerance_of_coordinates * values.sum() ? solver.eigenvectors() : Eigen::Matrix3d::Identity();
}

// Calls use(A, B, C) for the triangles of a patch.
template <typename Use>
void for_triangles(const PatchMesh& mesh, PatchIndex patch, Use use) {
  const PatchCorners corners = mesh.corner_points(patch);
  for (std::size_t k = 2; k < static_cast<std::size_t>(corners.count); ++k)
    use(corners.points[0], corners.points[k - 1], corners.points[k]);
}

double triangle_area(const Point& a, const Point& b, const Point& c) { return (b - a).cross(c - a).norm() / 2; }

// The integral of x x^T over a triangle.
Eigen::Matrix3d second_moments(const Vector& a, const Vector& b, const Vector& c) {
  const Vector sum = a + b + c;
  return triangle_area(a, b, c) / 12 *
         (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
}

// The integral over a triangle of the cube of each coordinate: a tenth of the area times the sum of all ten products of
// three of its values at the corners.
Vector third_moments(const Vector& a, const Vector& b, const Vector& c) {
  const Eigen::Array3d x = a.array(), y = b.array(), z = c.array();
  const Eigen::Array3d products =
      x.cube() + y.cube() + z.cube() + x.square() * (y + z) + y.square() * (x + z) + z.square() * (x + y) + x * y * z;
  return triangle_area(a, b, c) / 10 * products.matrix();
}

// Each axis points to the side of its third moment, or if that vanishes to the side of its largest coordinate.
Eigen::Matrix3d oriented(Eigen::Matrix3d axes, const Point& centre, double size, const PatchMesh& mesh) {
  Vector third = Vector::Zero();
  double total = 0;
  const auto local = [&](const Point& point) -> Vector { return axes.transpose() * (point - centre); };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for_triangles(mesh, i, [&](const Point& a, const Point& b, const Point& c) {
      third += third_moments(local(a), local(b), local(c));
    });
    total += mesh.area[i];
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index largest = 0;
    axes.col(axis).cwiseAbs().maxCoeff(&largest);
    const bool symmetric = std::abs(third[axis]) <= tolerance_of_coordinates * total * size * size * size;
    const double direction = symmetric ? axes(largest, axis) : third[axis];
    if (direction < 0) axes.col(axis) *= -1;
  }
  return axes;
}

// Computed from moments of the surfaces, so it does not depend on how they are cut into patches.
Frame scene_frame(const PatchMesh& mesh) {
  double total = 0;
  Vector sum = Vector::Zero();
  const Point origin = mesh.centroid[0];
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    total += mesh.area[i];
    sum += mesh.area[i] * (mesh.centroid[i] - origin);
  }
  const Point centre = origin + sum / total;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for_triangles(mesh, i, [&](const Point& a, const Point& b, const Point& c) {
      moments += second_moments(a - centre, b - centre, c - centre) / total;
    });
  }
  const double size = std::sqrt(moments.trace());
  return {centre, oriented(principal_axes(moments), centre, size, mesh), size};
}

// Coordinates in steps of 1e-4 of the scene's size: far above the rounding errors of files in single precision.
std::uint64_t step_of(double x) { return static_cast<std::uint64_t>(std::llround(x / 1e-4)); }

}  // namespace

std::vector<std::uint32_t> patch_keys(const PatchMesh& mesh) {
  std::vector<std::uint32_t> keys;
  if (mesh.size() == 0) return keys;
  const Frame frame = scene_frame(mesh);
  const double scale = frame.size > 0 ? 1 / frame.size : 1;
  keys.reserve(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector position = scale * frame.axes.transpose() * (mesh.centroid[i] - frame.centre);
    const double facing = mesh.normal[i].dot(frame.axes * Vector(1, 2, 4));  // distinguishes the two sides of a polygon
    keys.push_back(hash({step_of(position.x()), step_of(position.y()), step_of(position.z()), facing > 0 ? 1U : 0U}));
  }
  return keys;
}

}  // namespace patchlight
