#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/transport/entry_errors.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/sampling_error.h"

#include <Eigen/Core>
#include <string>
#include <string_view>

namespace patchlight {

/// How ClosedExchangeAreas::method begins where row sums were cut.
inline constexpr std::string_view cut_row_sums = "row sums cut at 1 plus three standard errors";

/// Exchange areas whose rows sum to the visible share.
struct ClosedExchangeAreas {
  ExchangeAreas exchange_areas;  ///< entries narrowed toward zero
  Eigen::VectorXd remainder;     ///< m^2, what narrowing took from each row; applied as remainder_i B_i
  std::string method;            ///< "least squares", "scaling", cut_row_sums or "none", with the reason
};

/// What the assembly knows of the errors of its entries, for weighing them against a measured lost share.
struct KnownErrors {
  const EntryErrors& entries;  ///< of all entries, or of none
  const SamplingError& sampling;
};

/// Corrects symmetric exchange areas so that row i sums to a_i = A_i (1 - lost_i), the smallest change in the norm
/// weighted by the entries' variance. In a closed scene S_ij^2 stands for it, and the sums become exact; in an open one
/// the measured lost share has a standard error that is weighed against those of the entries, which are next to 0 where
/// no shadow ray was needed. Without known errors 2 % of S_ij are taken for the error of each. Falls back to symmetric
/// scaling when an entry would become negative, in an open scene to cutting row sums at the area plus three standard
/// errors, and to the raw entries where no symmetric matrix with this pattern has such sums. docs/theory/closure.md.
/// \throws Cancelled.
ClosedExchangeAreas close_exchange_areas(ExchangeAreas raw, const Eigen::VectorXd& area, const LostShare& lost,
                                         const Observer& observer = {});
ClosedExchangeAreas close_exchange_areas(ExchangeAreas raw, const Eigen::VectorXd& area, const LostShare& lost,
                                         const KnownErrors& known, const Observer& observer = {});

/// The same entries without any change.
ClosedExchangeAreas keep_exchange_areas(ExchangeAreas raw, const std::string& reason);

}  // namespace patchlight
