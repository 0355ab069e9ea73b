#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "archive/scene_hash.h"
#include "cli/arguments.h"
#include "cli/render.h"
#include "cli/summary.h"
#include "light/photometry.h"
#include "output/report/report_json.h"
#include "page/write_page.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupt_flag.h"

#include <memory>
#include <pybind11/stl.h>

namespace patchlight {
namespace {

namespace py = pybind11;

// A solved scene and its request.
struct SolvedScene {
  std::shared_ptr<const Scene> scene;
  Request request;
  Simulation simulation;
  std::string command_line;
  std::vector<std::string> changes;  // see Provenance
};

using SolvedPointer = std::shared_ptr<SolvedScene>;

// Revokes the transport that a Python function received.
struct LentUntilTheEnd {
  std::shared_ptr<const RowTransport*> lent;
  ~LentUntilTheEnd() { *lent = nullptr; }
};

// Calls a Python function as the solver: it gets H = F B as a function, and E, rho and H_direct, and returns H.
SolveWith solve_by(const py::object& own, const InterruptFlag& flag) {
  return [&own, &flag](const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions&,
                       const Observer&) {
    Solution solution;
    const Eigen::Index size = problem.exitance.rows();
    {
      const py::gil_scoped_acquire lock;
      // The function may outlive the transport.
      const auto lent = std::make_shared<const RowTransport*>(&transport);
      const LentUntilTheEnd end{lent};
      const InterruptFlag::LeftToPython signals(flag);
      const auto apply = py::cpp_function([lent, size](const NumbersIn& radiosity) {
        if (*lent == nullptr)
          throw InputError("apply", "found a call after the solver has ended; expected calls before it returns");
        return array_of((*lent)->apply(field_of(radiosity, size)));
      });
      const Field direct =
          problem.direct_irradiance.size() > 0 ? problem.direct_irradiance : Field::Zero(size, problem.exitance.cols());
      solution.irradiance = field_of(
          NumbersIn(own(apply, array_of(problem.exitance), array_of(problem.scattering.reflectance), array_of(direct))),
          size);
    }
    if (solution.irradiance.cols() != problem.exitance.cols())
      throw InputError("own solver", "found " + std::to_string(solution.irradiance.cols()) +
                                         " columns; expected one for each of " +
                                         std::to_string(problem.exitance.cols()) + " bands");
    if (!solution.irradiance.allFinite())
      throw InputError("own solver", "found irradiances that are not finite; expected a finite number for each patch");
    solution.radiosity = radiosity_from(problem, solution.irradiance);
    solution.direct_irradiance = transport.apply(problem.exitance);
    if (problem.direct_irradiance.size() > 0) solution.direct_irradiance += problem.direct_irradiance;
    solution.history.emplace_back();
    solution.converged = true;
    return solution;
  };
}

SolvedPointer solved(const std::shared_ptr<Scene>& scene, const cli::SolveArguments& arguments, const py::object& own,
                     const std::vector<std::string>& changes, const py::object& progress) {
  const InterruptFlag flag;
  const Observer observer = InterruptFlag::observer(progress);
  auto result = std::make_shared<SolvedScene>();
  // A copy, so that later changes of the scene have no effect.
  result->scene = std::make_shared<const Scene>(*scene);
  check(*result->scene);
  result->request = arguments.request;
  result->command_line = arguments.command_line;
  result->changes = changes;
  Steps with;
  if (!own.is_none()) with.solve = solve_by(own, flag);
  const py::gil_scoped_release others;
  result->simulation = simulate(*result->scene, arguments.request, observer, with);
  return result;
}

Provenance provenance_of(const SolvedScene& self) {
  return {.command_line = self.command_line,
          .exposure = exposure_of(self.simulation),
          .scene_hash = scene_hash(*self.scene),
          .changes = self.changes};
}

std::string report_of_run(const SolvedScene& self) {
  const Report report = report_of(*self.scene, self.request, self.simulation);
  return report_json(report, provenance_of(self))
      .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

py::bytes page_of_run(const SolvedScene& self) {
  std::string html;
  {
    const py::gil_scoped_release others;
    const SolvedSurface surface = surface_of(self.simulation);
    const Picture picture = take_picture(self.simulation, {.width = 640, .height = 480});
    SensorView view;
    SensorFacts facts;
    if (!self.scene->sensors.empty()) {
      view = read_sensors(self.simulation);
      facts = sensor_facts(self.scene->sensors, view.readings, view.warnings);
    }
    const Report report = report_of(*self.scene, self.request, self.simulation, facts);
    html = page_of({.scene = *self.scene,
                    .provenance = provenance_of(self),
                    .surface = &surface,
                    .report = &report,
                    .readings = self.scene->sensors.empty() ? nullptr : &view.readings,
                    .pictures = {&picture}});
  }
  return html;
}

std::vector<std::string> notes_of(const SolvedScene& self) {
  return texts_of(cli::notes(*self.scene, self.simulation));
}

// Reasons why results miss the requested accuracy.
std::vector<std::string> shortcomings_of(const SolvedScene& self) {
  const Report report = report_of(*self.scene, self.request, self.simulation);
  if (report.solution.unfinished) return {cli::explain_unfinished(report)};
  if (!report.solution.converged) return {cli::explain_not_converged(report)};
  if (!is_accurate(report)) return {cli::explain_not_accurate(report)};
  return {};
}

void write_run(const SolvedScene& self, const std::string& file) {
  const py::gil_scoped_release others;
  write_result(file, surface_of(self.simulation), provenance_of(self));
}

py::dict sensors_of(const SolvedScene& self) {
  SensorView view;
  {
    const py::gil_scoped_release others;
    view = read_sensors(self.simulation);
  }
  const Readings& readings = view.readings;
  const Eigen::Index count = readings.irradiance.rows();
  Field values(count, 1), errors(count, 1), factors(readings.outside_by_sky ? count : 0, 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    const SensorValue value = sensor_value(readings, static_cast<std::size_t>(k));
    values(k, 0) = value.value;
    errors(k, 0) = value.standard_error;
    if (readings.outside_by_sky) factors(k, 0) = daylight_factor(readings, static_cast<std::size_t>(k));
  }
  py::dict result;
  result["unit"] = sensor_unit(readings);
  result["irradiance"] = array_of(readings.irradiance);
  result["standard_error"] = array_of(readings.standard_error);
  result["value"] = array_of(values).attr("ravel")();
  result["value_error"] = array_of(errors).attr("ravel")();
  if (readings.outside_by_sky) result["daylight_factor"] = array_of(factors).attr("ravel")();
  result["warnings"] = texts_of(view.warnings);
  return result;
}

py::dict picture_of(const SolvedScene& self, const cli::SolveArguments& arguments) {
  Picture picture;
  {
    const InterruptFlag flag;
    const Observer observer = InterruptFlag::observer(py::none());
    const py::gil_scoped_release others;
    picture = cli::make_picture(arguments.picture, *self.scene, self.simulation, observer);
  }
  const py::ssize_t width = picture.image.width, height = picture.image.height;
  py::dict result;
  result["srgb"] = py::array_t<std::uint8_t>({height, width, py::ssize_t{3}}, picture.image.pixels.front().data());
  result["radiance"] = array_of(picture.radiance.pixels).attr("reshape")(height, width, -1);
  result["exposure"] = picture.exposure;
  return result;
}

Field luminances_of(const SolvedScene& self, const Field& values) {
  const Bands bands = bands_of(*self.scene);
  Field result(values.rows(), 1);
  for (Eigen::Index row = 0; row < values.rows(); ++row) result(row, 0) = luminance(values.row(row), bands);
  return result;
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<SolvedScene, SolvedPointer> type(
      module, "Simulation",
      "A solved scene. Arrays have a row for each patch; they are the solver's own memory, read only.");
  using Run = const Simulation&;
  const auto add = [&](const char* name, const char* text, auto of) {
    const auto get = [of](const py::object& self) {
      return array_over(of(self.cast<SolvedPointer>()->simulation), self);
    };
    type.def_property_readonly(name, get, text);
  };
  add(
      "irradiance", "H, W/m^2, patches x bands", [](Run run) -> auto& { return run.solution.irradiance; });
  add(
      "radiosity", "B, W/m^2, patches x bands", [](Run run) -> auto& { return run.solution.radiosity; });
  add(
      "direct_irradiance", "the part of H straight from lamps, W/m^2",
      [](Run run) -> auto& { return run.solution.direct_irradiance; });
  add(
      "exitance", "E, W/m^2, patches x bands", [](Run run) -> auto& { return run.problem.exitance; });
  add(
      "reflectance", "rho, patches x bands", [](Run run) -> auto& { return run.problem.scattering.reflectance; });
  add(
      "area", "m^2", [](Run run) -> auto& { return run.problem.area; });
  add(
      "vertices", "meters, vertices x 3", [](Run run) -> auto& { return run.mesh.vertices; });
  add(
      "centroid", "meters, patches x 3", [](Run run) -> auto& { return run.mesh.centroid; });
  add(
      "normal", "unit, patches x 3", [](Run run) -> auto& { return run.mesh.normal; });
  add(
      "corners", corners_text, [](Run run) -> auto& { return run.mesh.corners; });
  add(
      "material", "index into Scene.materials", [](Run run) -> auto& { return run.mesh.material; });
  add(
      "polygon", "index into the scene's polygons", [](Run run) -> auto& { return run.mesh.polygon; });
  type.def_property_readonly(
      "error",
      [](const SolvedScene& self) -> py::object {
        const auto& bars = self.simulation.error_bars;
        return bars ? py::object(array_of(bars->total())) : py::none();
      },
      "error bars of H, W/m^2, patches x bands; None without error_bars");
  type.def_property_readonly(
          "luminance",
          [](const SolvedScene& self) {
            return array_of(luminances_of(self, self.simulation.solution.radiosity / std::numbers::pi)).attr("ravel")();
          },
          "cd/m^2")
      .def_property_readonly(
          "illuminance",
          [](const SolvedScene& self) {
            return array_of(luminances_of(self, self.simulation.solution.irradiance)).attr("ravel")();
          },
          "lx")
      .def_property_readonly("size", [](const SolvedScene& self) { return self.simulation.mesh.size(); })
      .def_property_readonly(
          "converged", [](const SolvedScene& self) { return self.simulation.solution.converged; },
          "the solver has reached its tolerance")
      .def_property_readonly("notes", &notes_of, "what is not simulated, and other remarks")
      .def_property_readonly("_warnings", &shortcomings_of)
      .def_property_readonly(
          "solution",
          [](const SolvedPointer& self) { return std::shared_ptr<Solution>(self, &self->simulation.solution); })
      .def_property_readonly("irradiance_address",
                             [](const SolvedScene& self) {
                               return reinterpret_cast<std::uintptr_t>(self.simulation.solution.irradiance.data());
                             })
      .def("report_json", &report_of_run)
      .def("page", &page_of_run)
      .def("write", &write_run, py::arg("file"), "Writes .vtp, .vtu, .ply or .glb.")
      .def("sensors", &sensors_of)
      .def("_picture", &picture_of);
  module.def("solve", &solved, py::arg("scene"), py::arg("arguments"), py::arg("own"), py::arg("changes"),
             py::arg("progress"));
}

}  // namespace patchlight
