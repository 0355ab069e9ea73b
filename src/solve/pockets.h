#pragma once

#include "patchlight/transport/transport_operator.h"

#include "transport/ray_transport.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <memory>
#include <utility>
#include <vector>

namespace patchlight {

/// Patches that keep light among themselves, as white boards 3 mm apart do: it takes hundreds of bounces to get out.
/// Iterations over all patches hardly change what is there, and no bound on the error is found. There are few of them:
/// where they are more than an eighth of all patches, it is the room that is white, and there are no pockets.
struct Pockets {
  std::vector<PatchIndex> patches;  ///< in rising order
  std::vector<PatchIndex> closed;   ///< in rising order, none of them in `patches`: they see each other alone and
                                    ///< reflect everything, so that no light gets to them but what starts there
  Eigen::SparseMatrix<double, Eigen::RowMajor> form_factors;  ///< F among `patches`, numbered as they stand there
  Eigen::IncompleteLUT<double> nearly_solved;  ///< factors of about I - F rho among them (ILUT, Saad 1994), rho the
                                               ///< highest of all bands
  Eigen::VectorXd bounces;                     ///< (I - F rho)^-1 1: how often light is reflected before it gets out
};

/// Half of the light of each of the patches is still among all patches after 4 bounces, and half of what starts on them
/// is among those that this is true of after 8; `reflectance` is the highest of each patch in any band. Nothing where
/// there are no pockets. Costs some five applications of one band; nothing where no reflectance is above .917.
std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance);

/// I - F R among the patches of pockets, from their reflectances.
Eigen::SparseMatrix<double, Eigen::RowMajor> system_within(const Pockets& pockets, const Eigen::VectorXd& reflectance);

/// True when light that patches with these reflectances send on is reflected at most twice as often as the bounces say:
/// (I - F R) bounces >= 1/2. It is for reflectances that are no higher than those the pockets were looked for with.
bool bounces_hold(const Pockets& pockets, const Eigen::VectorXd& reflectance);

/// x of such a system, by BiCGSTAB until ||r||_2 is below `tolerance` times ||right||_2, or 200 iterations are done.
Eigen::VectorXd solution_within(const Pockets& pockets, const Eigen::SparseMatrix<double, Eigen::RowMajor>& system,
                                const Eigen::VectorXd& right, double tolerance);

/// Rows of rays whose pockets are known: solve() follows light within these apart.
class RaysWithPockets : public TransportOperator {
 public:
  /// Looks for the pockets of patches with these reflectances, the highest of each in any band. For higher ones
  /// solve() may leave them out of account.
  RaysWithPockets(RayTransport rays, const Eigen::VectorXd& reflectance)
      : rays_(std::move(rays)), pockets_(pockets_of(rays_, reflectance)) {}

  PatchIndex size() const override { return rays_.size(); }
  Field apply(const FieldView& radiosity) const override { return rays_.apply(radiosity); }
  bool is_reciprocal() const override { return false; }

  const RayTransport& rays() const { return rays_; }
  /// Null where there are none.
  const Pockets* pockets() const { return pockets_.get(); }

 private:
  RayTransport rays_;
  std::shared_ptr<const Pockets> pockets_;
};

}  // namespace patchlight
