#include "patchlight/solve/solve.h"

#include "accuracy/errors.h"
#include "support/direct_solution.h"
#include "support/made_up_room.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::followed_test {
namespace {

using namespace test;

// Counts the bands that the operator is applied to.
class Counting : public TransportOperator {
 public:
  explicit Counting(const TransportOperator& transport) : transport_(transport) {}
  PatchIndex size() const override { return transport_.size(); }
  Field apply(const FieldView& radiosity) const override {
    bands += radiosity.cols();
    return transport_.apply(radiosity);
  }
  mutable Eigen::Index bands = 0;

 private:
  const TransportOperator& transport_;
};

// Three paints whose reflectances vary smoothly from band to band, up to `highest`.
RadiosityProblem painted(const Room& room, Eigen::Index bands, double highest) {
  RadiosityProblem problem{{Field(room.problem.area.size(), bands)}, {}, room.problem.area};
  for (Eigen::Index i = 0; i < problem.area.size(); ++i) {
    for (Eigen::Index band = 0; band < bands; ++band) {
      const double lambda = static_cast<double>(band) / static_cast<double>(bands - 1);
      const double shares[] = {1, 1 - 0.9 * lambda, 0.5 + 0.4 * std::sin(5 * lambda)};
      problem.scattering.reflectance(i, band) = highest * shares[i % 3];
    }
  }
  return problem;
}

// Errors of either sign of a light with a smooth spectrum.
Field errors(Eigen::Index patches, Eigen::Index bands) {
  Field irradiance(patches, bands);
  for (Eigen::Index i = 0; i < patches; ++i)
    for (Eigen::Index band = 0; band < bands; ++band)
      irradiance(i, band) =
          std::sin(1.0 + 2.3 * static_cast<double>(i * i)) *
          (1 + std::cos(static_cast<double>(band) / static_cast<double>(bands) + 0.1 * static_cast<double>(i % 4)));
  return irradiance;
}

// Distance of e from e = irradiance + F R e, relative to the reflected part, in the worst band.
double worst_error(const Room& room, const RadiosityProblem& problem, const Field& irradiance, const Field& found) {
  const RadiosityProblem of_sources{problem.scattering, problem.scattering.reflect(irradiance), problem.area};
  const Field exact = direct_solution(*room.transport, of_sources);
  const Field off = problem.scattering.reflect(found) - exact;
  return (area_norm(off, problem.area) / area_norm(exact - of_sources.exitance, problem.area)).maxCoeff();
}

// Theorem: y = E + R F y of every band is found to 5 % of the reflected part, by ||r||_A / (1 - kappa). This holds for
// solved bands and for combinations of others.
TEST(Followed, IsRightInEveryBand) {
  const Room room = made_up(120, 0.5);
  for (const double highest : {0.5, 0.9}) {
    const RadiosityProblem problem = painted(room, 40, highest);
    const Field irradiance = errors(120, 40);
    const Field found = followed(*room.transport, problem, irradiance);
    EXPECT_LE(worst_error(room, problem, irradiance, found), 0.05 * 1.05) << highest;
  }
}

// Bands that do not follow from others are solved.
TEST(Followed, IsRightInBandsThatDifferAtRandom) {
  const Room room = made_up(120, 0.5);
  RadiosityProblem problem = painted(room, 30, 0.8);
  Field irradiance = errors(120, 30);
  for (Eigen::Index i = 0; i < 120; ++i) {
    problem.scattering.reflectance(i, 7) = 0.8 * std::abs(std::sin(3.1 * static_cast<double>(i)));
    irradiance(i, 21) = std::sin(1.7 * static_cast<double>(i * i + 3 * i));
  }
  irradiance.col(3) = 0;
  const Field found = followed(*room.transport, problem, irradiance);
  EXPECT_TRUE((found.col(3) == 0).all());
  irradiance.col(3) = irradiance.col(2);
  Field with_all = found;
  with_all.col(3) = followed(*room.transport, problem, irradiance).col(3);
  EXPECT_LE(worst_error(room, problem, irradiance, with_all), 0.05 * 1.05);
}

// Five times the bands of the same spectra take only a few more products with the matrix.
TEST(Followed, DoesNotCostInProportionToTheBands) {
  const Room room = made_up(120, 0.5);
  const auto applied = [&](Eigen::Index bands) {
    const Counting counting(*room.transport);
    followed(counting, painted(room, bands, 0.8), errors(120, bands));
    return counting.bands;
  };
  EXPECT_LT(applied(80), 1.5 * static_cast<double>(applied(16)));
}

}  // namespace
}  // namespace patchlight::followed_test
