#pragma once

#include "patchlight/base/field.h"

#include <Eigen/Core>
#include <functional>

namespace patchlight {

/// Carries radiosity from all patches to all patches: H = F B. Geometry only: the same for all bands and materials.
class TransportOperator {
 public:
  virtual ~TransportOperator() = default;
  virtual PatchIndex size() const = 0;
  /// Irradiance H = F B; H_i = sum_j F_ij B_j. Rows are patches, columns bands.
  virtual Field apply(const FieldView& radiosity) const = 0;
  /// True when A_i F_ij = A_j F_ji, but for rounding. Solvers that rest on it refuse what is not.
  virtual bool is_reciprocal() const { return true; }
};

/// The patches that a sweep comes to: some patches with their radiosities of now, the irradiance by the radiosities of
/// now, their own among them, one row each, and the form factors from each of them (rows) to each (columns).
struct SweptPatches {
  PatchRange range;
  Field radiosity;
  Field irradiance;
  Eigen::MatrixXd own_form_factors;
};

/// The new radiosities of such patches.
using Relax = std::function<Field(const SweptPatches& patches)>;

/// The result of a sweep, and the start of the next one.
struct Sweep {
  Field radiosity;     ///< B after the sweep
  Field irradiance;    ///< F B of the radiosities before it; empty when it is not known
  Field from_earlier;  ///< private to the transport: sums that the next sweep starts from; empty to begin with
};

/// A transport whose rows can be had one by one.
class RowTransport : public TransportOperator {
 public:
  /// Irradiance of the receivers only: rows [begin, end) of F B.
  virtual Field gather(PatchRange receivers, const FieldView& radiosity) const = 0;
  /// Irradiance of all patches that comes from the sources only; `radiosity` has one row per source.
  virtual Field shoot(PatchRange sources, const FieldView& radiosity) const = 0;
  /// Form factors F_ij from the patches of `from` (rows) to the patches of `to` (columns).
  virtual Eigen::MatrixXd form_factors(PatchRange from, PatchRange to) const = 0;
  /// Relaxes all patches, block by block from the first to the last, each with the newest radiosities of all others;
  /// then, where `back` is not empty, from the last to the first with that. Costs up to two applications; there and
  /// back twice as many.
  virtual Sweep sweep(Sweep from, const Relax& there, const Relax& back) const;
};

}  // namespace patchlight
