#include "solve/iterations.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::coarse_transport_test {
namespace {

// Patches of an integrating sphere with a hole: each sends the fraction `arrives` of its light evenly to all area, F_ij
// = arrives A_j / A.
struct Sphere {
  RadiosityProblem problem;
  double arrives;

  Field arriving(Eigen::Index source, const Field& flash) const {
    const double F = arrives * problem.area[source] / problem.area.sum();
    return (F * flash).replicate(problem.area.size(), 1);
  }
};

// Two bands, various areas and reflectances.
Sphere sphere(Eigen::Index n, double arrives) {
  Sphere sphere{{{Field(n, 2)}, Field::Zero(n, 2), Eigen::VectorXd(n)}, arrives};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto x = static_cast<double>(i);
    sphere.problem.area[i] = 1.5 + std::sin(1.7 * x);
    sphere.problem.scattering.reflectance.row(i) << 0.5 + 0.4 * std::sin(0.3 * x), 0.3 + 0.2 * std::cos(x);
  }
  return sphere;
}

Field unshot_in(const Sphere& sphere) {
  const Eigen::Index n = sphere.problem.area.size();
  return Field::NullaryExpr(
      n, 2, [](Eigen::Index i, Eigen::Index band) { return std::abs(std::sin(static_cast<double>(i + 3 * band))); });
}

// Where light spreads evenly one row determines everything. With the geometric series of all reflections the irradiance
// is arrives sum A dB / A / (1 - arrives mean rho), to the rounding of rows in single precision.
TEST(CoarseTransport, IsExactInAnIntegratingSphereAfterOneRow) {
  for (const Eigen::Index n : {7, 64, 300}) {
    for (const double arrives : {1.0, 0.6}) {
      const Sphere in = sphere(n, arrives);
      CoarseTransport coarse(in.problem);
      Field flash(1, 2);
      flash << 0.5, 3;
      coarse.learn(n / 3, flash, in.arriving(n / 3, flash));
      const Field unshot = unshot_in(in);
      const Field ambient = coarse.ambient(unshot);
      const auto mean = [&](const Field& x, Eigen::Index band) {
        return (x.col(band) * in.problem.area.array()).sum() / in.problem.area.sum();
      };
      ASSERT_EQ(ambient.rows(), n);
      for (Eigen::Index band = 0; band < 2; ++band) {
        const double expected =
            arrives * mean(unshot, band) / (1 - arrives * mean(in.problem.scattering.reflectance, band));
        EXPECT_NEAR(ambient.col(band).minCoeff(), expected, 1e-6 * expected);
        EXPECT_NEAR(ambient.col(band).maxCoeff(), expected, 1e-6 * expected);
      }
    }
  }
}

// For any errors of rows, light does not grow: at most U / (1 - rho_max) of the flux U arrives.
TEST(CoarseTransport, MakesNoLightFromRowsThatAreTooLarge) {
  const Sphere in = sphere(200, 1.4);
  CoarseTransport coarse(in.problem);
  Field flash(1, 2);
  flash << 1, 1;
  for (Eigen::Index source = 0; source < 200; source += 9) coarse.learn(source, flash, in.arriving(source, flash));
  const Field unshot = unshot_in(in);
  const Field ambient = coarse.ambient(unshot);
  for (Eigen::Index band = 0; band < 2; ++band) {
    const double flux = (unshot.col(band) * in.problem.area.array()).sum();
    const double arriving = (ambient.col(band) * in.problem.area.array()).sum();
    EXPECT_LE(arriving, flux / (1 - in.problem.scattering.reflectance.col(band).maxCoeff()));
    EXPECT_GT(arriving, flux);
  }
}

// No light is ever lost, so there is no such irradiance, and the display has none.
TEST(CoarseTransport, ShowsNothingWhereLightIsNeverLost) {
  Sphere in = sphere(100, 1);
  in.problem.scattering.reflectance.col(0).setOnes();
  CoarseTransport coarse(in.problem);
  Field flash(1, 2);
  flash << 1, 1;
  coarse.learn(0, flash, in.arriving(0, flash));
  const Field ambient = coarse.ambient(unshot_in(in));
  EXPECT_TRUE((ambient.col(0) == 0).all());
  EXPECT_TRUE((ambient.col(1) > 0).all());
}

// 128 patches are 64 groups of two. With equal areas and flux that grows with the number, the odd patches shoot first,
// from the last to the first. Then the brightest of all follows.
TEST(CoarseTransport, LetsEachGroupShootOnceAndThenTheBrightest) {
  Sphere in = sphere(128, 1);
  in.problem.area.setOnes();
  CoarseTransport coarse(in.problem);
  Field waiting(128, 2);
  for (Eigen::Index i = 0; i < 128; ++i) waiting.row(i).setConstant(static_cast<double>(i + 1));
  Field flash(1, 2);
  flash << 1, 1;
  for (Eigen::Index expected = 127; expected > 0; expected -= 2) {
    const Eigen::Index source = coarse.next_source(waiting);
    ASSERT_EQ(source, expected);
    coarse.learn(source, flash, in.arriving(source, flash));
  }
  EXPECT_EQ(coarse.next_source(waiting), 127);
  // Excess flux counts as well.
  waiting.row(5).setConstant(-1000);
  EXPECT_EQ(coarse.next_source(waiting), 5);
  // Groups without flux do not shoot.
  const CoarseTransport nothing_known(in.problem);
  waiting.setZero();
  waiting(9, 1) = 1;
  EXPECT_EQ(nothing_known.next_source(waiting), 9);
}

}  // namespace
}  // namespace patchlight::coarse_transport_test
