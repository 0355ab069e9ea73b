#pragma once

#include "patchlight/base/field.h"

#include <Eigen/Core>

namespace patchlight {

/// Carries radiosity from all patches to all patches: H = F B. Geometry only: the same for all bands and materials.
class TransportOperator {
 public:
  virtual ~TransportOperator() = default;
  virtual PatchIndex size() const = 0;
  /// Irradiance H = F B; H_i = sum_j F_ij B_j. Rows are patches, columns bands.
  virtual Field apply(const FieldView& radiosity) const = 0;
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
};

}  // namespace patchlight
