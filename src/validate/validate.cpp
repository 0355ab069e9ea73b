#include "validate/validate.h"

#include "patchlight/base/error.h"
#include "patchlight/gather/gather.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

namespace patchlight::validation {
namespace {

// Scenes of one band. Polygons have vertices of their own; repair() joins them.

using Outline = std::vector<Point>;

// A scene repaired, checked and cut into patches, with its exchange areas before closure, summed by group.
struct GroupExchange {
  Eigen::MatrixXd exchange_area;  // m^2
  Eigen::MatrixXd error;  // m^2, bound on what quadrature and storage as float make of it; sampling not included
  Eigen::VectorXd area;   // m^2, of the groups
};

// Each triangle becomes four, whose new corners are pushed out to the sphere.
std::vector<Outline> halved(const std::vector<Outline>& triangles, double radius) {
  std::vector<Outline> result;
  for (const Outline& t : triangles) {
    const auto middle = [&](int k) -> Point { return radius * (t[k] + t[(k + 1) % 3]).normalized(); };
    const Point a = middle(0);
    const Point b = middle(1);
    const Point c = middle(2);
    for (const Outline& part : {Outline{t[0], a, c}, Outline{a, t[1], b}, Outline{c, b, t[2]}, Outline{a, b, c}}) {
      result.push_back(part);
    }
  }
  return result;
}

// A scene without polygons. Its materials are 0, with this reflectance and exitance, and 1, a black lamp of 1 W/m^2.
Scene empty_scene(double reflectance = 0.5, double exitance = 0) {
  Scene scene;
  scene.materials = {{"surface", Spectrum::Constant(1, reflectance), Spectrum::Constant(1, exitance)},
                     {"lamp", Spectrum::Constant(1, 0), Spectrum::Constant(1, 1)}};
  scene.file = "validation";
  return scene;
}

// The scene with one more polygon, facing the side from which its corners run counter-clockwise.
Scene with_polygon(Scene scene, const Outline& corners, std::uint32_t group, MaterialIndex material = 0) {
  Polygon polygon;
  polygon.material = material;
  polygon.group = group;
  for (const Point& corner : corners) {
    polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(corner);
  }
  scene.polygons.push_back(std::move(polygon));
  while (scene.groups.size() <= group) scene.groups.push_back("group " + std::to_string(scene.groups.size()));
  return scene;
}

// The same polygon facing the other way.
Outline turned(Outline corners) {
  std::reverse(corners.begin(), corners.end());
  return corners;
}

// A rectangle, counter-clockwise seen from where u x v points.
Outline rectangle(const Point& corner, const Vector& u, const Vector& v) {
  return {corner, corner + u, corner + u + v, corner + v};
}

// A regular polygon around (0, 0, z) in the circle of this radius, facing up.
Outline regular_polygon(int corners, double radius, double z) {
  Outline outline;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return outline;
}

// The walls of an upright regular prism in the cylinder of this radius, from z = 0 to `height`, facing outward.
std::vector<Outline> prism_walls(int sides, double radius, double height) {
  const Outline base = regular_polygon(sides, radius, 0);
  std::vector<Outline> walls;
  for (std::size_t k = 0; k < base.size(); ++k) {
    walls.push_back(rectangle(base[k], base[(k + 1) % base.size()] - base[k], height * Vector::UnitZ()));
  }
  return walls;
}

// A polyhedron in the sphere around the origin: each of an octahedron's faces, whose edges are halved so many times,
// pushed outward. 8 * 4^halvings triangles that face outward, octant by octant: x, y and z positive first and all
// negative last.
std::vector<Outline> sphere_triangles(int halvings, double radius) {
  std::vector<Outline> sphere;
  for (int octant = 0; octant < 8; ++octant) {
    const auto sign = [&](int axis) { return (octant >> axis & 1) == 0 ? 1.0 : -1.0; };
    std::vector<Outline> part{{{sign(0) * radius, 0, 0}, {0, sign(1) * radius, 0}, {0, 0, sign(2) * radius}}};
    if (sign(0) * sign(1) * sign(2) < 0) part[0] = turned(part[0]);
    for (int k = 0; k < halvings; ++k) part = halved(part, radius);
    sphere.insert(sphere.end(), part.begin(), part.end());
  }
  return sphere;
}

// The six walls of the unit cube, facing inward: the floor first, the ceiling second.
std::vector<Outline> cube_walls() {
  const Vector x = Vector::UnitX();
  const Vector y = Vector::UnitY();
  const Vector z = Vector::UnitZ();
  const Point origin = Point::Zero();
  return {rectangle(origin, x, y), rectangle(z, y, x),      rectangle(origin, z, x),
          rectangle(y, x, z),      rectangle(origin, y, z), rectangle(x, z, y)};
}

// The relative error of one pair that unoccluded_exchange_area() promises; the cases have no far patches at grazing
// angles.
constexpr double quadrature_error = 1e-3;

// The mean of so many runs lies within four of its standard errors: by Student's distribution with 15 degrees of
// freedom all but once in 900 cases, and as seeds are fixed a case that passes always does.
constexpr int runs = 16;

// Bound on the error of each pair, summed by group.
Eigen::MatrixXd error_between_groups(const ExchangeAreas& S, const PatchMesh& mesh,
                                     std::span<const std::uint32_t> group_of, std::uint32_t groups) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(groups, groups);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      const auto entry = static_cast<double>(S.at(i, j));
      if (entry == 0) continue;
      // contour_exchange_area() promises 1e-6; entries are floats, narrowed toward zero.
      const double relative = is_near(shapes[i], shapes[j]) ? 1e-6 : quadrature_error;
      sum(group_of[i], group_of[j]) += (relative + 0x1p-23) * entry;
    }
  }
  return sum;
}

// Uses the front sides of the polygons. Throws Canceled.
GroupExchange group_exchange(const Scene& scene, double max_edge, const AssemblyOptions& options,
                             const Observer& observer) {
  const Scene repaired = repair(scene);
  check(repaired);
  const PatchMesh mesh = tessellate(repaired, kept_sides(repaired, Sides::front), max_edge);
  const Assembly assembly = assemble_exchange_areas(mesh, Occluder(repaired), options, observer);

  const auto groups = static_cast<std::uint32_t>(repaired.groups.size());
  std::vector<std::uint32_t> group_of(mesh.size());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(groups);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    group_of[i] = repaired.polygons[mesh.polygon[i]].group;
    area[group_of[i]] += mesh.area[i];
  }
  return {exchange_between_groups(assembly.exchange_areas, group_of, groups),
          error_between_groups(assembly.exchange_areas, mesh, group_of, groups), area};
}

// The form factor from group 0 to group `to` where nothing can be hidden in part: the bar is that of the closed forms
// and of quadrature. Throws Canceled.
Measured unoccluded_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer) {
  const GroupExchange exchange = group_exchange(scene, max_edge, {}, observer);
  return {exchange.exchange_area(0, to) / exchange.area[0], exchange.error(0, to) / exchange.area[0], "quadrature"};
}

// The same where shadow rays decide: mean of runs with different seeds, and from their scatter its standard error.
// Throws Canceled.
Measured sampled_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer) {
  double sum = 0;
  double sum_of_squares = 0;
  double systematic = 0;
  for (int run = 1; run <= runs; ++run) {
    const AssemblyOptions options{16, static_cast<std::uint64_t>(run)};
    const GroupExchange exchange = group_exchange(scene, max_edge, options, observer);
    const double form_factor = exchange.exchange_area(0, to) / exchange.area[0];
    sum += form_factor;
    sum_of_squares += form_factor * form_factor;
    systematic = std::max(systematic, exchange.error(0, to) / exchange.area[0]);
  }
  const double mean = sum / runs;
  const double variance = std::max(0.0, sum_of_squares / runs - mean * mean) / (runs - 1);  // of the mean
  return {mean, 4 * std::sqrt(variance) + systematic, "4 standard errors, quadrature"};
}

// The result of a finer mesh, with an error bar from a mesh with edges twice as long: the error at least halves from
// the coarse mesh to the fine one.
Measured refined(const Measured& coarse, const Measured& fine) {
  return {fine.value, std::abs(fine.value - coarse.value) + fine.error_bar, "refinement, " + fine.bar_from};
}

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
  const Scene outer = with_polygons(empty_scene(), sphere_triangles(2, 2), outer_group, true);
  return with_polygons(outer, sphere_triangles(2, 1), 1 - outer_group, false);
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

// Discs, spheres and cylinders, by polygons and polyhedra.
std::vector<ValidationCase> curved_cases() {
  std::vector<ValidationCase> cases{discs_case(1, 1, 1), discs_case(1, 2, 1), discs_case(1, 0.5, 0.3),
                                    cylinders_case(1, 2, 2), cylinders_case(1, 1.5, 1)};
  for (ValidationCase& spheres : concentric_sphere_cases()) cases.push_back(std::move(spheres));
  cases.push_back(octant_case("the next", 1));
  cases.push_back(octant_case("the opposite", 7));
  return cases;
}

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

// Rectangles opposed, at a right angle, and sharing an edge at other angles; elements and rectangles.
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

// A simulation and the scene it belongs to.
struct Solved {
  Scene scene;
  Simulation simulation;
};

Solved solved(const Scene& scene, double max_edge, const Observer& observer) {
  Request request;
  request.mesh.max_edge = max_edge;
  request.mesh.sides = Sides::front;
  request.solver.relative_error = 1e-9;
  request.effects.force = {Effect::closure};  // error bars take the row sums, also where nothing is reflected
  Solved result{repair(scene), {}};
  check(result.scene);
  result.simulation = simulate(result.scene, request, observer);
  return result;
}

// Bound on |B_i - B_i*| of every patch from the solver's bound in the area norm: sqrt(A_i) |x_i| <= ||x||_A.
double solver_error(const Simulation& simulation) {
  const RadiosityProblem& problem = simulation.problem;
  const Field reflected = simulation.solution.radiosity - problem.exitance;
  return simulation.solution.history.back().error_bound * area_norm(reflected, problem.area)[0] /
         std::sqrt(problem.area.minCoeff());
}

// The mean irradiance of a group, W/m^2.
double mean_irradiance(const Solved& from, std::uint32_t group) {
  const Simulation& simulation = from.simulation;
  double flux = 0;
  double area = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (from.scene.polygons[simulation.mesh.polygon[i]].group != group) continue;
    flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
    area += simulation.problem.area[i];
  }
  return flux / area;
}

Scene cube(double reflectance, double exitance, bool ceiling_is_lamp) {
  Scene scene = empty_scene(reflectance, exitance);
  std::uint32_t wall = 0;
  for (const Outline& outline : cube_walls()) {
    scene = with_polygon(std::move(scene), outline, wall, ceiling_is_lamp && wall == 1 ? 1 : 0);
    ++wall;
  }
  return scene;
}

// B = E + rho F B has the solution B = 1 when E = 1 - rho and the rows of F sum up to 1. Rows that are off by d change
// B by rho d / (1 - rho). The value is the radiosity farthest from 1.
Measured measure_furnace(double reflectance, const Observer& observer) {
  const Simulation simulation = solved(cube(reflectance, 1 - reflectance, false), 0.25, observer).simulation;
  Eigen::Index farthest = 0;
  (simulation.solution.radiosity.col(0) - 1).abs().maxCoeff(&farthest);
  const double defect = (simulation.transport.row_sum.array() - 1).abs().maxCoeff();
  return {simulation.solution.radiosity(farthest, 0),
          solver_error(simulation) + reflectance * defect / (1 - reflectance), "solver, row sums"};
}

ValidationCase furnace_case(double reflectance) {
  std::ostringstream name;
  name << "furnace: closed cube with reflectance " << reflectance << ", radiosity";
  return {name.str(), 1, "E = 1 - rho: B = 1",
          [reflectance](const Observer& observer) { return measure_furnace(reflectance, observer); }};
}

// Where nothing reflects, the floor's irradiance below a ceiling of 1 W/m^2 is the form factor, after closure. Closure
// changes no row sum by more than its defect before.
Measured measure_black_cube(const Observer& observer) {
  const Solved black = solved(cube(0, 0, true), 0.125, observer);
  const double defect = (black.simulation.transport.raw_row_sum.array() - 1).abs().maxCoeff();
  const double form_factor = mean_irradiance(black, 0);
  return {form_factor, quadrature_error * form_factor + defect, "quadrature, closure"};
}

// The inside of a sphere; one octant is a lamp.
Scene lit_sphere(int halvings) {
  const std::vector<Outline> triangles = sphere_triangles(halvings, 1);
  Scene scene = empty_scene(0.5);
  scene.materials[1].reflectance = scene.materials[0].reflectance;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const auto octant = static_cast<std::uint32_t>(8 * k / triangles.size());
    scene = with_polygon(std::move(scene), turned(triangles[k]), octant, octant == 0 ? 1 : 0);
  }
  return scene;
}

// In a sphere F_ij = A_j / A, so H is everywhere the mean of B, which is the mean of E over 1 - rho: with E = 1 W/m^2
// on an octant and rho = 0.5 a quarter.
Measured measure_lit_sphere(const Observer& observer) {
  const auto opposite = [&](int halvings) {
    const Solved sphere = solved(lit_sphere(halvings), 2, observer);
    return Measured{mean_irradiance(sphere, 7), solver_error(sphere.simulation), "solver"};
  };
  return refined(opposite(2), opposite(3));
}

// Rooms solved as a whole.
std::vector<ValidationCase> solved_cases() {
  return {{"black closed cube, irradiance of the floor below a lit ceiling", opposed_rectangles(1, 1, 1), "Howell C-11",
           measure_black_cube},
          {"integrating sphere, irradiance opposite the lamp", 0.25, "H = mean E / (1 - rho)", measure_lit_sphere},
          furnace_case(0.5),
          furnace_case(0.95)};
}

}  // namespace

}  // namespace patchlight::validation

namespace patchlight {

bool within_bar(const ValidationResult& result) {
  return std::abs(result.measured.value - result.exact) <= result.measured.error_bar;
}

std::vector<ValidationCase> validation_cases() {
  std::vector<ValidationCase> all = validation::rectangle_cases();
  for (const auto& more : {validation::curved_cases(), validation::solved_cases()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

std::vector<ValidationResult> validate(std::span<const ValidationCase> cases, const Observer& observer) {
  std::vector<ValidationResult> results;
  for (const ValidationCase& one : cases) {
    if (observer && !observer({.stage = Stage::form_factors})) throw Canceled();
    results.push_back({one.name, one.exact, one.source, one.measure(observer)});
  }
  return results;
}

}  // namespace patchlight
