#include "cli/picture.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "base/rounded.h"
#include "cli/output_options.h"
#include "output/image/write_image.h"
#include "render/camera.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

namespace patchlight::cli {
namespace {

Camera in_metres(Camera camera, double metres_per_unit) {
  camera.eye *= metres_per_unit;
  camera.target *= metres_per_unit;
  camera.height *= metres_per_unit;
  return camera;
}

}  // namespace

std::optional<Camera> camera_for(const PictureSettings& settings, const Scene& scene) {
  if (settings.camera) return in_metres(*settings.camera, scene.metres_per_unit);
  std::string names;
  for (const Camera& camera : scene.cameras) {
    if (settings.views.empty() || camera.name == settings.views.front()) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (settings.views.empty()) return std::nullopt;
  throw InputError("--view", "found '" + settings.views.front() + "'; expected a camera of the scene file: " +
                                 (names.empty() ? "it has none" : "one of " + names));
}

Picture make_picture(const PictureSettings& settings, const Scene& scene, const Simulation& simulation,
                     const Observer& observer) {
  return take_picture(simulation,
                      {.camera = camera_for(settings, scene),
                       .colors = settings.colors,
                       .width = settings.size[0],
                       .height = settings.size[1],
                       .quality = settings.quality,
                       .error = settings.error,
                       .most_samples = settings.most_samples},
                      observer);
}

std::optional<std::string> missed_error(const PictureSettings& settings, const Picture& picture) {
  constexpr double tolerance = 1.1;
  if (picture.unfinished || !picture.reached_error || *picture.reached_error <= tolerance * settings.error)
    return std::nullopt;
  const std::string reached = rounded(100 * *picture.reached_error, 2) + "%";
  std::string text = settings.file.string() + ": the pixels' standard error is " + reached +
                     " (root mean square), not the " + rounded(100 * settings.error, 2) +
                     "% of --picture-error, with at most " + std::to_string(settings.most_samples) +
                     " samples per pixel\nhint: ";
  // Errors fall with the root of the samples' number at the slowest.
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

void write_error_map(const std::filesystem::path& file, const Picture& picture) { write_picture_errors(file, picture); }

}  // namespace patchlight::cli
