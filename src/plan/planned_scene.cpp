#include "plan/planned_scene.h"

#include "base/tolerances.h"
#include "light/photometry.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// The scene with every spectrum changed by change(spectrum); empty ones stay empty.
Scene with_spectra(Scene scene, const auto& change) {
  const auto apply = [&](Spectrum& spectrum, const SampledSpectrum*) { spectrum = change(spectrum); };
  visit_shares(scene, apply);
  visit_lights(scene, apply);
  return scene;
}

// The luminance of 1 in every band; for RGB exactly 179.
double luminance_of_ones(const Bands& bands) {
  const double ones = luminance(Spectrum::Ones(static_cast<Eigen::Index>(bands.size())), bands);
  return std::abs(ones - luminous_efficacy) <= tolerance_of_shapes * ones ? luminous_efficacy : ones;
}

// The same luminance without color.
Scene without_colour(Scene scene) {
  const Bands bands = bands_of(scene);
  const double white = luminance_of_ones(bands);
  return with_spectra(std::move(scene), [&](const Spectrum& spectrum) -> Spectrum {
    return Spectrum::Constant(spectrum.size(), luminance(spectrum, bands) / white);
  });
}

bool is_forced(const Plan& plan, Effect effect, bool simulate) {
  return std::any_of(plan.decisions.begin(), plan.decisions.end(), [&](const Decision& decision) {
    return decision.effect == effect && decision.forced && decision.simulate == simulate;
  });
}

bool is_skipped_by_force(const Plan& plan, Effect effect) { return is_forced(plan, effect, false); }

// The scene with the lights that are not left out, and without color when that is skipped by force.
std::shared_ptr<const Scene> with_light(const std::shared_ptr<const Scene>& scene, const Plan& plan,
                                        const auto& left_out) {
  const bool no_luminaires = left_out(Effect::luminaires) && !scene->luminaires.empty();
  const bool no_sun = left_out(Effect::sun) && scene->sun;
  const bool no_sky = left_out(Effect::sky) && scene->sky;
  const bool no_textures = is_skipped_by_force(plan, Effect::textures);
  const bool no_color = is_skipped_by_force(plan, Effect::colour);
  if (!no_luminaires && !no_sun && !no_sky && !no_textures && !no_color) return scene;
  Scene changed = *scene;
  if (no_luminaires) changed.luminaires.clear();
  if (no_sun) changed.sun.reset();
  if (no_sky) changed.sky.reset();
  if (no_textures) {
    for (Material& material : changed.materials) material.texture.reset();
  }
  return std::make_shared<const Scene>(no_color ? without_colour(std::move(changed)) : std::move(changed));
}

}  // namespace

Occluder::Blockers blockers_of(const Plan& plan) {
  if (is_skipped_by_force(plan, Effect::occlusion)) return Occluder::Blockers::none;
  return is_forced(plan, Effect::occlusion, true) ? Occluder::Blockers::all : Occluder::Blockers::inside_hull;
}

Reflections reflections_of(const Plan& plan) {
  const bool follows = plan.assembly.storage == Storage::rays && simulates(plan, Effect::mirrors);
  return follows ? Reflections::followed : Reflections::kept;
}

std::shared_ptr<const Scene> scene_for_sensors(const std::shared_ptr<const Scene>& scene, const Plan& plan) {
  return with_light(scene, plan, [&](Effect effect) { return is_skipped_by_force(plan, effect); });
}

std::shared_ptr<const Scene> scene_as_planned(const std::shared_ptr<const Scene>& scene, const Plan& plan) {
  return with_light(scene, plan, [&](Effect effect) { return !simulates(plan, effect); });
}

Scene in_bands(Scene scene, const std::vector<Eigen::Index>& bands) {
  // 1. The bands.
  const Bands all = bands_of(scene);
  scene.bands.clear();
  double weight = 0;
  for (const Eigen::Index band : bands) {
    scene.bands.push_back(all[static_cast<std::size_t>(band)]);
    weight += scene.bands.back().luminous_weight;
  }
  for (Band& band : scene.bands)
    band.luminous_weight = weight > 0 ? band.luminous_weight / weight : 1 / static_cast<double>(bands.size());

  // 2. Their values. A clear polygon reflects as glass does, also where it lets nothing through.
  for (Material& material : scene.materials) {
    if ((material.transmittance > 0).any())
      material.transmittance = material.transmittance.max(std::numeric_limits<double>::min());
  }
  return with_spectra(std::move(scene), [&](const Spectrum& spectrum) { return Spectrum(spectrum(bands)); });
}

Scene in_one_band(Scene scene, Eigen::Index band) {
  return with_spectra(std::move(scene),
                      [band](const Spectrum& spectrum) { return Spectrum::Constant(1, spectrum[band]); });
}

}  // namespace patchlight
