#pragma once

#include "patchlight/solve/problem.h"

#include "transport/closure.h"

#include <cmath>
#include <memory>
#include <utility>

namespace patchlight::test {

// A made-up closed scene: symmetric positive exchange areas; the areas are their row sums times `openness`.
struct Room {
  std::unique_ptr<RowTransport> transport;
  RadiosityProblem problem;
};

inline Room made_up(PatchIndex n, double reflectance, double openness = 1) {
  ExchangeAreas S(n);
  for (PatchIndex i = 0; i < n; ++i) {
    for (PatchIndex j = i + 1; j < n; ++j) {
      const auto entry = static_cast<float>(0.1 + 0.9 * std::abs(std::sin(1.7 * i + 0.3 * j * j)));
      S.set(i, j, entry);
    }
  }
  const Eigen::VectorXd area = openness * row_sums(S);
  RadiosityProblem problem{{Field::Constant(n, 3, reflectance)}, Field::Zero(n, 3), area};
  // Two lamps of different color, no light in the third band, and one black patch.
  problem.exitance(1, 0) = 5;
  problem.exitance(n - 1, 1) = 2;
  problem.scattering.reflectance.row(2) = 0;
  return {dense_transport(keep_exchange_areas(std::move(S), "test"), area), std::move(problem)};
}

}  // namespace patchlight::test
