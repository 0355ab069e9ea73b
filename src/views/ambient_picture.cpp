#include "patchlight/scene/sides.h"
#include "patchlight/views/picture.h"

#include "render/ambient_occlusion.h"
#include "render/inside_camera.h"
#include "render/lens.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "visibility/occluder.h"

#include <utility>

namespace patchlight {
namespace {

// Inside the room with most surface, each part as much as it reflects; else one that shows most of the model.
Camera view_of_model(const Scene& scene, const Occluder& occluder) {
  const KeptSides sides = kept_sides(scene, Sides::automatic);
  if (!has_open_side(scene, sides, occluder)) {
    const SideLight light = reflectance_of_sides(scene, sides);
    if (const auto camera = inside_camera(floors_of(scene, light), light, scene, occluder)) return *camera;
  }
  return default_camera(scene, sides, occluder);
}

}  // namespace

Picture ambient_picture(const Scene& scene, const PictureOptions& options, double distance) {
  const Occluder occluder(scene, Occluder::Blockers::all);
  const Camera camera = options.camera ? *options.camera : view_of_model(scene, occluder);
  const Lens lens(camera, picture_up(camera, scene.up, scene.north), options.width, options.height);
  Picture picture{.image = {.width = options.width, .height = options.height, .pixels = {}}, .camera = camera};
  picture.radiance = ambient_image(scene, occluder, lens, options.width, options.height, distance);
  const Bands bands = bands_of(scene);
  picture.exposure =
      exposure_for(picture.radiance.pixels, Eigen::VectorXd::Ones(picture.radiance.pixels.rows()), bands);
  picture.image.pixels = tone_map(picture.radiance.pixels, picture.exposure, bands);
  return picture;
}

}  // namespace patchlight
