#pragma once

#include "patchlight/transport/transport_operator.h"

#include "transport/closure.h"

#include <Eigen/Core>
#include <memory>

namespace patchlight {

/// Transport with all exchange areas in memory: F_ij = S_ij / A_i, summed in double. `area` in m^2.
std::unique_ptr<RowTransport> dense_transport(ClosedExchangeAreas exchange_areas, Eigen::VectorXd area);

}  // namespace patchlight
