// The color chart: sums over its spectra give the reference colors under D65.
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "light/photometry.h"
#include "scene/spectral_bands.h"
#include "support/meshes.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <string>

namespace patchlight::color_chart_test {
namespace {

struct FieldOfChart {
  const char* name;
  double Y, x, y;
};

// Spectra of Ohta 1997, summed every 5 nm from 380 to 780 nm with the CIE 1931 observer; rounded to four digits.
constexpr std::array<FieldOfChart, 4> expected = {{{"red", 0.1183, 0.5423, 0.3179},
                                                   {"blue", 0.0623, 0.1884, 0.1395},
                                                   {"green", 0.2357, 0.3047, 0.4953},
                                                   {"neutral_5", 0.2031, 0.3126, 0.3287}}};

Scene chart(Eigen::Index bands) {
  ReadOptions options;
  options.bands = BandsAsked{.edges_nm = equal_edges(bands)};
  return read_scene(mesh_folder() / "color_chart_d65.toml", options);
}

// Without interreflection a patch emits rho o H / pi of the lamp's light H, and a white patch H / pi.
TEST(ColorChart, FieldsUnderD65WithoutInterreflectionHaveTheirColours) {
  const Scene scene = chart(81);
  Request request;
  request.mesh.patches = 300;
  request.accuracy.error_bars = false;
  request.effects.skip = {Effect::interreflection};
  const Simulation simulation = simulate(scene, request);
  for (const FieldOfChart& field : expected) {
    const auto material = std::find_if(scene.materials.begin(), scene.materials.end(),
                                       [&](const Material& m) { return m.name == field.name; });
    ASSERT_NE(material, scene.materials.end());
    const auto index = static_cast<MaterialIndex>(material - scene.materials.begin());
    int patches = 0;
    for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
      if (simulation.mesh.material[i] != index) continue;
      ++patches;
      const Eigen::Vector3d xyz = xyz_of(simulation.solution.radiosity.row(i), scene.bands) /
                                  luminance(simulation.solution.irradiance.row(i), scene.bands);
      // Rounding of the table, and of bands of 4.9 nm.
      EXPECT_NEAR(xyz.x(), field.x / field.y * field.Y, 1e-3) << field.name;
      EXPECT_NEAR(xyz.y(), field.Y, 1e-3) << field.name;
      EXPECT_NEAR(xyz.z(), (1 - field.x - field.y) / field.y * field.Y, 1e-3) << field.name;
    }
    EXPECT_GT(patches, 0);
  }
}

// colour_error() bounds the true error: light after many reflections, fine bands against few.
TEST(ColorChart, ErrorsOfFewBandsAreBelowTheirBound) {
  Request request;
  request.mesh.patches = 400;
  request.accuracy.error_bars = false;
  const Scene fine = chart(100);
  const Simulation reference = simulate(fine, request);
  ReadOptions as_rgb;
  as_rgb.bands = BandsAsked{};
  as_rgb.bands->color_error = 2;
  const Scene few = read_scene(mesh_folder() / "color_chart_d65.toml", as_rgb);
  const Simulation simulation = simulate(few, request);
  ASSERT_LT(number_of_bands(few), 20);
  ASSERT_EQ(simulation.mesh.size(), reference.mesh.size());
  double worst = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    const Eigen::Vector3d white =
        Eigen::Vector3d(xyz_from_rgb().rowwise().sum()) * luminance(reference.solution.irradiance.row(i), fine.bands);
    worst = std::max(worst, colour_difference(lab_of(xyz_of(simulation.solution.radiosity.row(i), few.bands), white),
                                              lab_of(xyz_of(reference.solution.radiosity.row(i), fine.bands), white)));
  }
  EXPECT_LT(worst, 2);
  EXPECT_GT(worst, 0.05);  // the test can fail
}

}  // namespace
}  // namespace patchlight::color_chart_test
