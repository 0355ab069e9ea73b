#include "patchlight/form_factors.h"
#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/transport_operator.h"

#include "base/parallel.h"
#include "cli/arguments.h"
#include "cli/parse_value.h"
#include "gather/sensor_places.h"
#include "pipeline/world.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupt_flag.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <pybind11/stl.h>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Form factors between the patches of a scene, and the equations B = E + R F B.
struct TransportProblem {
  PatchMesh mesh;
  RadiosityProblem problem;
  Plan plan;
  std::shared_ptr<const World> world;
  std::shared_ptr<const RowTransport> transport;
};

// For each sensor (row) and patch, the irradiance for unit radiosity of that patch: its form factor including
// occlusion. NaN for sensors inside walls. Throws `Canceled`.
Field sensor_factors(const TransportProblem& problem, const Observer& observer) {
  const Scene& scene = problem.world->scene();
  const Occluder& occluder = problem.world->all_faces();
  const std::vector<SensorPlace> places = place_sensors(scene, scene.sensors, problem.plan.sides, occluder);
  const auto patches = static_cast<Eigen::Index>(problem.mesh.size());
  std::vector<Sensor> sensors;
  for (const SensorPlace& place : places) sensors.push_back(place.sensor);
  const Field one_each = Field(Eigen::MatrixXd::Identity(patches, patches).array());
  Field factors =
      gather_irradiance(
          problem.mesh, one_each, occluder, sensors,
          {.rays = std::max(8192, 8 * static_cast<int>(patches)), .seed = problem.plan.assembly.seed, .slopes = false},
          observer)
          .irradiance;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (places[k].standing == Standing::inside_wall)
      factors.row(static_cast<Eigen::Index>(k)).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return factors;
}

// Computes form factors with closure and keeps them. Throws InputError, MemoryError, `Canceled`.
TransportProblem transport_problem(const std::shared_ptr<const Scene>& scene, const Request& request,
                                   const Observer& observer) {
  // 1. The form factors before closure, which a run applies
  check(*scene);
  Request raw = request;
  raw.assembly.close = false;
  std::erase(raw.effects.force, Effect::closure);
  FormFactors found = find_form_factors(*scene, raw, observer);
  TransportProblem result{.mesh = found.mesh, .problem = {}, .plan = {}, .world = nullptr, .transport = nullptr};

  // 2. The materials and lamps of a run with them
  const SolveWith take_problem = [&](const RowTransport& transport, const RadiosityProblem& problem,
                                     const SolverOptions&, const Observer&) {
    result.problem = problem;
    // Only the light of the lamps; the solution is not used.
    Solution solution;
    solution.direct_irradiance = transport.apply(problem.exitance);
    solution.irradiance = solution.direct_irradiance;
    solution.radiosity = radiosity_from(problem, solution.irradiance);
    solution.history.emplace_back();
    solution.converged = true;
    return solution;
  };
  Steps with{.exchange = [&](const PatchMesh&) { return found.exchange; }, .solve = take_problem};
  with.mesh = [&] { return found.mesh; };
  Request kept = found.request;
  kept.assembly.close = request.assembly.close;
  kept.effects = request.effects;
  kept.assembly.storage = Storage::tiles;
  kept.effects.force.push_back(Effect::interreflection);
  Simulation simulation = simulate(scene, kept, observer, with);
  const bool closes = simulation.plan.assembly.close;
  result.plan = std::move(simulation.plan);
  result.world = std::move(simulation.world);

  // 3. The operator
  Eigen::VectorXd area = found.exchange.area;
  ClosedExchangeAreas areas = closes ? close_exchange(std::move(found.exchange), observer)
                                     : keep_exchange_areas(std::move(found.exchange.exchange_areas), "as found");
  result.transport = dense_transport(std::move(areas), std::move(area));
  return result;
}

namespace py = pybind11;

using ProblemPointer = std::shared_ptr<TransportProblem>;

ProblemPointer found_problem(const std::shared_ptr<Scene>& scene, const cli::SolveArguments& arguments,
                             const py::object& progress) {
  const InterruptFlag flag;
  const Observer observer = InterruptFlag::observer(progress);
  const auto kept = std::make_shared<const Scene>(*scene);
  const py::gil_scoped_release others;
  const ThreadLimit limit(arguments.request.resources.threads);
  return std::make_shared<TransportProblem>(transport_problem(kept, arguments.request, observer));
}

py::array applied(const TransportProblem& self, const NumbersIn& radiosity) {
  const Field B = field_of(radiosity, self.transport->size());
  Field H;
  {
    const py::gil_scoped_release others;
    H = self.transport->apply(B);
  }
  return array_of(std::move(H));
}

Solution solved_by(const TransportProblem& self, const std::string& solver, const RadiosityProblem& problem,
                   std::optional<double> tolerance, int max_iterations, std::optional<double> relaxation) {
  const InterruptFlag flag;
  const Observer observer = InterruptFlag::observer(py::none());
  SolverOptions options{.solver = cli::solver_named("solver", solver)};
  options.relative_error = tolerance;
  options.max_iterations = max_iterations;
  options.relaxation = relaxation;
  const py::gil_scoped_release others;
  return solve(*self.transport, problem, options, observer);
}

Solution solved_problem(const TransportProblem& self, const std::string& solver, std::optional<double> tolerance,
                        int max_iterations, std::optional<double> relaxation, const py::object& exitance) {
  RadiosityProblem problem = self.problem;
  if (!exitance.is_none()) {
    problem.exitance = field_of(NumbersIn(exitance), self.transport->size());
    problem.direct_irradiance = {};
  }
  return solved_by(self, solver, problem, tolerance, max_iterations, relaxation);
}

py::array factors(const TransportProblem& self, const std::array<PatchIndex, 2>& from,
                  const std::array<PatchIndex, 2>& to) {
  const PatchIndex size = self.transport->size();
  for (const auto& [begin, end] : {from, to}) {
    if (begin > end || end > size) throw py::index_error("patches are 0 to " + std::to_string(size));
  }
  return array_of(self.transport->form_factors({from[0], from[1]}, {to[0], to[1]}).array());
}

py::array factors_of_sensors(const TransportProblem& self) {
  const InterruptFlag flag;
  const Observer observer = InterruptFlag::observer(py::none());
  Field found;
  {
    const py::gil_scoped_release others;
    found = sensor_factors(self, observer);
  }
  return array_of(std::move(found));
}

py::list history_of(const Solution& solution) {
  py::list rows;
  for (const Iteration& iteration : solution.history) {
    py::dict row;
    row["iteration"] = iteration.number;
    row["relative_residual"] = iteration.relative_residual;
    row["error_bound"] = iteration.error_bound;
    row["applications"] = iteration.work;
    row["seconds"] = iteration.seconds;
    rows.append(row);
  }
  return rows;
}

template <class Owner>
void bind_mesh(py::class_<Owner, std::shared_ptr<Owner>>& type) {
  using Self = const Owner&;
  const auto add = [&](const char* name, const char* text, auto of) {
    const auto get = [of](const py::object& self) {
      return array_over(of(*self.cast<std::shared_ptr<Owner>>()), self);
    };
    type.def_property_readonly(name, get, text);
  };
  add(
      "vertices", "meters, vertices x 3", [](Self o) -> auto& { return o.mesh.vertices; });
  add(
      "corners", corners_text, [](Self o) -> auto& { return o.mesh.corners; });
  add(
      "material", "index into Scene.materials", [](Self o) -> auto& { return o.mesh.material; });
  add(
      "centroid", "meters, patches x 3", [](Self o) -> auto& { return o.mesh.centroid; });
  add(
      "area", "exposed, m^2", [](Self o) -> auto& { return o.problem.area; });
  add(
      "exitance", "E, W/m^2, patches x bands", [](Self o) -> auto& { return o.problem.exitance; });
  add(
      "reflectance", "rho, patches x bands", [](Self o) -> auto& { return o.problem.scattering.reflectance; });
  add(
      "direct_irradiance", "H_direct by luminaires, sun and sky, W/m^2; empty where there are none",
      [](Self o) -> auto& { return o.problem.direct_irradiance; });
}

}  // namespace

void bind_transport(py::module_& module) {
  py::class_<Solution, std::shared_ptr<Solution>>(module, "Solution", "The result of a solver, with its history.")
      .def_property_readonly(
          "radiosity", [](const py::object& self) { return array_over(self.cast<const Solution&>().radiosity, self); })
      .def_property_readonly(
          "irradiance",
          [](const py::object& self) { return array_over(self.cast<const Solution&>().irradiance, self); })
      .def_readonly("converged", &Solution::converged)
      .def_property_readonly("history", &history_of);
  py::class_<TransportProblem, ProblemPointer> type(
      module, "Transport", "H = F B between the patches of a scene, and B = E + rho (F B + H_direct).");
  bind_mesh(type);
  type.def_property_readonly("size", [](const TransportProblem& self) { return self.transport->size(); })
      .def_property_readonly(
          "front",
          [](const py::object& self) {
            const auto& side = self.cast<ProblemPointer>()->mesh.side;
            return array_over(reinterpret_cast<const std::uint8_t*>(side.data()),
                              {static_cast<py::ssize_t>(side.size())}, self);
          },
          "0 for patches on the front of their polygons")
      .def_property_readonly("emits_from_back",
                             [](const TransportProblem& self) { return self.plan.sides.emit_from_back; })
      .def(
          "sensor_factors", &factors_of_sensors,
          "The irradiance of each sensor of the scene (row) for unit radiosity of each patch. Other Python threads run "
          "meanwhile. Memory: about 32 bytes for each pair of patches, e.g. 3 GB for 10,000 patches.")
      .def("apply", &applied, "H = F B for radiosities B, patches x columns", py::arg("radiosity"))
      .def("form_factors", &factors, "F_ij from patches [begin, end) to patches [begin, end)", py::arg("begin_end"),
           py::arg("to"))
      .def("solve", &solved_problem, py::arg("solver") = "cg", py::arg("tolerance") = py::none(),
           py::arg("max_iterations") = 1000, py::arg("relaxation") = py::none(), py::arg("exitance") = py::none(),
           "Solves with one of patchlight.solvers; with `exitance` for other lamps, W/m^2, patches x bands.");
  module.def("transport", &found_problem, py::arg("scene"), py::arg("arguments"), py::arg("progress"));
}

}  // namespace patchlight
