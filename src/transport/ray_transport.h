#pragma once

#include "patchlight/transport/transport_operator.h"

#include "transport/ray_rows.h"

#include <array>
#include <cstddef>

namespace patchlight {

/// Transport by sparse rows of rays, Storage::rays: H = F B, where F is the mean of two halves. Its rows sum up to what
/// patches see, but A_i F_ij and A_j F_ji differ by the errors of both. One application reads every entry once.
class RayTransport : public TransportOperator {
 public:
  explicit RayTransport(std::array<RayRows, 2> halves) : halves_(std::move(halves)) {}

  PatchIndex size() const override { return static_cast<PatchIndex>(halves_[0].hit_weight.size()); }
  Field apply(const FieldView& radiosity) const override;
  bool is_reciprocal() const override { return false; }

  /// The same by one half of the rays alone, 0 or 1.
  Field apply_half(std::size_t half, const FieldView& radiosity) const;

  /// F 1, the same bits as apply() has, without looking at what is met.
  Eigen::VectorXd row_sums() const;

  const RayRows& rows(std::size_t half) const { return halves_[half]; }

 private:
  std::array<RayRows, 2> halves_;
};

}  // namespace patchlight
