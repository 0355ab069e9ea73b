#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/output/write_result.h"

#include "base/parallel.h"
#include "cli/arguments.h"
#include "cli/solve_input.h"
#include "mesh/nested_mesh.h"
#include "output/report/write_checks.h"
#include "pipeline/expected_cost.h"
#include "pipeline/first_mesh.h"
#include "plan/check_request.h"
#include "python/arrays.h"
#include "python/bindings.h"

#include <memory>
#include <pybind11/stl.h>
#include <vector>

namespace patchlight {
namespace {

namespace py = pybind11;

using ScenePointer = std::shared_ptr<Scene>;

// The command line words of each value.
template <class Wanted>
Wanted parsed(const std::vector<std::string>& words) {
  std::vector<const char*> values;
  for (const std::string& word : words) values.push_back(word.c_str());
  cli::Arguments arguments = cli::parse_arguments(static_cast<int>(values.size()), values.data());
  if (auto* found = std::get_if<Wanted>(&arguments)) return std::move(*found);
  throw InputError("keywords", "found a command that is another one");
}

std::vector<double> numbers_of(const Spectrum& spectrum) { return {spectrum.begin(), spectrum.end()}; }

// One number applies to all bands.
Spectrum spectrum_of(const py::object& numbers, Eigen::Index bands) {
  const NumbersIn array(numbers);
  if (array.size() == 1 && array.ndim() == 0) return Spectrum::Constant(bands, *array.data());
  if (array.size() != bands)
    throw InputError("material", "found " + std::to_string(array.size()) +
                                     " numbers; expected one, or one for each of " + std::to_string(bands) + " bands");
  return Eigen::Map<const Spectrum>(array.data(), bands);
}

void bind_spectrum(py::class_<Material>& type, const char* name, Spectrum Material::*member, const char* text) {
  type.def_property(
      name, [member](const Material& material) { return numbers_of(material.*member); },
      [member](Material& material, const py::object& numbers) {
        material.*member = spectrum_of(numbers, material.reflectance.size());
        // A value replaces a texture, like --set.
        if (member != &Material::exitance) material.texture.reset();
      },
      text);
}

void bind_material(py::module_& module) {
  py::class_<Material> type(module, "Material", "A surface; spectra have a value for each band.");
  type.def_readwrite("name", &Material::name);
  bind_spectrum(type, "reflectance", &Material::reflectance, "diffuse, 0 to 1");
  bind_spectrum(type, "exitance", &Material::exitance, "self-emitted, W/m^2: pi times the emitted radiance");
  bind_spectrum(type, "transmittance", &Material::transmittance,
                "direct transmittance at normal incidence, 0 to 1; empty: opaque");
  bind_spectrum(type, "specular_reflectance", &Material::specular_reflectance,
                "specular (mirror) reflectance, 0 to 1; empty: none");
  bind_spectrum(type, "diffuse_transmittance", &Material::diffuse_transmittance,
                "out of the other side, 0 to 1; empty: none");
  type.def_readwrite("index", &Material::index, "of refraction, 1 or more");
  type.def("__repr__", [](const Material& material) { return "<Material " + material.name + ">"; });
}

py::list materials_of(const py::object& self) {
  py::list list;
  for (Material& material : self.cast<ScenePointer>()->materials)
    list.append(py::cast(&material, py::return_value_policy::reference_internal, self));
  return list;
}

py::list problems_of(const Scene& scene) {
  py::list list;
  for (const Diagnostic& problem : scene.diagnostics) {
    if (is_note(problem.code)) continue;
    py::dict entry;
    entry["kind"] = name_of(problem.code);
    entry["severity"] = name_of(severity_of(problem.code));
    entry["makes_results_wrong"] = makes_results_wrong(problem.code);
    entry["count"] = problem.count;
    entry["what"] = problem.text;
    list.append(entry);
  }
  return list;
}

// Passed by value: other threads may change materials meanwhile.
std::string plan_of(Scene scene, const cli::SolveArguments& arguments) {  // NOLINT(performance-unnecessary-value-param)
  const py::gil_scoped_release others;
  const ThreadLimit limit(arguments.request.resources.threads);
  check(arguments.request, scene);
  const Plan plan = make_plan(scene, arguments.request);
  return plan_json(scene, plan, expected_cost(scene, plan, first_mesh(scene, plan).patches));
}

}  // namespace

void bind_scene(py::module_& module) {
  bind_material(module);
  // The dynamic attributes hold the reading options, see scene.py.
  py::class_<Scene, ScenePointer>(module, "Scene", py::dynamic_attr(),
                                  "A model: polygons with materials, in meters. Materials can be changed.")
      .def_property_readonly("materials", &materials_of)
      .def_readonly("groups", &Scene::groups)
      .def_readonly("file", &Scene::file)
      .def_readonly("sha256", &Scene::sha256)
      .def_property_readonly("notes", [](const Scene& scene) { return texts_of(chosen(scene.diagnostics, is_note)); })
      .def_property_readonly("problems", &problems_of)
      .def_property_readonly("polygons", [](const Scene& scene) { return scene.polygons.size(); })
      .def_property_readonly("sensor_groups",
                             [](const Scene& scene) {
                               std::vector<std::string> names;
                               for (const SensorGroup& group : scene.sensors) names.push_back(group.name);
                               return names;
                             })
      .def_property_readonly(
          "vertices", [](const py::object& self) { return array_over(self.cast<ScenePointer>()->vertices, self); })
      .def("copy", [](const Scene& scene) { return std::make_shared<Scene>(scene); })
      .def(
          "check", [](const Scene& scene) { check(scene); }, "Raises InputError for what cannot be solved.");
  py::class_<cli::SolveArguments>(module, "Arguments")
      .def_readwrite("command_line", &cli::SolveArguments::command_line);
  module.def("parse", &parsed<cli::SolveArguments>);
  module.def("help", [](const std::string& command) {
    return parsed<cli::Information>({"patchlight", command, "--help"}).text;
  });
  module.def("version", &version);
  module.def("read", [](const cli::SolveArguments& arguments) {
    const py::gil_scoped_release others;
    return std::make_shared<Scene>(cli::with_points(read_scene(arguments.models, arguments.read), arguments));
  });
  module.def("plan", &plan_of);
  py::list solvers;
  for (const Solver solver : all_solvers()) solvers.append(name_of(solver));
  module.attr("solvers") = solvers;
}

}  // namespace patchlight
