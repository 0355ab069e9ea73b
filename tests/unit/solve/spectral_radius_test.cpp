#include "solve/bounds.h"
#include "transport/closure.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>

namespace patchlight::spectral_radius_test {
namespace {

constexpr PatchIndex size = 40;

ExchangeAreas made_up() {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i + 1; j < size; ++j) {
      S.set(i, j, static_cast<float>(0.1 + std::abs(std::sin(1.7 * i + 0.3 * j * j))));
    }
  }
  return S;
}

// Half of the patches are dark, half bright. The third band reflects nothing.
RadiosityProblem problem_in(const Eigen::VectorXd& area) {
  RadiosityProblem problem{{Field::Constant(size, 3, 0.9)}, Field::Zero(size, 3), area};
  problem.scattering.reflectance.topRows(size / 2) = 0.2;
  problem.scattering.reflectance.col(1) = 0.5;
  problem.scattering.reflectance.col(2) = 0;
  return problem;
}

TEST(SpectralRadius, IsThatOfADenseEigensolver) {
  const ExchangeAreas S = made_up();
  const Eigen::VectorXd area = row_sums(S);
  const RadiosityProblem problem = problem_in(area);
  const auto transport = dense_transport(keep_exchange_areas(S, "test"), area);
  const Eigen::ArrayXd radius = spectral_radius(*transport, problem, 60);

  const Eigen::MatrixXd F = transport->apply(Field(Eigen::MatrixXd::Identity(size, size))).matrix();
  for (Eigen::Index band = 0; band < 3; ++band) {
    const Eigen::MatrixXd K = problem.scattering.reflectance.col(band).matrix().asDiagonal() * F;
    EXPECT_NEAR(radius[band], K.eigenvalues().cwiseAbs().maxCoeff(), 1e-12) << band;
  }
}

// Two rooms that see little of each other have two close eigenvalues: the power iteration takes hundreds of steps. For
// even light in each room, K has the blocks [[0.7 (1 - e), 0.7 e], [0.7 e, 0.69 (1 - e)]].
TEST(SpectralRadius, OfTwoRoomsIsFoundInFewSteps) {
  ExchangeAreas S(2 * size);
  const ExchangeAreas room = made_up();
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i + 1; j < size; ++j) {
      S.set(i, j, static_cast<float>(room.at(i, j)));
      S.set(size + i, size + j, static_cast<float>(room.at(i, j)));
    }
  }
  S.set(0, size, 0.05F);
  const Eigen::VectorXd area = row_sums(S);
  RadiosityProblem problem{{Field::Constant(2 * size, 1, 0.7)}, Field::Zero(2 * size, 1), area};
  problem.scattering.reflectance.bottomRows(size) = 0.69;
  const auto transport = dense_transport(keep_exchange_areas(S, "test"), area);
  const Eigen::MatrixXd F = transport->apply(Field(Eigen::MatrixXd::Identity(2 * size, 2 * size))).matrix();
  const Eigen::MatrixXd K = problem.scattering.reflectance.col(0).matrix().asDiagonal() * F;
  const double exact = K.eigenvalues().cwiseAbs().maxCoeff();
  const SpectralRadius found = spectral_radius_with_error(*transport, problem, 30);
  EXPECT_NEAR(found.value[0], exact, 1e-9);
  EXPECT_GE(found.error[0] + 1e-12, std::abs(found.value[0] - exact));
}

// For a symmetric matrix ||G w|| / ||w|| never exceeds the radius and never decreases: ||G w||^2 = <w, G^2 w> <= ||w||
// ||G^2 w||.
TEST(SpectralRadius, IsApproachedFromBelow) {
  const ExchangeAreas S = made_up();
  const Eigen::VectorXd area = row_sums(S);
  const RadiosityProblem problem = problem_in(area);
  const auto transport = dense_transport(keep_exchange_areas(S, "test"), area);
  const double limit = spectral_radius(*transport, problem, 100)[0];
  double before = 0;
  for (const int steps : {1, 2, 3, 5, 8}) {
    const double radius = spectral_radius(*transport, problem, steps)[0];
    EXPECT_GE(radius, before);
    EXPECT_LE(radius, limit + 1e-14);
    before = radius;
  }
}

// Two plates that see only each other, with reflectances 0.2 and 0.8: the eigenvalues of K are +-sqrt(0.2 0.8) = +-0.4,
// for F = 1.
TEST(SpectralRadius, OfTwoPlatesHasEigenvaluesOfBothSigns) {
  ExchangeAreas S(2);
  S.set(0, 1, 1);
  const auto transport = dense_transport(keep_exchange_areas(std::move(S), "test"), Eigen::Vector2d(1, 1));
  RadiosityProblem problem{{Field(2, 1)}, Field::Zero(2, 1), Eigen::Vector2d(1, 1)};
  problem.scattering.reflectance << 0.2, 0.8;
  EXPECT_NEAR(spectral_radius(*transport, problem, 2)[0], 0.4, 1e-14);
}

// In a closed room of one reflectance the constant mode has the largest eigenvalue: rho.
TEST(SpectralRadius, OfAClosedRoomIsItsReflectance) {
  const ExchangeAreas S = made_up();
  const Eigen::VectorXd area = row_sums(S);
  const auto transport = dense_transport(keep_exchange_areas(S, "test"), area);
  const RadiosityProblem problem{{Field::Constant(size, 1, 0.7)}, Field::Zero(size, 1), area};
  EXPECT_NEAR(spectral_radius(*transport, problem, 1)[0], 0.7, 1e-14);
}

}  // namespace
}  // namespace patchlight::spectral_radius_test
