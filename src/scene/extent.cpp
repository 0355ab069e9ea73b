#include "scene/extent.h"

#include "scene/limits.h"
#include "scene/simple_polygon.h"
#include "scene/weld.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

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
  std::erase(areas, 0);
  std::sort(areas.begin(), areas.end());
  if (areas.empty()) return 0;
  if (largest_share * static_cast<double>(areas.size()) < 1) return areas.front();
  double below = 0;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    // With the k smallest as they are: c = share (below + (n - k) c).
    const double rest = 1 - largest_share * static_cast<double>(areas.size() - k);
    if (rest > 0 && largest_share * below <= rest * areas[k]) return largest_share * below / rest;
    below += areas[k];
  }
  return areas.back();
}

// The corners of all polygons with their share of the lowered areas; none when no polygon has an area.
struct Corners {
  std::vector<Point> points;
  std::vector<double> weights;
};

Corners weighted_corners(const Scene& scene) {
  std::vector<double> areas;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) areas.push_back(area_vector(corner_points(scene, p)).norm());
  const double cap = cap_of(areas);
  Corners all;
  if (!(cap > 0)) return all;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    for (const std::uint32_t corner : corners) {
      all.points.push_back(scene.vertices[corner]);
      all.weights.push_back(std::min(areas[p], cap) / static_cast<double>(corners.size()));
    }
  }
  return all;
}

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
bool may_be_far(const Corners& corners, const Box& all) {
  constexpr int parts = far_away / 2;
  int axis = 0;
  const double length = all.sizes().maxCoeff(&axis);
  std::array<double, parts + 1> held{};
  double total = 0;
  for (std::size_t k = 0; k < corners.points.size(); ++k) {
    const double along = parts * ((corners.points[k][axis] - all.min()[axis]) / length);
    held[static_cast<std::size_t>(along)] += corners.weights[k];
    total += corners.weights[k];
  }
  for (std::size_t k = 0; k < parts; ++k) {
    if (held[k] + held[k + 1] >= most * total) return true;
  }
  return false;
}

}  // namespace

Box main_bounds(const Scene& scene) {
  const Box all = bounds(scene);
  if (all.isEmpty()) return all;
  const Corners corners = weighted_corners(scene);
  if (corners.points.empty() || !may_be_far(corners, all)) return all;
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

double extent_of(const Scene& scene) { return main_bounds(scene).diagonal().norm(); }

double weld_distance(const Scene& scene) {
  double distance = weld_distance(main_bounds(scene));
  std::vector<double> areas;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) areas.push_back(area_vector(corner_points(scene, p)).norm());
  const double cap = cap_of(areas);
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
  const Box main = main_bounds(scene);
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
