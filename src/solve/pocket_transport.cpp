#include "solve/pocket_transport.h"

#include "base/parallel.h"
#include "base/vectors.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {

PocketTransport::PocketTransport(const TransportOperator& transport, const Pockets& pockets,
                                 const Scattering& scattering, bool closed_are_dark, double accuracy)
    : transport_(transport), pockets_(pockets), closed_are_dark_(closed_are_dark), accuracy_(accuracy) {
  assert(scattering.is_diagonal());
  const Field reflectance = chosen_rows(scattering.reflectance, pockets.patches);
  for (Eigen::Index band = 0; band < reflectance.cols(); ++band)
    systems_.push_back(system_within(pockets, reflectance.col(band).matrix()));
  highest_ = system_within(pockets, reflectance.rowwise().maxCoeff().matrix());
}

// F_PP B_P
Field PocketTransport::sent_within(const FieldView& radiosity) const {
  return (pockets_.form_factors * chosen_rows(radiosity, pockets_.patches).matrix()).array();
}

// (I - F_PP R)^-1 H. No entry of the inverse is negative: so |error| <= max |r| y of any y with (I - F_PP R) y >= 1,
// and twice the bounces are such a one.
Eigen::VectorXd PocketTransport::followed_in_band(const Eigen::SparseMatrix<double, Eigen::RowMajor>& system,
                                                  const Eigen::VectorXd& irradiance) const {
  constexpr int most_tries = 2;
  const double highest_bound = 2 * pockets_.bounces.maxCoeff();  // of the error, where max |r| is 1
  double tolerance = accuracy_ / highest_bound;
  for (int tries = 1;; ++tries) {
    Eigen::VectorXd found = solution_within(pockets_, system, irradiance, tolerance);
    const double residual = (irradiance - system * found).cwiseAbs().maxCoeff();
    // From a right side that is not finite zeros are found.
    if (!std::isfinite(residual)) return Eigen::VectorXd::Constant(irradiance.size(), residual);
    if (residual * highest_bound <= accuracy_ * found.cwiseAbs().maxCoeff() || tries == most_tries) return found;
    tolerance /= 10;
  }
}

Field PocketTransport::followed(const Field& irradiance) const {
  const bool is_of_highest = irradiance.cols() == 1 && systems_.size() > 1;
  assert(is_of_highest || irradiance.cols() == static_cast<Eigen::Index>(systems_.size()));
  Field found(irradiance.rows(), irradiance.cols());
  if (found.rows() == 0) return found;
  parallel_for(static_cast<std::size_t>(found.cols()), [&](std::size_t index) {
    const auto band = static_cast<Eigen::Index>(index);
    found.col(band) =
        followed_in_band(is_of_highest ? highest_ : systems_[index], irradiance.col(band).matrix()).array();
  });
  return found;
}

Field PocketTransport::with_pockets(Field irradiance, const Field& of_pockets) const {
  for (std::size_t k = 0; k < pockets_.patches.size(); ++k)
    irradiance.row(pockets_.patches[k]) = of_pockets.row(static_cast<Eigen::Index>(k));
  return irradiance;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  Field irradiance = transport_.apply(radiosity);
  const Field from_others = chosen_rows(irradiance, pockets_.patches) - sent_within(radiosity);
  irradiance = with_pockets(std::move(irradiance), followed(from_others));
  if (closed_are_dark_)
    for (const PatchIndex patch : pockets_.closed) irradiance.row(patch) = 0;
  return irradiance;
}

Field PocketTransport::irradiance_within(const FieldView& radiosity) const {
  return with_pockets(Field::Zero(radiosity.rows(), radiosity.cols()), followed(sent_within(radiosity)));
}

}  // namespace patchlight
