#include "input/with_bands.h"

#include "base/rounded.h"
#include "base/shortest.h"
#include "scene/band_choice.h"
#include "scene/joined_bands.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace patchlight {
namespace {

std::string counted(std::size_t count, std::size_t of, const std::string& noun) {
  return std::to_string(count) + " of " + std::to_string(of) + " " + noun + (of == 1 ? "" : "s");
}

bool has_spectrum(const MaterialSpectra& spectra) {
  return spectra.reflectance || spectra.specular_reflectance || spectra.transmittance || spectra.diffuse_transmittance;
}

// "3 of 5 materials and 1 of 2 lights have spectra"
std::string what_has_spectra(const Scene& scene) {
  const auto materials =
      static_cast<std::size_t>(std::count_if(scene.materials.begin(), scene.materials.end(),
                                             [](const Material& material) { return has_spectrum(material.spectra); }));
  std::size_t lights = 0, with_spectrum = 0;
  for_all_spectra(
      scene, [](const Spectrum&, const SampledSpectrum*) {},
      [&](const Spectrum& values, const SampledSpectrum* spectrum) {
        if (!(values > 0).any()) return;
        ++lights;
        with_spectrum += spectrum ? 1 : 0;
      });
  return counted(materials, scene.materials.size(), "material") + " and " + counted(with_spectrum, lights, "light") +
         " have spectra";
}

std::string bands_in_words(std::size_t number) { return std::to_string(number) + (number == 1 ? " band" : " bands"); }

Scene in_asked_bands(Scene scene, const std::vector<double>& edges_nm) {
  const std::size_t number = edges_nm.size() - 1;
  const std::string has = what_has_spectra(scene);
  const double error = colour_error(scene, edges_nm);
  scene = in_wavelength_bands(std::move(scene), edges_nm);
  scene.band_choice = BandChoice{
      true,
      has + "; " + bands_in_words(number) + " are asked for, colours are off by up to " + rounded(error, 2) + " dE00",
      "the solution has " + bands_in_words(number) + " instead of 3"};
  return scene;
}

Scene in_needed_bands(Scene scene, double color_error) {
  const std::string has = what_has_spectra(scene);
  const BandsWithError chosen = bands_within(scene, color_error);
  const std::size_t number = chosen.edges_nm.size() - 1;
  scene = with_alike_bands_joined(in_wavelength_bands(std::move(scene), chosen.edges_nm));
  std::string reason = has + "; with " + bands_in_words(number) + " colours are off by up to " +
                       rounded(chosen.color_error, 2) + " dE00, " + shortest(color_error) + " is asked for";
  if (scene.bands.size() < number)
    reason += "; nothing tells some of them apart, so that " + bands_in_words(scene.bands.size()) + " remain";
  scene.band_choice =
      BandChoice{true, std::move(reason), bands_in_words(scene.bands.size()) + " instead of 400, one for each nm"};
  return scene;
}

}  // namespace

Scene with_bands(Scene scene, const BandsAsked& asked) {
  if (!asked.edges_nm.empty()) return in_asked_bands(std::move(scene), asked.edges_nm);
  if (!has_spectra(scene)) return scene;
  if (!asked.rgb) return in_needed_bands(std::move(scene), asked.color_error);
  const std::string has = what_has_spectra(scene);
  scene = in_rgb(std::move(scene));
  scene.band_choice = BandChoice{false, has + "; linear RGB is asked for, in which they count by their colours",
                                 "3 bands; colours of light that is reflected more than once may be off"};
  return scene;
}

}  // namespace patchlight
