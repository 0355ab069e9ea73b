#include "cli/picture.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_image.h"
#include "patchlight/views/picture.h"

#include <string>

namespace patchlight::cli {
namespace {

Camera in_metres(const Camera& camera, double metres_per_unit) {
  return {camera.eye * metres_per_unit, camera.target * metres_per_unit, camera.vertical_field_of_view};
}

}  // namespace

std::optional<Camera> camera_for(const SolveArguments& arguments, const Scene& scene) {
  if (arguments.camera) return in_metres(*arguments.camera, scene.metres_per_unit);
  std::string names;
  for (const Camera& camera : scene.cameras) {
    if (arguments.view.empty() || camera.name == arguments.view) return camera;
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (arguments.view.empty()) return std::nullopt;
  throw InputError("--view", "found '" + arguments.view + "'; expected a camera of the scene file: " +
                                 (names.empty() ? "it has none" : "one of " + names));
}

DisplayImage make_picture(const SolveArguments& arguments, const Scene& scene, const Simulation& simulation,
                          const Observer& observer) {
  const PictureOptions options{.camera = camera_for(arguments, scene), .colors = arguments.colors};
  const Picture picture = take_picture(scene, simulation, options, observer);
  return picture.brightest ? with_legend(picture.image, 0, *picture.brightest, "luminance, cd/m^2") : picture.image;
}

}  // namespace patchlight::cli
