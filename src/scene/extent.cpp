#include "scene/extent.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "scene/photometric_web.h"
#include "scene/simple_polygon.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

// A cell of a grid that is coarse against the distance: few points have to look into a second cell.
using Cell = std::array<std::int64_t, 3>;
constexpr double cells_per_distance = 0.125;

std::size_t hash_of(const Cell& cell) {
  // FNV-1a (Fowler, Noll, Vo) by words
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::int64_t index : cell) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x100000001b3U;
  return static_cast<std::size_t>(hash ^ (hash >> 32U));
}

// Points farther away share the outermost cells.
std::int64_t cell_at(double coordinate) {
  return static_cast<std::int64_t>(std::floor(std::clamp(coordinate, -1e15, 1e15)));
}

Cell cell_at(const Vector& at) { return {cell_at(at.x()), cell_at(at.y()), cell_at(at.z())}; }

constexpr std::uint32_t no_point = ~std::uint32_t{0};

// The points that stand for themselves by their cells, those of one cell in a list. A table with open addresses (Knuth,
// volume 3, section 6.4, algorithm L) of the lists' heads alone: a cell is that of its head.
class PointsByCell {
 public:
  PointsByCell(std::span<const Point> points, double scale)
      : points_(points),
        scale_(scale),
        heads_(std::bit_ceil(2 * points.size()), no_point),
        previous_(points.size(), no_point) {}

  Vector place(std::uint32_t point) const { return scale_ * (points_[point] - points_[0]); }
  std::uint32_t last_in(const Cell& cell) const { return heads_[slot_of(cell)]; }
  std::uint32_t before(std::uint32_t point) const { return previous_[point]; }
  void add(std::uint32_t point) {
    std::uint32_t& head = heads_[slot_of(cell_at(place(point)))];
    previous_[point] = std::exchange(head, point);
  }

 private:
  // The slot of the cell, or the free slot where it belongs.
  std::size_t slot_of(const Cell& cell) const {
    std::size_t slot = hash_of(cell) & (heads_.size() - 1);
    while (heads_[slot] != no_point && cell_at(place(heads_[slot])) != cell) slot = (slot + 1) & (heads_.size() - 1);
    return slot;
  }

  std::span<const Point> points_;
  double scale_;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> previous_;
};

constexpr double largest_share = 0.125;  // of the area, that a polygon counts for
constexpr double main_share = 0.6;       // of the area, that lies in the main part
constexpr int far_away = 100;            // times as far as the main part reaches

// Doubles at the far end of a box are this many meters apart, with a margin for rounding.
double resolution_of(const Box& box) {
  if (box.isEmpty()) return 0;
  return 4 * std::numeric_limits<double>::epsilon() * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
}

struct WeightedPoint {
  Point point;
  double weight;
};

// The value at the points below or at which lies this share of the weight.
double quantile(const std::vector<WeightedPoint>& points, const std::function<double(const Point&)>& value_at,
                double share) {
  struct Weighted {
    double value;
    double weight;
  };
  std::vector<Weighted> values;
  for (const auto& [point, weight] : points) values.push_back({value_at(point), weight});
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
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) areas.push_back(polygon_area(scene, p));
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

// Would welding by so much make a line of a polygon that is no sliver, a hundred thousand times as long as wide?
bool collapses(const Scene& scene, PolygonIndex polygon, double distance) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  return is_narrow(corners, distance) && !is_narrow(corners, polygon_box(scene, polygon).diagonal().norm() / 1e5);
}

// Points within 1 / far_away of the farthest distance lie within two neighbors of so many parts of the longest side.
// False when no two of them hold the main share: then nothing is far away.
bool may_be_far(const Scene& scene, const std::vector<double>& areas, double cap, const Box& all) {
  constexpr int parts = far_away / 2;
  int axis = 0;
  const double length = all.sizes().maxCoeff(&axis);
  std::array<double, parts + 1> weights{};
  double total = 0;
  for_weighted_corners(scene, areas, cap, [&](const Point& corner, double weight) {
    const double along = parts * ((corner[axis] - all.min()[axis]) / length);
    weights[static_cast<std::size_t>(along)] += weight;
    total += weight;
  });
  for (std::size_t k = 0; k < parts; ++k) {
    if (weights[k] + weights[k + 1] >= main_share * total) return true;
  }
  return false;
}

Box main_bounds(const Scene& scene, const std::vector<double>& areas, double cap) {
  const Box all = bounds(scene);
  if (all.isEmpty() || !(cap > 0) || !may_be_far(scene, areas, cap, all)) return all;
  std::vector<WeightedPoint> corners;
  for_weighted_corners(scene, areas, cap, [&](const Point& corner, double weight) {
    corners.push_back({corner, weight});
  });
  Point middle;
  for (int axis = 0; axis < 3; ++axis)
    middle[axis] = quantile(
        corners, [axis](const Point& corner) { return corner[axis]; }, 0.5);
  const auto distance = [&](const Point& corner) { return (corner - middle).cwiseAbs().maxCoeff(); };
  const double reach = far_away * quantile(corners, distance, main_share);
  if (!(reach > 0)) return all;
  Box main;
  for (const WeightedPoint& corner : corners) {
    if (distance(corner.point) <= reach) main.extend(corner.point);
  }
  // No ray resolves such a distance: then most of the faces are too small to be meant.
  return most_extents * main.diagonal().norm() < all.diagonal().norm() ? all : main;
}

// How far the corners of a polygon are from lying in one plane, meters.
double bend_of(const Scene& scene, PolygonIndex polygon) {
  const Vector normal = front_normal(scene, polygon);
  double lowest = 0;
  double highest = 0;
  for (const Point& corner : corner_points(scene, polygon)) {
    const double height = normal.dot(corner - scene.vertices[scene.polygons[polygon].corners[0]]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return highest - lowest;
}

constexpr double brightest = 1e25;

// Squares of weaker light would be below the smallest double.
constexpr double weakest = 1e-150;

void require_strength(const Spectrum& strength, const std::string& where, const std::string& what) {
  for (const double value : strength) {
    if (value == 0 || (value >= weakest && value <= brightest)) continue;
    std::ostringstream text;
    text << what << " is " << value << "; expected 0 or a number from " << weakest << " to " << brightest
         << " in every band";
    throw InputError(where, text.str());
  }
}

void check_luminaire(const Luminaire& luminaire, const Reach& reach) {
  require_in_reach(reach, luminaire.position, luminaire.place, "the position of luminaire '" + luminaire.name + "'");
  const std::string what = " of luminaire '" + luminaire.name + "'";
  const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
  const bool is_measured = std::holds_alternative<WebLight>(luminaire.light);
  const char* const strength = sphere        ? "the exitance in W/m^2"
                               : is_measured ? "the scale in W/lm"
                                             : "the intensity in W/sr";
  require_strength(strength_of(luminaire), luminaire.place, strength + what);
  if (!sphere) return;
  const Point rim = luminaire.position + Vector(sphere->radius, 0, 0);
  require_in_reach(reach, rim, luminaire.place, "the rim" + what);
}

void check_daylight(const Scene& scene) {
  if (scene.sun) require_strength(scene.sun->normal_irradiance, scene.file, "the sun's irradiance in W/m^2");
  if (!scene.sky) return;
  require_strength(scene.sky->horizontal_irradiance, scene.file, "the sky's irradiance in W/m^2");
  require_strength(scene.sky->zenith_radiance, scene.file, "the sky's radiance in W/(m^2 sr)");
  require_strength(scene.sky->ground_radiance, scene.file, "the ground's radiance in W/(m^2 sr)");
}

}  // namespace

double weld_distance(const Box& bounds) {
  if (bounds.isEmpty()) return 0;
  return std::max(tolerance_of_coordinates * bounds.sizes().maxCoeff(), resolution_of(bounds));
}

std::vector<std::uint32_t> used_vertices(const Scene& scene) {
  std::vector<std::uint8_t> is_used(scene.vertices.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    for (const std::uint32_t corner : polygon.corners) is_used[corner] = 1;
  }
  std::vector<std::uint32_t> used;
  for (std::uint32_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v] != 0) used.push_back(v);
  }
  return used;
}

std::vector<std::uint32_t> welded(std::span<const Point> points, double distance) {
  std::vector<std::uint32_t> stands_for(points.size());
  if (points.empty()) return stands_for;
  // If the model's size is near the smallest double, the quotient would be infinite.
  const double scale = distance > 0 ? std::min(cells_per_distance / distance, std::numeric_limits<double>::max()) : 0;
  const Vector reach = Vector::Constant(cells_per_distance);
  PointsByCell by_cell(points, scale);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    // The first of those in reach that stand for themselves.
    const Vector at = by_cell.place(v);
    const Cell low = cell_at(Vector(at - reach));
    const Cell high = cell_at(Vector(at + reach));
    std::uint32_t first = v;
    const auto look_into = [&](const Cell& cell) {
      for (std::uint32_t k = by_cell.last_in(cell); k != no_point; k = by_cell.before(k)) {
        if (k < first && (points[k] - points[v]).norm() <= distance) first = k;
      }
    };
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) look_into({x, y, z});
      }
    }
    stands_for[v] = first;
    if (first == v) by_cell.add(v);
  }
  return stands_for;
}

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
      if (!(areas[p] > 0) || !collapses(scene, p, distance)) continue;
      area += areas[p];
      ++faces;
    }
    return area > 1e-6 * total || faces > 0.2 * static_cast<double>(areas.size());
  };
  // Below single precision of single precision there is no detail that is meant; below double precision none at all.
  const double least = std::max(tolerance_of_coordinates * weld_distance(main), resolution_of(main));
  while (distance > least && loses_much()) distance = std::max(least, 0.1 * distance);
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

std::vector<std::uint8_t> bent_faces(const Scene& scene) {
  const double touch = weld_distance(scene);
  std::vector<std::uint8_t> is_bent(scene.polygons.size(), 0);
  parallel_for(is_bent.size(),
               [&](std::size_t p) { is_bent[p] = bend_of(scene, static_cast<PolygonIndex>(p)) > touch ? 1 : 0; });
  std::vector<std::uint8_t> is_rounded(scene.vertices.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_bent[p] == 0) continue;
    for (const std::uint32_t corner : scene.polygons[p].corners) is_rounded[corner] = 1;
  }
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t corner) { return is_rounded[corner] != 0; }))
      is_bent[p] = 1;
  }
  return is_bent;
}

Reach reach_of(const Scene& scene) {
  const Box box = main_bounds(scene);
  return {box.center(), most_extents * box.diagonal().norm()};
}

void require_in_reach(const Reach& reach, const Point& position, const std::string& where, const std::string& what) {
  const Vector offset = position - reach.centre;
  if (offset.stableNorm() <= reach.distance) return;
  std::ostringstream text;
  text << what << " is " << offset.stableNorm() << " m from the middle of the scene; expected at most "
       << reach.distance << " m, 1e12 times its size. Are the units the same?";
  throw InputError(where, text.str());
}

void check_limits(const Scene& scene) {
  for (const Material& material : scene.materials) {
    require_strength(material.exitance, scene.file, "the exitance in W/m^2 of material '" + material.name + "'");
  }
  const Reach reach = reach_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) check_luminaire(luminaire, reach);
  check_daylight(scene);
  for (const SensorGroup& group : scene.sensors) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k) {
      require_in_reach(reach, group.sensors[k].point, scene.file, place_of(group, k));
    }
  }
  for (const Camera& camera : scene.cameras) {
    require_in_reach(reach, camera.eye, scene.file, "the eye of camera '" + camera.name + "'");
    require_in_reach(reach, camera.target, scene.file, "the target of camera '" + camera.name + "'");
  }
}

}  // namespace patchlight
