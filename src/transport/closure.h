#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/half_differences.h"
#include "patchlight/transport/lost_share.h"
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

/// A row of form factors with a wrong sum.
struct RowDefect {
  PatchIndex patch = 0;
  double row_sum = 0;   ///< sum_j F_ij
  double expected = 0;  ///< 1 - lost
};

/// The `count` rows with the largest |row_sum - expected| times the patch's area, worst first, ties in order of index.
/// Fewer if there are fewer rows, none without row sums. `area` in m^2. O(size log count).
std::vector<RowDefect> worst_rows(const Eigen::VectorXd& row_sum, const LostShare& lost, const Eigen::VectorXd& area,
                                  std::size_t count);

/// The start of ClosedExchangeAreas::method when row sums were cut.
inline constexpr std::string_view cut_row_sums = "row sums cut at 1 plus three standard errors";

/// Exchange areas whose rows sum to the visible share.
struct ClosedExchangeAreas {
  ExchangeAreas exchange_areas;  ///< entries rounded toward zero to float
  Eigen::VectorXd remainder;     ///< m^2, the loss of each row by this rounding; applied as remainder_i B_i
  std::string method;            ///< "least squares", "scaling", cut_row_sums or "none", with the reason
};

/// Corrects symmetric exchange areas so that row i sums to a_i = A_i (1 - lost_i). It makes the smallest change in the
/// norm weighted by the variances of the entries. In a closed scene S_ij^2 replaces the variance, and the sums become
/// exact. In an open scene the standard error of the measured lost share is weighed against those of the rows, which
/// follow from `differences` and are nearly 0 where no shadow ray was needed. Without differences, or above 4,096
/// patches, each entry has an error of 2 % of S_ij.
///
/// If an entry would become negative, a closed scene falls back to symmetric scaling. An open scene falls back to
/// cutting row sums at the area plus three standard errors. The raw entries stay if no symmetric matrix with this
/// pattern has such sums. docs/theory/closure.md. \throws Canceled.
ClosedExchangeAreas close_exchange_areas(ExchangeAreas raw, const Eigen::VectorXd& area, const LostShare& lost,
                                         const HalfDifferences& differences = {}, const Observer& observer = {});

/// Keeps the entries without any change.
ClosedExchangeAreas keep_exchange_areas(ExchangeAreas raw, const std::string& reason);

/// Exchange areas between groups of patches in m^2: entry (G, H) is the sum of S_ij over the patches i of G and j of H,
/// so F_GH = S_GH / A_G. Symmetric. `group_of` has one number below `groups` per patch. O(size^2).
Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups);

/// The exchange areas between the parents of a mesh: S_GH = sum_{i in G, j in H} S_ij over its patches. No ray is
/// traced; row sums and closure stay valid. O(size^2).
ClosedExchangeAreas merged(const ClosedExchangeAreas& closed, const NestedMesh& mesh);

/// The effect on other patches of the differences within each parent: for each parent G the sum over bands and patches
/// i of weight_i (sum_{c in G} S_ic difference_c)^2. `difference` is that of each patch from its parent's mean.
/// O(size^2).
Eigen::VectorXd effects_of_parts(const ExchangeAreas& S, const NestedMesh& mesh, const FieldView& difference,
                                 const FieldView& weight);

/// Transport with all exchange areas in memory: F_ij = S_ij / A_i, summed in double. `area` in m^2.
std::unique_ptr<RowTransport> dense_transport(ClosedExchangeAreas exchange_areas, Eigen::VectorXd area);

/// Transport without a stored matrix: O(size) memory. A row of the exchange areas is computed when it is needed, in
/// O(size) time, with the same bits as assemble_exchange_areas() with the same options. F_ij = S_ij / A_i with `area`
/// in m^2. gather() and form_factors() compute the rows of their receivers, shoot() those of its sources, apply() all
/// in O(size^2) time. Computing rows of neighbors together is faster than one by one. The rows are not closed, because
/// closure needs all rows at once. The same bits for any number of threads. Estimator::automatic only. `mesh` and
/// `occluder` must outlive the transport.
std::unique_ptr<RowTransport> on_demand_transport(const PatchMesh& mesh, const Occluder& occluder,
                                                  const AssemblyOptions& options, Eigen::VectorXd area);

}  // namespace patchlight
