#pragma once

#include "patchlight/scene/scene.h"

#include "light/spectra.h"
#include "scene/photometric_web.h"

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace patchlight {

/// Bands of wavelengths, inside of which light is spread in one way.
class WavelengthBands {
 public:
  /// From edges in nm, growing, two or more, within 380 and 780; `light` is how light is spread in each.
  WavelengthBands(const std::vector<double>& edges_nm, const Cells& light);

  /// The mean over each band, by the light there.
  Spectrum mean_of(const Cells& share) const { return (share_weights_ * share.matrix()).transpose().array(); }

  /// The light in each band, where `light` is per nm.
  Spectrum sum_of(const Cells& light) const { return (overlap_ * light.matrix()).transpose().array(); }

  /// Their names, weights and colors.
  Bands bands() const;

  /// True when they reach from 380 to 780 nm.
  bool are_of_all_light() const { return edges_nm_.front() <= 380 && edges_nm_.back() >= 780; }

 private:
  std::vector<double> edges_nm_;
  Eigen::Matrix<double, Eigen::Dynamic, number_of_cells> overlap_;        // the part of each cell, 0 to 1
  Eigen::Matrix<double, Eigen::Dynamic, number_of_cells> share_weights_;  // rows sum up to 1
};

/// True for whole numbers from 1 to 400, a band for each nm.
bool is_number_of_bands(double number);

/// `number` bands of one width, nm.
std::vector<double> equal_edges(Eigen::Index number, double from = shortest_wavelength, double to = longest_wavelength);

/// A light of a scene in linear RGB, per nm, such that its luminance is that of its color: spread as the spectrum, or
/// where there is none, D65 times the smooth reflectance of that color.
Cells light_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum);

/// A reflectance or transmittance in linear RGB, or as its spectrum is where there is one. One of gray is even.
Cells share_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum);

/// How all lights of a scene in linear RGB are spread, a luminance of 1 each; of several alike one.
std::vector<Cells> spread_of_lights(const Scene& scene);

/// Calls visit(values, const SampledSpectrum*) for all reflectances and transmittances of a scene, const or not, that
/// are not empty, with their spectra by wavelength or null.
void visit_shares(auto& scene, const auto& visit) {
  const auto each = [&](auto& values, const SampledSpectrum* spectrum) {
    if (values.size() > 0) visit(values, spectrum);
  };
  for (auto& material : scene.materials) {
    const MaterialSpectra& spectra = material.spectra;
    each(material.reflectance, spectra.reflectance.get());
    each(material.transmittance, spectra.transmittance.get());
    each(material.specular_reflectance, spectra.specular_reflectance.get());
    each(material.diffuse_transmittance, spectra.diffuse_transmittance.get());
    if (material.stated_pane) each(material.stated_pane->matt_reflectance, spectra.reflectance.get());
    if (material.stated_mirror) each(material.stated_mirror->matt_reflectance, spectra.reflectance.get());
    if (!material.texture) continue;
    for (auto& values : material.texture->of_primaries) each(values, nullptr);
  }
}

/// The same for all light sources.
void visit_lights(auto& scene, const auto& visit) {
  const auto each = [&](auto& values, const SampledSpectrum* spectrum) {
    if (values.size() > 0) visit(values, spectrum);
  };
  for (auto& material : scene.materials) each(material.exitance, material.spectra.light.get());
  for (auto& luminaire : scene.luminaires) each(strength_of(luminaire), luminaire.spectrum.get());
  if (scene.sun) each(scene.sun->normal_irradiance, scene.sun->spectrum.get());
  if (!scene.sky) return;
  for (auto* values : {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance, &scene.sky->ground_radiance})
    each(*values, scene.sky->spectrum.get());
}

/// A visitor of a quantity with a value for each band: its values, and its spectrum or null.
using OfQuantity = std::function<void(const Spectrum& values, const SampledSpectrum* spectrum)>;

/// Calls one for all reflectances and transmittances, the other for all light sources. Empty spectra are left out.
void for_all_spectra(const Scene& scene, const OfQuantity& of_share, const OfQuantity& of_light);

/// True when something has a spectrum by wavelength.
bool has_spectra(const Scene& scene);

/// The scene, which is in linear RGB, in bands of wavelengths, and without the spectra it had.
Scene in_wavelength_bands(Scene scene, const std::vector<double>& edges_nm);

/// A light in linear RGB, or as its spectrum is where there is one, in the bands of wavelengths of a scene.
Spectrum light_in_bands(const Bands& bands, const Spectrum& rgb, const SampledSpectrum* spectrum);

/// The scene, which is in bands of wavelengths, with its sun and its sky, which are in linear RGB, in these as well.
Scene with_daylight_in_bands(Scene scene);

/// The scene, which is in linear RGB, with the colors of its spectra, and without these.
Scene in_rgb(Scene scene);

/// Bands of wavelengths, and how far colors are off by them.
struct BandsWithError {
  std::vector<double> edges_nm;
  double color_error = 0;  ///< CIE dE00, see colour_error()
};

/// The largest color error of bands with these edges, CIE dE00. It covers the light of each lamp of the scene in linear
/// RGB, direct and after one, two or three reflections, seen beside a white under that lamp. With many materials, those
/// with the largest errors stand for all in multiple reflections.
double colour_error(const Scene& scene, const std::vector<double>& edges_nm);

/// The fewest bands, of a series from 4 to 200, that keep colour_error() within one that is above 0; else the most.
BandsWithError bands_within(const Scene& scene, double color_error);

/// The scene with neighboring bands as one where all reflectances and transmittances are the same in both, and all
/// lights have the same share of their light in each, or none has any: nothing that is linear in light changes.
Scene with_alike_bands_joined(Scene scene);

/// Bands in which all spectra have the same values, in the order of their first. Empty spectra do not count.
std::vector<std::vector<Eigen::Index>> alike_bands(const std::vector<Spectrum>& spectra, Eigen::Index bands);

}  // namespace patchlight
