#include "cli/render.h"

#include "patchlight/base/error.h"

#include "archive/read_solution.h"
#include "base/parallel.h"
#include "cli/distinct_files.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/picture.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/whole_file.h"
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

}  // namespace

ExitCode render(const RenderArguments& arguments) {
  // 1. Refuse what cannot be written, or would be lost
  const std::vector<PictureSettings> wanted = wanted_pictures(arguments.picture);
  for (const PictureSettings& one : wanted) {
    check_writable(one.file);
    if (!one.error_map.empty()) check_writable(one.error_map);
  }

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
  for (const PictureSettings& one : wanted) {
    if (!may_write_what_is_there() || unfinished) break;
    const Picture picture = make_picture(one, scene, simulation, observer);
    unfinished = picture.unfinished;
    if (!may_write_what_is_there()) throw Cancelled();
    const WritingGuard guard;
    write_picture_file(one.file, picture, scene);
    written.push_back(one.file);
    if (one.error_map.empty()) continue;
    write_error_map(one.error_map, picture);
    written.push_back(one.error_map);
  }
  line.hide();
  if (!arguments.quiet) std::cout << files_line(written) << std::flush;
  if (!unfinished) return good;
  print_message("warning", "interrupted; the last picture is unfinished, with larger errors than asked for");
  return interrupted_run;
}

}  // namespace patchlight::cli
