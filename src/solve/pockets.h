#pragma once

#include "patchlight/base/field.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <memory>
#include <utility>
#include <vector>

namespace patchlight {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Triangular factors of about a sparse matrix: small entries were dropped (ILUT, Saad 1994).
struct IncompleteFactors {
  Eigen::SparseMatrix<float, Eigen::RowMajor> factors;  ///< L without its diagonal of ones, and U
  std::vector<int> order;                               ///< row k of the factors is that of the matrix's row order[k]
};

/// Patches that keep light among themselves, as those of white boards 3 mm apart do: it takes hundreds of bounces to
/// get out. Iterations over all patches hardly change what is there, and no bound on the error is found.
struct Pocket {
  std::vector<PatchIndex> patches;  ///< in rising order; none sees one of another pocket
  SparseRows form_factors;          ///< F among them, numbered as they stand there
  Eigen::VectorXd bounces;          ///< (I - F rho)^-1 1, rho the highest reflectance of all bands: how often light is
                                    ///< reflected before it gets out
  IncompleteFactors nearly_solved;  ///< of I - F rho; of few patches empty
};

/// I - F R among the patches of a pocket, in each band of R.
struct PocketSystem {
  Field reflectance;                                          ///< R
  std::vector<Eigen::PartialPivLU<Eigen::MatrixXd>> factors;  ///< per band of up to 512 patches, else empty

  bool is_eliminated() const { return !factors.empty(); }
};

/// From F and the reflectances of the patches.
PocketSystem system_within(const SparseRows& form_factors, const FieldView& reflectance);

/// Of I - F rho. Costs some applications of it for each entry of a row.
IncompleteFactors incomplete_factors(const SparseRows& form_factors, const Eigen::VectorXd& reflectance);

/// F B: the irradiance of the patches by each other, of their radiosities in each band.
Field arriving_within(const Pocket& pocket, const Field& radiosity);

/// right - (I - F R) x in each band.
Field residual_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, const FieldView& x);

/// x in each band: by the factors of the system, or by BiCGSTAB (van der Vorst 1992) until ||r||_2 is below `tolerance`
/// times ||right||_2, or 200 iterations are done. Each band is solved as it would be by itself, to the bit.
Field solution_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, double tolerance);

/// There are few pockets: where their patches are more than an eighth of all, it is the room that is white.
struct Pockets {
  std::vector<Pocket> each;
  std::vector<PatchIndex> closed;  ///< in rising order, of no pocket: they see each other alone and reflect everything,
                                   ///< so that no light gets to them but what starts there
};

/// Half of the light of each of the patches is still among all patches after 4 bounces, and half of what starts on them
/// is among those that this is true of after 8; `reflectance` is the highest of each patch in any band. Left out are
/// pockets whose bounces are not found to a factor of two, as when rounding of F hides what gets out, or are more than
/// 1e8, 1e5 of more than 512 patches. Null where nothing is left. Costs some five applications of
/// one band; nothing where no reflectance is above .917.
std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance);

/// Rows of rays whose pockets are known: solve() follows light within these apart.
class RaysWithPockets : public TransportOperator {
 public:
  /// Looks for the pockets of patches with these reflectances, the highest of each in any band.
  RaysWithPockets(RayTransport rays, Eigen::VectorXd reflectance)
      : rays_(std::move(rays)), reflectance_(std::move(reflectance)), pockets_(pockets_of(rays_, reflectance_)) {}

  PatchIndex size() const override { return rays_.size(); }
  Field apply(const FieldView& radiosity) const override { return rays_.apply(radiosity); }
  bool is_reciprocal() const override { return false; }

  const RayTransport& rays() const { return rays_; }
  /// For patches that reflect so much in their highest band. Null where there are none, or one reflects more than
  /// those that the pockets were looked for with: then light may be reflected more often than they say.
  const Pockets* pockets(const Eigen::ArrayXd& reflectance) const {
    return (reflectance <= reflectance_.array()).all() ? pockets_.get() : nullptr;
  }

 private:
  RayTransport rays_;
  Eigen::VectorXd reflectance_;
  std::shared_ptr<const Pockets> pockets_;
};

}  // namespace patchlight
