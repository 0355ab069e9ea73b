#include "patchlight/gather/gather.h"

#include "mesh/mesher.h"
#include "scene/repair.h"
#include "validate/cases.h"
#include "validate/closed_forms.h"
#include "validate/measure.h"
#include "validate/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace patchlight::validation {
namespace {

// Short sides are cut into so many patches.
constexpr double cuts = 4;

std::string words(const std::string& before, double a, const std::string& between, double b, const std::string& after,
                  double c) {
  std::ostringstream text;
  text << before << a << between << b << after << c;
  return text.str();
}

Scene opposed(double a, double b, double c) {
  const Outline lower = rectangle(Point::Zero(), a * Vector::UnitX(), b * Vector::UnitY());
  const Outline upper = rectangle({0, 0, c}, b * Vector::UnitY(), a * Vector::UnitX());
  return with_polygon(with_polygon(empty_scene(), lower, 0), upper, 1);
}

// Two rectangles that share an edge of length l and face each other at this angle in radian.
Scene sharing_an_edge(double w, double h, double l, double angle) {
  const Vector up(std::cos(angle), 0, std::sin(angle));
  const Outline flat = rectangle(Point::Zero(), w * Vector::UnitX(), l * Vector::UnitY());
  const Outline inclined = rectangle(Point::Zero(), l * Vector::UnitY(), h * up);
  return with_polygon(with_polygon(empty_scene(), flat, 0), inclined, 1);
}

ValidationCase unoccluded_case(std::string name, double exact, std::string source, Scene scene, double max_edge) {
  return {std::move(name), exact, std::move(source), [scene = std::move(scene), max_edge](const Observer& observer) {
            return unoccluded_form_factor(scene, max_edge, 1, observer);
          }};
}

ValidationCase opposed_case(double a, double b, double c) {
  return unoccluded_case(words("opposed rectangles ", a, " x ", b, ", distance ", c), opposed_rectangles(a, b, c),
                         "Howell C-11", opposed(a, b, c), std::min(a, b) / cuts);
}

ValidationCase perpendicular_case(double w, double h, double l) {
  return unoccluded_case(words("perpendicular rectangles ", w, " and ", h, " wide, edge ", l),
                         perpendicular_rectangles(w, h, l), "Howell C-14",
                         sharing_an_edge(w, h, l, std::numbers::pi / 2), std::min({w, h, l}) / cuts);
}

ValidationCase angled_case(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  std::ostringstream name;
  name << "unit squares sharing an edge at " << degrees << " degrees";
  return unoccluded_case(name.str(), angled_rectangles(1, 1, 1, angle), "Howell C-16", sharing_an_edge(1, 1, 1, angle),
                         1 / cuts);
}

// The irradiance of an element at the origin from a lamp with an exitance of 1 W/m^2 is the form factor. Here all is in
// closed form, in double: some hundred operations for each patch.
ValidationCase element_case(std::string name, double exact, std::string source, const Outline& lamp,
                            const Vector& normal) {
  const Scene scene = with_polygon(empty_scene(), lamp, 0, 1);
  return {std::move(name), exact, std::move(source), [scene, normal](const Observer& observer) {
            const Scene repaired = repair(scene);
            check(repaired);
            const PatchMesh mesh = tessellate(repaired, kept_sides(repaired, Sides::front), 1 / cuts);
            const Field radiosity = Field::Ones(mesh.size(), 1);
            const std::vector<Sensor> sensors{{Point::Zero(), normal}};
            const Occluder occluder(repaired, Occluder::Blockers::all);
            const Field irradiance = gather_irradiance(mesh, radiosity, occluder, sensors, {}, observer).irradiance;
            return Measured{irradiance(0, 0), 100 * mesh.size() * std::numeric_limits<double>::epsilon(), "rounding"};
          }};
}

ValidationCase parallel_element_case(double a, double b, double c) {
  const Outline lamp = rectangle({0, 0, c}, b * Vector::UnitY(), a * Vector::UnitX());
  return element_case(words("element to parallel rectangle ", a, " x ", b, ", distance ", c),
                      element_to_parallel_rectangle(a, b, c), "Howell B-3", lamp, Vector::UnitZ());
}

ValidationCase perpendicular_element_case(double a, double b, double c) {
  const Outline lamp = rectangle({c, 0, 0}, a * Vector::UnitZ(), b * Vector::UnitY());
  return element_case(words("element to perpendicular rectangle ", a, " x ", b, ", distance ", c),
                      element_to_perpendicular_rectangle(a, b, c), "Howell B-4", lamp, Vector::UnitZ());
}

// A right triangle half way between opposed unit squares blocks the rays that pass this height at x > y. The mirror
// x = y maps each square to itself, and these rays to the others: the triangle hides one half.
ValidationCase half_hidden_case() {
  const Scene scene = with_polygon(opposed(1, 1, 1), {{0, 0, 0.5}, {1, 0, 0.5}, {1, 1, 0.5}}, 2);
  return {"opposed unit squares, half hidden by a triangle", opposed_rectangles(1, 1, 1) / 2, "symmetry, Howell C-11",
          [scene](const Observer& observer) { return sampled_form_factor(scene, 1 / cuts, 1, observer); }};
}

}  // namespace

std::vector<ValidationCase> rectangle_cases() {
  std::vector<ValidationCase> cases{opposed_case(1, 1, 1), opposed_case(1, 1, 0.1), opposed_case(1, 1, 10),
                                    opposed_case(4, 1, 1), opposed_case(10, 1, 2)};
  for (const auto& [w, h, l] : {std::array{1.0, 1.0, 1.0}, {1.0, 4.0, 2.0}, {1.0, 1.0, 10.0}, {5.0, 1.0, 1.0}}) {
    cases.push_back(perpendicular_case(w, h, l));
  }
  for (const double degrees : {1, 5, 30, 60, 120, 150, 175, 179}) cases.push_back(angled_case(degrees));
  cases.push_back(parallel_element_case(1, 1, 1));
  cases.push_back(parallel_element_case(2, 1, 0.1));
  cases.push_back(perpendicular_element_case(1, 1, 1));
  cases.push_back(perpendicular_element_case(1, 3, 0.1));
  cases.push_back(half_hidden_case());
  return cases;
}

}  // namespace patchlight::validation
