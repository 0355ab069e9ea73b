#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"

#include <Eigen/Core>
#include <functional>
#include <memory>

namespace patchlight {

class RowTransport;
struct Pockets;

/// The transport of light between all patches: H = F B. It depends on geometry only and is the same for all bands and
/// materials.
class TransportOperator {
 public:
  virtual ~TransportOperator() = default;
  virtual PatchIndex size() const = 0;
  /// Irradiance H = F B; H_i = sum_j F_ij B_j. Rows are patches, columns bands.
  virtual Field apply(const FieldView& radiosity) const = 0;
  /// True when A_i F_ij = A_j F_ji up to rounding. Solvers that require symmetry reject other transports.
  virtual bool is_reciprocal() const { return true; }
  /// The adjoint of F in the inner product sum_i A_i x_i y_i; `area` in m^2. Null if there is none; F is its own where
  /// it is reciprocal.
  virtual std::unique_ptr<TransportOperator> adjoint(const Eigen::VectorXd& area) const;
  /// Access to single rows; null if the transport has none.
  virtual const RowTransport* rows() const { return nullptr; }
  /// Blocks of patches that keep light among themselves, given the highest reflectance of each patch in any band. Null
  /// if there are none, or none are known. solve() treats them separately.
  virtual const Pockets* pockets(const Eigen::ArrayXd& reflectance) const;
};

/// F E, W/m^2, by the rows of emitting patches alone, or by one application if the transport has no rows. \throws
/// Canceled.
Field irradiance_by_emitters(const TransportOperator& transport, const FieldView& exitance,
                             const Observer& observer = {});

/// A block of patches during a sweep: its current radiosities, the irradiance by the current radiosities of all patches
/// (one row per patch of the block), and the form factors within the block (rows: from, columns: to).
struct SweptPatches {
  PatchRange range;
  Field radiosity;
  Field irradiance;
  Eigen::MatrixXd own_form_factors;
};

/// Returns the new radiosities of a block.
using Relax = std::function<Field(const SweptPatches& patches)>;

/// The result of a sweep, and the start of the next one.
struct Sweep {
  Field radiosity;     ///< B after the sweep
  Field irradiance;    ///< F B of the radiosities before the sweep; empty if unknown
  Field from_earlier;  ///< private to the transport: partial sums for the next sweep; initially empty
};

/// A transport with access to single rows.
class RowTransport : public TransportOperator {
 public:
  const RowTransport* rows() const final { return this; }
  /// Irradiance of the receivers only: rows [begin, end) of F B.
  virtual Field gather(PatchRange receivers, const FieldView& radiosity) const = 0;
  /// Irradiance of all patches by the sources only; `radiosity` has one row per source.
  virtual Field shoot(PatchRange sources, const FieldView& radiosity) const = 0;
  /// Form factors F_ij from the patches of `from` (rows) to the patches of `to` (columns).
  virtual Eigen::MatrixXd form_factors(PatchRange from, PatchRange to) const = 0;
  /// Relaxes all patches block by block with `there`, first to last, each with the newest radiosities of all others.
  /// Then relaxes them from last to first with `back`, unless that is empty. One direction costs up to two
  /// applications, both cost twice as much.
  virtual Sweep sweep(Sweep from, const Relax& there, const Relax& back) const;
};

}  // namespace patchlight
