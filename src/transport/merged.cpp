#include "transport/merged.h"

#include "base/parallel.h"
#include "mesh/nested_mesh.h"
#include "transport/closure.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace patchlight {

Eigen::MatrixXd exchange_between_groups(const ExchangeAreas& S, std::span<const std::uint32_t> group_of,
                                        std::uint32_t groups) {
  assert(group_of.size() == S.size());
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(groups, groups);
  for (PatchIndex i = 0; i < S.size(); ++i) {
    for (PatchIndex j = i; j < S.size(); ++j) upper(group_of[i], group_of[j]) += static_cast<double>(S.at(i, j));
  }
  // Each pair was met once; the diagonal of S is zero.
  return upper + upper.transpose();
}

namespace {

// Partial sums are kept per stripe of parents; their number is fixed, so that the bits do not depend on the threads.
constexpr PatchIndex parent_stripes = 16;

struct Effects {
  const ExchangeAreas& S;
  const FieldView& difference;
  const FieldView& weight;

  // The effect of the patches `from` on the patches `on`.
  double of(const PatchRange& from, const PatchRange& on) const {
    double effect = 0;
    Eigen::ArrayXd sum(difference.cols());
    for (PatchIndex i = on.begin; i < on.end; ++i) {
      sum.setZero();
      for (PatchIndex c = from.begin; c < from.end; ++c)
        sum += static_cast<double>(S.at(c, i)) * difference.row(c).transpose();
      for (Eigen::Index band = 0; band < sum.size(); ++band) effect += weight(i, band) * sum[band] * sum[band];
    }
    return effect;
  }
};

}  // namespace

ClosedExchangeAreas merged(const ClosedExchangeAreas& closed, const NestedMesh& mesh) {
  const ExchangeAreas& S = closed.exchange_areas;
  assert(S.size() == mesh.patches.size());
  ExchangeAreas sums(mesh.parents.size());
  parallel_for(mesh.parents.size(), [&](std::size_t row) {
    const auto G = static_cast<PatchIndex>(row);
    const PatchRange g = mesh.patches_of(G);
    for (PatchIndex H = 0; H < G; ++H) {
      const PatchRange h = mesh.patches_of(H);
      double sum = 0;
      for (PatchIndex i = g.begin; i < g.end; ++i) {
        for (PatchIndex j = h.begin; j < h.end; ++j) sum += static_cast<double>(S.at(j, i));
      }
      sums.set(H, G, narrow_toward_zero(sum));
    }
  });
  // What narrowing took, and what the patches of a parent keep among themselves.
  const Field rows = summed_by_parent(mesh, (row_sums(S) + closed.remainder).array());
  Eigen::VectorXd remainder = rows.col(0).matrix() - row_sums(sums);
  return {std::move(sums), std::move(remainder), closed.method};
}

Eigen::VectorXd effects_of_parts(const ExchangeAreas& S, const NestedMesh& mesh, const FieldView& difference,
                                 const FieldView& weight) {
  const PatchIndex count = mesh.parents.size();
  if (difference.isZero(0)) return Eigen::VectorXd::Zero(count);
  const Effects effects{S, difference, weight};
  std::vector<Eigen::VectorXd> partial(parent_stripes, Eigen::VectorXd::Zero(count));
  parallel_for(parent_stripes, [&](std::size_t stripe) {
    for (auto G = static_cast<PatchIndex>(stripe); G < count; G += parent_stripes) {
      const PatchRange g = mesh.patches_of(G);
      for (PatchIndex H = 0; H < G; ++H) {
        const PatchRange h = mesh.patches_of(H);
        partial[stripe][G] += effects.of(g, h);
        partial[stripe][H] += effects.of(h, g);
      }
    }
  });
  for (std::size_t stripe = 1; stripe < parent_stripes; ++stripe) partial[0] += partial[stripe];
  return partial[0];
}

}  // namespace patchlight
