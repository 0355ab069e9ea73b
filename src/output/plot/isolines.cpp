#include "output/plot/isolines.h"

#include <cstddef>

namespace patchlight {
namespace {

// Where the level is crossed around a square, corner after corner.
std::vector<Eigen::Vector2d> crossings(const std::array<double, 4>& values, double column, double row, double level) {
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(column, row), Eigen::Vector2d(column + 1, row),
                                                  Eigen::Vector2d(column + 1, row + 1),
                                                  Eigen::Vector2d(column, row + 1)};
  std::vector<Eigen::Vector2d> found;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    if ((values[k] >= level) == (values[next] >= level)) continue;
    const double part = (level - values[k]) / (values[next] - values[k]);
    found.push_back((1 - part) * corners[k] + part * corners[next]);
  }
  return found;
}

}  // namespace

std::vector<IsolinePiece> isoline(const Eigen::MatrixXd& values, double level) {
  std::vector<IsolinePiece> pieces;
  for (Eigen::Index row = 0; row + 1 < values.rows(); ++row) {
    for (Eigen::Index column = 0; column + 1 < values.cols(); ++column) {
      const std::array<double, 4> around = {values(row, column), values(row, column + 1), values(row + 1, column + 1),
                                            values(row + 1, column)};
      const double mean = (around[0] + around[1] + around[2] + around[3]) / 4;
      if (!(mean == mean)) continue;
      const auto found = crossings(around, static_cast<double>(column), static_cast<double>(row), level);
      // Of a saddle with four crossings the middle says which belong together.
      const std::size_t shift = found.size() == 4 && (mean >= level) == (around[0] >= level) ? 0 : 1;
      if (found.size() == 2) pieces.push_back({found[0], found[1]});
      for (std::size_t k = 0; found.size() == 4 && k < 4; k += 2)
        pieces.push_back({found[(k + shift) % 4], found[(k + shift + 1) % 4]});
    }
  }
  return pieces;
}

}  // namespace patchlight
