#pragma once

#include "patchlight/scene/sensor.h"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace patchlight {

/// The lattice that the cells of a grid lie on.
struct SensorLattice {
  Eigen::MatrixXd values;  ///< not a number where there is no sensor; none where the sensors lie on no lattice
  Point origin;            ///< of column and row 0
  Vector step, step_of_rows;
};

/// That of a grid whose first cell is this.
SensorLattice lattice_of(const std::vector<Sensor>& sensors, const std::array<Point, 4>& cell,
                         const std::vector<double>& values);

}  // namespace patchlight
