#pragma once

#include "patchlight/base/field.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

namespace patchlight {

class RayTransport;

/// Patches that keep light among themselves, as white boards 3 mm apart do: it takes hundreds of bounces to get out, so
/// that iterations over all patches hardly change what is there, and bounds on the error are slow to come down. They
/// are few: rooms that are white altogether have none.
struct Pockets {
  std::vector<PatchIndex> patches;  ///< in rising order
  std::vector<PatchIndex> closed;   ///< in rising order, none of them in `patches`: they see each other alone and
                                   ///< reflect everything, so that no light gets to them but what starts there
  Eigen::SparseMatrix<double, Eigen::RowMajor> form_factors;  ///< F among `patches`, numbered as they stand there
  Eigen::IncompleteLUT<double> nearly_solved;                 ///< I - F rho among them, rho the highest of all bands
};

/// Half of the light of each of the patches is still among them after some bounces; `reflectance` is the highest of
/// each patch in any band. Null where there are none. Where all reflectances are below .94 it costs nothing, else some
/// five applications of one band.
std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance);

/// I - F R among some patches, from F among them and their reflectances.
Eigen::SparseMatrix<double, Eigen::RowMajor> inner_system(
    const Eigen::SparseMatrix<double, Eigen::RowMajor>& form_factors, const Eigen::VectorXd& reflectance);

}  // namespace patchlight
