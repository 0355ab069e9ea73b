#include "output/report/write_study.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/plot/write_plot.h"
#include "output/report/report_json.h"
#include "output/vtk/write_vtk.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// Keeps the keys in the order in which they are set. Numbers that are not finite are written as null.
using Json = nlohmann::ordered_json;

// A table in CSV, whose columns are the keys of its rows.
std::string table(const std::vector<Json>& rows) {
  const auto cell = [](const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return std::string(value.get<bool>() ? "1" : "0");
    return csv_cell(value.get<double>());
  };
  std::string names, lines;
  for (const Json& row : rows) {
    std::string keys, values;
    for (const auto& [name, value] : row.items()) {
      keys.append(keys.empty() ? 0 : 1, ',').append(name);
      values.append(values.empty() ? 0 : 1, ',').append(cell(value));
    }
    names = keys;
    lines += values + '\n';
  }
  return names + '\n' + lines;
}

constexpr std::array<const char*, 2> plot_extensions = {".svg", ".png"};

void write_plots(const fs::path& folder, const std::string& name, const Plot& plot) {
  for (const char* extension : plot_extensions) write_plot(folder / (name + extension), plot);
}

constexpr const char* comparison_kind = "patchlight comparison of solvers";
constexpr const char* comparison_facts_file = "compare.json";
constexpr const char* comparison_table_file = "compare.csv";
constexpr const char* history_file = "history.csv";

// A measure of cost that the error is drawn against.
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
      {"error_by_second", "seconds; without assembly, on demand with the rows",
       [](const SolverRun& run, const Iteration& iteration) { return seconds_of(run, iteration); }}};
}

Json run_facts(const SolverRun& run, PatchIndex patches) {
  const Iteration& last = run.solution.history.back();
  Json facts;
  facts["solver"] = name_of(run.contestant);
  facts["reached"] = run.solution.converged;
  facts["iterations"] = iterations_of(run, last, patches);
  facts["applications"] = last.work;
  facts["seconds"] = run.seconds;
  facts["seconds_with_assembly"] = run.seconds + run.assembly_seconds;
  facts["cpu_seconds"] = run.cpu_seconds;
  facts["true_error"] = last.true_error;
  facts["error_bound"] = last.error_bound;
  facts["rate"] = run.rate;
  return facts;
}

Json iteration_facts(const SolverRun& run, const Iteration& iteration, PatchIndex patches) {
  return {{"iteration", iterations_of(run, iteration, patches)},
          {"applications", iteration.work},
          {"seconds", seconds_of(run, iteration)},
          {"relative_residual", iteration.relative_residual},
          {"error_bound", iteration.error_bound},
          {"true_error", iteration.true_error}};
}

std::string table(const Comparison& comparison) {
  std::vector<Json> rows;
  for (const SolverRun& run : comparison.runs) rows.push_back(run_facts(run, comparison.simulation.mesh.size()));
  return table(rows);
}

std::string histories(const Comparison& comparison) {
  std::vector<Json> rows;
  for (const SolverRun& run : comparison.runs) {
    for (const Iteration& iteration : run.solution.history) {
      Json& row = rows.emplace_back(Json{{"solver", name_of(run.contestant)}});
      row.update(iteration_facts(run, iteration, comparison.simulation.mesh.size()));
    }
  }
  return table(rows);
}

Json run_part(const SolverRun& run, PatchIndex patches) {
  Json part = run_facts(run, patches);
  part["history"] = Json::array();
  for (const Iteration& iteration : run.solution.history)
    part["history"].push_back(iteration_facts(run, iteration, patches));
  return part;
}

// On a linear axis an error that falls by a factor with each iteration is a straight line; one axis for runs of very
// different lengths has to be logarithmic.
Scale scale_for(const Comparison& comparison, const Abscissa& abscissa) {
  double least = 0;
  double greatest = 0;
  for (const SolverRun& run : comparison.runs) {
    const double end = abscissa.value(run, run.solution.history.back());
    if (!run.solution.converged || !(end > 0)) continue;
    least = least == 0 ? end : std::min(least, end);
    greatest = std::max(greatest, end);
  }
  return greatest > 20 * least ? Scale::logarithmic : Scale::linear;
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
  write_plots(folder, abscissa.file, plot);
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
    for (const char* extension : plot_extensions) names.push_back(std::string(abscissa.file) + extension);
  }
  for (const Contestant& contestant : all_contestants()) {
    names.push_back(name_of(contestant) + ".pvd");
    names.push_back(name_of(contestant) + "_series");
  }
  return holds_result(folder, {comparison_facts_file, comparison_kind, names});
}

constexpr const char* study_kind = "patchlight study of accuracy and cost";
constexpr const char* study_facts_file = "study.json";
constexpr const char* study_table_file = "study.csv";

// The stages that a setting consists of.
constexpr Stage stages[] = {Stage::plan,    Stage::mesh,  Stage::form_factors,
                            Stage::closure, Stage::solve, Stage::error_bars};

// "form_factors"
std::string key_of(Stage stage) {
  std::string key = name_of(stage);
  std::replace(key.begin(), key.end(), ' ', '_');
  return key;
}

StageCost cost_of(const StudySetting& setting, Stage stage) {
  const auto cost = std::find_if(setting.costs.begin(), setting.costs.end(),
                                 [stage](const StageCost& one) { return one.stage == stage; });
  return cost == setting.costs.end() ? StageCost{stage} : *cost;
}

// The values of a setting, by the names they have in the table and in the facts.
Json row_of(const StudySweep& sweep, const StudySetting& setting) {
  Json row;
  row["sweep"] = sweep.name;
  row["patches"] = setting.patches;
  row["estimator"] = name_of(setting.estimator);
  row["samples"] = setting.samples;
  row["tolerance"] = setting.tolerance;
  row["seconds"] = seconds_of(setting);
  row["cpu_seconds"] = cpu_seconds_of(setting);
  for (const Stage stage : stages) row[key_of(stage) + "_seconds"] = cost_of(setting, stage).seconds;
  for (const Stage stage : stages) row[key_of(stage) + "_cpu_seconds"] = cost_of(setting, stage).cpu_seconds;
  row["matrix_bytes"] = setting.matrix_bytes;
  row["error"] = setting.error;
  row["display_error"] = setting.display_error;
  row["own_error"] = setting.own_error;
  row["order"] = setting.order;
  row["on_time_front"] = setting.on_time_front;
  row["on_memory_front"] = setting.on_memory_front;
  return row;
}

std::string table(const Study& study) {
  std::vector<Json> rows;
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) rows.push_back(row_of(sweep, setting));
  }
  return table(rows);
}

const char* name_of(Finding finding) {
  constexpr std::array names = {"interpolated", "at most", "extrapolated", "not reached", "not known"};
  static_assert(names.size() == static_cast<std::size_t>(Finding::not_known) + 1);
  return names.at(static_cast<std::size_t>(finding));
}

Json price_part(double error, const Study& study) {
  const Price price = price_of(error, study);
  const bool known = price.finding != Finding::not_reached && price.finding != Finding::not_known;
  return {
      {"error", error}, {"finding", name_of(price.finding)}, {"cpu_seconds", known ? Json(price.cpu_seconds) : Json()}};
}

// Which value is drawn over which.
struct StudyPlot {
  const char* file;
  const char* x_label;
  const char* y_label;
  std::function<double(const StudySetting&)> x;
  double StudySetting::*y;
  bool StudySetting::*front;  // none: no front is drawn
  std::function<bool(const StudySweep&)> shows;
};

std::vector<StudyPlot> pictures() {
  const auto competes = [](const StudySweep& sweep) { return sweep.competes; };
  const auto is_estimator = [](const StudySweep& sweep) { return !sweep.competes; };
  const auto megabytes = [](const StudySetting& setting) { return setting.matrix_bytes / 1e6; };
  const char* const error = "relative error of the patch means";
  return {{"error_by_cpu_second", "CPU seconds", error, cpu_seconds_of, &StudySetting::error,
           &StudySetting::on_time_front, competes},
          {"error_by_memory", "form factors, MB", error, megabytes, &StudySetting::error,
           &StudySetting::on_memory_front, competes},
          {"display_error_by_cpu_second", "CPU seconds", "relative error of the field, constant on each patch",
           cpu_seconds_of, &StudySetting::display_error, nullptr, competes},
          {"estimators_by_cpu_second", "CPU seconds", "relative error due to the form factors alone", cpu_seconds_of,
           &StudySetting::own_error, nullptr, is_estimator}};
}

Curve front_of(const Study& study, const StudyPlot& picture) {
  Curve front{"Pareto front", {}};
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) {
      if (sweep.competes && setting.*picture.front) front.points.push_back({picture.x(setting), setting.*picture.y});
    }
  }
  std::sort(front.points.begin(), front.points.end());
  return front;
}

void draw(const fs::path& folder, const Scene& scene, const Study& study, const StudyPlot& picture) {
  const std::string bar =
      study.reference.closed_form ? "closed form" : "reference " + std::to_string(study.reference.patches) + " patches";
  Plot plot{fs::path(scene.file).filename().string() + ": " + bar,
            {picture.x_label, Scale::logarithmic},
            {picture.y_label, Scale::logarithmic},
            {}};
  for (const StudySweep& sweep : study.sweeps) {
    if (!picture.shows(sweep)) continue;
    Curve curve{sweep.name, {}};
    for (const StudySetting& setting : sweep.settings) {
      curve.points.push_back({picture.x(setting), setting.*picture.y});
    }
    plot.curves.push_back(std::move(curve));
  }
  if (picture.front != nullptr) plot.curves.push_back(front_of(study, picture));
  write_plots(folder, picture.file, plot);
}

bool is_earlier_study(const fs::path& folder) {
  std::vector<std::string> names = {study_facts_file, study_table_file};
  for (const StudyPlot& picture : pictures()) {
    for (const char* extension : plot_extensions) names.push_back(std::string(picture.file) + extension);
  }
  return holds_result(folder, {study_facts_file, study_kind, names});
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
      if (observer && !observer({.stage = Stage::write, .fraction = fraction})) throw Canceled();
      const SolverRun& run = comparison.runs[k];
      if (run.frames.empty()) continue;
      write_frames(in / (name_of(run.contestant) + ".pvd"), scene, comparison.simulation, run, provenance, observer);
    }
    write_bytes(in / comparison_facts_file, json_text(comparison_json(scene, comparison, provenance)));
  });
}

void check_comparison_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_comparison); }

nlohmann::ordered_json study_json(const Scene& scene, const Study& study, const Provenance& provenance) {
  Json json;
  json["kind"] = study_kind;
  json["version"] = version();
  json["command_line"] = provenance.command_line;
  json["input"] = {{"file", scene.file}, {"sha256", scene.sha256}};
  const StudyReference& reference = study.reference;
  json["reference"] = {{"closed_form", reference.closed_form}, {"patches", reference.patches},
                       {"samples", reference.samples},         {"bar", reference.bar},
                       {"cpu_seconds", reference.cpu_seconds}, {"converged", reference.converged}};
  const ErrorParts& parts = study.parts;
  json["finest_setting"] = {{"error_mesh", parts.mesh},
                            {"error_form_factors", parts.form_factors},
                            {"error_solver", parts.solver},
                            {"worst_place", parts.worst_place},
                            {"worst_share", parts.worst_share}};
  json["settings"] = Json::array();
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) json["settings"].push_back(row_of(sweep, setting));
  }
  json["prices"] = Json::array();
  for (const double error : {0.1, 0.03, 0.01, 0.003, 0.001}) json["prices"].push_back(price_part(error, study));
  json["conclusion"] = conclusion(study);
  return json;
}

void write_study(const fs::path& folder, const Scene& scene, const Study& study, const Provenance& provenance) {
  write_whole_folder(folder, is_earlier_study, [&](const fs::path& in) {
    write_bytes(in / study_table_file, table(study));
    for (const StudyPlot& picture : pictures()) draw(in, scene, study, picture);
    write_bytes(in / study_facts_file, json_text(study_json(scene, study, provenance)));
  });
}

void check_study_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_study); }

}  // namespace patchlight
