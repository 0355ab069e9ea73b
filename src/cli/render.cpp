#include "cli/render.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"
#include "patchlight/views/views.h"

#include "accuracy/spaces.h"
#include "archive/read_solution.h"
#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/messages.h"
#include "cli/output_options.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "output/file/whole_file.h"
#include "output/image/write_image.h"
#include "page/write_page.h"
#include "pipeline/world.h"
#include "render/camera.h"
#include "scene/extent.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// The requested cameras, else all of the scene.
std::vector<Camera> observers_of(const std::vector<PictureSettings>& wanted, const Scene& scene) {
  if (wanted.front().views.empty() && !wanted.front().camera && !scene.cameras.empty()) return scene.cameras;
  std::vector<Camera> cameras;
  for (const PictureSettings& one : wanted) {
    const std::optional<Camera> camera = camera_for(one, scene);
    if (!camera) throw InputError("--observers", "the scene has no [[camera]]\nhint: --camera EYE TARGET FOV");
    cameras.push_back(*camera);
    if (cameras.back().name.empty()) cameras.back().name = "camera";
  }
  return cameras;
}

// So that equal radiances have equal colors in all images of a series, the others take the scale of the first.
void share_scale(std::vector<PictureSettings>& series, const Picture& first) {
  for (PictureSettings& one : series) {
    one.brightest = first.brightest;
    if (!one.exposure.each) one.exposure.factor = first.exposure;
  }
}

// Adds the patches that are enclosed by day, which the file does not contain.
Simulation stored_solution(const std::filesystem::path& file, const std::shared_ptr<const Scene>& scene) {
  Simulation simulation = read_solution(file, scene);
  if (scene->sky || scene->sun)
    simulation.enclosed = enclosed_patches(*scene, simulation.world->all_faces(), simulation.mesh);
  return simulation;
}

void write_page_of_pictures(const RenderArguments& arguments, const Scene& scene, const Simulation& simulation,
                            const std::vector<Picture>& pictures) {
  const SolvedSurface surface = surface_of(simulation);
  Page page{.scene = scene,
            .provenance = {.command_line = arguments.command_line,
                           .exposure = exposure_of(simulation),
                           .scene_hash = scene_hash(scene)},
            .surface = &surface};
  for (const Picture& picture : pictures) page.pictures.push_back(&picture);
  write_page(arguments.page, page);
}

// Returns the line about the lightmap.
std::string write_lightmap_of(const RenderArguments& arguments, const Scene& scene, const Simulation& simulation,
                              const Observer& observer) {
  const Lightmap map = bake_lightmap(simulation, arguments.lightmap.options, observer);
  const WritingGuard guard;
  write_lightmap(arguments.lightmap.folder, scene, simulation, map,
                 {.command_line = arguments.command_line, .scene_hash = scene_hash(scene)});
  return lightmap_line(map, arguments.lightmap);
}

}  // namespace

std::optional<Camera> camera_for(const PictureSettings& settings, const Scene& scene) {
  if (settings.camera) {
    Camera camera = *settings.camera;
    camera.eye *= scene.metres_per_unit;
    camera.target *= scene.metres_per_unit;
    camera.height *= scene.metres_per_unit;
    return camera;
  }
  std::string names;
  for (const Camera& camera : scene.cameras) {
    if (settings.views.empty() || camera.name == settings.views.front()) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (settings.views.empty()) return std::nullopt;
  throw InputError("--view", "found '" + settings.views.front() + "'; expected a camera of the scene file: " +
                                 (names.empty() ? "it has none" : "one of " + names));
}

void require_camera_in_reach(const PictureSettings& settings, const Scene& scene) {
  const std::optional<Camera> camera = camera_for(settings, scene);
  if (!camera) return;
  const Reach reach = reach_of(scene);
  require_in_reach(reach, camera->eye, "--camera", "the eye");
  require_in_reach(reach, camera->target, "--camera", "the target");
}

Picture make_picture(const PictureSettings& settings, const Scene& scene, const Simulation& simulation,
                     const Observer& observer) {
  return take_picture(simulation,
                      {.camera = camera_for(settings, scene),
                       .colors = settings.colors,
                       .exposure = settings.exposure.factor,
                       .stops = settings.exposure.stops,
                       .brightest = settings.brightest,
                       .width = settings.size[0],
                       .height = settings.size[1],
                       .quality = settings.quality,
                       .error = settings.error,
                       .most_samples = settings.most_samples},
                      observer);
}

std::optional<std::string> missed_error(const PictureSettings& settings, const Picture& picture) {
  if (picture.unfinished || !picture.reached_error || *picture.reached_error <= 1.1 * settings.error)
    return std::nullopt;
  const std::string reached = rounded(100 * *picture.reached_error, 2) + "%";
  std::string text = settings.file.string() + ": the pixels' standard error is " + reached +
                     " (root mean square), not the " + rounded(100 * settings.error, 2) +
                     "% of --picture-error, with at most " + std::to_string(settings.most_samples) +
                     " samples per pixel\nhint: ";
  // Errors decrease at least with the square root of the number of samples.
  const double times = std::pow(*picture.reached_error / settings.error, 2);
  const double wanted = std::min<double>(most_picture_samples, std::ceil(times * settings.most_samples));
  const auto samples = std::bit_ceil(static_cast<std::uint32_t>(wanted));
  if (samples > static_cast<std::uint32_t>(settings.most_samples))
    text += "--picture-samples " + std::to_string(samples) + ", or ";
  return text + "a larger --picture-error";
}

void write_picture_file(const std::filesystem::path& file, const Picture& picture, const Scene& scene) {
  write_picture(file, picture, picture_up(picture.camera, scene.up, scene.north), bands_of(scene));
}

ExitCode run(const RenderArguments& arguments) {
  // 1. Refuse outputs that cannot be written or would be lost
  std::vector<PictureSettings> wanted = single_pictures(arguments.picture);
  if (!arguments.observers.empty()) check_writable(arguments.observers);
  for (const PictureSettings& one : wanted) {
    if (!one.file.empty()) check_writable(one.file);
    if (!one.error_map.empty()) check_writable(one.error_map);
  }
  if (!arguments.page.empty()) check_writable(arguments.page);
  if (!arguments.lightmap.folder.empty()) check_lightmap_writable(arguments.lightmap.folder);

  // 2. Read the scene and its solution
  const ThreadLimit limit(arguments.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);
  const auto read = std::make_shared<const Scene>(read_models(arguments.models, arguments.read, observer));
  const Scene& scene = *read;
  check_limits(scene);
  for (const PictureSettings& one : wanted) require_camera_in_reach(one, scene);
  const Simulation simulation = stored_solution(arguments.solution, read);
  std::optional<Simulation> other;
  if (!arguments.difference.empty()) other = stored_solution(arguments.difference, read);
  if (wanted.size() == 1 && !other) line.expect({Stage::read, Stage::gather, Stage::render});

  // 3. Render the images and write each at once; the first Ctrl-C stops after the current one
  std::vector<std::filesystem::path> written;
  if (!arguments.observers.empty()) {
    const auto readings = read_observers(simulation, observers_of(wanted, scene), observer);
    const WritingGuard guard;
    write_observers(arguments.observers, readings);
    written.push_back(arguments.observers);
  }
  std::vector<Picture> taken;
  std::vector<std::string> missed_errors;
  bool stopped = false, unfinished = false;
  for (const PictureSettings& one : wanted) {
    if (one.file.empty()) break;
    keep_what_is_there();
    Picture picture = make_picture(one, scene, simulation, observer);
    if (&one == &wanted.front()) share_scale(wanted, picture);
    std::optional<Picture> of_other;
    if (other) of_other = make_picture(one, scene, *other, observer);
    stopped = interrupted();
    unfinished = picture.unfinished || (of_other && of_other->unfinished);
    if (!may_write_what_is_there()) throw Canceled();
    const WritingGuard guard;
    if (of_other)
      write_difference(one.file, picture, *of_other, bands_of(scene));
    else
      write_picture_file(one.file, picture, scene);
    written.push_back(one.file);
    if (!one.error_map.empty()) {
      write_picture_errors(one.error_map, picture);
      written.push_back(one.error_map);
    }
    if (const auto missed = missed_error(one, picture); missed && !arguments.quiet) missed_errors.push_back(*missed);
    stopped = stopped || interrupted();
    if (!arguments.page.empty()) taken.push_back(std::move(picture));
    if (stopped) break;
  }
  if (!taken.empty()) {
    const WritingGuard guard;
    write_page_of_pictures(arguments, scene, simulation, taken);
    written.push_back(arguments.page);
  }
  std::string said;
  if (!stopped && !arguments.lightmap.folder.empty()) {
    said = write_lightmap_of(arguments, scene, simulation, observer);
    written.push_back(arguments.lightmap.folder);
  }
  line.hide();
  for (const std::string& missed : missed_errors) print_message("warning", missed);
  if (!arguments.quiet) std::cout << said << files_line(written) << std::flush;
  if (!stopped) return good;
  print_message("warning", unfinished ? "interrupted; the last picture is unfinished, with larger errors than asked for"
                                      : "interrupted; the files that were written are complete");
  return interrupted_run();
}

}  // namespace patchlight::cli
