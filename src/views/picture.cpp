#include "patchlight/views/picture.h"

#include "base/sampling.h"
#include "light/photometry.h"
#include "lighting/lighting.h"
#include "lighting/mirrored_irradiance.h"
#include "lighting/sky_openings.h"
#include "pipeline/world.h"
#include "plan/planned_scene.h"
#include "render/final_gather.h"
#include "render/inside_camera.h"
#include "render/lens.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "views/solved_light.h"
#include "views/surroundings.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
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

// Where false colours end: lamps are so much brighter than what they light that only the brightest twentieth of the
// pixels may lie above.
double end_of_scale(const Eigen::VectorXd& values) {
  std::vector<double> lit;
  std::copy_if(values.begin(), values.end(), std::back_inserter(lit), [](double value) { return value > 0; });
  if (lit.empty()) return 1;
  const auto end = lit.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), end, lit.end());
  return rounded_up(*end);
}

// 1 for the pixels that exposure goes by: what is seen of a room, not through its windows; all where that is nothing.
Eigen::VectorXd weight_of_pixels(const Image& image) {
  const Eigen::VectorXd inside = (image.outlook.array() <= 0.5).cast<double>();
  const bool is_lit = ((image.pixels.rowwise().maxCoeff() > 0) && (inside.array() > 0)).any();
  return is_lit ? inside : Eigen::VectorXd::Ones(inside.size()).eval();
}

// As it is shown on a display.
Picture shown(GatheredImage taken, const Camera& camera, PictureColors colors, const Bands& bands) {
  const Image& image = taken.image;
  Picture picture{.image = {.width = image.width, .height = image.height, .pixels = {}}, .camera = camera};
  picture.unfinished = taken.unfinished;
  picture.reached_error = taken.error;
  if (colors == PictureColors::natural) {
    picture.exposure = exposure_for(image.pixels, weight_of_pixels(image), bands);
    picture.image.pixels = tone_map(image.pixels, picture.exposure, bands);
  } else {
    const Eigen::VectorXd values = pixel_luminance(image, bands);
    picture.brightest = end_of_scale(values.cwiseProduct(weight_of_pixels(image)));
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
  const bool is_lit = ((radiance.rowwise().maxCoeff() > 0) && (inside.array() > 0)).any();
  return exposure_for(radiance, is_lit ? inside : area, bands);
}

Picture take_picture(const Simulation& simulation, const PictureOptions& options, const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  const Occluder& occluder = simulation.world->all_faces();
  const Camera camera = options.camera ? *options.camera : view_of_brightest_room(scene, simulation, occluder);
  const Vector up = picture_up(camera, scene.up, scene.north);
  const SmoothField radiance = smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, occluder);
  const Scene& seen = simulation.world->sensor_scene();
  const auto surroundings = surroundings_of(seen);
  GatheredImage taken;
  if (options.quality == PictureQuality::final) {
    const bool reflects_again = simulates(simulation.plan, Effect::interreflection);
    const SolvedLight light = solved_light(simulation);
    const Lens lens(camera, up, options.width, options.height);
    taken = final_gather(light, radiance, lens,
                         {.width = options.width,
                          .height = options.height,
                          .error = options.error,
                          .most_samples = options.most_samples,
                          .hemisphere = {.most_bounces = reflects_again ? HemisphereOptions().most_bounces : 0},
                          .seed = hash({simulation.plan.assembly.seed}),
                          .surroundings = surroundings},
                         observer);
  } else {
    const RenderOptions fineness{.width = options.width,
                                 .height = options.height,
                                 .surroundings = surroundings,
                                 .spheres = spheres_of(seen.luminaires)};
    taken.image = render(simulation.mesh, radiance, occluder, camera, up, fineness, observer);
  }
  return shown(std::move(taken), camera, options.colors, bands_of(scene));
}

}  // namespace patchlight
