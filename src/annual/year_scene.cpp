#include "annual/year_scene.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "light/photometry.h"
#include "lighting/sky.h"
#include "plan/planned_scene.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace patchlight {
namespace {

Scene without_lamps(Scene scene) {
  for (Material& material : scene.materials) {
    material.exitance *= 0;
    if (material.stated_pane) material.stated_pane->matt_exitance *= 0;
  }
  scene.luminaires.clear();
  scene.sun.reset();
  scene.sky.reset();
  return scene;
}

// Light of 1 lx of the same color as all of these; nothing without any.
std::optional<Spectrum> color_of(const std::vector<Spectrum>& lights, const Bands& bands, const char* what) {
  std::optional<Spectrum> color;
  for (const Spectrum& light : lights) {
    const double lux = luminance(light, bands);
    if (!(lux > 0)) continue;
    if (!color) color = light / lux;
    if (!((light / lux - *color).abs() <= 1e-6 * color->maxCoeff()).all())
      throw InputError("year", std::string("the ") + what + " changes its color; expected one for all hours");
  }
  return color;
}

// Bands in which no material differs. Pictures have all colors.
std::vector<std::vector<Eigen::Index>> bands_alike_in(const Scene& scene, Eigen::Index bands) {
  std::vector<Spectrum> shares;
  visit_shares(scene, [&](const Spectrum& values, const SampledSpectrum*) { shares.push_back(values); });
  const bool has_textures = std::any_of(scene.materials.begin(), scene.materials.end(),
                                        [](const Material& m) { return m.texture.has_value(); });
  if (has_textures) shares.push_back(Spectrum::LinSpaced(bands, 0, 1));
  return alike_bands(shares, bands);
}

double weight_in(const std::vector<Eigen::Index>& group, const Spectrum& color, const Bands& bands) {
  double weight = 0;
  for (const Eigen::Index band : group)
    weight += luminous_efficacy * bands[static_cast<std::size_t>(band)].luminous_weight * color[band];
  return weight;
}

}  // namespace

YearScene scene_of_year(const Scene& read, const Year& year) {
  // 1. The colors of sun and sky.
  const Bands bands = bands_of(read);
  std::vector<Spectrum> suns, skies;
  for (const Daylight& hour : year.hours) {
    if (hour.sun) suns.push_back(hour.sun->normal_irradiance);
    if (hour.sky) skies.push_back(hour.sky->horizontal_irradiance);
  }
  const auto of_sun = color_of(suns, bands, "sun");
  const auto of_sky = color_of(skies, bands, "sky");
  if (!of_sun && !of_sky) throw InputError("year", "found no daylight; expected sun or sky in some hour");

  // 2. The bands that differ, with the weights of daylight.
  const auto groups = bands_alike_in(read, static_cast<Eigen::Index>(bands.size()));
  std::vector<Eigen::Index> first;
  for (const auto& group : groups) first.push_back(group.front());
  YearScene result{in_bands(without_lamps(read), first), {}};
  for (std::size_t k = 0; k < groups.size(); ++k) {
    result.scene.bands[k].luminous_weight = weight_in(groups[k], of_sky ? *of_sky : *of_sun, bands);
    result.sun_weights.push_back(weight_in(groups[k], of_sun ? *of_sun : *of_sky, bands));
  }

  // 3. The reference sky.
  Sky sky{.kind = SkyKind::cie_overcast};
  sky.horizontal_irradiance =
      Spectrum::Constant(static_cast<Eigen::Index>(groups.size()), reference_illuminance / luminous_efficacy);
  result.scene.sky =
      above_ground({{}, sky}, year.ground_reflectance, read.up, static_cast<Eigen::Index>(groups.size())).sky;
  result.scene.photometric = true;
  return result;
}

SunsOfYear suns_of(const Year& year, const Scene& scene) {
  const Bands bands = bands_of(scene);
  SunsOfYear found;
  std::vector<float> lux;
  for (std::size_t hour = 0; hour < year.hours.size(); ++hour) {
    const std::optional<Sun>& sun = year.hours[hour].sun;
    if (!sun || !(sun->direction.dot(scene.up) > 0)) continue;
    found.hours.push_back(hour);
    found.directions.push_back(sun->direction);
    lux.push_back(static_cast<float>(luminance(sun->normal_irradiance, bands)));
  }
  found.illuminance = Eigen::Map<const Eigen::VectorXf>(lux.data(), static_cast<Eigen::Index>(lux.size()));
  return found;
}

Eigen::VectorXf luminances_of(const Sky& sky, double horizontal, double ground, const SkyDivisions& divisions,
                              const Vector& up) {
  const SkyModel model = relative_sky(sky, up);
  // About 5,000 to 9,000 directions.
  const int across = divisions.size() < 300 ? 6 : divisions.size() < 1000 ? 3 : 2;
  Eigen::VectorXf found = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(divisions.size()));
  const auto add_all = [&] {
    double irradiance = 0;
    for (std::size_t d = 1; d < divisions.size(); ++d) {
      double sum = 0, on_ground = 0;
      for (const Vector& direction : divisions.directions(d, across)) {
        const double radiance = relative_radiance(model, direction);
        sum += radiance;
        on_ground += radiance * direction.dot(up);
      }
      found[static_cast<Eigen::Index>(d)] = static_cast<float>(sum / (across * across));
      irradiance += on_ground * divisions.solid_angle(d) / (across * across);
    }
    return irradiance;
  };
  found *= static_cast<float>(horizontal / add_all());
  found[0] = static_cast<float>(ground);
  return found;
}

SkiesOfYear skies_of(const Year& year, const Scene& scene, const SkyDivisions& divisions, const Observer& observer) {
  const Bands bands = bands_of(scene);
  SkiesOfYear found;
  for (std::size_t hour = 0; hour < year.hours.size(); ++hour)
    if (year.hours[hour].sky) found.hours.push_back(hour);
  found.luminance.resize(static_cast<Eigen::Index>(divisions.size()), static_cast<Eigen::Index>(found.hours.size()));
  parallel_for(found.hours.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const Sky& sky = *year.hours[found.hours[k]].sky;
    const double ground = sky.ground_radiance.size() > 0 ? luminance(sky.ground_radiance, bands) : 0;
    found.luminance.col(static_cast<Eigen::Index>(k)) =
        luminances_of(sky, luminance(sky.horizontal_irradiance, bands), ground, divisions, scene.up);
  });
  return found;
}

}  // namespace patchlight
