#include "patchlight/views/picture.h"

#include "light/photometry.h"
#include "lighting/sky.h"
#include "plan/planned_scene.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
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

// The sky, the ground and the disc of the sun, as far as the plan has them; nothing is seen without.
std::function<Spectrum(const Vector&)> surroundings_of(const Scene& scene) {
  if (!scene.sky) return {};
  constexpr double sun_radius = 0.2665 * std::numbers::pi / 180;  // as seen from the earth
  const SkyModel sky = sky_model(*scene.sky, scene.up);
  return [sky, sun = scene.sun](const Vector& direction) -> Spectrum {
    Spectrum seen = radiance(sky, direction);
    // L = E / solid angle, 2 pi (1 - cos)
    if (sun && direction.dot(sun->direction) > std::cos(sun_radius) && direction.dot(sky.up) > 0)
      seen += sun->normal_irradiance / (2 * std::numbers::pi * (1 - std::cos(sun_radius)));
    return seen;
  };
}

// 1 for the pixels that exposure goes by: what is seen of a room, not through its windows; all where that is nothing.
Eigen::VectorXd weight_of_pixels(const Image& image) {
  const Eigen::VectorXd inside = (image.outlook.array() <= 0.5).cast<double>();
  const bool is_lit = ((image.pixels.rowwise().maxCoeff() > 0) && (inside.array() > 0)).any();
  return is_lit ? inside : Eigen::VectorXd::Ones(inside.size()).eval();
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

Picture take_picture(const Scene& scene, const Simulation& simulation, const PictureOptions& options,
                     const Observer& observer) {
  const Occluder& occluder = simulation.tracing->all_faces(scene);
  const Camera camera = options.camera ? *options.camera : default_camera(scene, simulation.plan.sides, occluder);
  const SmoothField radiance = smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, occluder);
  RenderOptions fineness;
  fineness.surroundings = surroundings_of(scene_for_sensors(scene, simulation.plan));
  const Image image = render(simulation.mesh, radiance, occluder, camera, scene.up, fineness, observer);
  const Bands bands = bands_of(scene);
  if (options.colors == PictureColors::natural) {
    const double exposure = exposure_for(image.pixels, weight_of_pixels(image), bands);
    return {{.width = image.width, .height = image.height, .pixels = tone_map(image.pixels, exposure, bands)}};
  }
  const Eigen::VectorXd values = pixel_luminance(image, bands);
  const double end = end_of_scale(values.cwiseProduct(weight_of_pixels(image)));
  return {{.width = image.width, .height = image.height, .pixels = false_color(values, 0, end)}, end};
}

}  // namespace patchlight
