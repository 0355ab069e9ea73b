#include "solve/pocket_transport.h"

#include "base/parallel.h"
#include "base/vectors.h"

#include <cassert>
#include <cstddef>

namespace patchlight {
namespace {

// F_PP B_P
Field sent_within(const Pocket& pocket, const FieldView& radiosity) {
  return arriving_within(pocket, chosen_rows(radiosity, pocket.patches));
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
    of_bands_.push_back(system_within(pocket.form_factors, reflectance));
    if (reflectance.cols() > 1)
      of_highest_.push_back(system_within(pocket.form_factors, reflectance.rowwise().maxCoeff()));
  }
}

// (I - F_PP R)^-1 H. No entry of the inverse is negative: so |error| <= max |r| y of any y with (I - F_PP R) y >= 1,
// and twice the bounces are such a one.
Field PocketTransport::followed(const Pocket& pocket, const PocketSystem& system, const FieldView& irradiance) const {
  const double highest_bound = 2 * pocket.bounces.maxCoeff();  // of the error, where max |r| is 1
  const auto relative_errors = [&](const Field& found) {
    const Field residual = residual_within(pocket, system, irradiance, found);
    return quotient(highest_bound * highest(residual.abs()), highest(found.abs()));
  };
  const double tolerance = accuracy_ / highest_bound;
  Field found = solution_within(pocket, system, irradiance, tolerance);
  Eigen::ArrayXd error = relative_errors(found);
  // Bands that are not near enough are looked for once more, each by itself.
  if (!system.is_eliminated() && !(error <= accuracy_).all()) {
    constexpr double nearer = 0.1;
    const Field again = solution_within(pocket, system, irradiance, nearer * tolerance);
    for (Eigen::Index band = 0; band < found.cols(); ++band)
      if (!(error[band] <= accuracy_)) found.col(band) = again.col(band);
    error = relative_errors(found);
  }
  for (Eigen::Index band = 0; band < found.cols(); ++band) {
    // From what is not finite nothing is found.
    if (!irradiance.col(band).allFinite()) found.col(band).setConstant(irradiance.col(band).sum());
    if (error[band] > 0) raise_to(farthest_off_, error[band]);
  }
  return found;
}

// An irradiance with (I - F_PP R)^-1 H in its pockets, where H arrives at each of these.
Field PocketTransport::followed_in_each(const std::function<Field(const Pocket&)>& arriving, Field irradiance) const {
  const bool is_of_highest = irradiance.cols() == 1 && !of_highest_.empty();
  const std::vector<PocketSystem>& systems = is_of_highest ? of_highest_ : of_bands_;
  parallel_for(pockets_.each.size(), [&](std::size_t index) {
    const Pocket& pocket = pockets_.each[index];
    irradiance(pocket.patches, Eigen::all) = followed(pocket, systems[index], arriving(pocket));
  });
  return irradiance;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  const Field irradiance = transport_.apply(radiosity);
  const auto from_others = [&](const Pocket& pocket) {
    return Field(chosen_rows(irradiance, pocket.patches) - sent_within(pocket, radiosity));
  };
  Field found = followed_in_each(from_others, irradiance);
  if (closed_are_dark_)
    for (const PatchIndex patch : pockets_.closed) found.row(patch) = 0;
  return found;
}

Field PocketTransport::irradiance_within(const FieldView& radiosity) const {
  const auto from_own = [&](const Pocket& pocket) { return sent_within(pocket, radiosity); };
  return followed_in_each(from_own, Field::Zero(radiosity.rows(), radiosity.cols()));
}

}  // namespace patchlight
