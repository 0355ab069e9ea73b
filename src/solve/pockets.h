#pragma once

#include "patchlight/transport/transport_operator.h"

#include "solve/pocket.h"
#include "transport/ray_transport.h"

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

namespace patchlight {

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
