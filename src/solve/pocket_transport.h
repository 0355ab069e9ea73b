#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include "solve/pockets.h"

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <vector>

namespace patchlight {

/// The transport by which light within pockets P goes on until it gets out, O being all other patches:
///
///   H_O = F_OO B_O + F_OP B_P,   H_P = (I - F_PP R)^-1 F_PO B_O.
///
/// With irradiance_within() added to what arrives from no patch, B = E + R H has the same solution as with F, in the
/// iterations of a room without pockets.
class PocketTransport : public TransportOperator {
 public:
  /// Refers to all three but the last. R is diagonal and has the bands of all fields; one of a single column, where
  /// there are more, goes with the highest R of each patch in any band. `closed_are_dark` says that no light starts on
  /// closed patches, so that H is 0 there. H_P is within `accuracy` times its highest value of each band, or what
  /// farthest_off() says, and not finite where what arrives is not.
  PocketTransport(const TransportOperator& transport, const Pockets& pockets, const Scattering& scattering,
                  bool closed_are_dark, double accuracy);

  PatchIndex size() const override { return transport_.size(); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The irradiance within pockets by what their own patches send out, (I - F_PP R)^-1 F_PP B_P, W/m^2; elsewhere 0.
  Field irradiance_within(const FieldView& radiosity) const;

  /// How far off H_P may have been so far, relative to its highest value of a band: rounding may keep it from being as
  /// near as was wanted, or the iterations end before.
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
