#pragma once

#include "patchlight/scene/scene.h"

#include <type_traits>
#include <variant>

namespace patchlight {

/// What of a scene has spectra, and what is needed to know how they are meant.
inline Scene without_geometry(const Scene& scene) {
  Scene kept;
  kept.materials = scene.materials;
  kept.luminaires = scene.luminaires;
  kept.sun = scene.sun;
  kept.sky = scene.sky;
  kept.bands = scene.bands;
  return kept;
}

/// Calls visit(Spectrum&, const SampledSpectrum*) for all reflectances and transmittances of a scene that are not
/// empty, with their spectra by wavelength or null.
template <typename Visit>
void visit_shares(Scene& scene, const Visit& visit) {
  const auto each = [&](Spectrum& values, const SampledSpectrum* spectrum) {
    if (values.size() > 0) visit(values, spectrum);
  };
  for (Material& material : scene.materials) {
    const MaterialSpectra& spectra = material.spectra;
    each(material.reflectance, spectra.reflectance.get());
    each(material.transmittance, spectra.transmittance.get());
    each(material.specular_reflectance, spectra.specular_reflectance.get());
    each(material.diffuse_transmittance, spectra.diffuse_transmittance.get());
    if (material.stated_pane) each(material.stated_pane->matt_reflectance, spectra.reflectance.get());
    if (material.stated_mirror) each(material.stated_mirror->matt_reflectance, spectra.reflectance.get());
    if (!material.texture) continue;
    for (Spectrum& values : material.texture->of_primaries) each(values, nullptr);
  }
}

/// The same for what surfaces would emit that emit less because of what a model file says of them.
template <typename Visit>
void visit_matt_lights(Scene& scene, const Visit& visit) {
  for (Material& material : scene.materials) {
    if (!material.stated_pane || material.stated_pane->matt_exitance.size() == 0) continue;
    visit(material.stated_pane->matt_exitance, material.spectra.light.get());
  }
}

/// The same for all that gives light.
template <typename Visit>
void visit_lights(Scene& scene, const Visit& visit) {
  const auto each = [&](Spectrum& values, const SampledSpectrum* spectrum) {
    if (values.size() > 0) visit(values, spectrum);
  };
  for (Material& material : scene.materials) each(material.exitance, material.spectra.light.get());
  for (Luminaire& luminaire : scene.luminaires) {
    const SampledSpectrum* const spectrum = luminaire.spectrum.get();
    std::visit(
        [&](auto& light) {
          using Light = std::decay_t<decltype(light)>;
          if constexpr (std::is_same_v<Light, WebLight>) {
            each(light.watts_per_lumen, spectrum);
          } else if constexpr (std::is_same_v<Light, SphericalLamp>) {
            each(light.exitance, spectrum);
          } else {
            each(light.intensity, spectrum);
          }
        },
        luminaire.light);
  }
  if (scene.sun) each(scene.sun->normal_irradiance, scene.sun->spectrum.get());
  if (!scene.sky) return;
  for (Spectrum* values : {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance, &scene.sky->ground_radiance})
    each(*values, scene.sky->spectrum.get());
}

}  // namespace patchlight
