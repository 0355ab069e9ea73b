#include "scene/spectral_bands.h"

#include "base/rounded.h"
#include "light/photometry.h"
#include "scene/all_spectra.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace patchlight {
namespace {

// What rounding makes of numbers of about 1.
constexpr double alike_within = 1e-12;

std::string name_of_band(double from, double to) {
  std::ostringstream text;
  text.precision(4);
  text << from << '-' << to << " nm";
  return text.str();
}

bool is_even(const Spectrum& spectrum) { return (spectrum == spectrum[0]).all(); }

// How light is spread inside of bands: as that of all lights together, each as bright as any other.
Cells mean_light(const Scene& scene) {
  Cells sum = Cells::Zero();
  for (const Cells& light : spread_of_lights(scene)) sum += light;
  return (sum > 0).any() ? sum : in_cells(*illuminant_d65_spectrum(), Beyond::zero);
}

// Where the bands are those of all visible light, scaled to the luminance that it had as a colour: else what lies
// beyond them is left out.
Spectrum in_bands_of(const WavelengthBands& to, const Bands& bands, const Spectrum& rgb,
                     const SampledSpectrum* spectrum) {
  const Spectrum values = to.sum_of(light_in_cells(rgb, spectrum));
  const double found = luminance(values, bands);
  return found > 0 && to.are_of_all_light() ? Spectrum(luminance(rgb) / found * values) : values;
}

Spectrum share_in_bands(const WavelengthBands& to, Eigen::Index number, const Spectrum& rgb,
                        const SampledSpectrum* spectrum) {
  if (!spectrum && is_even(rgb)) return Spectrum::Constant(number, rgb[0]);
  return to.mean_of(share_in_cells(rgb, spectrum)).max(0.0).min(1.0);
}

// What is scattered and what goes elsewhere are 1 at most. In a band they may be more where in linear RGB they were
// not.
Scene with_kept_sums(Scene scene) {
  for (Material& material : scene.materials) {
    const Spectrum stated = material.reflectance;
    for (const Spectrum* other :
         {&material.transmittance, &material.specular_reflectance, &material.diffuse_transmittance}) {
      if (other->size() > 0) material.reflectance = material.reflectance.min((1 - *other).max(0.0));
    }
    constexpr double rounding = 1e-9;
    Eigen::Index band = 0;
    if (stated.size() == 0 || (stated - material.reflectance).maxCoeff(&band) <= rounding) continue;
    scene.diagnostics.push_back(
        {DiagnosticCode::lowered_reflectance,
         "material '" + material.name + "': what it reflects and lets through is more than 1, as in " +
             scene.bands[static_cast<std::size_t>(band)].name + "; there it scatters " +
             rounded(material.reflectance[band], 2) + " instead of " + rounded(stated[band], 2)});
  }
  return scene;
}

// What lights what lies below the horizon, in the bands that sun and sky have.
Spectrum light_on_ground(const Scene& scene, Eigen::Index bands) {
  Spectrum lit = Spectrum::Zero(bands);
  if (scene.sky->horizontal_irradiance.size() > 0) lit += scene.sky->horizontal_irradiance;
  if (scene.sky->zenith_radiance.size() > 0) lit += scene.sky->zenith_radiance;
  if (scene.sun) lit += std::max(0.0, scene.sun->direction.dot(scene.up)) * scene.sun->normal_irradiance;
  return lit;
}

// What lies below the horizon reflects sun and sky: of their colour, and in the bands the share of them that it is in
// linear RGB. `lit` is their luminance in linear RGB.
Spectrum ground_in_bands(const Scene& scene, Eigen::Index bands, const Spectrum& rgb, double lit) {
  const Spectrum light = light_on_ground(scene, bands);
  return lit > 0 ? Spectrum(luminance(rgb) / lit * light) : light;
}

Scene without_spectra(Scene scene) {
  for (Material& material : scene.materials) material.spectra = {};
  for (Luminaire& luminaire : scene.luminaires) luminaire.spectrum.reset();
  if (scene.sun) scene.sun->spectrum.reset();
  if (scene.sky) scene.sky->spectrum.reset();
  return scene;
}

}  // namespace

WavelengthBands::WavelengthBands(const std::vector<double>& edges_nm, const Cells& light) : edges_nm_(edges_nm) {
  assert(edges_nm.size() >= 2);
  const auto number = static_cast<Eigen::Index>(edges_nm.size()) - 1;
  overlap_.setZero(number, number_of_cells);
  for (Eigen::Index band = 0; band < number; ++band) {
    const double from = edges_nm[static_cast<std::size_t>(band)], to = edges_nm[static_cast<std::size_t>(band) + 1];
    for (Eigen::Index cell = 0; cell < number_of_cells; ++cell) {
      const double begin = shortest_wavelength + static_cast<double>(cell);
      overlap_(band, cell) = std::clamp(std::min(to, begin + 1) - std::max(from, begin), 0.0, 1.0);
    }
  }
  share_weights_ = overlap_ * light.matrix().asDiagonal();
  for (Eigen::Index band = 0; band < number; ++band) {
    if (!(share_weights_.row(band).sum() > 0)) share_weights_.row(band) = overlap_.row(band);
    share_weights_.row(band) /= share_weights_.row(band).sum();
  }
}

Bands WavelengthBands::bands() const {
  Bands bands;
  // The mean of the observer over each band, by the light there.
  const Eigen::Matrix3Xd xyz = observer_in_cells().matrix() * share_weights_.transpose();
  for (Eigen::Index band = 0; band < xyz.cols(); ++band) {
    const auto k = static_cast<std::size_t>(band);
    const Eigen::Vector3d of_one_watt = xyz_per_watt(xyz.col(band)) / luminous_efficacy;
    const Eigen::Vector3d rgb = rgb_from_xyz() * of_one_watt;
    bands.push_back({name_of_band(edges_nm_[k], edges_nm_[k + 1]),
                     of_one_watt.y(),
                     {rgb.x(), rgb.y(), rgb.z()},
                     {edges_nm_[k], edges_nm_[k + 1]}});
  }
  return bands;
}

bool is_number_of_bands(double number) {
  return number >= 1 && number <= static_cast<double>(number_of_cells) && number == std::floor(number);
}

std::vector<double> equal_edges(Eigen::Index number) {
  std::vector<double> edges;
  for (Eigen::Index k = 0; k <= number; ++k)
    edges.push_back(shortest_wavelength +
                    (longest_wavelength - shortest_wavelength) * static_cast<double>(k) / static_cast<double>(number));
  return edges;
}

Cells light_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum) {
  Cells light = Cells::Zero();
  if (spectrum) {
    light = in_cells(*spectrum, Beyond::zero);
  } else {
    for (std::size_t k = 0; k < 3; ++k) light += rgb[static_cast<Eigen::Index>(k)] * reflectances_of_primaries()[k];
    light *= in_cells(*illuminant_d65_spectrum(), Beyond::zero);
  }
  const double found = luminance_of_cells(light);
  return found > 0 ? Cells(luminance(rgb) / found * light) : Cells(Cells::Zero());
}

Cells share_in_cells(const Spectrum& rgb, const SampledSpectrum* spectrum) {
  if (spectrum) return in_cells(*spectrum, Beyond::end);
  if (is_even(rgb)) return Cells::Constant(rgb[0]);
  Cells share = Cells::Zero();
  for (std::size_t k = 0; k < 3; ++k) share += rgb[static_cast<Eigen::Index>(k)] * reflectances_of_primaries()[k];
  return share;
}

void for_all_spectra(const Scene& scene, const OfQuantity& of_share, const OfQuantity& of_light) {
  // Nothing is changed of the copy.
  Scene copy = without_geometry(scene);
  const auto told = [](const OfQuantity& of) {
    return [&of](Spectrum& values, const SampledSpectrum* spectrum) { of(values, spectrum); };
  };
  visit_shares(copy, told(of_share));
  visit_lights(copy, told(of_light));
}

std::vector<Cells> spread_of_lights(const Scene& scene) {
  std::vector<Cells> all;
  for_all_spectra(
      scene, [](const Spectrum&, const SampledSpectrum*) {},
      [&](const Spectrum& rgb, const SampledSpectrum* spectrum) {
        Cells light = light_in_cells(rgb, spectrum);
        const double luminance = luminance_of_cells(light);
        if (!(luminance > 0)) return;
        light /= luminance;
        const double size = light.maxCoeff();
        const bool is_known = std::any_of(all.begin(), all.end(), [&](const Cells& other) {
          return ((other - light).abs() <= alike_within * size).all();
        });
        if (!is_known) all.push_back(light);
      });
  return all;
}

bool has_spectra(const Scene& scene) {
  bool found = false;
  const OfQuantity look = [&found](const Spectrum&, const SampledSpectrum* spectrum) { found = found || spectrum; };
  for_all_spectra(scene, look, look);
  return found;
}

Scene in_wavelength_bands(Scene scene, const std::vector<double>& edges_nm) {
  assert(number_of_bands(scene) == 3);
  const WavelengthBands to(edges_nm, mean_light(scene));
  const Bands bands = to.bands();
  const auto number = static_cast<Eigen::Index>(bands.size());
  visit_shares(scene, [&](Spectrum& values, const SampledSpectrum* spectrum) {
    values = share_in_bands(to, number, values, spectrum);
  });
  std::optional<Spectrum> ground;
  if (scene.sky && scene.sky->ground_radiance.size() > 0) ground = std::exchange(scene.sky->ground_radiance, {});
  const double lit = ground ? luminance(light_on_ground(scene, 3)) : 0;
  const auto take_to_bands = [&](Spectrum& values, const SampledSpectrum* spectrum) {
    values = in_bands_of(to, bands, values, spectrum);
  };
  visit_lights(scene, take_to_bands);
  visit_matt_lights(scene, take_to_bands);
  if (ground) scene.sky->ground_radiance = ground_in_bands(scene, number, *ground, lit);
  scene.bands = bands;
  return without_spectra(with_kept_sums(std::move(scene)));
}

Spectrum light_in_bands(const Bands& bands, const Spectrum& rgb, const SampledSpectrum* spectrum) {
  std::vector<double> edges_nm = {bands.front().edges_nm[0]};
  for (const Band& band : bands) edges_nm.push_back(band.edges_nm[1]);
  // What light there is in a band does not depend on how it is spread inside.
  return in_bands_of(WavelengthBands(edges_nm, Cells::Ones()), bands, rgb, spectrum);
}

Scene with_daylight_in_bands(Scene scene) {
  const Bands bands = scene.bands;
  const double lit = scene.sky ? luminance(light_on_ground(scene, 3)) : 0;
  if (scene.sun) {
    scene.sun->normal_irradiance = light_in_bands(bands, scene.sun->normal_irradiance, scene.sun->spectrum.get());
    scene.sun->spectrum.reset();
  }
  if (!scene.sky) return scene;
  for (Spectrum* const values : {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance})
    if (values->size() > 0) *values = light_in_bands(bands, *values, scene.sky->spectrum.get());
  scene.sky->spectrum.reset();
  if (scene.sky->ground_radiance.size() > 0)
    scene.sky->ground_radiance =
        ground_in_bands(scene, static_cast<Eigen::Index>(bands.size()), scene.sky->ground_radiance, lit);
  return scene;
}

Scene in_rgb(Scene scene) {
  assert(number_of_bands(scene) == 3);
  const auto take_to_rgb = [](Spectrum& values, const SampledSpectrum* spectrum) {
    if (spectrum) values = luminance(values) / luminous_efficacy * rgb_of_light(*spectrum);
  };
  visit_lights(scene, take_to_rgb);
  visit_matt_lights(scene, take_to_rgb);
  return without_spectra(std::move(scene));
}

}  // namespace patchlight
