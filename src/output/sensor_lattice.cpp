#include "output/sensor_lattice.h"

#include <limits>

namespace patchlight {

SensorLattice lattice_of(const std::vector<Sensor>& sensors, const std::array<Point, 4>& cell,
                         const std::vector<double>& values) {
  SensorLattice lattice{{}, sensors[0].point, cell[1] - cell[0], cell[3] - cell[0]};
  const auto place = [&](const Point& point) -> Eigen::Vector2d {
    const Vector way = point - lattice.origin;
    return {way.dot(lattice.step) / lattice.step.squaredNorm(),
            way.dot(lattice.step_of_rows) / lattice.step_of_rows.squaredNorm()};
  };
  Eigen::Vector2d low(0, 0), high(0, 0);
  for (const Sensor& sensor : sensors) {
    low = low.cwiseMin(place(sensor.point));
    high = high.cwiseMax(place(sensor.point));
  }
  const Eigen::Vector2d size = (high - low).array().round() + 1;
  // More places than a file can show: cells of several sizes, or not in one plane
  if (!(size.prod() < 100.0 * static_cast<double>(sensors.size()) + 1000)) return lattice;
  lattice.values = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(size[1]), static_cast<Eigen::Index>(size[0]),
                                             std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const Eigen::Vector2d at = (place(sensors[k].point) - low).array().round();
    lattice.values(static_cast<Eigen::Index>(at[1]), static_cast<Eigen::Index>(at[0])) = values[k];
  }
  lattice.origin += low[0] * lattice.step + low[1] * lattice.step_of_rows;
  return lattice;
}

}  // namespace patchlight
