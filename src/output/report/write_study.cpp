#include "output/report/write_study.h"

#include "output/file/whole_file.h"
#include "output/plot/write_plot.h"
#include "study/study.h"

#include <algorithm>
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

std::string cell_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  return csv_cell(value.get<double>());
}

std::string table(const Study& study) {
  std::vector<std::string> lines{""};
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) {
      std::string names, values;
      const Json row = row_of(sweep, setting);
      for (const auto& [name, value] : row.items()) {
        names.append(names.empty() ? 0 : 1, ',').append(name);
        values.append(values.empty() ? 0 : 1, ',').append(cell_of(value));
      }
      lines.front() = names;
      lines.push_back(values);
    }
  }
  std::string text;
  for (const std::string& line : lines) text.append(line).append(1, '\n');
  return text;
}

const char* name_of(Finding finding) {
  switch (finding) {
    case Finding::interpolated:
      return "interpolated";
    case Finding::at_most:
      return "at most";
    case Finding::extrapolated:
      return "extrapolated";
    case Finding::not_reached:
      return "not reached";
    case Finding::not_known:
      return "not known";
  }
  return "";
}

Json price_part(double error, const Study& study) {
  const Price price = price_of(error, study);
  const bool known = price.finding != Finding::not_reached && price.finding != Finding::not_known;
  return {
      {"error", error}, {"finding", name_of(price.finding)}, {"cpu_seconds", known ? Json(price.cpu_seconds) : Json()}};
}

}  // namespace

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

namespace {

// What is drawn over what.
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
  for (const char* extension : {".svg", ".png"}) write_plot(folder / (std::string(picture.file) + extension), plot);
}

bool is_earlier_study(const fs::path& folder) {
  std::vector<std::string> names = {study_facts_file, study_table_file};
  for (const StudyPlot& picture : pictures()) {
    for (const char* extension : {".svg", ".png"}) names.push_back(std::string(picture.file) + extension);
  }
  return holds_result(folder, {study_facts_file, study_kind, names});
}

}  // namespace

void write_study(const fs::path& folder, const Scene& scene, const Study& study, const Provenance& provenance) {
  write_whole_folder(folder, is_earlier_study, [&](const fs::path& in) {
    write_bytes(in / study_table_file, table(study));
    for (const StudyPlot& picture : pictures()) draw(in, scene, study, picture);
    write_bytes(in / study_facts_file,
                study_json(scene, study, provenance).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  });
}

void check_study_writable(const fs::path& folder) { check_folder_writable(folder, is_earlier_study); }

}  // namespace patchlight
