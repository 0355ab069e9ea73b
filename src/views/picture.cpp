#include "patchlight/views/picture.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/sides.h"

#include "base/sampling.h"
#include "light/photometry.h"
#include "lighting/lighting.h"
#include "lighting/sky_openings.h"
#include "pipeline/world.h"
#include "plan/choose_storage.h"
#include "plan/planned_scene.h"
#include "render/camera.h"
#include "render/final_gather.h"
#include "render/lightmap.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "views/solved_light.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

Eigen::VectorXd pixel_luminance(const Image& image, const Bands& bands) {
  Eigen::VectorXd values(image.pixels.rows());
  for (Eigen::Index pixel = 0; pixel < values.size(); ++pixel)
    values[pixel] = luminance(image.pixels.row(pixel), bands);
  return values;
}

// The next of 1, 2, 5, 10, ... not below the value: a legend that ends at such a number is easy to read.
double rounded_up(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * decade) return step * decade;
  }
  return 10 * decade;
}

// The end of false colors: lamps are so much brighter than all else that the brightest twentieth of the pixels may lie
// above.
double end_of_scale(const Eigen::VectorXd& values) {
  std::vector<double> lit;
  std::copy_if(values.begin(), values.end(), std::back_inserter(lit), [](double value) { return value > 0; });
  return lit.empty() ? 1 : rounded_up(quantile(std::move(lit), 0.95));
}

// 1 for the pixels that exposure goes by: those that show a room, not its windows; all where a room is dark.
Eigen::VectorXd weight_of_pixels(const Image& image) {
  const Eigen::VectorXd inside = (image.outlook.array() <= 0.5).cast<double>();
  return is_lit(image.pixels, inside) ? inside : Eigen::VectorXd::Ones(inside.size()).eval();
}

// As it is shown on a display.
Picture shown(GatheredImage taken, const Camera& camera, const PictureOptions& options, const Bands& bands) {
  const Image& image = taken.image;
  Picture picture{.image = {.width = image.width, .height = image.height, .pixels = {}}, .camera = camera};
  picture.unfinished = taken.unfinished;
  picture.reached_error = taken.error;
  if (options.colors == PictureColors::natural) {
    const double own = exposure_for(image.pixels, weight_of_pixels(image), bands);
    picture.exposure = options.exposure.value_or(std::exp2(options.stops) * own);
    picture.image.pixels = tone_map(image.pixels, picture.exposure, bands);
  } else {
    const Eigen::VectorXd values = pixel_luminance(image, bands);
    const double own = end_of_scale(values.cwiseProduct(weight_of_pixels(image)));
    picture.brightest = options.brightest.value_or(own);
    picture.image.pixels = false_color(values, 0, *picture.brightest);
    // At the numbers of the legend
    const double step = *picture.brightest / 4;
    picture.image = with_isolines(std::move(picture.image), values, {step, 2 * step, 3 * step});
  }
  picture.radiance = std::move(taken.image);
  return picture;
}

// Inside the room that reflects most light, by day of those that hold it; where a side of the model is open, or no room
// is found, a view that shows most of the model.
Camera view_of_brightest_room(const Scene& scene, const Simulation& simulation, const Occluder& occluder) {
  const Field reflected = std::numbers::pi * display_radiance(simulation) - simulation.problem.exitance;
  Eigen::VectorXd light = reflected.rowwise().mean().max(0);
  const bool by_day = (simulation.enclosed.array() > 0).any();
  if (by_day) light = light.cwiseProduct(simulation.enclosed);
  if (by_day || !has_open_side(scene, simulation.plan.sides, occluder)) {
    const auto camera = inside_camera(floors_of(simulation.mesh, light, scene.up),
                                      light_of_sides(simulation.mesh, light, scene.polygons.size()), scene, occluder);
    if (camera) return *camera;
  }
  return default_camera(scene, simulation.plan.sides, occluder);
}

// Inside the room with most surface, each part as much as it reflects; else one that shows most of the model.
Camera view_of_model(const Scene& scene, const Occluder& occluder) {
  const KeptSides sides = kept_sides(scene, Sides::automatic);
  if (!has_open_side(scene, sides, occluder)) {
    const SideLight light = reflectance_of_sides(scene, sides);
    if (const auto camera = inside_camera(floors_of(scene, light), light, scene, occluder)) return *camera;
  }
  return default_camera(scene, sides, occluder);
}

// The light of patches that does not follow from the irradiance on their fronts: E + t H_behind, W/m^2.
Field sent_besides(const Simulation& simulation) {
  const Scattering& scattering = simulation.problem.scattering;
  Field sent = simulation.problem.exitance;
  if (scattering.other_side.empty()) return sent;
  for (Eigen::Index patch = 0; patch < sent.rows(); ++patch) {
    const PatchIndex other = scattering.other_side[static_cast<std::size_t>(patch)];
    sent.row(patch) += scattering.transmittance.row(patch) * simulation.solution.irradiance.row(other);
  }
  return sent;
}

// Three fields in single precision, once more while they are written, and 8 bytes of each texel.
void require_memory_of(const PackedCharts& charts, const Simulation& simulation) {
  const auto bands = static_cast<double>(simulation.problem.exitance.cols());
  const double bytes = static_cast<double>(charts.width) * charts.height * (2 * 12 * bands + 8);
  const double usable = usable_memory(simulation.plan.resources);
  if (bytes <= usable) return;
  throw InputError("lightmap", "found that " + std::to_string(charts.width) + " x " + std::to_string(charts.height) +
                                   " texels take " + gigabytes(bytes) + ", and " + gigabytes(usable) +
                                   " may be taken; expected larger texels or fewer bands");
}

}  // namespace

Field display_radiance(const Simulation& simulation) {
  const Solution& solution = simulation.solution;
  Field radiosity = solution.radiosity;
  if (!solution.converged && solution.ambient.size() > 0) {
    // B + rho H_ambient: Cohen et al. 1988, the ambient term
    radiosity += simulation.problem.scattering.reflect(solution.ambient);
  }
  return radiosity / std::numbers::pi;  // L = B / pi
}

double exposure_of(const Simulation& simulation) {
  const Field radiance = display_radiance(simulation);
  const Eigen::VectorXd& area = simulation.problem.area;
  const Bands bands = bands_of(simulation.world->scene());
  if (simulation.enclosed.size() == 0) return exposure_for(radiance, area, bands);
  const Eigen::VectorXd inside = area.cwiseProduct(simulation.enclosed);
  return exposure_for(radiance, is_lit(radiance, inside) ? inside : area, bands);
}

Picture take_picture(const Simulation& simulation, const PictureOptions& options, const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  const Occluder& occluder = simulation.world->all_faces();
  const Camera camera = options.camera ? *options.camera : view_of_brightest_room(scene, simulation, occluder);
  const Vector up = picture_up(camera, scene.up, scene.north);
  const Scene& seen = simulation.world->sensor_scene();
  GatheredImage taken;
  if (options.quality == PictureQuality::final) {
    const bool reflects_again = simulates(simulation.plan, Effect::interreflection);
    const SolvedLight light = solved_light(simulation);
    const SmoothField radiance =
        smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, occluder);
    const Lens lens(camera, up, options.width, options.height);
    taken = final_gather(light, radiance, lens,
                         {.width = options.width,
                          .height = options.height,
                          .error = options.error,
                          .most_samples = options.most_samples,
                          .hemisphere = {.most_bounces = reflects_again ? HemisphereOptions().most_bounces : 0},
                          .seed = hash({simulation.plan.assembly.seed}),
                          .surroundings = surroundings_of(seen)},
                         observer);
  } else {
    taken.image = draft(simulation, camera, options.width, options.height, seen.luminaires, observer);
  }
  return shown(std::move(taken), camera, options, bands_of(scene));
}

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

Lightmap bake_lightmap(const Simulation& simulation, const LightmapOptions& options, const Observer& observer) {
  PackedCharts charts = packed_charts(charts_of(simulation.world->scene(), simulation.mesh), options.texel);
  require_memory_of(charts, simulation);
  BakeOptions baking{.seed = hash({simulation.plan.assembly.seed})};
  if (!simulates(simulation.plan, Effect::interreflection)) baking.hemisphere.most_bounces = 0;
  return bake(solved_light(simulation), sent_besides(simulation), std::move(charts), baking, observer);
}

}  // namespace patchlight
