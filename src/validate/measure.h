#pragma once

#include "patchlight/transport/assemble.h"

#include "validate/validate.h"

#include <Eigen/Core>

namespace patchlight::validation {

/// What unoccluded_exchange_area() promises of the relative error of one pair; the cases have no far patches at grazing
/// angles.
inline constexpr double quadrature_error = 1e-3;

/// A scene repaired, checked and cut into patches, with its exchange areas before closure, summed by group.
struct GroupExchange {
  Eigen::MatrixXd exchange_area;  ///< m^2
  Eigen::MatrixXd error;  ///< m^2, bound on what quadrature and storage as float make of it; sampling not included
  Eigen::VectorXd area;   ///< m^2, of the groups
};

/// The front sides of the polygons take part. \throws Cancelled.
GroupExchange group_exchange(const Scene& scene, double max_edge, const AssemblyOptions& options,
                             const Observer& observer);

/// The form factor from group 0 to group `to` where nothing can be hidden in part: the bar is that of the closed forms
/// and of quadrature. \throws Cancelled.
Measured unoccluded_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer);

/// The same where shadow rays decide: mean of runs with different seeds, and from their scatter its standard error.
/// \throws Cancelled.
Measured sampled_form_factor(const Scene& scene, double max_edge, std::uint32_t to, const Observer& observer);

/// What a finer mesh yields; a coarser one with edges twice as long tells how far it is from the limit, as the error at
/// least halves from one to the next.
Measured refined(const Measured& coarse, const Measured& fine);

}  // namespace patchlight::validation
