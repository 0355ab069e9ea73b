#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/sampling_error.h"
#include "patchlight/transport/transport_operator.h"

#include "mesh/nested_mesh.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

class Occluder;

/// A row of form factors whose sum is off.
struct RowDefect {
  PatchIndex patch = 0;
  double row_sum = 0;   ///< sum_j F_ij
  double expected = 0;  ///< 1 - lost
};

/// The `count` rows with the largest defect |row_sum - expected| times the patch's area, worst first; of equals the
/// first. Fewer where there are fewer rows, none without row sums. `area` in m^2. O(size log count).
std::vector<RowDefect> worst_rows(const Eigen::VectorXd& row_sum, const LostShare& lost, const Eigen::VectorXd& area,
                                  std::size_t count);

/// How ClosedExchangeAreas::method begins where row sums were cut.
inline constexpr std::string_view cut_row_sums = "row sums cut at 1 plus three standard errors";

/// Exchange areas whose rows sum to the visible share.
struct ClosedExchangeAreas {
  ExchangeAreas exchange_areas;  ///< entries narrowed toward zero
  Eigen::VectorXd remainder;     ///< m^2, the loss of each row by narrowing; applied as remainder_i B_i
  std::string method;            ///< "least squares", "scaling", cut_row_sums or "none", with the reason
};

/// The known errors of the entries, for weighing them against a measured lost share.
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

/// Exchange areas between groups of patches in m^2: entry (G, H) is the sum of S_ij over the patches i of G and j of H,
/// so that F_GH = S_GH / A_G. Symmetric. `group_of` has one number below `groups` per patch. O(size^2).
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups);

/// The exchange areas between the parents of a mesh from those between its patches: their sums, S_GH = sum_{i in G, j
/// in H} S_ij. No ray is traced; row sums and closure carry over. O(size^2).
ClosedExchangeAreas merged(const ClosedExchangeAreas& closed, const NestedMesh& mesh);

/// The change elsewhere because the patches of a parent differ: for each parent G the
/// sum over bands and patches i of weight_i (sum_{c in G} S_ic difference_c)^2, with the difference of each patch from
/// its parent's mean. O(size^2).
Eigen::VectorXd effects_of_parts(const ExchangeAreas& S, const NestedMesh& mesh, const FieldView& difference,
                                 const FieldView& weight);

/// Transport with all exchange areas in memory: F_ij = S_ij / A_i, summed in double. `area` in m^2.
std::unique_ptr<RowTransport> dense_transport(ClosedExchangeAreas exchange_areas, Eigen::VectorXd area);

/// Transport that keeps no matrix: O(size) memory. Row i of the exchange areas is computed whenever it is asked for, in
/// O(size) time, and has the bits that assemble_exchange_areas() gives it with the same options; F_ij = S_ij / A_i with
/// `area` in m^2. gather() and form_factors() compute the rows of their receivers, shoot() those of its sources,
/// apply() all: O(size^2) time. Rows of neighbors that are asked for at once take less time than one by one. Closure
/// needs all rows at once: these rows are not closed. The same bits for any number of threads. Estimator::automatic
/// only. `mesh` and `occluder` have to outlive the transport.
std::unique_ptr<RowTransport> on_demand_transport(const PatchMesh& mesh, const Occluder& occluder,
                                                  const AssemblyOptions& options, Eigen::VectorXd area);

}  // namespace patchlight
