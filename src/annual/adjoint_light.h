#pragma once

#include "patchlight/base/field.h"
#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace patchlight {

/// W per patch (row) and column of the patches seen.
struct AdjointWeights {
  Field values;
  bool converged = true;
};

/// The reflections of a solved scene seen from the receivers. Let sensors read sum_j g_j B_j from B = R (F B + H). This
/// is sum_j W_j H_j with W = A R z, z = g / A + F* R z: w = R z is the radiosity of a scene with the transport F* whose
/// patches emit R g / A. A is the area; F* is the adjoint of F and R is its own in the inner product sum_j A_j x_j y_j.
class AdjointLight {
 public:
  /// Keeps a reference to `solved`. With rows of rays it makes F* from their entries, O(rays) memory.
  explicit AdjointLight(const SolvedTransport& solved);

  /// 0 without a transport, as then sensors see no reflected light. W of each column of `seen`, g; `bands` has its
  /// band, counted within SolvedTransport::bands.
  AdjointWeights weights(const Field& seen, const std::vector<Eigen::Index>& bands, double tolerance) const;

 private:
  const SolvedTransport& solved_;
  std::shared_ptr<const TransportOperator> adjoint_;
};

}  // namespace patchlight
