#include "study/few_paths.h"

#include "base/sampling.h"
#include "base/vectors.h"
#include "lighting/lighting.h"
#include "study/left_out.h"
#include "verify/lights.h"
#include "verify/ray_end.h"

#include <vector>

namespace patchlight {
namespace {

// Patches in which light is looked at, and points in each.
constexpr std::size_t looked_at = 64;
constexpr std::uint32_t points_in_each = 256;

std::vector<LitPlace> places_in(const PatchMesh& mesh, PatchIndex patch) {
  std::vector<LitPlace> places;
  for (const auto& u : scrambled_sobol(points_in_each, hash({patch, 0x706f6f6c}))) {
    const Point point = square_to_quad(mesh.corner_points(patch).points, u[0], u[1]);
    const double choice = uniform({patch, places.size(), 0x706f6f6c});
    places.push_back({{point, mesh.normal[patch], mesh.polygon[patch]}, choice, {u[2], u[3]}});
  }
  return places;
}

// Per patch the mean square of the light of luminaires and sun over the square of its mean, which is above 1 where a
// pool of light is smaller than the patch; 1 where that is not looked at.
Eigen::ArrayXd unevenness_of(const Scene& scene, const Simulation& simulation, const Eigen::VectorXd& flux) {
  Eigen::ArrayXd unevenness = Eigen::ArrayXd::Ones(flux.size());
  if (!has_point_or_daylight(scene)) return unevenness;
  const Lighting lighting = lighting_of(scene, *simulation.tracing);
  const std::vector<std::uint32_t> patches =
      drawn_by_weight({flux.data(), static_cast<std::size_t>(flux.size())}, looked_at, {1, 0x706f6f6c});
  for (const std::uint32_t patch : patches) {
    Eigen::ArrayXd light = irradiance_by_lights(lighting, places_in(simulation.mesh, patch)).rowwise().sum();
    if (!(light.maxCoeff() > 0)) continue;
    light /= light.maxCoeff();  // squares of what is left far from a spot's axis would be 0
    unevenness[patch] = light.square().mean() / (light.mean() * light.mean());
  }
  return unevenness;
}

}  // namespace

Spectrum few_paths_error(const Scene& scene, const Simulation& simulation, std::uint32_t paths) {
  const Eigen::VectorXd& area = simulation.problem.area;
  const Field reflected = simulation.problem.scattering.reflect(simulation.solution.direct_irradiance);
  const Eigen::VectorXd flux = (area.array() * reflected.rowwise().sum()).matrix();
  const Field squares = reflected.square().colwise() * unevenness_of(scene, simulation, flux);
  const Eigen::ArrayXd light = area_sum(reflected, area);
  const Eigen::ArrayXd mean = (light > 0).select(area_sum(squares, area) / light, 0.0);
  return (bound_of_none / paths * mean).transpose();
}

}  // namespace patchlight
