#include "input/tables/read_tables.h"
#include "light/photometry.h"
#include "model_files.h"

#include <numbers>

namespace patchlight::read_spectrum_test {
namespace {

class ReadSpectrum : public ModelFiles {
 protected:
  SampledSpectrum read(const std::string& text) const { return read_spectrum(write("paint.spd", text)); }
};

TEST_F(ReadSpectrum, ReadsColumnsHoweverTheyAreSeparated) {
  for (const char* text : {"wavelength_nm,value\n400,0.1\n500,0.2\n", "# by hand\n400 0.1 # blue\r\n\n500\t0.2\r\n",
                           "400; 0.1\n500; 0.2"}) {
    SCOPED_TRACE(text);
    const SampledSpectrum spectrum = read(text);
    EXPECT_EQ(spectrum.wavelengths, (std::vector<double>{400, 500}));
    EXPECT_EQ(spectrum.values, (std::vector<double>{0.1, 0.2}));
    EXPECT_EQ(spectrum.name, "paint.spd");
  }
}

constexpr const char* argyll =
    "SPECT\n\nSPECTRAL_BANDS \"3\"\nSPECTRAL_START_NM \"400.0\"\nSPECTRAL_END_NM \"700.0\"\nSPECTRAL_NORM \"100.0\"\n\n"
    "NUMBER_OF_FIELDS 4\nBEGIN_DATA_FORMAT\nSAMPLE_ID SPEC_400 SPEC_550 SPEC_700\nEND_DATA_FORMAT\n\nNUMBER_OF_SETS 1\n"
    "BEGIN_DATA\n1 10.0 25.5 ";

TEST_F(ReadSpectrum, ReadsWhatArgyllWrites) {
  const SampledSpectrum spectrum = read(std::string(argyll) + "90.0\nEND_DATA\n");
  EXPECT_EQ(spectrum.wavelengths, (std::vector<double>{400, 550, 700}));
  EXPECT_EQ(spectrum.values, (std::vector<double>{0.1, 0.255, 0.9}));
}

TEST_F(ReadSpectrum, RefusesWithFileAndLine) {
  const std::string two = argyll;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"400 0.1\n500 -0.1\n", ".spd:2: found -0.1 at 500 nm"},
      {"400 0.1\n\n390 0.2\n", ".spd:3: found the wavelength 390 nm after 400 nm"},
      {"400 0.1\n400 0.2\n", ".spd:2: found the wavelength 400 nm after 400 nm"},
      {"400 0.1\n410 nan\n", ".spd:2: found 'nan'"},
      {"nm value\nnm value\n", ".spd:2: found 'nm'"},
      {"400 0.1 0.2\n", ".spd:1: found 3 values"},
      {"380nm, 0.04\n390, 0.05\n", ".spd:1: found '380nm'"},
      {"SPECTRAL_BANDS \"2.5\"\nSPECTRAL_START_NM 400\nSPECTRAL_END_NM 700\n", "SPECTRAL_BANDS of 2 or more"},
      {"0 1\n", ".spd:1: found the wavelength 0"},
      {"# nothing\n", "found no spectrum"},
      {two + "END_DATA\n", "found 2 values between BEGIN_DATA and END_DATA; expected the 3"},
      {two + "x\nEND_DATA\n", ".spd:15: found 'x'"},
      {"SPECTRAL_BANDS \"1e300\"\nSPECTRAL_START_NM 400\nSPECTRAL_END_NM 700\n", "SPECTRAL_BANDS of 2 or more"}};
  for (const auto& [text, part] : cases) {
    SCOPED_TRACE(text);
    try {
      read(text);
      FAIL() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

constexpr const char* room =
    "[[model]]\nfile = \"room.obj\"\n[[material]]\nname = \"wall\"\nreflectance = 0.5\n[[material]]\nname = \"lamp\"\n"
    "radiance = 10\n";

class SpectraOfScenes : public ModelFiles {
 protected:
  SpectraOfScenes() {
    write("room.obj",
          "mtllib room.mtl\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 1 1 2.5\nv 1 2 2.5\nv 2 2 2.5\nv 2 1 2.5\n"
          "usemtl wall\nf 1 2 3 4\nusemtl lamp\nf 5 6 7 8\n");
    write("room.mtl", "newmtl wall\nKd .1 .2 .3\nnewmtl lamp\nKd 0 0 0\n");
    write("percent.csv", "400,10\n700,90\n");
    write("dark.csv", "900,1\n1000,1\n");
    write("blue.csv", "400,0.9\n700,0\n");
  }
  Scene read(const std::string& more) const { return read_scene(write("scene.toml", room + more)); }
};

TEST_F(SpectraOfScenes, AreRefusedWithTheLineThatNamesThem) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"[[material]]\nname = \"wall\"\nreflectance = \"missing.csv\"\n", "scene.toml:11: material.reflectance"},
      {"[[material]]\nname = \"wall\"\nreflectance = \"percent.csv\"\n",
       "scene.toml:11: material.reflectance: found 10 at"},
      {"[[material]]\nname = \"wall\"\nreflectance = \"D65\"\n", "scene.toml:11: material.reflectance: found 'D65'"},
      {"[[material]]\nname = \"lamp\"\nspectrum = \"dark.csv\"\n", "expected a spectrum with light between"},
      {"[[material]]\nname = \"lamp\"\nspectrum = {kelvin = 10}\n", "500 to 100000 K"},
      {"[[material]]\nname = \"lamp\"\nspectrum = {daylight = 3000}\n", "4000 to 25000 K"},
      {"[[material]]\nname = \"lamp\"\nradiance = {kelvin = 3000}\n", "e.g. spectrum = {kelvin = 2700}"},
      {"[[material]]\nname = \"lamp\"\nexitance = \"blue.csv\"\nspectrum = \"A\"\n",
       "expected one of exitance, spectrum"},
      {"[spectra]\nbands = 0\n", "scene.toml:10: spectra.bands: found 0"},
      {"[spectra]\nbands = \"many\"\n", "expected one of 'rgb', 'auto'"},
      {"[spectra]\nedges_nm = [500, 400]\n", "increasing wavelengths from 380 to 780 nm"},
      {"[spectra]\nbands = 3\nedges_nm = [400, 500]\n", "expected one of bands, edges_nm"},
      {"[sky]\nkind = \"uniform\"\nilluminance = 1\ncolor_temperature = 2700\n",
       "scene.toml:12: sky.color_temperature"}};
  for (const auto& [text, part] : cases) {
    SCOPED_TRACE(text);
    const std::string message = refusal(write("scene.toml", room + text));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST_F(SpectraOfScenes, BringBandsOfWavelengthsOnlyWhereThereAreSome) {
  EXPECT_EQ(number_of_bands(read("")), 3);
  EXPECT_FALSE(read("").band_choice);
  const Scene with = read("[[material]]\nname = \"wall\"\nreflectance = \"blue.csv\"\n");
  EXPECT_GT(number_of_bands(with), 3);
  ASSERT_TRUE(with.band_choice);
  for (const char* part : {"1 of 2", "0 of 1"})
    EXPECT_NE(with.band_choice->reason.find(part), std::string::npos) << with.band_choice->reason;
  const Scene rgb = read("[spectra]\nbands = \"rgb\"\n[[material]]\nname = \"wall\"\nreflectance = \"blue.csv\"\n");
  EXPECT_EQ(number_of_bands(rgb), 3);
  EXPECT_GT(rgb.materials[0].reflectance[2], rgb.materials[0].reflectance[0]);
  EXPECT_FALSE(rgb.band_choice->spectral);
}

// A single number for a lamp keeps its spectrum. Red, green and blue replace it.
TEST_F(SpectraOfScenes, OfLampsStayWhereTheirStrengthChanges) {
  const std::string lamp =
      "[[material]]\nname = \"lamp\"\nspectrum = \"A\"\n[[material]]\nname = \"lamp\"\nradiance = ";
  EXPECT_TRUE(read(lamp + "20\n").band_choice);
  EXPECT_FALSE(read(lamp + "[20, 10, 5]\n").band_choice);
}

// Two lights with the same distribution over the bands and the expected luminance.
void expect_spread(const Spectrum& found, const Spectrum& as, double luminance_expected, const Bands& bands) {
  EXPECT_NEAR(luminance(found, bands), luminance_expected, 1e-9 * luminance_expected);
  EXPECT_TRUE((found / found.sum()).isApprox(as / as.sum(), 1e-9)) << found.transpose() << " is not " << as.transpose();
}

// The same when it is relit from stored form factors.
TEST_F(SpectraOfScenes, OfSolvedScenesTakeNewLight) {
  const std::string bands = "[spectra]\nbands = 16\n";
  const auto lamp = [&](const std::string& value) {
    return read(bands + "[[material]]\nname = \"lamp\"\nradiance = " + value + "\n");
  };
  const auto changed = [](const Scene& scene, const std::vector<std::string>& settings) {
    ReadOptions options;
    for (const std::string& setting : settings) options.settings.push_back(parse_material_setting(setting));
    return with_options(scene, options);
  };
  const Scene scene = read(bands);
  EXPECT_TRUE((changed(scene, {"wall.reflectance=0.3", "lamp.radiance=0"}).materials[0].reflectance == 0.3).all());
  EXPECT_FALSE(has(changed(scene, {"wall.reflectance=0.3"}).diagnostics, DiagnosticCode::simplified_light));
  const std::size_t m = scene.materials[0].name == "lamp" ? 0 : 1;
  // A new color gets the same spectrum as a color from a file. It replaces the lamp's spectrum.
  const Scene orange = changed(scene, {"lamp.radiance=20,10,5"});
  expect_spread(orange.materials[m].exitance, lamp("[20, 10, 5]").materials[m].exitance,
                std::numbers::pi * luminance(rgb(20, 10, 5)), scene.bands);
  EXPECT_TRUE(has(orange.diagnostics, DiagnosticCode::simplified_light));
  ;
  // A number makes it brighter.
  expect_spread(changed(orange, {"lamp.exitance=7"}).materials[m].exitance, orange.materials[m].exitance,
                luminance(rgb(7, 7, 7)), scene.bands);
}

TEST_F(SpectraOfScenes, OfSolvedScenesTakeNewDaylight) {
  const Scene scene = read("[spectra]\nbands = 16\n");
  ReadOptions options;
  options.daylight.sky = SkyKind::uniform;
  const Scene lit = with_options(scene, options);
  ASSERT_TRUE(lit.sky);
  const Scene as_read = read("[spectra]\nbands = 16\n[sky]\nkind = \"uniform\"\nilluminance = 1000\n");
  const Scene in_rgb = with_options(read(""), options);
  expect_spread(lit.sky->horizontal_irradiance, as_read.sky->horizontal_irradiance,
                luminance(in_rgb.sky->horizontal_irradiance), scene.bands);
  // The ground has the color of the light on it.
  expect_spread(lit.sky->ground_radiance, lit.sky->horizontal_irradiance, luminance(in_rgb.sky->ground_radiance),
                scene.bands);
}

// Light outside the bands is omitted, in settings and in files.
TEST_F(SpectraOfScenes, OfPartOfTheLightStayWhereTheSameIsSet) {
  const std::string part = "[spectra]\nedges_nm = [500, 600]\n";
  const Scene scene = read(part);
  const std::size_t m = scene.materials[0].name == "lamp" ? 0 : 1;
  ReadOptions options;
  options.settings = {parse_material_setting("lamp.radiance=10")};
  const Scene same = with_options(scene, options);
  EXPECT_LT(luminance(scene.materials[m].exitance, scene.bands), .9 * std::numbers::pi * luminance(rgb(10, 10, 10)));
  EXPECT_TRUE(same.materials[m].exitance.isApprox(scene.materials[m].exitance, 1e-12))
      << same.materials[m].exitance << " instead of " << scene.materials[m].exitance;
  // Diffuse ground of reflectance rho has the radiance rho / pi times the irradiance, in every band.
  const std::string sky = "[sky]\nkind = \"uniform\"\nilluminance = 1000\n[ground]\nreflectance = 0.3\n";
  const Scene lit = read(part + sky);
  const Spectrum expected = .3 / std::numbers::pi * lit.sky->horizontal_irradiance;
  EXPECT_TRUE(lit.sky->ground_radiance.isApprox(expected, 1e-12)) << lit.sky->ground_radiance << " not " << expected;
  options.settings.clear();
  options.daylight.sky = SkyKind::uniform;
  const auto in_rgb = *with_options(read(""), options).sky;
  const auto in_part = *with_options(scene, options).sky;
  const double ratio = luminance(in_rgb.ground_radiance) / luminance(in_rgb.horizontal_irradiance);
  EXPECT_TRUE(in_part.ground_radiance.isApprox(ratio * in_part.horizontal_irradiance, 1e-12))
      << in_part.ground_radiance;
}

TEST_F(SpectraOfScenes, AreInputsOfTheScene) {
  const Scene scene = read("[[material]]\nname = \"wall\"\nreflectance = \"blue.csv\"\n");
  EXPECT_TRUE(std::any_of(scene.inputs.begin(), scene.inputs.end(),
                          [](const std::filesystem::path& file) { return file.filename() == "blue.csv"; }));
  write("blue.csv", "400,0.8\n700,0\n");
  EXPECT_NE(read("[[material]]\nname = \"wall\"\nreflectance = \"blue.csv\"\n").sha256, scene.sha256);
}

}  // namespace
}  // namespace patchlight::read_spectrum_test
