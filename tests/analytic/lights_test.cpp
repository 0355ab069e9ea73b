#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

#include "input/tables/read_tables.h"
#include "light/photometry.h"
#include "lighting/direct_irradiance.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <string>

// Light of luminaires and the sun against closed forms, including those of CIE 171:2006, Test cases to assess the
// accuracy of lighting computer programs. Its tables are rounded to four figures. The numbers here are the exact closed
// forms, which differ from the tables by up to 0.22 %.
namespace patchlight::lights_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Spectrum watts(double lumens) { return Spectrum::Constant(1, lumens / luminous_efficacy); }

Scene floor_of(double half_width, double reflectance = 0) {
  const double w = half_width;
  return with_quad(empty_scene({grey(reflectance)}),
                   {Point(-w, -w, 0), Point(w, -w, 0), Point(w, w, 0), Point(-w, w, 0)});
}

double illuminance(const Scene& scene, const SurfacePoint& point) {
  return luminance(direct_irradiance(lighting_of(scene, Tracing(scene)), {&point, 1}).irradiance.row(0));
}

Luminaire isotropic(const Point& position, double lumens) {
  Luminaire lamp;
  lamp.position = position;
  lamp.light = PointLight{watts(lumens) / (4 * pi)};
  return lamp;
}

TEST(PointLuminaire, OfTenThousandLumensAtThreeMetres) {
  // E = Phi / (4 pi) h / (h^2 + r^2)^(3/2), h = 3 m, at r = 0 to 5 m. Rounded to 0.005 lx.
  Scene scene = floor_of(6);
  scene.luminaires = {isotropic(Point(0, 0, 3), 10000)};
  const std::array<double, 6> expected = {88.42, 75.49, 50.93, 31.26, 19.10, 12.04};
  for (std::size_t r = 0; r < expected.size(); ++r) {
    const SurfacePoint here{Point(static_cast<double>(r), 0, 0), Vector::UnitZ(), 0};
    EXPECT_NEAR(illuminance(scene, here), expected[r], 0.0051) << r;
  }
}

// An IES file of 1000 cd cos v, every degree.
std::string lambertian_file() {
  std::string text = "IESNA:LM-63-2002\nTILT=NONE\n1 3141.593 1 91 1 1 2 0 0 0\n1 1 10\n";
  for (int v = 0; v <= 90; ++v) text += std::to_string(v) + "\n";
  text += "0\n";
  for (int v = 0; v <= 90; ++v) text += std::to_string(1000 * std::cos(v * pi / 180)) + "\n";
  return text;
}

TEST(Cie171, Case52LambertianLuminaireAboveAFloor) {
  // Lambertian point source of 1000 cd, 3 m above the floor: E = I0 h^2 / d^4. Linear interpolation over one degree is
  // at most 4e-5 too low.
  Scene scene = floor_of(3);
  Luminaire lamp;
  lamp.position = Point(0, 0, 3);
  lamp.light = WebLight{std::make_shared<PhotometricWeb>(parse_ies(lambertian_file(), "lambert.ies")), watts(1)};
  scene.luminaires = {lamp};
  struct Case {
    double x, y, lux;
  };
  const std::array<Case, 10> cases = {{{0, 0, 111.11111},
                                       {0.5, 0, 105.18627},
                                       {1, 0, 90.00000},
                                       {1.5, 0, 71.11111},
                                       {0.5, 0.5, 99.72299},
                                       {1, 0.5, 85.66330},
                                       {1.5, 0.5, 68.05293},
                                       {1, 1, 74.38017},
                                       {1.5, 1, 59.97501},
                                       {1.5, 1.5, 49.38272}}};
  for (const Case& c : cases) {
    EXPECT_NEAR(illuminance(scene, {Point(c.x, c.y, 0), Vector::UnitZ(), 0}), c.lux, 1e-4 * c.lux) << c.x << ' ' << c.y;
  }
}

TEST(Cie171, Case56LightReflectedByAnEvenlyLitFloor) {
  // A floor of 4 x 4 m under the sun at the zenith is uniformly bright. E / (E_horizontal rho) is the form factor in
  // percent from a point of the wall y = 0 (B to F) or of the ceiling z = 3 m (G to N) to the floor. Only visibility is
  // sampled, and it is complete.
  Scene scene = with_quad(empty_scene({grey(0.3)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene.sun = Sun{Vector::UnitZ(), watts(50000)};
  Request request;
  request.mesh.max_edge = 1;
  request.mesh.sides = Sides::front;
  const Simulation simulation = simulate(scene, request);
  struct Case {
    double y, z, percent;
  };
  const std::array<Case, 13> cases = {{{0, 0.75, 35.90050},
                                       {0, 1.25, 27.99162},
                                       {0, 1.75, 21.63851},
                                       {0, 2.25, 16.71631},
                                       {0, 2.75, 12.96737},
                                       {0.25, 3, 26.79519},
                                       {0.75, 3, 30.93871},
                                       {1.25, 3, 33.97572},
                                       {1.75, 3, 35.56659},
                                       {2.25, 3, 35.56659},
                                       {2.75, 3, 33.97572},
                                       {3.25, 3, 30.93871},
                                       {3.75, 3, 26.79519}}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  for (const Case& c : cases) {
    const Sensor sensor{Point(2, c.y, c.z), c.y == 0 ? Vector(Vector::UnitY()) : Vector(-Vector::UnitZ())};
    const Field irradiance =
        gather_irradiance(simulation.mesh, simulation.solution.radiosity, occluder, {&sensor, 1}).irradiance;
    EXPECT_NEAR(100 * luminance(irradiance.row(0)) / (50000 * 0.3), c.percent, 1e-5 * c.percent) << c.y << ' ' << c.z;
  }
}

class Case58 : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Case58, IndirectLightInAClosedCube) {
  // A 4 m cube with an isotropic source of 10,000 lm in its middle. The mean indirect illuminance of all faces is rho
  // Phi / (S (1 - rho)), S = 96 m^2. Closure makes row sums exact, so the error is that of the sampled direct light.
  // All patches see the lamp, and 64 points on each give its mean to well below 0.1 %.
  const auto [rho, expected] = GetParam();
  Scene scene = with_box(empty_scene({grey(rho)}), Point(-2, -2, -2), Point(2, 2, 2), true);
  scene.luminaires = {isotropic(Point::Zero(), 10000)};
  Request request;
  request.mesh.patches = 600;
  request.solver.relative_error = 1e-8;
  const Simulation simulation = simulate(scene, request);
  const Field indirect = simulation.solution.irradiance - simulation.solution.direct_irradiance;
  const double mean = (indirect.col(0) * simulation.problem.area.array()).sum() / simulation.problem.area.sum();
  EXPECT_NEAR(luminous_efficacy * mean, expected, 0.001 * expected);
  EXPECT_NEAR(luminous_efficacy * simulation.balance.arriving[0], 10000, 10);
  EXPECT_LT(simulation.balance.imbalance, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Cie171, Case58,
                         testing::Values(std::pair(0.05, 5.48246), std::pair(0.5, 104.16667), std::pair(0.8, 416.66667),
                                         std::pair(0.95, 1979.16667)));

TEST(SpotLuminaire, LightsAFloorByItsProfile) {
  // On the axis I / h^2, at the beam's half angle half of I cos^3 / h^2; none of the 1000 cd reaches the far end.
  Scene scene = floor_of(20);
  Luminaire lamp;
  lamp.position = Point(0, 0, 2);
  lamp.light = SpotLight{watts(1000), 20, 35};
  scene.luminaires = {lamp};
  EXPECT_NEAR(illuminance(scene, {Point(0, 0, 0), Vector::UnitZ(), 0}), 250, 1e-9);
  const double angle = 20 * pi / 180;
  EXPECT_NEAR(illuminance(scene, {Point(2 * std::tan(angle), 0, 0), Vector::UnitZ(), 0}),
              125 * std::pow(std::cos(angle), 3), 1e-9);
  EXPECT_LT(illuminance(scene, {Point(19, 0, 0), Vector::UnitZ(), 0}), 1e-3);
}

TEST(Simulate, FluxOfALuminaireInAClosedRoomIsAbsorbed) {
  // Theorem: absorbed flux equals arriving flux in a closed room with any contents, and all flux of the lamp arrives.
  Scene scene = furnished_room(0.5, 0);
  scene.luminaires = {isotropic(Point(3.2, 2.2, 1.9), 1000)};
  Request request;
  request.mesh.patches = 1500;
  const Simulation simulation = simulate(scene, request);
  const EnergyBalance& balance = simulation.balance;
  EXPECT_EQ(balance.emitted[0], 0);
  // Shadow edges are sampled: 0.5 % is three times the standard error, which the next line bounds.
  EXPECT_NEAR(luminous_efficacy * balance.arriving[0], 1000, 5);
  const double error =
      std::sqrt((simulation.direct_standard_error.col(0) * simulation.problem.area.array()).square().sum());
  EXPECT_LT(luminous_efficacy * error, 1.7);
  EXPECT_NEAR(balance.absorbed[0] + balance.defect[0] + balance.escaped[0] + balance.lost_at_backs[0],
              balance.arriving[0], 1e-6 * balance.arriving[0]);
}

}  // namespace
}  // namespace patchlight::lights_test
