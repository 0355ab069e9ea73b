#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/pockets.h"

#include <Eigen/SparseCore>
#include <vector>

namespace patchlight {

/// The transport by which light within pockets goes on until it gets out: H = F B outside; of a pocket's patches H =
/// (I - F_PP R)^-1 F_PO B_O, with P the pockets and O all others, and of closed ones 0. With `within()` added to what
/// arrives from no patch, B = E + R H has the same solution as with F, in the iterations of a room without pockets.
class PocketTransport : public TransportOperator {
 public:
  /// Both are referred to. R is diagonal and has the bands of all fields; one of a single column, where there are more,
  /// goes with the highest R of each patch in any band.
  PocketTransport(const TransportOperator& transport, const Pockets& pockets, const Scattering& scattering);

  PatchIndex size() const override { return transport_.size(); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The irradiance within pockets by what their own patches send out, (I - F_PP R)^-1 F_PP B_P, W/m^2; elsewhere 0.
  Field within(const Field& radiosity) const;

 private:
  Field followed(const Field& irradiance) const;

  const TransportOperator& transport_;
  const Pockets& pockets_;
  std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>> systems_;  // I - F_PP R, per band
  Eigen::SparseMatrix<double, Eigen::RowMajor> highest_;               // with the highest R of all bands
};

}  // namespace patchlight
