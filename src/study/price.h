#pragma once

#include "study/study.h"

#include <array>
#include <string>
#include <vector>

namespace patchlight {

/// The power p with which an error falls with the edge of the patches: e1 / e2 = (h1 / h2)^p from `coarse` to `fine`.
/// The reference has so many patches; infinitely many stand for the truth. Not a number where the errors do not fall,
/// or where the edges of `fine` are less than four times as long as those of the reference.
double order_in_edge(const StudySetting& coarse, const StudySetting& fine, double reference_patches);

/// The sweep with its orders filled in.
StudySweep with_orders(StudySweep sweep, double reference_patches);

/// The error of a reference: Richardson's extrapolation from its difference to the finest setting of a sweep of
/// patches. The order is the observed one, at least 1/2 and at most 2: from plain ratios of errors where two settings
/// are far coarser than the reference, else with the error of the reference in the model.
double richardson_bar(const StudySweep& by_size, double reference_patches);

/// The number of patches that its mesh has at least the fineness of a uniform one of; infinite for the closed form.
double patches_of(const StudyReference& reference);

/// Which of some points (cost, error) are on the Pareto front: no other one is at least as good in both and better in
/// one.
std::vector<bool> pareto_front(const std::vector<std::array<double, 2>>& points);

/// The study with the fronts of all settings that compete marked.
Study with_fronts(Study study);

/// How a price was found.
enum class Finding {
  interpolated,  ///< between two settings of the front, in logarithms
  at_most,       ///< the cheapest setting is good enough
  extrapolated,  ///< beyond the finest mesh, by the observed order, no farther than 16 times its patches
  not_reached,   ///< farther, or no order is known
  not_known      ///< the reference's own error is as large
};

/// What an error costs.
struct Price {
  double error = 0;  ///< asked for
  Finding finding = Finding::not_reached;
  double cpu_seconds = 0;
  double order = 0;  ///< by which it was extrapolated
};

/// The reference's bar counts as part of every error.
Price price_of(double error, const Study& study);

/// The study in a sentence: "1 % costs 2.1 CPU seconds here, 0.3 % about 19 (...); what limits you is ...".
std::string conclusion(const Study& study);

}  // namespace patchlight
