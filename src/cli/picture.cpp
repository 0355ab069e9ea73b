#include "cli/picture.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_image.h"

#include "output/write_picture.h"
#include "render/lens.h"

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
  return take_picture(scene, simulation,
                      {.camera = camera_for(settings, scene),
                       .colors = settings.colors,
                       .width = settings.size[0],
                       .height = settings.size[1],
                       .quality = settings.quality,
                       .error = settings.error},
                      observer);
}

void write_picture_file(const std::filesystem::path& file, const Picture& picture, const Scene& scene) {
  write_picture(file, picture, picture_up(picture.camera, scene.up, scene.north), bands_of(scene));
}

void write_error_map(const std::filesystem::path& file, const Picture& picture) { write_picture_errors(file, picture); }

}  // namespace patchlight::cli
