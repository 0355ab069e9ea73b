#include "form_factor/contour.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// Edges closer to one line than this share of their length are integrated as collinear.
constexpr double collinear_tolerance = 1e-12;

// Directions that differ by a smaller sine count as parallel.
constexpr double parallel_tolerance = 1e-12;

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
  if (std::max(h_start, h_end) <= collinear_tolerance * (a.length + b.length)) {
    return parallel_integral(along_start, along_end, b.length, 0);
  }
  if (b.direction.cross(a.direction).norm() <= parallel_tolerance) {
    return parallel_integral(along_start, along_end, b.length, 0.5 * (h_start + h_end));
  }

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

}  // namespace patchlight
