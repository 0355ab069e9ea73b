#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace patchlight {

/// A straight piece of an isoline: (column, row) of both ends, in steps of the lattice.
using IsolinePiece = std::array<Eigen::Vector2d, 2>;

/// Where values at the points of a lattice, linear between neighbours, have this level (marching squares, Lorensen and
/// Cline 1987 in the plane); nothing next to points that have no number.
std::vector<IsolinePiece> isoline(const Eigen::MatrixXd& values, double level);

}  // namespace patchlight
