#include "scene/extent.h"

#include "scene/limits.h"
#include "scene/simple_polygon.h"
#include "scene/weld.h"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>

namespace patchlight {
namespace {

constexpr double largest_share = 0.125;
constexpr double most = 0.6;
constexpr int far_away = 100;

// A face is a sliver when it is this much longer than wide.
constexpr double sliver = 1e5;
constexpr double largest_loss = 1e-6;   // of the area
constexpr double largest_number = 0.2;  // of the faces
constexpr double tenth = 0.1;

struct Weighted {
  double value;
  double weight;
};

// The value below or at which lies this share of the weight.
double quantile(std::vector<Weighted> values, double share) {
  std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0;
  for (const Weighted& one : values) total += one.weight;
  double sum = 0;
  for (const Weighted& one : values) {
    sum += one.weight;
    if (sum >= share * total) return one.value;
  }
  return values.back().value;
}

// c with c = share (sum min(a_i, c)): none of the areas, lowered to it, is more than its share of their sum. The
// smallest area, by which all are alike, when there are too few.
double cap_of(std::vector<double> areas) {
  constexpr std::ptrdiff_t most_lowered = 7;
  static_assert(largest_share * (most_lowered + 1) == 1);
  std::erase(areas, 0);
  if (areas.empty()) return 0;
  if (largest_share * static_cast<double>(areas.size()) < 1) return *std::min_element(areas.begin(), areas.end());
  const auto largest = areas.end() - most_lowered;
  std::nth_element(areas.begin(), largest, areas.end());
  std::sort(largest, areas.end());
  // With more digits the sum seldom depends on the order.
  double below = static_cast<double>(std::accumulate(areas.begin(), largest, 0.0L));
  for (auto area = largest; area != areas.end(); ++area) {
    // With those below as they are: c = share (below + (the number of others) c).
    const double rest = 1 - largest_share * static_cast<double>(areas.end() - area);
    if (largest_share * below <= rest * *area) return largest_share * below / rest;
    below += *area;
  }
  return areas.back();
}

std::vector<double> areas_of(const Scene& scene) {
  std::vector<double> areas;
  areas.reserve(scene.polygons.size());
  std::vector<Point> points;
  for (const Polygon& polygon : scene.polygons) {
    points.clear();
    for (const std::uint32_t corner : polygon.corners) points.push_back(scene.vertices[corner]);
    areas.push_back(area_vector(points).norm());
  }
  return areas;
}

// Calls `visit` with each corner of the polygons and its share of their areas, lowered to `cap`.
void for_weighted_corners(const Scene& scene, const std::vector<double>& areas, double cap, const auto& visit) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    const double weight = std::min(areas[p], cap) / static_cast<double>(corners.size());
    for (const std::uint32_t corner : corners) visit(scene.vertices[corner], weight);
  }
}

struct Corners {
  std::vector<Point> points;
  std::vector<double> weights;
};

// Would welding by so much make a line of a face that is none?
bool collapses(const std::vector<Point>& corners, double distance) {
  Box box;
  for (const Point& corner : corners) box.extend(corner);
  const double length = box.diagonal().norm();
  return is_narrow(corners, distance) && !is_narrow(corners, length / sliver);
}

double quantile(const Corners& corners, const std::function<double(const Point&)>& value_at, double share) {
  std::vector<Weighted> values;
  for (std::size_t k = 0; k < corners.points.size(); ++k)
    values.push_back({value_at(corners.points[k]), corners.weights[k]});
  return quantile(std::move(values), share);
}

// What lies within 1 / far_away of the farthest distance lies within two neighbours of so many parts of the longest
// side. False when no two of them hold most: then nothing is far away.
bool may_be_far(const Scene& scene, const std::vector<double>& areas, double cap, const Box& all) {
  constexpr int parts = far_away / 2;
  int axis = 0;
  const double length = all.sizes().maxCoeff(&axis);
  std::array<double, parts + 1> held{};
  double total = 0;
  for_weighted_corners(scene, areas, cap, [&](const Point& corner, double weight) {
    const double along = parts * ((corner[axis] - all.min()[axis]) / length);
    held[static_cast<std::size_t>(along)] += weight;
    total += weight;
  });
  for (std::size_t k = 0; k < parts; ++k) {
    if (held[k] + held[k + 1] >= most * total) return true;
  }
  return false;
}

Box main_bounds(const Scene& scene, const std::vector<double>& areas, double cap) {
  const Box all = bounds(scene);
  if (all.isEmpty() || !(cap > 0) || !may_be_far(scene, areas, cap, all)) return all;
  Corners corners;
  for_weighted_corners(scene, areas, cap, [&](const Point& corner, double weight) {
    corners.points.push_back(corner);
    corners.weights.push_back(weight);
  });
  Point middle;
  for (int axis = 0; axis < 3; ++axis)
    middle[axis] = quantile(
        corners, [axis](const Point& corner) { return corner[axis]; }, 0.5);
  const auto distance = [&](const Point& corner) { return (corner - middle).cwiseAbs().maxCoeff(); };
  const double reach = far_away * quantile(corners, distance, most);
  if (!(reach > 0)) return all;
  Box main;
  for (const Point& corner : corners.points) {
    if (distance(corner) <= reach) main.extend(corner);
  }
  // Of what is still farther no ray can tell: then most of the model are faces too small to be meant.
  return most_extents * main.diagonal().norm() < all.diagonal().norm() ? all : main;
}

}  // namespace

Box main_bounds(const Scene& scene) {
  const std::vector<double> areas = areas_of(scene);
  return main_bounds(scene, areas, cap_of(areas));
}

double extent_of(const Scene& scene) { return main_bounds(scene).diagonal().norm(); }

double weld_distance(const Scene& scene) {
  std::vector<double> areas = areas_of(scene);
  const double cap = cap_of(areas);
  const Box main = main_bounds(scene, areas, cap);
  double distance = weld_distance(main);
  double total = 0;
  for (double& area : areas) total += area = std::min(area, cap);
  const auto loses_much = [&] {
    double area = 0;
    double faces = 0;
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      if (!(areas[p] > 0) || !collapses(corner_points(scene, p), distance)) continue;
      area += areas[p];
      ++faces;
    }
    return area > largest_loss * total || faces > largest_number * static_cast<double>(areas.size());
  };
  // Below single precision of single precision there is no detail that is meant; below double precision none at all.
  const double resolved = weld_tolerance * weld_distance(main);
  const double farthest = main.isEmpty() ? 0 : main.min().cwiseAbs().cwiseMax(main.max().cwiseAbs()).maxCoeff();
  const double least = std::max(resolved, 4 * std::numeric_limits<double>::epsilon() * farthest);
  while (distance > least && loses_much()) distance = std::max(least, tenth * distance);
  return distance;
}

std::vector<PolygonIndex> far_polygons(const Scene& scene) {
  const Box main = main_bounds(scene);
  std::vector<PolygonIndex> polygons;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return !main.contains(scene.vertices[c]); }))
      polygons.push_back(p);
  }
  return polygons;
}

}  // namespace patchlight
