#include "patchlight/simulate.h"

#include "scene/repair.h"
#include "validate/cases.h"
#include "validate/closed_forms.h"
#include "validate/measure.h"
#include "validate/scenes.h"

#include <cmath>
#include <sstream>
#include <utility>

namespace patchlight::validation {
namespace {

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

}  // namespace

std::vector<ValidationCase> solved_cases() {
  return {{"black closed cube, irradiance of the floor below a lit ceiling", opposed_rectangles(1, 1, 1), "Howell C-11",
           measure_black_cube},
          {"integrating sphere, irradiance opposite the lamp", 0.25, "H = mean E / (1 - rho)", measure_lit_sphere},
          furnace_case(0.5),
          furnace_case(0.95)};
}

}  // namespace patchlight::validation
