#include "cli/solve.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"
#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "cli/accuracy_options.h"
#include "cli/checkpoint.h"
#include "cli/interrupt.h"
#include "cli/lightmap_options.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/picture.h"
#include "cli/progress.h"
#include "cli/scene_warnings.h"
#include "cli/sensors.h"
#include "cli/solution_options.h"
#include "cli/solve_input.h"
#include "cli/step_in_words.h"
#include "cli/summary.h"
#include "output/whole_file.h"
#include "output/write_bytes.h"
#include "output/write_lightmap.h"
#include "output/write_points.h"
#include "output/write_sensor_map.h"
#include "output/write_series.h"
#include "page/write_page.h"
#include "pipeline/stage_clock.h"
#include "plan/check_request.h"
#include "plan/survey.h"
#include "scene/limits.h"
#include "scene/section.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// What is looked at of a solution.
struct Views {
  std::vector<std::filesystem::path> points_outputs;
  SensorView sensors;
  std::optional<Picture> picture;
  std::optional<Picture> page_picture;  // where a page is wanted and no picture
  std::optional<Lightmap> lightmap;
  std::optional<InputError> lightmap_error;
};

// All that is computed before anything is written.
struct Results {
  Scene scene;
  Simulation simulation;
  Views views;
  std::vector<IterateIrradiance> iterates;
  Report report;
  Provenance provenance;
};

// The iterates of the last solutions: that which is written need not be the last, when the run was stopped or a second
// solution was no better.
class Iterates {
 public:
  explicit Iterates(bool wanted) : wanted_(wanted) {}

  void add(const Progress& progress) {
    if (!wanted_ || !progress.irradiance) return;
    if (progress.iteration->number == 0) {
      if (solutions_.size() == most) solutions_.pop_front();
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
                       "found clear faces or mirrors of several colours, whose light is solved colour by colour; a "
                       "series needs one solution: leave it out, or give --skip colour");
    if (found == solutions_.rend()) throw Cancelled();
    return std::move(*found);
  }

 private:
  bool is_solved_by_colours(const Simulation& simulation) const {
    return std::any_of(solutions_.begin(), solutions_.end(), [&](const std::vector<IterateIrradiance>& iterates) {
      return !iterates.empty() && iterates.front().cols() != simulation.problem.exitance.cols();
    });
  }

  static constexpr std::size_t most = 3;
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

// Reads what is solved, and checks what could be refused only after hours.
SolveInput read(const SolveArguments& arguments, const Observer& observer) {
  if (!observer({.stage = Stage::read})) throw Cancelled();
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
                     "found daylight-factor, which is of a CIE overcast sky as the only light; expected one, as "
                     "in --sky overcast:10000lx, or --map illuminance");
  if (const std::optional<Camera> camera = camera_for(arguments.picture, input.scene)) {
    const Reach reach = reach_of(input.scene);
    require_in_reach(reach, camera->eye, "--camera", "the eye");
    require_in_reach(reach, camera->target, "--camera", "the target");
  }
  return input;
}

// Irradiance at sensors, and the picture; the simulation's costs get theirs.
Views views_of(const Scene& scene, Simulation& simulation, const SolveArguments& arguments, const Observer& observer) {
  Views views;
  StageClock looking;
  if (!scene.sensors.empty()) {
    views.points_outputs = points_outputs(arguments, scene);
    views.sensors = read_sensors(scene, simulation, observer);
    looking.finish(Stage::gather);
  }
  if (!arguments.picture.file.empty()) {
    views.picture = make_picture(arguments.picture, scene, simulation, observer);
    if (views.picture->unfinished) simulation.unfinished = true;
    looking.finish(Stage::render);
  } else if (!arguments.page.empty()) {
    views.page_picture = make_picture(arguments.picture, scene, simulation, observer);
    looking.finish(Stage::render);
  }
  if (!arguments.lightmap.folder.empty()) {
    try {
      views.lightmap = bake_lightmap(scene, simulation, arguments.lightmap.options, observer);
    } catch (const InputError& error) {
      views.lightmap_error = error;  // the solution is not lost for it
    } catch (const Cancelled&) {
      simulation.unfinished = true;
    }
    looking.finish(Stage::render);
  }
  simulation.costs.insert(simulation.costs.end(), looking.costs().begin(), looking.costs().end());
  return views;
}

// Without them when the run is stopped meanwhile, so that the solution is not lost.
Results with_views(Results results, const SolveArguments& arguments, const Observer& observer) {
  if (!arguments.discards) keep_what_is_there();
  try {
    results.views = views_of(results.scene, results.simulation, arguments, observer);
  } catch (const Cancelled&) {
    results.simulation.unfinished = true;
  }
  if (!may_write_what_is_there()) throw Cancelled();
  return results;
}

// Tells of each mesh as soon as it is solved, unless the run is quiet.
LookAt tell_of_meshes(const SolveArguments& arguments, ProgressLine& line) {
  if (arguments.verbosity == Verbosity::quiet) return {};
  return [&line](const Simulation& simulation) {
    line.hide();
    const std::vector<AccuracyStep>& meshes = simulation.accuracy;
    print_message(("mesh " + std::to_string(meshes.size())).c_str(), step_in_words(meshes.back()));
  };
}

// Before it begins.
void tell_of_long_work(const Scene& scene, const SolveArguments& arguments, ProgressLine& line) {
  if (arguments.verbosity == Verbosity::quiet) return;
  line.hide();
  for (const Problem& problem : problems_with_sensors(scene)) print_message("note", problem.what);
}

Results compute(const SolveArguments& arguments, Checkpoint& checkpoint, ProgressLine& line) {
  const Observer observer = observer_on(line);
  Results results;
  Simulation& simulation = results.simulation;

  // 1. Read the scene and the points
  StageClock reading;
  SolveInput input = read(arguments, observer);
  results.scene = std::move(input.scene);
  reading.finish(Stage::read);
  line.hide();
  print_scene_warnings(results.scene);
  tell_of_long_work(results.scene, arguments, line);

  // 2. Solve
  Iterates iterates(!arguments.series.empty());
  const auto observed = [&](const Progress& progress) {
    iterates.add(progress);
    return observer(progress);
  };
  Steps with{.exchange = input.exchange, .ray_exchange = input.ray_exchange};
  if (!arguments.discards) with.keeps_unfinished = keep_what_is_there;
  with.look = tell_of_meshes(arguments, line);
  with.row_blocks = checkpoint.blocks({results.scene, input.request.effects});
  simulation = simulate(results.scene, input.request, observed, with);
  // Who stops a run that comes to its end all the same wants what it has.
  if (!may_write_what_is_there()) throw Cancelled();
  results.iterates = iterates.of_solution(simulation);
  simulation.costs.insert(simulation.costs.begin(), reading.costs().begin(), reading.costs().end());
  results.provenance = {.command_line = arguments.command_line,
                        .exposure = exposure_of(results.scene, simulation),
                        .scene_hash = scene_hash(results.scene)};

  // 3. Look at the solution, and tell of it
  results = with_views(std::move(results), arguments, observer);
  const SensorView& sensors = results.views.sensors;
  const bool are_read = sensors.readings.irradiance.size() > 0;  // not where the run was stopped before
  results.report =
      report_of(results.scene, arguments.request, simulation,
                are_read ? sensor_facts(results.scene.sensors, sensors.readings, sensors.warnings) : SensorFacts{});
  return results;
}

// What the plane of a grid cuts of the model.
std::vector<std::array<Point, 2>> section_at(const SensorGroup& group, const Scene& scene) {
  if (group.sensors.empty()) return {};
  return section_of(scene, group.sensors[0].point, group.sensors[0].normal);
}

// As a table, or as maps.
void write_readings(const std::filesystem::path& file, const Results& results, MapOptions map) {
  const Readings& readings = results.views.sensors.readings;
  if (file.extension() != ".svg" && file.extension() != ".png")
    return write_points(file, results.scene.sensors, readings);
  map.up = results.scene.up;
  map.north = results.scene.north;
  map.north_known = results.scene.sun || results.scene.sky;
  for (const SensorGroup& group : results.scene.sensors) map.sections.push_back(section_at(group, results.scene));
  write_sensor_map(file, results.scene.sensors, readings, map);
}

Page page_of_run(const Results& results, const SolvedSurface& surface) {
  const Views& views = results.views;
  Page page{.scene = results.scene, .provenance = results.provenance, .surface = &surface, .report = &results.report};
  if (views.sensors.readings.irradiance.size() > 0) page.readings = &views.sensors.readings;
  if (views.picture) page.pictures.push_back(&*views.picture);
  if (views.page_picture) page.pictures.push_back(&*views.page_picture);
  return page;
}

// Writes one file after the other, the series last, and lets them appear together; the run can be stopped between two.
// Returns the files written.
std::vector<std::filesystem::path> write(const SolveArguments& arguments, const Results& results) {
  std::vector<std::filesystem::path> written;
  WholeFiles files;
  const auto write_to = [&](const std::filesystem::path& file, const auto& write_it) {
    if (file.empty()) return;
    if (interrupted()) throw Cancelled();
    files.write(file, write_it);
    written.push_back(file);
  };
  using Path = std::filesystem::path;
  const WritingGuard guard;
  if (!arguments.results.empty() || !arguments.page.empty()) {
    const SolvedSurface surface = surface_of(results.scene, results.simulation, arguments.ambient_distance);
    write_to(arguments.page, [&](const Path& to) { write_page(to, page_of_run(results, surface)); });
    for (const Path& file : arguments.results) {
      write_to(file, [&](const Path& to) { write_result(to, surface, results.provenance); });
    }
  }
  const Views& views = results.views;
  if (views.picture) {
    write_to(arguments.picture.file, [&](const Path& to) { write_picture_file(to, *views.picture, results.scene); });
    write_to(arguments.picture.error_map, [&](const Path& to) { write_error_map(to, *views.picture); });
  }
  for (const Path& file : views.points_outputs) {
    write_to(file, [&](const Path& to) { write_readings(to, results, arguments.map); });
  }
  if (views.lightmap) {
    if (interrupted()) throw Cancelled();
    write_lightmap(arguments.lightmap.folder, results.scene, results.simulation, *views.lightmap, results.provenance);
    written.push_back(arguments.lightmap.folder);
  }
  write_to(arguments.report, [&](const Path& to) { write_report(to, results.report, results.provenance); });
  if (arguments.series.empty()) {
    if (interrupted()) throw Cancelled();
    files.publish();
    return written;
  }
  write_series(
      arguments.series, results.scene, results.simulation, results.iterates, results.provenance,
      [](const Progress&) { return !interrupted(); },
      [&](const std::string& collection) {
        write_to(arguments.series, [&](const Path& to) { write_bytes(to, collection); });
        files.publish();
      });
  return written;
}

// Said of a result without error bars.
std::string how_to_know_errors(const SolveArguments& arguments, bool unfinished) {
  if (unfinished) return "";
  if (!arguments.form_factors.empty())
    return " with stored form factors; patchlight solve MODEL tells the error for as many --patches, and form "
           "factors of more --patches err less";
  const auto part = part_without_error_bars(arguments.request);
  return part ? " with " + with_option_names(*part) : "; --error-bars tells them, in about twice the time";
}

}  // namespace

ExitCode solve(const SolveArguments& arguments) {
  check_outputs(arguments);
  Checkpoint checkpoint = arguments.checkpoint.empty() ? Checkpoint() : Checkpoint(arguments.checkpoint);

  const ThreadLimit limit(arguments.request.resources.threads);
  const bool quiet = arguments.verbosity == Verbosity::quiet;
  if (const auto note = note_on_accuracy(arguments.request); note && !quiet) print_message("note", *note);
  const Results results = [&] {
    ProgressLine line(progress_shown(quiet));
    return compute(arguments, checkpoint, line);
  }();
  const std::vector<std::filesystem::path> written = write(arguments, results);
  if (!results.report.solution.unfinished) checkpoint.remove();

  if (const std::string note = checkpoint.note(); !note.empty() && !quiet) print_message("note", note);
  print_notes(notes(results.scene, results.simulation), quiet);
  for (const std::string& warning : results.views.sensors.warnings) print_message("warning", warning);
  if (results.views.picture) {
    if (const auto missed = missed_error(arguments.picture, *results.views.picture)) print_message("warning", *missed);
  }
  if (!quiet) {
    std::cout << summary(results.report, arguments.verbosity == Verbosity::verbose,
                         how_to_know_errors(arguments, results.report.solution.unfinished));
    if (results.views.lightmap) std::cout << lightmap_line(*results.views.lightmap, arguments.lightmap);
    std::cout << files_line(written) << std::flush;
  }
  if (results.views.lightmap_error) throw InputError(*results.views.lightmap_error);
  if (results.report.solution.unfinished) {
    print_message("warning", explain_unfinished(results.report));
    return interrupted_run;
  }
  if (!results.report.solution.converged) {
    print_message("warning", explain_not_converged(results.report));
    return not_converged;
  }
  if (is_accurate(results.report)) return good;
  print_message("warning", explain_not_accurate(results.report));
  return not_converged;
}

}  // namespace patchlight::cli
