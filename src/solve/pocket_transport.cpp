#include "solve/pocket_transport.h"

#include "base/parallel.h"
#include "base/vectors.h"

#include <cassert>
#include <cstddef>
#include <limits>

namespace patchlight {
namespace {

// F_PP B_P.
Field sent_within(const Pocket& pocket, const FieldView& radiosity) {
  return pocket.rays.apply(chosen_rows(radiosity, pocket.patches));
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
    systems_.push_back(system_within(pocket.rays, reflectance));
    if (reflectance.cols() > 1) of_highest_.push_back(system_within(pocket.rays, reflectance.rowwise().maxCoeff()));
  }
}

// (I - F_PP R)^-1 H. No entry of the inverse is negative: so |error| <= max |r| y of any y with (I - F_PP R) y >= 1,
// and twice the bounces are such a one.
Field PocketTransport::followed_within(std::size_t pocket, const Field& irradiance) const {
  const RayTransport& rays = pockets_.each[pocket].rays;
  const bool of_all = irradiance.cols() == systems_[pocket].reflectance.cols();
  assert(of_all || irradiance.cols() == 1);  // one column of several bands: that of the highest R
  const PocketSystem& system = of_all ? systems_[pocket] : of_highest_[pocket];
  const double highest_bound = 2 * pockets_.each[pocket].bounces.maxCoeff();  // of the error, where max |r| is 1
  Eigen::ArrayXd goal = dot(irradiance, irradiance).sqrt() * (accuracy_ / highest_bound);
  Field found = Field::Zero(irradiance.rows(), irradiance.cols());
  Field residual = irradiance;
  Eigen::ArrayXd largest_off, largest;
  // What the recurrences of the iterations leave is followed once more.
  for (int tries = 0; tries < 2; ++tries) {
    found += solution_within(rays, system, residual, goal);
    residual = residual_within(rays, system, irradiance, found);
    for (Eigen::Index band = 0; band < found.cols(); ++band)
      if (!residual.col(band).isFinite().all()) found.col(band) = std::numeric_limits<double>::quiet_NaN();
    largest_off = highest(residual.abs()) * highest_bound;
    largest = highest(found.abs());
    if (system.is_eliminated() || (largest_off <= accuracy_ * largest).all()) break;
    goal = accuracy_ / highest_bound * largest;
  }
  raise_to(farthest_off_, quotient(largest_off, largest).maxCoeff());
  return found;
}

// An irradiance with (I - F_PP R)^-1 H in its pockets, where H arrives at each of these.
Field PocketTransport::followed(const Arriving& arriving, Field irradiance) const {
  parallel_for(pockets_.each.size(), [&](std::size_t k) {
    const Field found = followed_within(k, arriving(pockets_.each[k]));
    const std::vector<PatchIndex>& patches = pockets_.each[k].patches;
    for (std::size_t i = 0; i < patches.size(); ++i)
      irradiance.row(patches[i]) = found.row(static_cast<Eigen::Index>(i));
  });
  return irradiance;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  const Field irradiance = transport_.apply(radiosity);
  const auto from_others = [&](const Pocket& pocket) -> Field {
    return chosen_rows(irradiance, pocket.patches) - sent_within(pocket, radiosity);
  };
  Field found = followed(from_others, irradiance);
  if (closed_are_dark_)
    for (const PatchIndex patch : pockets_.closed) found.row(patch) = 0;
  return found;
}

Field PocketTransport::irradiance_within(const FieldView& radiosity) const {
  const auto from_own = [&](const Pocket& pocket) { return sent_within(pocket, radiosity); };
  return followed(from_own, Field::Zero(radiosity.rows(), radiosity.cols()));
}

}  // namespace patchlight
