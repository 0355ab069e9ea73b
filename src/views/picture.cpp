#include "patchlight/views/picture.h"

#include "base/sampling.h"
#include "light/photometry.h"
#include "lighting/lighting.h"
#include "lighting/mirrored_irradiance.h"
#include "lighting/sky.h"
#include "lighting/sky_openings.h"
#include "pipeline/lamps_apart.h"
#include "plan/planned_scene.h"
#include "render/final_gather.h"
#include "render/lens.h"
#include "render/render.h"
#include "render/tone_map.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A picture looks at so many emitting faces by shadow rays.
constexpr std::size_t most_lamps = 256;

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

// The faces that emit much more than most do, the brightest first. The light of those left out is gathered like that of
// patches which reflect.
struct PictureLamps {
  std::vector<LampFace> faces;
  Field exitance;  // of their patches, 0 of all others
};

// Seen from its front, a face's corners go round counter-clockwise.
LampFace seen_from_front(LampFace face, Side side) {
  if (side == Side::front) return face;
  const auto [a, b, c, d] = face.corners;
  face.corners = c == d ? std::array<Point, 4>{c, b, a, a} : std::array<Point, 4>{d, c, b, a};
  return face;
}

PictureLamps lamps_of_picture(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  const Field& exitance = simulation.problem.exitance;
  struct Lamp {
    PatchRange patches;
    double flux;
  };
  std::vector<Lamp> sides;
  const double mean = exitance.rowwise().mean().matrix().dot(simulation.problem.area) / simulation.problem.area.sum();
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    for (const Side side : {Side::front, Side::back}) {
      const PatchRange patches = mesh.patches_on(polygon, side);
      if (patches.begin == patches.end || !(exitance.row(patches.begin) > 0).any()) continue;
      double area = 0;
      for (PatchIndex patch = patches.begin; patch < patches.end; ++patch) area += mesh.area[patch];
      if (exitance.row(patches.begin).mean() > bright * mean)
        sides.push_back({patches, area * exitance.row(patches.begin).mean()});
    }
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Lamp& a, const Lamp& b) { return a.flux > b.flux; });
  PictureLamps lamps{{}, Field::Zero(exitance.rows(), exitance.cols())};
  for (const auto& [patches, flux] : sides) {
    if (lamps.faces.size() >= most_lamps) break;
    for (LampFace& face : lamp_faces(scene, mesh.polygon[patches.begin], mesh.side[patches.begin])) {
      face.exitance = exitance.row(patches.begin);
      lamps.faces.push_back(seen_from_front(std::move(face), mesh.side[patches.begin]));
    }
    const auto count = static_cast<Eigen::Index>(patches.end - patches.begin);
    lamps.exitance.middleRows(patches.begin, count) = exitance.middleRows(patches.begin, count);
  }
  return lamps;
}

SolvedLight solved_light(const Scene& scene, const Simulation& simulation, const Lighting& lighting) {
  const RadiosityProblem& problem = simulation.problem;
  PictureLamps lamps = lamps_of_picture(scene, simulation);
  const Field sent = simulates(simulation.plan, Effect::interreflection)
                         ? Field(std::numbers::pi * display_radiance(simulation))
                         : problem.exitance;
  const Bands bands = bands_of(scene);
  Eigen::VectorXd weights(static_cast<Eigen::Index>(bands.size()));
  for (std::size_t band = 0; band < bands.size(); ++band)
    weights[static_cast<Eigen::Index>(band)] = luminous_efficacy * bands[band].luminous_weight;
  return {.mesh = simulation.mesh,
          .occluder = simulation.tracing->all_faces(scene),
          .lights = {std::move(lamps.faces), lighting},
          .exitance = problem.exitance,
          .reflected = sent - lamps.exitance,
          .reflectance = problem.scattering.reflectance,
          .other_side = problem.scattering.other_side,
          .transmittance = problem.scattering.transmittance,
          .luminous_weights = weights,
          .scene = &scene};
}

// As it is shown on a display.
Picture shown(GatheredImage taken, const Camera& camera, PictureColors colors, const Bands& bands) {
  const Image& image = taken.image;
  Picture picture{.image = {.width = image.width, .height = image.height, .pixels = {}}, .camera = camera};
  picture.unfinished = taken.unfinished;
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
  const Vector up = picture_up(camera, scene.up, scene.north);
  const SmoothField radiance = smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, occluder);
  const Scene seen = scene_for_sensors(scene, simulation.plan);
  const auto surroundings = surroundings_of(seen);
  GatheredImage taken;
  if (options.quality == PictureQuality::final) {
    const bool reflects_again = simulates(simulation.plan, Effect::interreflection);
    Lighting lighting = lighting_of(seen, *simulation.tracing);
    lighting.openings = openings_apart(lighting.openings, lighting.paths);
    const SolvedLight light = solved_light(seen, simulation, lighting);
    const Lens lens(camera, up, options.width, options.height);
    taken = final_gather(light, radiance, lens,
                         {.width = options.width,
                          .height = options.height,
                          .error = options.error,
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
