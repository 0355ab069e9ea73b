#include "validate/cases.h"
#include "validate/closed_forms.h"
#include "validate/measure.h"
#include "validate/scenes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace patchlight::validation {
namespace {

// Longer than any edge: each polygon is one patch.
constexpr double uncut = 10;

Scene with_polygons(Scene scene, const std::vector<Outline>& outlines, std::uint32_t group, bool inward) {
  for (const Outline& outline : outlines) {
    scene = with_polygon(std::move(scene), inward ? turned(outline) : outline, group);
  }
  return scene;
}

// Polygons inscribed in the discs see less of each other than the discs, circumscribed ones more, as the integrand is
// nowhere negative. The value is the middle of the two, the bar reaches both. The area is that of the disc.
Measured measure_discs(double r1, double r2, double h, const Observer& observer) {
  constexpr int corners = 64;
  const double outside = 1 / std::cos(std::numbers::pi / corners);  // radius ratio of circumscribed and inscribed
  std::array<double, 2> bound{};
  double error = 0;
  for (const bool circumscribed : {false, true}) {
    const double scale = circumscribed ? outside : 1;
    const Outline lower = regular_polygon(corners, scale * r1, 0);
    const Outline upper = turned(regular_polygon(corners, scale * r2, h));
    const Scene scene = with_polygon(with_polygon(empty_scene(), lower, 0), upper, 1);
    const GroupExchange exchange = group_exchange(scene, std::min(r1, r2) / 4, {}, observer);
    const double disc = std::numbers::pi * r1 * r1;
    bound[circumscribed ? 1 : 0] = exchange.exchange_area(0, 1) / disc;
    error = exchange.error(0, 1) / disc;
  }
  return {(bound[0] + bound[1]) / 2, (bound[1] - bound[0]) / 2 + error, "inscribed and circumscribed, quadrature"};
}

ValidationCase discs_case(double r1, double r2, double h) {
  std::ostringstream name;
  name << "coaxial discs of radius " << r1 << " and " << r2 << ", distance " << h;
  return {name.str(), coaxial_discs(r1, r2, h), "Howell C-41",
          [=](const Observer& observer) { return measure_discs(r1, r2, h, observer); }};
}

// Coaxial cylinders as prisms of as many sides.
Scene cylinders(double r1, double r2, double h, int sides) {
  const Scene outer = with_polygons(empty_scene(), prism_walls(sides, r2, h), 0, true);
  return with_polygons(outer, prism_walls(sides, r1, h), 1, false);
}

ValidationCase cylinders_case(double r1, double r2, double h) {
  std::ostringstream name;
  name << "coaxial cylinders of radius " << r2 << " and " << r1 << ", length " << h;
  return {name.str(), coaxial_cylinders(r1, r2, h), "Howell C-91", [=](const Observer& observer) {
            const auto with_sides = [&](int sides) {
              return unoccluded_form_factor(cylinders(r1, r2, h, sides), h / 4, 1, observer);
            };
            return refined(with_sides(16), with_sides(32));
          }};
}

// The inner sphere sees the outer only. The polyhedra are alike, so the ratio of their areas is that of the spheres.
// Shadow rays decide here, too: outer faces that cross the horizon of an inner one are hidden in part by the inner
// sphere.
Scene concentric_spheres(std::uint32_t outer_group) {
  constexpr int halvings = 2;
  const Scene outer = with_polygons(empty_scene(), sphere_triangles(halvings, 2), outer_group, true);
  return with_polygons(outer, sphere_triangles(halvings, 1), 1 - outer_group, false);
}

std::vector<ValidationCase> concentric_sphere_cases() {
  return {{"concentric spheres of radius 1 and 2, inner to outer", 1, "closure",
           [](const Observer& observer) { return sampled_form_factor(concentric_spheres(1), uncut, 1, observer); }},
          {"concentric spheres of radius 1 and 2, outer to inner", 0.25, "reciprocity, A_1 / A_2",
           [](const Observer& observer) { return sampled_form_factor(concentric_spheres(0), uncut, 1, observer); }},
          {"concentric spheres of radius 1 and 2, outer to itself", 0.75, "closure, 1 - A_1 / A_2",
           [](const Observer& observer) { return sampled_form_factor(concentric_spheres(0), uncut, 0, observer); }}};
}

// The octants of the inside of a sphere as groups.
Scene sphere_octants(int halvings) {
  const std::vector<Outline> triangles = sphere_triangles(halvings, 1);
  Scene scene = empty_scene();
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    scene = with_polygon(std::move(scene), turned(triangles[k]), static_cast<std::uint32_t>(8 * k / triangles.size()));
  }
  return scene;
}

ValidationCase octant_case(const std::string& where, std::uint32_t octant) {
  return {"sphere interior, octant to " + where, 0.125, "F_ij = A_j / A", [octant](const Observer& observer) {
            const auto halved = [&](int halvings) {
              return unoccluded_form_factor(sphere_octants(halvings), uncut, octant, observer);
            };
            return refined(halved(2), halved(3));
          }};
}

}  // namespace

std::vector<ValidationCase> curved_cases() {
  std::vector<ValidationCase> cases{discs_case(1, 1, 1), discs_case(1, 2, 1), discs_case(1, 0.5, 0.3),
                                    cylinders_case(1, 2, 2), cylinders_case(1, 1.5, 1)};
  for (ValidationCase& spheres : concentric_sphere_cases()) cases.push_back(std::move(spheres));
  cases.push_back(octant_case("the next", 1));
  cases.push_back(octant_case("the opposite", 7));
  return cases;
}

}  // namespace patchlight::validation
