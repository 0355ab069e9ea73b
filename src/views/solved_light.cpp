#include "views/solved_light.h"

#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "light/photometry.h"
#include "lighting/sky.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/world.h"
#include "render/render.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// At most 256 faces that emit much more than most do, the brightest first: pictures send shadow rays to these. The
// light of others is gathered like that of patches which reflect.
struct PictureEmitters {
  std::vector<EmitterFace> faces;
  Field exitance;  // of their patches, 0 of all others
};

PictureEmitters emitters_of_picture(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  const Field& exitance = simulation.problem.exitance;
  PictureEmitters lamps{{}, Field::Zero(exitance.rows(), exitance.cols())};
  for (const auto& [polygon, side] : select_emitters(scene, mesh, simulation.problem, 256)) {
    const auto [begin, end] = mesh.patches_on(polygon, side);
    for (EmitterFace& face : emitter_faces(scene, polygon, side)) {
      face.exitance = exitance.row(begin);
      lamps.faces.push_back(std::move(face));
    }
    lamps.exitance.middleRows(begin, end - begin) = exitance.middleRows(begin, end - begin);
  }
  return lamps;
}

}  // namespace

SolvedLight solved_light(const Simulation& simulation) {
  const Scene& scene = simulation.world->sensor_scene();
  const RadiosityProblem& problem = simulation.problem;
  PictureEmitters lamps = emitters_of_picture(scene, simulation);
  const Field sent = simulates(simulation.plan, Effect::interreflection)
                         ? Field(std::numbers::pi * display_radiance(simulation))
                         : problem.exitance;
  const Bands bands = bands_of(scene);
  Eigen::VectorXd weights(static_cast<Eigen::Index>(bands.size()));
  for (std::size_t band = 0; band < bands.size(); ++band)
    weights[static_cast<Eigen::Index>(band)] = luminous_efficacy * bands[band].luminous_weight;
  return {.mesh = simulation.mesh,
          .occluder = simulation.world->all_faces(),
          .lights = {simulation.world->sensor_lighting(), std::move(lamps.faces)},
          .exitance = problem.exitance,
          .reflected = sent - lamps.exitance,
          .reflectance = problem.scattering.reflectance,
          .other_side = problem.scattering.other_side,
          .transmittance = problem.scattering.transmittance,
          .luminous_weights = weights,
          .scene = &scene};
}

Image draft(const Simulation& simulation, const Camera& camera, int width, int height,
            const std::vector<Luminaire>& luminaires, const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  const Occluder& occluder = simulation.world->all_faces();
  const SmoothField radiance = smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, occluder);
  const SurfaceOptics optics(simulation.world->sensor_scene(), simulation.world->tracing().reflections());
  return render(simulation.mesh, radiance, occluder, optics, camera, picture_up(camera, scene.up, scene.north),
                {.width = width,
                 .height = height,
                 .surroundings = surroundings_of(simulation.world->sensor_scene()),
                 .luminaires = seen_luminaires(luminaires, scene.up)},
                observer);
}

std::function<Spectrum(const Vector&)> surroundings_of(const Scene& scene) {
  if (!scene.sky && !scene.sun) return {};
  const double sun_cosine = std::cos(0.2665 * std::numbers::pi / 180);  // of the radius as seen from the earth
  std::optional<SkyModel> sky;
  if (scene.sky) sky = sky_model(*scene.sky, scene.up);
  return [sky, sun_cosine, sun = scene.sun, up = scene.up, bands = number_of_bands(scene)](const Vector& direction) {
    Spectrum seen = sky ? radiance(*sky, direction) : Spectrum::Zero(bands);
    // L = E / solid angle, 2 pi (1 - cos)
    if (sun && direction.dot(sun->direction) > sun_cosine && direction.dot(up) > 0)
      seen += sun->normal_irradiance / (2 * std::numbers::pi * (1 - sun_cosine));
    return seen;
  };
}

std::function<Spectrum(const Vector&)> sky_of(const Simulation& simulation) {
  Scene seen = simulation.world->sensor_scene();
  seen.sun.reset();
  return surroundings_of(seen);
}

SolvedSurface surface_of(const Simulation& simulation, const std::optional<double>& ambient_distance) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  const Occluder& occluder = simulation.world->all_faces();
  const PatchMesh& mesh = simulation.mesh;
  const Eigen::VectorXd& area = simulation.problem.area;
  SolvedSurface surface{simulation.world->scene(), simulation, smooth(mesh, radiance, area, occluder).at_vertices};
  if (ambient_distance) {
    surface.ambient_occlusion = ambient_occlusion(mesh, occluder, *ambient_distance);
    surface.ambient_occlusion_at_vertices =
        smooth(mesh, Field(surface.ambient_occlusion.array()), area, occluder).at_vertices.col(0).matrix();
  }
  return surface;
}

}  // namespace patchlight
