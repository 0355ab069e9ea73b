#include "cli/render.h"

#include "patchlight/base/error.h"
#include "patchlight/views/views.h"

#include "archive/read_solution.h"
#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "cli/distinct_files.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/picture.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/whole_file.h"
#include "page/write_page.h"
#include "render/tone_map.h"
#include "scene/limits.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// "room.png" of the view "desk": "room.desk.png", with what file names do not like as "_".
std::filesystem::path with_view(const std::filesystem::path& file, const std::string& view) {
  if (file.empty()) return file;
  std::string name = view;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == '/' || letter == '\\' || letter == ':'; }, '_');
  return file.parent_path() / (file.stem().string() + '.' + name + file.extension().string());
}

// The pictures that are wanted, one view each.
std::vector<PictureSettings> wanted_pictures(const PictureSettings& settings) {
  if (settings.views.size() < 2) return {settings};
  std::vector<PictureSettings> all;
  for (const std::string& view : settings.views) {
    PictureSettings one = settings;
    one.views = {view};
    one.file = with_view(settings.file, view);
    one.error_map = with_view(settings.error_map, view);
    all.push_back(std::move(one));
  }
  return all;
}

void require_cameras(const std::vector<PictureSettings>& pictures, const Scene& scene) {
  const Reach reach = reach_of(scene);
  for (const PictureSettings& picture : pictures) {
    const std::optional<Camera> camera = camera_for(picture, scene);
    if (!camera) continue;
    require_in_reach(reach, camera->eye, "--camera", "the eye");
    require_in_reach(reach, camera->target, "--camera", "the target");
  }
}

void write_page_of_pictures(const RenderArguments& arguments, const Scene& scene, const Simulation& simulation,
                            const std::vector<Picture>& pictures) {
  const SolvedSurface surface = surface_of(scene, simulation);
  Page page{.scene = scene,
            .provenance = {.command_line = arguments.command_line, .scene_hash = scene_hash(scene)},
            .surface = &surface};
  const Eigen::VectorXd& area = simulation.problem.area;
  page.provenance.exposure = exposure_for(display_radiance(simulation), area, bands_of(scene));
  for (const Picture& picture : pictures) page.pictures.push_back(&picture);
  write_page(arguments.page, page);
}

}  // namespace

ExitCode render(const RenderArguments& arguments) {
  // 1. Refuse what cannot be written, or would be lost
  const std::vector<PictureSettings> wanted = wanted_pictures(arguments.picture);
  for (const PictureSettings& one : wanted) {
    check_writable(one.file);
    if (!one.error_map.empty()) check_writable(one.error_map);
  }
  if (!arguments.page.empty()) check_writable(arguments.page);

  // 2. Read the scene and its solution
  const ThreadLimit limit(arguments.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);
  const Scene scene = read_models(arguments.models, arguments.read, observer);
  check_limits(scene);
  require_cameras(wanted, scene);
  const Simulation simulation = read_solution(arguments.solution, scene);

  // 3. Take the pictures, and write each as soon as it is there
  keep_what_is_there();
  std::vector<std::filesystem::path> written;
  bool unfinished = false;
  std::vector<Picture> taken;
  for (const PictureSettings& one : wanted) {
    if (!may_write_what_is_there() || unfinished) break;
    Picture picture = make_picture(one, scene, simulation, observer);
    unfinished = picture.unfinished;
    if (!may_write_what_is_there()) throw Cancelled();
    const WritingGuard guard;
    write_picture_file(one.file, picture, scene);
    written.push_back(one.file);
    if (!one.error_map.empty()) {
      write_error_map(one.error_map, picture);
      written.push_back(one.error_map);
    }
    if (!arguments.page.empty()) taken.push_back(std::move(picture));
  }
  if (!taken.empty()) {
    const WritingGuard guard;
    write_page_of_pictures(arguments, scene, simulation, taken);
    written.push_back(arguments.page);
  }
  line.hide();
  if (!arguments.quiet) std::cout << files_line(written) << std::flush;
  if (!unfinished) return good;
  print_message("warning", "interrupted; the last picture is unfinished, with larger errors than asked for");
  return interrupted_run;
}

}  // namespace patchlight::cli
