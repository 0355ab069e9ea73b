#include "benchmarks/unoccluded.h"

#include "patchlight/transport/assemble.h"

#include "base/sampling.h"
#include "form_factor/contour.h"
#include "form_factor/patch_shape.h"
#include "support/scenes.h"
#include "validate/closed_forms.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight::benchmarks {
namespace {

constexpr std::size_t drawn_pairs = 20000;

// The four quarters of a triangle or quadrilateral, by the middles of its edges.
std::vector<std::vector<Point>> quarters(const PatchCorners& corners) {
  const auto& p = corners.points;
  const Point a = (p[0] + p[1]) / 2;
  const Point b = (p[1] + p[2]) / 2;
  if (corners.count == 3) {
    const Point c = (p[2] + p[0]) / 2;
    return {{p[0], a, c}, {a, p[1], b}, {c, b, p[2]}, {a, b, c}};
  }
  const Point c = (p[2] + p[3]) / 2;
  const Point d = (p[3] + p[0]) / 2;
  const Point middle = (a + c) / 2;
  return {{p[0], a, middle, d}, {a, p[1], b, middle}, {middle, b, p[2], c}, {d, middle, c, p[3]}};
}

double by_quarters(const PatchShape& first, const PatchShape& second) {
  double sum = 0;
  for (const auto& a : quarters(first.corners)) {
    for (const auto& b : quarters(second.corners)) sum += contour_exchange_area(a, b);
  }
  return sum;
}

std::size_t zone_of(const PatchShape& first, const PatchShape& second) {
  constexpr double middle_diameters = 4;
  if (is_near(first, second)) return 0;
  const double diameters = (first.centroid - second.centroid).norm() / (2 * std::max(first.radius, second.radius));
  return diameters < middle_diameters ? 1 : 2;
}

struct ZoneSamples {
  std::vector<double> relative;
  ZoneErrors errors;

  void add(double found, double exact, double smaller_area) {
    const double difference = std::abs(found - exact);
    relative.push_back(difference / exact);
    errors.largest_F = std::max(errors.largest_F, difference / smaller_area);
    errors.within_millionth += relative.back() < 1e-6 ? 1 : 0;
    errors.within_millionth_F += difference / smaller_area < 1e-6 ? 1 : 0;
  }

  ZoneErrors summary() {
    ZoneErrors result = errors;
    if (relative.empty()) return result;
    std::sort(relative.begin(), relative.end());
    result.pairs = static_cast<double>(relative.size());
    result.median = relative[relative.size() / 2];
    result.p999 = relative[static_cast<std::size_t>(0.999 * result.pairs)];
    result.largest = relative.back();
    result.within_millionth /= result.pairs;
    result.within_millionth_F /= result.pairs;
    return result;
  }
};

}  // namespace

ExchangeAreas without_occluders(const Room& room) {
  const Box box = bounds(room.scene);
  const Scene hull = test::with_box(test::empty_scene({test::grey(0.5)}), box.min(), box.max(), true);
  return assemble_exchange_areas(room.mesh, Occluder(hull)).exchange_areas;
}

std::array<ZoneErrors, 3> zone_errors(const PatchMesh& mesh, const ExchangeAreas& unoccluded) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  std::array<ZoneSamples, 3> zones;
  for (std::uint32_t draw = 0; draw < 8000000; ++draw) {
    const PatchIndex i = hash({draw, 2}) % mesh.size();
    const PatchIndex j = hash({draw, 3}) % mesh.size();
    if (mesh.polygon[i] == mesh.polygon[j]) continue;
    ZoneSamples& zone = zones[zone_of(shapes[i], shapes[j])];
    if (zone.relative.size() >= drawn_pairs) continue;
    if (orientation(shapes[i], shapes[j]) == Orientation::averted) continue;
    zone.add(unoccluded.at(i, j), by_quarters(shapes[i], shapes[j]), std::min(mesh.area[i], mesh.area[j]));
  }
  return {zones[0].summary(), zones[1].summary(), zones[2].summary()};
}

double entries_above(const ExchangeAreas& S, const ExchangeAreas& unoccluded) {
  double above = 0;
  for (PatchIndex i = 0; i < S.size(); ++i) {
    for (PatchIndex j = i + 1; j < S.size(); ++j) above += S.at(i, j) > (1 + 1e-6) * unoccluded.at(i, j) ? 1 : 0;
  }
  return above;
}

double edge_sharing_error(double angle) {
  const double radians = angle * std::numbers::pi / 180;
  const Vector up(std::cos(radians), 0, std::sin(radians));
  const std::vector<Point> flat{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Point> inclined{Point(0, 0, 0), Point(0, 1, 0), Point(Vector(0, 1, 0) + up), Point(up)};
  return std::abs(contour_exchange_area(flat, inclined) - validation::angled_rectangles(1, 1, 1, radians));
}

}  // namespace patchlight::benchmarks
