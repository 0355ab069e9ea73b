#include "lighting/sky.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::sky_test {
namespace {

constexpr double pi = std::numbers::pi;

Vector direction(double altitude, double azimuth) {
  const double h = altitude * pi / 180;
  const double a = azimuth * pi / 180;
  return {std::cos(h) * std::cos(a), std::cos(h) * std::sin(a), std::sin(h)};
}

Sky sky_of(SkyKind kind) {
  Sky sky;
  sky.kind = kind;
  sky.zenith_radiance = Spectrum::Constant(1, 2.0);
  sky.sun_direction = direction(40, 10);
  sky.clearness = 3;
  sky.brightness = 0.2;
  return sky;
}

// Irradiance of a horizontal plane: pi times the mean of the radiance over the square of sin^2 h and azimuth.
double integrated(const SkyModel& sky) {
  constexpr int n = 1500;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double altitude = std::asin(std::sqrt((i + 0.5) / n)) * 180 / pi;
    for (int k = 0; k < n; ++k) sum += radiance(sky, direction(altitude, 360 * (k + 0.5) / n))[0];
  }
  return sum * pi / n / n;
}

TEST(SkyModel, OfTheCieOvercastSkyIsThatOfMoonAndSpencer) {
  const SkyModel sky = sky_model(sky_of(SkyKind::cie_overcast), Vector::UnitZ());
  EXPECT_NEAR(radiance(sky, Vector::UnitZ())[0], 2, 1e-15);
  EXPECT_NEAR(radiance(sky, direction(0, 77))[0], 2.0 / 3, 1e-15);
  EXPECT_NEAR(radiance(sky, direction(30, 200))[0], 2 * (1 + 2 * 0.5) / 3, 1e-12);
}

TEST(SkyModel, OfTheCieClearSkyIsTheStandardsFormula) {
  // L / L_z = (1 - exp(-0.32 / sin h)) (0.91 + 10 exp(-3 g) + 0.45 cos^2 g) over the same at the zenith. g is the
  // angular distance of the sun, 50 degrees there. At an altitude of 30 degrees below the sun g = 10 degrees.
  const SkyModel sky = sky_model(sky_of(SkyKind::cie_clear), Vector::UnitZ());
  const auto factor = [](double g) { return 0.91 + 10 * std::exp(-3 * g) + 0.45 * std::cos(g) * std::cos(g); };
  const double expected =
      2 * (1 - std::exp(-0.32 / 0.5)) * factor(10 * pi / 180) / ((1 - std::exp(-0.32)) * factor(50 * pi / 180));
  EXPECT_NEAR(radiance(sky, direction(30, 10))[0], expected, 1e-9 * expected);
}

TEST(SkyModel, OfPerezFollowsTheTable) {
  // Clearness 3 (class 6), brightness 0.2 and the sun's zenith angle Z = 50 degrees = 0.87266, by hand: for example, a
  // = -1.0156 - 0.3670 Z + 0.2 (1.0078 + 1.4051 Z).
  const double Z = 50 * pi / 180;
  const double a = -1.0156 - 0.3670 * Z + 0.2 * (1.0078 + 1.4051 * Z);
  const double b = 0.2875 - 0.5328 * Z + 0.2 * (-3.8500 + 3.3750 * Z);
  const double c = 14.0000 - 0.9999 * Z + 0.2 * (-7.1406 + 7.5469 * Z);
  const double d = -3.4000 - 0.1078 * Z + 0.2 * (-1.0750 + 1.5702 * Z);
  const double e = -0.0672 + 0.4016 * Z + 0.2 * (0.3017 - 0.4844 * Z);
  const auto relative = [&](double zenith_angle, double g) {
    return (1 + a * std::exp(b / std::cos(zenith_angle))) * (1 + c * std::exp(d * g) + e * std::cos(g) * std::cos(g));
  };
  const SkyModel sky = sky_model(sky_of(SkyKind::perez), Vector::UnitZ());
  const double expected = 2 * relative(60 * pi / 180, 10 * pi / 180) / relative(0, Z);
  EXPECT_NEAR(radiance(sky, direction(30, 10))[0], expected, 1e-9 * expected);
}

TEST(SkyModel, OfPerezInTheOvercastClassHasItsOwnFormulas) {
  // Perez et al. 1993, eqs. 6 and 7: c = exp((Delta (c1 + c2 Z))^c3) - c4, d = -exp(Delta (d1 + d2 Z)) + d3 + Delta d4.
  Sky overcast = sky_of(SkyKind::perez);
  overcast.clearness = 1;
  const double Z = 50 * pi / 180;
  const SkyModel sky = sky_model(overcast, Vector::UnitZ());
  EXPECT_NEAR(sky.coefficients[2], std::exp(std::pow(0.2 * (2.8 + 0.6004 * Z), 1.2375)) - 1, 1e-12);
  EXPECT_NEAR(sky.coefficients[3], -std::exp(0.2 * (1.8734 + 0.6297 * Z)) + 0.9738 + 0.2 * 0.2809, 1e-12);
}

TEST(SkyModel, GivesTheHorizontalIrradianceThatIsAsked) {
  for (const SkyKind kind : {SkyKind::uniform, SkyKind::cie_overcast, SkyKind::cie_clear, SkyKind::perez}) {
    Sky sky = sky_of(kind);
    sky.horizontal_irradiance = Spectrum::Constant(1, 100);
    EXPECT_NEAR(integrated(sky_model(sky, Vector::UnitZ())), 100, 2e-3) << static_cast<int>(kind);
  }
}

TEST(SkyModel, TurnsWithTheScene) {
  // Cyclic permutation of the axes: y up, with the sun and the direction rotated in the same way.
  const auto turned = [](const Vector& v) { return Vector(v.y(), v.z(), v.x()); };
  Sky sky = sky_of(SkyKind::cie_clear);
  const double before = radiance(sky_model(sky, Vector::UnitZ()), direction(20, 100))[0];
  sky.sun_direction = turned(sky.sun_direction);
  EXPECT_NEAR(radiance(sky_model(sky, Vector::UnitY()), turned(direction(20, 100)))[0], before, 1e-12);
}

TEST(SkyModel, BelowTheHorizonIsGround) {
  Sky sky = sky_of(SkyKind::uniform);
  EXPECT_EQ(radiance(sky_model(sky, Vector::UnitZ()), direction(-1, 0))[0], 0);
  sky.ground_radiance = Spectrum::Constant(1, 0.3);
  EXPECT_EQ(radiance(sky_model(sky, Vector::UnitZ()), direction(-1, 0))[0], 0.3);
}

TEST(SkyModel, IsNeverNegative) {
  // For all classes, brightnesses and solar altitudes in weather files.
  for (const double clearness : {1.0, 1.1, 1.3, 1.7, 2.3, 3.5, 5.0, 8.0}) {
    for (const double brightness : {0.02, 0.1, 0.3, 0.5, 0.7, 2.0}) {
      for (const double altitude : {2.0, 30.0, 85.0}) {
        Sky sky = sky_of(SkyKind::perez);
        sky.clearness = clearness;
        sky.brightness = brightness;
        sky.sun_direction = direction(altitude, 0);
        sky.horizontal_irradiance = Spectrum::Constant(1, 1);
        const SkyModel model = sky_model(sky, Vector::UnitZ());
        for (int h = 0; h <= 90; h += 5) {
          const double value = radiance(model, direction(h, 17))[0];
          EXPECT_TRUE(value >= 0 && std::isfinite(value)) << clearness << ' ' << brightness << ' ' << altitude;
        }
      }
    }
  }
}

// The clearness (Perez et al. 1990, eq. 1), brightness and sun of a measured hour, as measured_daylight() makes them.
Sky measured_sky(double direct_normal, double diffuse, double altitude) {
  Sky sky = *measured_daylight({direct_normal, diffuse, 172}, direction(altitude, 0), Vector::UnitZ(), 1).sky;
  sky.horizontal_irradiance = Spectrum::Constant(1, diffuse);
  return sky;
}

TEST(SkyModel, OfPerezTakesTheBrightnessWithinTheLimitsOfTheFit) {
  Sky sky = sky_of(SkyKind::perez);
  const auto coefficients = [&](double clearness, double brightness) {
    sky.clearness = clearness;
    sky.brightness = brightness;
    return sky_model(sky, Vector::UnitZ()).coefficients;
  };
  EXPECT_EQ(coefficients(1, 1.4), coefficients(1, 0.6));
  EXPECT_EQ(coefficients(1.3, 0.05), coefficients(1.3, 0.2));
  EXPECT_EQ(coefficients(8, 0.001), coefficients(8, 0.01));
  // At the horizon, Z = pi / 2, and a clearness of 3: a = -1.5921 + 3.2149 Delta is 0 at 0.4952, b is above 0 there.
  sky.sun_direction = direction(0, 0);
  EXPECT_NEAR(coefficients(3, 0.55)[0], 0, 1e-12);
  EXPECT_NEAR(coefficients(3, 0.49)[0], -1.5921 + 3.2149 * 0.49, 1e-4);
}

// A facade that faces the sun receives at most four times the horizontal irradiance.
TEST(SkyModel, OfPerezGivesEveryMeasuredIrradianceAndNoFacadeMoreThanTheSunGives) {
  for (const double direct_normal : {0.0, 100.0, 400.0, 1000.0}) {
    for (const double diffuse : {10.0, 40.0, 100.0, 300.0}) {
      for (const double altitude : {0.5, 2.0, 15.0, 90.0}) {
        const SkyModel sky = sky_model(measured_sky(direct_normal, diffuse, altitude), Vector::UnitZ());
        double horizontal = 0;
        double facade = 0;
        constexpr int n = 300;
        for (int i = 0; i < n; ++i) {
          for (int k = 0; k < n; ++k) {
            // Equal solid angles, so that the lowest tenth of a degree has its small weight.
            const double sine = (i + 0.5) / n;
            const double azimuth = 2 * pi * (k + 0.5) / n;
            const double across = std::sqrt(1 - sine * sine);
            const double value =
                radiance(sky, {across * std::cos(azimuth), across * std::sin(azimuth), sine})[0] * 2 * pi / n / n;
            horizontal += value * sine;
            facade += value * std::max(0.0, across * std::cos(azimuth));
          }
        }
        const auto hour = [&] { return ::testing::Message() << direct_normal << ' ' << diffuse << ' ' << altitude; };
        EXPECT_NEAR(horizontal, diffuse, 0.01 * diffuse) << hour();
        EXPECT_LT(facade, 4 * diffuse) << hour();
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::sky_test
