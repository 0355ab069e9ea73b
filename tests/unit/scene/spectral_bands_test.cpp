#include "scene/spectral_bands.h"

#include "light/photometry.h"
#include "support/scenes.h"

#include <gtest/gtest.h>
#include <memory>
#include <numbers>

namespace patchlight::spectral_bands_test {
namespace {

using namespace test;

std::shared_ptr<const SampledSpectrum> sampled(std::vector<double> wavelengths, std::vector<double> values) {
  return std::make_shared<const SampledSpectrum>(SampledSpectrum{"test", std::move(wavelengths), std::move(values)});
}

// A room with these walls, in linear RGB, and a white lamp with a luminance of 1,790 cd/m^2.
Scene room(const Spectrum& walls) {
  Scene scene = furnished_room(0.5);
  const Spectrum none = Spectrum::Zero(3);
  scene.materials = {{"wall", walls, none}, {"lamp", none, Spectrum::Constant(3, 10 * std::numbers::pi)}};
  return scene;
}

Scene with_kelvin(Scene scene, double kelvin) {
  scene.materials[1].spectra.light = planckian_spectrum(kelvin);
  return scene;
}

Eigen::Vector3d xyz_of_lamp(const Scene& scene) {
  return xyz_of(scene.materials[1].exitance / std::numbers::pi, bands_of(scene));
}

// Light within bands has the spectrum of the only lamp: sums over bands are those over wavelengths.
TEST(WavelengthBands, KeepTheColourOfOneLampHoweverFewTheyAre) {
  const Eigen::Vector3d a = xyz_of_cells(in_cells(*planckian_spectrum(2700), Beyond::zero));
  for (const Eigen::Index number : {1, 3, 16, 77}) {
    const Scene scene = in_wavelength_bands(with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700), equal_edges(number));
    EXPECT_EQ(number_of_bands(scene), number);
    const Eigen::Vector3d xyz = xyz_of_lamp(scene);
    EXPECT_NEAR(xyz.y(), 1790, 1e-9);
    EXPECT_LT((xyz / xyz.y() - a / a.y()).norm(), 1e-12);
    EXPECT_FALSE(scene.materials[1].spectra.light);
  }
}

// With several lights the color of each is approximate, but the luminance is exact.
TEST(WavelengthBands, KeepTheLuminanceOfEachLight) {
  Scene scene = with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700);
  scene.sky = Sky{.horizontal_irradiance = rgb(2, 3, 4)};
  const double before = luminance(scene.sky->horizontal_irradiance);
  scene = in_wavelength_bands(std::move(scene), equal_edges(5));
  EXPECT_NEAR(luminance(scene.sky->horizontal_irradiance, scene.bands) / before, 1, 1e-12);
  EXPECT_NEAR(xyz_of_lamp(scene).y(), 1790, 1e-9);
}

// The smooth spectrum of a color has this color under D65 by construction. One reflection of linear RGB in fine bands
// gives it, too. Bands of a third of a nm, which divide cells, give the same.
TEST(WavelengthBands, KeepColoursOfRgbUnderTheirWhite) {
  const Spectrum colour = rgb(0.6, 0.1, 0.3);
  for (const Eigen::Index number : {400, 320}) {
    const Scene scene = in_wavelength_bands(room(colour), equal_edges(number));
    const Bands bands = bands_of(scene);
    Spectrum found = Spectrum::Zero(3);
    for (Eigen::Index band = 0; band < number; ++band) {
      const double radiance =
          scene.materials[0].reflectance[band] * scene.materials[1].exitance[band] / std::numbers::pi;
      for (Eigen::Index k = 0; k < 3; ++k)
        found[k] += radiance * bands[static_cast<std::size_t>(band)].rgb[static_cast<std::size_t>(k)];
    }
    EXPECT_LT((found / 10 - colour).abs().maxCoeff(), number == 400 ? 1e-4 : 1e-3);
    EXPECT_GE(scene.materials[0].reflectance.minCoeff(), 0);
    EXPECT_LE(scene.materials[0].reflectance.maxCoeff(), 1);
  }
}

TEST(WavelengthBands, KeepGreyEvenAndSharesWithinOne) {
  const Scene grey_one = in_wavelength_bands(room(rgb(0.7, 0.7, 0.7)), equal_edges(16));
  EXPECT_TRUE((grey_one.materials[0].reflectance == 0.7).all());
  Scene sheet = room(rgb(0.3, 0.6, 1));
  sheet.materials[0].diffuse_transmittance = rgb(0.7, 0.4, 0);
  const Material material = in_wavelength_bands(std::move(sheet), equal_edges(16)).materials[0];
  EXPECT_LE((material.reflectance + material.diffuse_transmittance).maxCoeff(), 1);
  EXPECT_GT((material.reflectance + material.diffuse_transmittance).minCoeff(), 0.999);
}

TEST(WavelengthBands, LeaveOutWhatLiesBeyondThem) {
  // Luminances add up over bands that meet at 550 nm. No band includes light above 700 nm.
  const auto lamp_between = [](double from, double to) {
    return xyz_of_lamp(in_wavelength_bands(with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700), {from, to})).y();
  };
  EXPECT_NEAR(lamp_between(400, 550) + lamp_between(550, 700), lamp_between(400, 700), 1e-9);
  EXPECT_LT(lamp_between(400, 550), 0.5 * 1790);
  Scene scene = room(rgb(0.5, 0.5, 0.5));
  scene.materials[1].spectra.light = sampled({600, 610, 620}, {0, 1, 0});
  EXPECT_EQ(xyz_of_lamp(in_wavelength_bands(scene, {400, 550})).y(), 0);
}

TEST(WavelengthBands, TellOfSharesThatAreMoreThanOneInABand) {
  Scene sheet = room(rgb(0.5, 0.1, 0.1));
  sheet.materials[0].spectra.reflectance = sampled({640, 645, 655, 660}, {0, 0.9, 0.9, 0});
  sheet.materials[0].diffuse_transmittance = rgb(0.4, 0.4, 0.4);
  const Scene scene = in_wavelength_bands(std::move(sheet), equal_edges(40));
  const Material& material = scene.materials[0];
  EXPECT_LE((material.reflectance + material.diffuse_transmittance).maxCoeff(), 1);
  ASSERT_EQ(scene.diagnostics.size(), 1U);
  EXPECT_EQ(scene.diagnostics[0].code, DiagnosticCode::lowered_reflectance);
  const std::string& note = scene.diagnostics[0].text;
  EXPECT_NE(note.find("material 'wall'"), std::string::npos) << note;
  EXPECT_NE(note.find(" 0.6 "), std::string::npos) << note;
}

TEST(Rgb, OfSpectraIsTheirColourAndLuminance) {
  const Scene scene = in_rgb(with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700));
  const Spectrum& light = scene.materials[1].exitance;
  EXPECT_NEAR(luminance(light / std::numbers::pi), 1790, 1e-9);
  EXPECT_GT(light[0], 2 * light[2]);
}

// The same sums over all bands before and after, of light and of its rest after two reflections.
TEST(JoinedBands, KeepTheColourOfAllLight) {
  Scene scene = with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700);
  scene.materials[0].spectra.reflectance = sampled({500, 600}, {0.2, 0.8});
  const Scene fine = in_wavelength_bands(std::move(scene), equal_edges(40));
  const Scene joined = with_alike_bands_joined(fine);
  // One below 500 nm, one above 600, and ten between them.
  EXPECT_EQ(number_of_bands(joined), 12);
  EXPECT_EQ(joined.bands.front().name, "380-500 nm");
  EXPECT_EQ(joined.bands.back().edges_nm[0], 600);
  const auto reflected_twice = [](const Scene& of) {
    return xyz_of(of.materials[1].exitance * of.materials[0].reflectance.square(), bands_of(of));
  };
  EXPECT_LT((reflected_twice(joined) - reflected_twice(fine)).norm(), 1e-12 * reflected_twice(fine).norm());
}

TEST(JoinedBands, AreOneWhereAllIsGreyAndAllLightsAreAlike) {
  Scene scene = with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700);
  EXPECT_EQ(number_of_bands(with_alike_bands_joined(in_wavelength_bands(scene, equal_edges(16)))), 1);
  scene.sky = Sky{.horizontal_irradiance = rgb(1, 1, 1)};
  EXPECT_EQ(number_of_bands(with_alike_bands_joined(in_wavelength_bands(scene, equal_edges(16)))), 16);
}

TEST(JoinedBands, WithoutLightGoWithTheirNeighbours) {
  Scene scene = room(rgb(0.5, 0.5, 0.5));
  scene.materials[0].spectra.reflectance = sampled({400, 700}, {0.1, 0.9});
  scene.materials[1].spectra.light = sampled({449, 450, 550, 551}, {0, 1, 1, 0});
  const Scene joined = with_alike_bands_joined(in_wavelength_bands(scene, equal_edges(40)));
  EXPECT_EQ(number_of_bands(joined), 12);  // 440 to 560 nm by ten
  EXPECT_NEAR(xyz_of_lamp(joined).y(), 1790, 1e-9);
}

TEST(JoinedBands, AreNotJoinedByALightThatIsDarkInBoth) {
  // A lamp of only 450 to 550 nm, a warm and a cold sky. The two skies distinguish all other bands.
  Scene scene = room(rgb(0.5, 0.5, 0.5));
  scene.materials[1].spectra.light = sampled({449, 450, 550, 551}, {0, 1, 1, 0});
  scene.sky = Sky{.horizontal_irradiance = rgb(1, 1, 1), .spectrum = planckian_spectrum(2700)};
  scene.sun = Sun{.normal_irradiance = rgb(1, 1, 1), .spectrum = planckian_spectrum(9000)};
  const Scene fine = in_wavelength_bands(scene, equal_edges(16)), joined = with_alike_bands_joined(fine);
  EXPECT_EQ(number_of_bands(joined), 16);
  const double before = luminance(fine.sun->normal_irradiance, fine.bands);
  EXPECT_NEAR(luminance(joined.sun->normal_irradiance, joined.bands) / before, 1, 1e-12);
}

TEST(BandChoice, TakesTheFewestThatAreWithinTheError) {
  Scene scene = with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700);
  scene.materials[0].spectra.reflectance = sampled({400, 550, 560, 700}, {0.1, 0.1, 0.8, 0.8});
  const BandsWithError rough = bands_within(scene, 3), fine = bands_within(scene, 0.1);
  EXPECT_LE(rough.color_error, 3);
  EXPECT_LE(fine.color_error, 0.1);
  EXPECT_LT(rough.edges_nm.size(), fine.edges_nm.size());
  EXPECT_GT(colour_error(scene, equal_edges(4)), 3);
  EXPECT_EQ(fine.color_error, colour_error(scene, fine.edges_nm));
}

TEST(BandChoice, NeedsNoMoreThanTheFewestForGreyUnderOneLamp) {
  const BandsWithError chosen = bands_within(with_kelvin(room(rgb(0.5, 0.5, 0.5)), 2700), 1e-6);
  EXPECT_EQ(chosen.edges_nm.size(), 5U);
}

}  // namespace
}  // namespace patchlight::spectral_bands_test
