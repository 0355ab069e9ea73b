#include "support/surface_places.h"

#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "base/sampling.h"
#include "pipeline/world.h"
#include "render/camera.h"
#include "render/final_gather.h"
#include "render/render.h"
#include "views/solved_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace patchlight::test {
namespace {

// A camera stays this far from the surface at most.
constexpr double farthest_camera = 0.05;

// The smallest gap that has room for a camera: rays are traced with 1e-7 of the scene's extent.
constexpr double least_gap = 1e-3;

bool is_opaque_and_matte(const Simulation& simulation, const SolvedLight& light, PatchIndex patch) {
  return is_plain(light, patch) && !behind(light, patch) && simulation.problem.area[patch] > 0 &&
         (light.reflectance.row(patch) > 0.01).all();
}

// A place of a patch; nothing where it is covered.
std::optional<SurfacePlace> place_in(const Simulation& simulation, PatchIndex patch, double u, double v) {
  const PatchMesh& mesh = simulation.mesh;
  const Occluder& occluder = simulation.world->all_faces();
  const PatchCorners corners = mesh.corner_points(patch);
  const Point point = square_to_quad(corners.points, 0.1 + 0.8 * u, 0.1 + 0.8 * v);
  if (occluder.is_covered(mesh.polygon[patch], mesh.side[patch], point)) return {};
  const Ray ray{point, mesh.normal[patch], mesh.polygon[patch]};
  const auto hit = occluder.first_hits({&ray, 1}).front();
  const double free = hit ? hit->distance : 1;
  if (free < least_gap) return {};
  const bool counts = simulation.enclosed.size() == 0 || simulation.enclosed[patch] > 0;
  return SurfacePlace{{point, mesh.normal[patch]}, patch, free, std::sqrt(mesh.area[patch]), counts};
}

Camera camera_of(const SurfacePlace& place) {
  const double distance = std::min(farthest_camera, place.free_distance / 2);
  return {.eye = place.sensor.point + distance * place.sensor.normal,
          .target = place.sensor.point,
          .projection = Projection::orthographic,
          .height = std::min(1e-3, 0.01 * place.width)};
}

struct Pictures {
  const Simulation& simulation;
  SolvedLight light;
  SmoothField radiance;

  // The irradiance of one picture.
  Spectrum irradiance(const SurfacePlace& place, std::uint32_t seed) const {
    const Scene& scene = simulation.world->scene();
    const Camera camera = camera_of(place);
    const FinalGatherOptions options{.width = 3, .height = 3, .seed = seed};
    const Lens lens(camera, picture_up(camera, scene.up, scene.north), options.width, options.height);
    const GatheredImage taken = final_gather(light, radiance, lens, options);
    const Spectrum sent = std::numbers::pi * taken.image.pixels.colwise().mean();
    return (sent - light.exitance.row(place.patch)) / reflectance_at(light, place.patch, place.sensor.point);
  }
};

}  // namespace

std::vector<SurfacePlace> draw_surface_places(const Simulation& simulation, std::size_t count, std::uint64_t seed) {
  const SolvedLight light = solved_light(simulation);
  std::vector<SurfacePlace> places;
  std::vector<Sensor> sensors;
  const auto random = [&](std::uint64_t k, std::uint64_t use) { return (hash({seed, k, use}) + 0.5) * 0x1p-32; };
  for (std::uint64_t k = 0; k < 100 * count && places.size() < 2 * count; ++k) {
    const auto patch = static_cast<PatchIndex>(random(k, 0) * simulation.mesh.size());
    if (!is_opaque_and_matte(simulation, light, patch)) continue;
    const auto place = place_in(simulation, patch, random(k, 1), random(k, 2));
    if (!place) continue;
    places.push_back(*place);
    sensors.push_back(place->sensor);
  }
  const Readings readings = read_sensors(simulation, {{.name = "places", .sensors = sensors}}).readings;
  std::vector<SurfacePlace> free;
  for (std::size_t k = 0; k < places.size() && free.size() < count; ++k)
    if (!is_inside_wall(readings, k)) free.push_back(places[k]);
  return free;
}

PlaceIrradiance picture_irradiance(const Simulation& simulation, std::span<const SurfacePlace> places,
                                   std::uint32_t seeds) {
  const Pictures pictures{
      simulation, solved_light(simulation),
      smooth(simulation.mesh, display_radiance(simulation), simulation.problem.area, simulation.world->all_faces())};
  const auto rows = static_cast<Eigen::Index>(places.size());
  PlaceIrradiance found{Field(rows, simulation.problem.exitance.cols()), {}};
  found.standard_error = found.irradiance;
  for (std::size_t k = 0; k < places.size(); ++k) {
    Field each(seeds, found.irradiance.cols());
    for (std::uint32_t seed = 0; seed < seeds; ++seed) each.row(seed) = pictures.irradiance(places[k], seed + 1);
    const auto row = static_cast<Eigen::Index>(k);
    found.irradiance.row(row) = each.colwise().mean();
    const Field off = each.rowwise() - found.irradiance.row(row).eval();
    found.standard_error.row(row) = (off.square().colwise().sum() / (seeds * (seeds - 1.0))).sqrt();
  }
  return found;
}

}  // namespace patchlight::test
