#include "solve/pocket_transport.h"

#include "base/parallel.h"
#include "base/vectors.h"

#include <cassert>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// F_PP B_P of one band.
Eigen::VectorXd sent_within(const Pocket& pocket, const FieldView& radiosity, Eigen::Index band) {
  return pocket.form_factors * radiosity(pocket.patches, band).matrix();
}

void raise_to(std::atomic<double>& highest, double value) {
  double before = highest;
  while (before < value && !highest.compare_exchange_weak(before, value)) {
  }
}

}  // namespace

PocketTransport::PocketTransport(const TransportOperator& transport, const Pockets& pockets,
                                 const Scattering& scattering, bool closed_are_dark, double accuracy)
    : transport_(transport), pockets_(pockets), closed_are_dark_(closed_are_dark), accuracy_(accuracy) {
  assert(scattering.is_diagonal());
  for (const Pocket& pocket : pockets.each) {
    const Field reflectance = chosen_rows(scattering.reflectance, pocket.patches);
    std::vector<PocketSystem>& systems = systems_.emplace_back();
    for (Eigen::Index band = 0; band < reflectance.cols(); ++band)
      systems.push_back(system_within(pocket, reflectance.col(band).matrix()));
    if (reflectance.cols() > 1) systems.push_back(system_within(pocket, reflectance.rowwise().maxCoeff().matrix()));
  }
}

// (I - F_PP R)^-1 H. No entry of the inverse is negative: so |error| <= max |r| y of any y with (I - F_PP R) y >= 1,
// and twice the bounces are such a one.
Eigen::VectorXd PocketTransport::followed_in_band(const Pocket& pocket, const PocketSystem& system,
                                                  const Eigen::VectorXd& irradiance) const {
  constexpr int most_tries = 2;
  const double highest_bound = 2 * pocket.bounces.maxCoeff();  // of the error, where max |r| is 1
  double tolerance = accuracy_ / highest_bound;
  for (int tries = 1;; ++tries) {
    Eigen::VectorXd found = solution_within(pocket, system, irradiance, tolerance);
    const Eigen::VectorXd residual = irradiance - system.matrix * found;
    // From a right side that is not finite zeros are found.
    if (!residual.allFinite()) return Eigen::VectorXd::Constant(irradiance.size(), residual.sum());
    const double largest_off = residual.cwiseAbs().maxCoeff() * highest_bound;
    const double largest = found.cwiseAbs().maxCoeff();
    if (largest_off <= accuracy_ * largest || system.is_eliminated() || tries == most_tries) {
      if (largest > 0) raise_to(farthest_off_, largest_off / largest);
      return found;
    }
    tolerance /= 10;
  }
}

// An irradiance with (I - F_PP R)^-1 H in its pockets, where H arrives at each of these in each band.
Field PocketTransport::followed(const Arriving& arriving, Field irradiance) const {
  const auto bands = static_cast<std::size_t>(irradiance.cols());
  parallel_for(pockets_.each.size() * bands, [&](std::size_t index) {
    const Pocket& pocket = pockets_.each[index / bands];
    const std::vector<PocketSystem>& systems = systems_[index / bands];
    assert(bands == 1 || bands + 1 == systems.size());  // one column of several bands: that of the highest R
    const PocketSystem& system = bands == 1 ? systems.back() : systems[index % bands];
    const auto band = static_cast<Eigen::Index>(index % bands);
    irradiance(pocket.patches, band) = followed_in_band(pocket, system, arriving(pocket, band)).array();
  });
  return irradiance;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  const Field irradiance = transport_.apply(radiosity);
  const auto from_others = [&](const Pocket& pocket, Eigen::Index band) -> Eigen::VectorXd {
    return irradiance(pocket.patches, band).matrix() - sent_within(pocket, radiosity, band);
  };
  Field found = followed(from_others, irradiance);
  if (closed_are_dark_)
    for (const PatchIndex patch : pockets_.closed) found.row(patch) = 0;
  return found;
}

Field PocketTransport::irradiance_within(const FieldView& radiosity) const {
  const auto from_own = [&](const Pocket& pocket, Eigen::Index band) { return sent_within(pocket, radiosity, band); };
  return followed(from_own, Field::Zero(radiosity.rows(), radiosity.cols()));
}

}  // namespace patchlight
