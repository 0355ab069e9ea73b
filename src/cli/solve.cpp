#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/output_options.h"
#include "cli/progress.h"
#include "cli/render.h"
#include "cli/solve_input.h"
#include "cli/summary.h"
#include "output/file/whole_file.h"
#include "output/image/write_image.h"
#include "output/plot/write_sensor_map.h"
#include "output/vtk/write_vtk.h"
#include "page/write_page.h"
#include "pipeline/run.h"
#include "plan/check_request.h"
#include "plan/survey.h"
#include "scene/extent.h"
#include "scene/face_tree.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <iostream>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// Views of a solution.
struct Views {
  std::vector<std::filesystem::path> points_outputs;
  SensorView sensors;
  std::optional<Picture> picture;  // for the file, or only for the page
  std::optional<Lightmap> lightmap;
  std::optional<InputError> lightmap_error;
};

struct Results {
  std::shared_ptr<const Scene> scene;
  Simulation simulation;
  Views views;
  std::vector<IterateIrradiance> iterates;
  Report report;
  Provenance provenance;
};

// The iterates of the last three solutions. The written solution may be an earlier one, when the run was stopped or a
// later solution was no better.
class Iterates {
 public:
  explicit Iterates(bool wanted) : wanted_(wanted) {}

  void add(const Progress& progress) {
    if (!wanted_ || !progress.irradiance) return;
    if (progress.iteration->number == 0) {
      if (solutions_.size() == 3) solutions_.pop_front();
      solutions_.emplace_back();
    }
    solutions_.back().emplace_back(progress.irradiance().cast<float>());
  }

  std::vector<IterateIrradiance> of_solution(const Simulation& simulation) {
    if (!wanted_) return {};
    const auto is_it = [&](const std::vector<IterateIrradiance>& iterates) {
      return iterates.size() == simulation.solution.history.size() &&
             iterates.front().rows() == static_cast<Eigen::Index>(simulation.mesh.size()) &&
             iterates.front().cols() == simulation.problem.exitance.cols();
    };
    const auto found = std::find_if(solutions_.rbegin(), solutions_.rend(), is_it);
    if (found == solutions_.rend() && is_solved_by_colours(simulation))
      throw InputError("--series",
                       "colored glazing or mirrors need one solution for each color, but a series shows only one\n"
                       "hint: leave --series out, or give --disable color");
    if (found == solutions_.rend()) throw Canceled();
    return std::move(*found);
  }

 private:
  bool is_solved_by_colours(const Simulation& simulation) const {
    return std::any_of(solutions_.begin(), solutions_.end(), [&](const std::vector<IterateIrradiance>& iterates) {
      return !iterates.empty() && iterates.front().cols() != simulation.problem.exitance.cols();
    });
  }

  bool wanted_;
  std::deque<std::vector<IterateIrradiance>> solutions_;
};

void check_outputs(const SolveArguments& arguments) {
  for (const std::filesystem::path& file : arguments.results) check_writable(file);
  if (!arguments.series.empty()) check_series_writable(arguments.series);
  if (!arguments.lightmap.folder.empty()) check_lightmap_writable(arguments.lightmap.folder);
  for (const auto* file : {&arguments.report, &arguments.page, &arguments.picture.file, &arguments.picture.error_map}) {
    if (!file->empty()) check_writable(*file);
  }
  for (const std::filesystem::path& file : arguments.points_outputs) check_writable(file);
}

// Reads the input and checks everything that could fail only after hours.
SolveInput read(const SolveArguments& arguments, const Observer& observer) {
  if (!observer({.stage = Stage::read})) throw Canceled();
  SolveInput input = read_input(arguments);
  input.scene = with_points(std::move(input.scene), arguments);
  std::vector<OutputFile> outputs = outputs_of(arguments);
  if (!arguments.checkpoint.empty()) outputs.push_back({"--checkpoint", arguments.checkpoint});
  for (const std::filesystem::path& file : points_outputs(arguments, input.scene)) {
    check_writable(file);
    if (arguments.points_outputs.empty()) outputs.push_back({"--points-output", file});
  }
  require_distinct(outputs);
  require_not_read(outputs, input.scene.inputs);
  require_not_read(outputs, given_files(arguments));
  if (const OutputFile lightmap{"--lightmap", arguments.lightmap.folder}; !lightmap.file.empty()) {
    require_not_read_from(lightmap, input.scene.inputs);
    require_not_read_from(lightmap, given_files(arguments));
  }
  check_limits(input.scene);
  if (arguments.map.quantity == MapQuantity::daylight_factor && !has_daylight_factors(input.scene))
    throw InputError("--map",
                     "daylight factors need a CIE overcast sky as the only light\n"
                     "hint: --sky overcast:10000lx, or --map illuminance");
  require_camera_in_reach(arguments.picture, input.scene);
  return input;
}

// Computes sensors, images and the lightmap, in this order, until a signal, and adds their costs to the simulation.
Views views_of(const Scene& scene, Simulation& simulation, const SolveArguments& arguments, const Observer& observer) {
  Views views;
  StageClock looking;
  try {
    if (!scene.sensors.empty()) {
      std::vector<std::filesystem::path> files = points_outputs(arguments, scene);
      views.sensors = read_sensors(simulation, observer);
      views.points_outputs = std::move(files);
      looking.finish(Stage::gather);
    }
    if (!arguments.picture.file.empty() || !arguments.page.empty()) {
      views.picture = make_picture(arguments.picture, scene, simulation, observer);
      if (views.picture->unfinished && !arguments.picture.file.empty()) simulation.unfinished = true;
      looking.finish(Stage::render);
    }
    if (!arguments.lightmap.folder.empty()) {
      views.lightmap = bake_lightmap(simulation, arguments.lightmap.options, observer);
      looking.finish(Stage::render);
    }
  } catch (const Canceled&) {
    simulation.unfinished = true;
  } catch (const InputError& error) {
    if (arguments.lightmap.folder.empty()) throw;
    views.lightmap_error = error;  // the other views are kept
  }
  simulation.costs.insert(simulation.costs.end(), looking.costs().begin(), looking.costs().end());
  return views;
}

Report report_on(const Results& results, const Request& request) {
  const SensorView& sensors = results.views.sensors;
  const bool are_read = sensors.readings.irradiance.size() > 0;  // false if the run was stopped before
  return report_of(*results.scene, request, results.simulation,
                   are_read ? sensor_facts(results.scene->sensors, sensors.readings, sensors.warnings) : SensorFacts{});
}

// The expected share of the first mesh in the work on all meshes.
double share_of_first_mesh(const AccuracyOptions& accuracy) {
  if (refines(accuracy)) return 0.2;
  return accuracy.local_cuts ? 0.5 : 1;
}

// Prints a line for each solved mesh, unless the run is quiet.
LookAt tell_of_meshes(const SolveArguments& arguments, ProgressLine& line) {
  if (arguments.quiet) return {};
  return [&line](const Simulation& simulation) {
    line.hide();
    const std::vector<AccuracyStep>& meshes = simulation.accuracy;
    print_message(("mesh " + std::to_string(meshes.size())).c_str(), step_in_words(meshes.back()));
    line.next_mesh(meshes.back().total, simulation.plan.accuracy.relative_error);
  };
}

// The stages of a run, the meshes and then the views.
void expect_stages(const SolveArguments& arguments, const Request& request, const Scene& scene, ProgressLine& line) {
  std::vector<Stage> stages = {Stage::read,    Stage::plan,         Stage::mesh, Stage::form_factors,
                               Stage::closure, Stage::direct_light, Stage::solve};
  const AccuracyOptions& accuracy = request.accuracy;
  if (accuracy.error_bars || accuracy.cheap_error_bars || refines(accuracy)) stages.push_back(Stage::error_bars);
  if (!scene.sensors.empty()) stages.push_back(Stage::gather);
  if (!arguments.picture.file.empty() || !arguments.page.empty() || !arguments.lightmap.folder.empty())
    stages.push_back(Stage::render);
  line.expect(std::move(stages), share_of_first_mesh(accuracy), accuracy.seconds);
}

// Solves the scene.
Results solved(const SolveArguments& arguments, Checkpoint& checkpoint, ProgressLine& line, const Observer& observer) {
  Results results;
  Simulation& simulation = results.simulation;

  StageClock reading;
  SolveInput input = read(arguments, observer);
  results.scene = std::make_shared<const Scene>(std::move(input.scene));
  reading.finish(Stage::read);
  line.hide();
  print_scene_warnings(*results.scene);
  if (!arguments.quiet)
    for (const Diagnostic& problem : problems_with_sensors(*results.scene)) print_diagnostic("note", problem);

  Iterates iterates(!arguments.series.empty());
  const auto observed = [&](const Progress& progress) {
    iterates.add(progress);
    return observer(progress);
  };
  Steps with{.exchange = input.exchange, .ray_exchange = input.ray_exchange};
  if (!arguments.discards) with.keeps_unfinished = keep_what_is_there;
  with.look = tell_of_meshes(arguments, line);
  with.row_blocks = checkpoint.blocks({*results.scene, input.request.effects});
  expect_stages(arguments, input.request, *results.scene, line);
  simulation = with_option_names(simulate(results.scene, input.request, observed, with));
  if (!may_write_what_is_there()) throw Canceled();
  results.iterates = iterates.of_solution(simulation);
  simulation.costs.insert(simulation.costs.begin(), reading.costs().begin(), reading.costs().end());
  results.provenance = {.command_line = arguments.command_line,
                        .exposure = exposure_of(simulation),
                        .scene_hash = scene_hash(*results.scene)};
  return results;
}

// Writes a table, or maps with the section lines of the model in each grid plane.
void write_readings(const std::filesystem::path& file, const Results& results, MapOptions map) {
  const Readings& readings = results.views.sensors.readings;
  if (file.extension() != ".svg" && file.extension() != ".png")
    return write_points(file, results.scene->sensors, readings);
  map.up = results.scene->up;
  map.north = results.scene->north;
  map.north_known = results.scene->sun || results.scene->sky;
  for (const SensorGroup& group : results.scene->sensors) {
    map.sections.emplace_back();
    if (group.sensors.empty()) continue;
    map.sections.back() = section_of(*results.scene, group.sensors[0].point, group.sensors[0].normal);
  }
  write_sensor_map(file, results.scene->sensors, readings, map);
}

Page page_of_run(const Results& results, const SolvedSurface& surface) {
  const Views& views = results.views;
  Page page{.scene = *results.scene, .provenance = results.provenance, .surface = &surface, .report = &results.report};
  if (views.sensors.readings.irradiance.size() > 0) page.readings = &views.sensors.readings;
  if (views.picture) page.pictures.push_back(&*views.picture);
  return page;
}

// Files that are published together.
class Outputs {
 public:
  template <typename Write>
  void add(const std::filesystem::path& file, const Write& write) {
    if (file.empty()) return;
    files_.write(file, write);
    written_.push_back(file);
  }
  void publish() { files_.publish(); }
  const std::vector<std::filesystem::path>& written() const { return written_; }

 private:
  WholeFiles files_;
  std::vector<std::filesystem::path> written_;
};

bool has_views(const SolveArguments& arguments, const Scene& scene) {
  return !scene.sensors.empty() || !arguments.picture.file.empty() || !arguments.page.empty() ||
         !arguments.lightmap.folder.empty();
}

// Publishes the solution before views are computed, which may take long. Without views it is published together with
// the report and the series.
void write_solution(const SolveArguments& arguments, const Results& results,
                    const std::optional<SolvedSurface>& surface, Outputs& outputs) {
  const WritingGuard guard;
  for (const std::filesystem::path& file : arguments.results)
    outputs.add(file, [&](const auto& to) { write_result(to, *surface, results.provenance); });
  if (has_views(arguments, *results.scene)) outputs.publish();
}

void throw_if_interrupted() {
  if (interrupted()) throw Canceled();
}

// Writes the views, the report and finally the series. The run can be stopped between two files.
void write_views(const SolveArguments& arguments, const Results& results, const std::optional<SolvedSurface>& surface,
                 Outputs& outputs) {
  using Path = std::filesystem::path;
  const WritingGuard guard;
  const auto add = [&](const Path& file, const auto& write) {
    throw_if_interrupted();
    outputs.add(file, write);
  };
  const Views& views = results.views;
  add(arguments.page, [&](const Path& to) { write_page(to, page_of_run(results, *surface)); });
  if (views.picture) {
    add(arguments.picture.file, [&](const Path& to) { write_picture_file(to, *views.picture, *results.scene); });
    add(arguments.picture.error_map, [&](const Path& to) { write_picture_errors(to, *views.picture); });
  }
  for (const Path& file : views.points_outputs)
    add(file, [&](const Path& to) { write_readings(to, results, arguments.map); });
  if (views.lightmap) {
    throw_if_interrupted();
    write_lightmap(arguments.lightmap.folder, *results.scene, results.simulation, *views.lightmap, results.provenance);
  }
  add(arguments.report, [&](const Path& to) { write_report(to, results.report, results.provenance); });
  throw_if_interrupted();
  if (arguments.series.empty()) return outputs.publish();
  write_series(
      arguments.series, *results.scene, results.simulation, results.iterates, results.provenance,
      [](const Progress&) { return !interrupted(); },
      [&](const std::string& collection) {
        add(arguments.series, [&](const Path& to) { write_bytes(to, collection); });
        throw_if_interrupted();
        outputs.publish();
      });
}

// Explains how to compute the errors, after a statement that they are unknown.
std::string how_to_know_errors(const SolveArguments& arguments, bool unfinished) {
  if (unfinished) return "";
  if (!arguments.form_factors.empty())
    return " with stored form factors\nhint: patchlight solve MODEL computes error bars";
  const auto part = part_without_error_bars(arguments.request);
  return part ? " with " + with_option_names(*part) : "\nhint: --error-bars computes it, in about twice the time";
}

// Prints warnings, requested results, files, facts of the run, and notes.
void print_results(const SolveArguments& arguments, const Results& results,
                   const std::vector<std::filesystem::path>& written, const Diagnostics& of_checkpoint) {
  const Diagnostics all = merged({of_checkpoint, notes(*results.scene, results.simulation)});
  print_notes(chosen(all, makes_results_wrong), arguments.quiet);
  for (const Diagnostic& warning : results.views.sensors.warnings) print_diagnostic("warning", warning);
  if (results.views.picture && !arguments.picture.file.empty()) {
    if (const auto missed = missed_error(arguments.picture, *results.views.picture)) print_message("warning", *missed);
  }
  if (arguments.quiet) return;
  std::cout << summary_of_results(results.report, arguments.verbose,
                                  how_to_know_errors(arguments, results.report.solution.unfinished));
  if (results.views.lightmap) std::cout << lightmap_line(*results.views.lightmap, arguments.lightmap);
  std::cout << files_line(written) << summary_of_run(results.report, arguments.verbose) << std::flush;
  const Diagnostics others = chosen(all, [](DiagnosticCode code) { return !makes_results_wrong(code); });
  print_notes(others, false, arguments.verbose ? others.size() : 5);
}

// Warns of results that miss the requested accuracy.
ExitCode exit_code_of(const Report& report) {
  if (report.solution.unfinished) {
    print_message("warning", explain_unfinished(report));
    return interrupted_run();
  }
  if (!report.solution.converged) {
    print_message("warning", explain_not_converged(report));
    return not_converged;
  }
  if (is_accurate(report)) return good;
  print_message("warning", explain_not_accurate(report));
  return not_converged;
}

}  // namespace

ExitCode run(const SolveArguments& arguments) {
  check_outputs(arguments);
  Checkpoint checkpoint = arguments.checkpoint.empty() ? Checkpoint() : Checkpoint(arguments.checkpoint);

  const ThreadLimit limit(arguments.request.resources.threads);
  print_note_on_accuracy(arguments.request, arguments.quiet);
  // 1. Solve, and write the solution
  std::optional<ProgressLine> line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(*line);
  Results results = solved(arguments, checkpoint, *line, observer);
  if (!arguments.discards) keep_what_is_there();
  std::optional<SolvedSurface> surface;
  if (!arguments.results.empty() || !arguments.page.empty())
    surface.emplace(surface_of(results.simulation, arguments.ambient_distance));
  Outputs outputs;
  write_solution(arguments, results, surface, outputs);

  // 2. Compute and write the views
  if (!arguments.discards) keep_what_is_there();
  results.views = views_of(*results.scene, results.simulation, arguments, observer);
  if (!may_write_what_is_there()) throw Canceled();
  results.report = report_on(results, arguments.request);
  line.reset();
  write_views(arguments, results, surface, outputs);
  if (!results.report.solution.unfinished) checkpoint.remove();
  std::vector<std::filesystem::path> written = outputs.written();
  if (results.views.lightmap) written.push_back(arguments.lightmap.folder);
  print_results(arguments, results, written, checkpoint.notes());
  if (results.views.lightmap_error) throw InputError(*results.views.lightmap_error);
  return exit_code_of(results.report);
}

}  // namespace patchlight::cli
