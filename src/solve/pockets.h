#pragma once

#include "patchlight/base/field.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <atomic>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace patchlight {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Patches that keep light among themselves, for example white boards 3 mm apart, where light needs hundreds of bounces
/// to leave. Iterations over all patches hardly change the light there, and give no error bound.
struct Pocket {
  std::vector<PatchIndex> patches;  ///< in rising order; none sees one of another pocket
  SparseRows form_factors;          ///< F among them, numbered as they stand there
  Eigen::VectorXd bounces;          ///< (I - F rho)^-1 1, rho the highest reflectance of all bands: how often light is
                                    ///< reflected before it gets out
  /// Incomplete factors of I - F rho (ILUT, Saad 1994); null for pockets of at most 512 patches.
  std::shared_ptr<const Eigen::IncompleteLUT<double>> nearly_solved;
};

/// I - F R among the patches of a pocket, in each band of R.
struct PocketSystem {
  Field reflectance;                                          ///< R
  std::vector<SparseRows> matrices;                           ///< per band of more than 512 patches, else empty
  std::vector<Eigen::PartialPivLU<Eigen::MatrixXd>> factors;  ///< per band of up to 512 patches, else empty

  bool is_eliminated() const { return !factors.empty(); }
};

/// From F and the reflectances of the patches.
PocketSystem system_within(const SparseRows& form_factors, const FieldView& reflectance);

/// right - (I - F R) x in each band.
Field residual_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, const FieldView& x);

/// x in each band: by the factors of the system, or by BiCGSTAB (van der Vorst 1992) until ||r||_2 is below `tolerance`
/// times ||right||_2, or about 200 iterations are done.
Field solution_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, double tolerance);

/// There are few pockets: where their patches are more than an eighth of all, it is the room that is white.
struct Pockets {
  std::vector<Pocket> each;
  std::vector<PatchIndex> closed;  ///< in rising order, of no pocket: they see each other alone and reflect everything,
                                   ///< so that no light gets to them but what starts there
};

/// Finds patches for which half of the light is still among all patches after 4 bounces. Half of the light that starts
/// on them is still among such patches after 8. `reflectance` is the highest of each patch in any band. Pockets are
/// left out if their bounces are not known within a factor of two, e.g. when rounding of F hides the losses. They are
/// also left out with more than 1e8 bounces, or 1e5 for more than 512 patches. Null if no pocket remains. Costs about
/// five applications of one band; nothing if no reflectance is above 0.917.
std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance);

/// Ray rows with known pockets: solve() treats the light within these separately.
class RaysWithPockets : public TransportOperator {
 public:
  /// Looks for the pockets of patches with these reflectances, the highest of each in any band.
  RaysWithPockets(RayTransport rays, Eigen::VectorXd reflectance)
      : rays_(std::move(rays)), reflectance_(std::move(reflectance)), pockets_(pockets_of(rays_, reflectance_)) {}

  PatchIndex size() const override { return rays_.size(); }
  Field apply(const FieldView& radiosity) const override { return rays_.apply(radiosity); }
  bool is_reciprocal() const override { return false; }
  std::unique_ptr<TransportOperator> adjoint(const Eigen::VectorXd& area) const override {
    return std::make_unique<RayTransport>(adjoint_of(rays_, area));
  }
  /// Null as well if a patch reflects more than in the search: light may be reflected more often than the pockets
  /// state.
  const Pockets* pockets(const Eigen::ArrayXd& reflectance) const override {
    return (reflectance <= reflectance_.array()).all() ? pockets_.get() : nullptr;
  }

  const RayTransport& rays() const { return rays_; }

 private:
  RayTransport rays_;
  Eigen::VectorXd reflectance_;
  std::shared_ptr<const Pockets> pockets_;
};

/// The transport by which light within pockets P goes on until it gets out, O being all other patches:
///
///   H_O = F_OO B_O + F_OP B_P,   H_P = (I - F_PP R)^-1 F_PO B_O.
///
/// With irradiance_within() added to what arrives from no patch, B = E + R H has the same solution as with F, in the
/// iterations of a room without pockets.
class PocketTransport : public TransportOperator {
 public:
  /// Keeps references to the first three arguments. R is diagonal and has the bands of all fields. A field with a
  /// single column, if there are several bands, uses the highest R of each patch. `closed_are_dark` means that no light
  /// starts on closed patches, so H is 0 there. H_P has an error of at most `accuracy` times its highest value in each
  /// band, or of farthest_off(). It is not finite where the arriving light is not.
  PocketTransport(const TransportOperator& transport, const Pockets& pockets, const Scattering& scattering,
                  bool closed_are_dark, double accuracy);

  PatchIndex size() const override { return transport_.size(); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The irradiance within pockets by what their own patches send out, (I - F_PP R)^-1 F_PP B_P, W/m^2; elsewhere 0.
  Field irradiance_within(const FieldView& radiosity) const;

  /// The largest error of H_P so far, relative to its highest value in a band. Rounding or the limit of iterations may
  /// keep it above the requested accuracy.
  double farthest_off() const { return farthest_off_; }

 private:
  Field followed(const Pocket& pocket, const PocketSystem& system, const FieldView& irradiance) const;
  Field followed_in_each(const std::function<Field(const Pocket&)>& arriving, Field irradiance) const;

  const TransportOperator& transport_;
  const Pockets& pockets_;
  bool closed_are_dark_;
  double accuracy_;
  std::vector<PocketSystem> of_bands_;            // per pocket
  std::vector<PocketSystem> of_highest_;          // of the highest R of all bands, where these are several; else empty
  mutable std::atomic<double> farthest_off_ = 0;  // of all calls: in whatever order these come it is the same
};

}  // namespace patchlight
