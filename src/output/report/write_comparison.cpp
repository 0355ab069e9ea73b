#include "output/report/write_comparison.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/plot/write_plot.h"
#include "output/vtk/write_vtk.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// Keeps the keys in the order in which they are set. Numbers that are not finite are written as null.
using Json = nlohmann::ordered_json;

constexpr const char* comparison_kind = "patchlight comparison of solvers";
constexpr const char* comparison_facts_file = "compare.json";
constexpr const char* comparison_table_file = "compare.csv";
constexpr const char* history_file = "history.csv";

// What the error is drawn against.
struct Abscissa {
  const char* file;
  const char* label;
  std::function<double(const SolverRun&, const Iteration&)> value;
};

std::vector<Abscissa> abscissas(PatchIndex patches) {
  return {
      {"error_by_iteration", "iterations; for what shoots, shots / patches",
       [patches](const SolverRun& run, const Iteration& iteration) { return iterations_of(run, iteration, patches); }},
      {"error_by_application", "operator applications",
       [](const SolverRun&, const Iteration& iteration) { return iteration.work; }},
      {"error_by_second", "seconds; without assembly, on demand with the rows", seconds_of}};
}

std::string row(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& text : fields) line += (&text == &fields.front() ? "" : ",") + text;
  return line + '\n';
}

std::string table(const Comparison& comparison) {
  std::string text =
      "solver,reached,iterations,applications,seconds,seconds_with_assembly,cpu_seconds,true_error,error_bound,rate\n";
  for (const SolverRun& run : comparison.runs) {
    const Iteration& last = run.solution.history.back();
    text += row({name_of(run.contestant), run.solution.converged ? "1" : "0",
                 csv_cell(iterations_of(run, last, comparison.simulation.mesh.size())), csv_cell(last.work),
                 csv_cell(run.seconds), csv_cell(run.seconds + run.assembly_seconds), csv_cell(run.cpu_seconds),
                 csv_cell(last.true_error), csv_cell(last.error_bound), csv_cell(run.rate)});
  }
  return text;
}

std::string histories(const Comparison& comparison) {
  std::string text = "solver,iteration,applications,seconds,relative_residual,error_bound,true_error\n";
  for (const SolverRun& run : comparison.runs) {
    for (const Iteration& iteration : run.solution.history) {
      text +=
          row({name_of(run.contestant), csv_cell(iterations_of(run, iteration, comparison.simulation.mesh.size())),
               csv_cell(iteration.work), csv_cell(seconds_of(run, iteration)), csv_cell(iteration.relative_residual),
               csv_cell(iteration.error_bound), csv_cell(iteration.true_error)});
    }
  }
  return text;
}

Json run_part(const SolverRun& run, PatchIndex patches) {
  const Iteration& last = run.solution.history.back();
  Json part;
  part["solver"] = name_of(run.contestant);
  part["reached"] = run.solution.converged;
  part["iterations"] = iterations_of(run, last, patches);
  part["applications"] = last.work;
  part["seconds"] = run.seconds;
  part["seconds_with_assembly"] = run.seconds + run.assembly_seconds;
  part["cpu_seconds"] = run.cpu_seconds;
  part["true_error"] = last.true_error;
  part["error_bound"] = last.error_bound;
  part["rate"] = run.rate;
  part["history"] = Json::array();
  for (const Iteration& iteration : run.solution.history) {
    part["history"].push_back({{"iteration", iterations_of(run, iteration, patches)},
                               {"applications", iteration.work},
                               {"seconds", seconds_of(run, iteration)},
                               {"relative_residual", iteration.relative_residual},
                               {"error_bound", iteration.error_bound},
                               {"true_error", iteration.true_error}});
  }
  return part;
}

}  // namespace

nlohmann::ordered_json comparison_json(const Scene& scene, const Comparison& comparison, const Provenance& provenance) {
  const Simulation& simulation = comparison.simulation;
  Json json;
  json["kind"] = comparison_kind;
  json["version"] = version();
  json["command_line"] = provenance.command_line;
  json["input"] = {{"file", scene.file}, {"sha256", scene.sha256}};
  json["patches"] = simulation.mesh.size();
  json["bands"] = simulation.problem.exitance.cols();
  json["highest_reflectance"] = simulation.problem.scattering.reflectance.maxCoeff();
  json["closure"] = simulation.transport.closure;
  json["reference_relative_residual"] = comparison.reference_residual;
  json["spectral_radius"] = comparison.spectral_radius;
  json["spectral_radius_error"] = comparison.spectral_radius_error;
  json["runs"] = Json::array();
  for (const SolverRun& run : comparison.runs) json["runs"].push_back(run_part(run, simulation.mesh.size()));
  return json;
}

namespace {

// On a linear axis an error that falls by a factor with each iteration is a straight line; one axis for runs of very
// different lengths has to be logarithmic.
Scale scale_for(const Comparison& comparison, const Abscissa& abscissa) {
  constexpr double most = 20;
  double least = 0;
  double greatest = 0;
  for (const SolverRun& run : comparison.runs) {
    const double end = abscissa.value(run, run.solution.history.back());
    if (!run.solution.converged || !(end > 0)) continue;
    least = least == 0 ? end : std::min(least, end);
    greatest = std::max(greatest, end);
  }
  return greatest > most * least ? Scale::logarithmic : Scale::linear;
}

void draw(const fs::path& folder, const Scene& scene, const Comparison& comparison, const Abscissa& abscissa) {
  Plot plot{
      fs::path(scene.file).filename().string() + ": " + std::to_string(comparison.simulation.mesh.size()) + " patches",
      {abscissa.label, scale_for(comparison, abscissa)},
      {"relative error of the reflected light", Scale::logarithmic},
      {}};
  for (const SolverRun& run : comparison.runs) {
    Curve curve{name_of(run.contestant), {}};
    for (const Iteration& iteration : run.solution.history) {
      curve.points.push_back({abscissa.value(run, iteration), iteration.true_error});
    }
    plot.curves.push_back(std::move(curve));
  }
  for (const char* extension : {".svg", ".png"}) write_plot(folder / (std::string(abscissa.file) + extension), plot);
}

void write_frames(const fs::path& pvd, const Scene& scene, Simulation simulation, const SolverRun& run,
                  const Provenance& provenance, const Observer& observer) {
  std::vector<IterateIrradiance> iterates;
  simulation.solution = run.solution;
  simulation.solution.history.clear();
  for (const Frame& frame : run.frames) {
    simulation.solution.history.push_back(frame.iteration);
    iterates.push_back(frame.irradiance);
  }
  write_series(pvd, scene, simulation, iterates, provenance, observer);
}

bool is_earlier_comparison(const fs::path& folder) {
  std::vector<std::string> names = {comparison_facts_file, comparison_table_file, history_file};
  for (const Abscissa& abscissa : abscissas(1)) {
    for (const char* extension : {".svg", ".png"}) names.push_back(std::string(abscissa.file) + extension);
  }
  for (const Contestant& contestant : all_contestants()) {
    names.push_back(name_of(contestant) + ".pvd");
    names.push_back(name_of(contestant) + "_series");
  }
  return holds_result(folder, {comparison_facts_file, comparison_kind, names});
}

}  // namespace

double iterations_of(const SolverRun& run, const Iteration& iteration, PatchIndex patches) {
  return is_shooting(run.contestant.solver) ? static_cast<double>(iteration.number) / patches : iteration.number;
}

double seconds_of(const SolverRun& run, const Iteration& iteration) {
  return iteration.seconds + (keeps_entries(run.contestant.storage) ? 0 : run.assembly_seconds);
}

void write_comparison(const fs::path& folder, const Scene& scene, const Comparison& comparison,
                      const Provenance& provenance, const Observer& observer) {
  write_whole_folder(folder, is_earlier_comparison, [&](const fs::path& in) {
    write_bytes(in / comparison_table_file, table(comparison));
    write_bytes(in / history_file, histories(comparison));
    for (const Abscissa& abscissa : abscissas(comparison.simulation.mesh.size())) draw(in, scene, comparison, abscissa);
    for (std::size_t k = 0; k < comparison.runs.size(); ++k) {
      const double fraction = static_cast<double>(k) / static_cast<double>(comparison.runs.size());
      if (observer && !observer({.stage = Stage::write, .fraction = fraction})) throw Cancelled();
      const SolverRun& run = comparison.runs[k];
      if (run.frames.empty()) continue;
      write_frames(in / (name_of(run.contestant) + ".pvd"), scene, comparison.simulation, run, provenance, observer);
    }
    write_bytes(
        in / comparison_facts_file,
        comparison_json(scene, comparison, provenance).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  });
}

void check_comparison_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_comparison); }

}  // namespace patchlight
