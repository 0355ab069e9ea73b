#include "transport/random_errors.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "transport/tiles.h"

#include <cassert>

namespace patchlight {
namespace {

// Calls add(i, j, D_ij, sum) for all pairs i < j with a difference. The sum of each stripe starts from `zero`.
template <typename Add>
Field sum_over_pairs(const HalfDifferences& differences, const Field& zero, Add add) {
  return sum_over_stripes(differences.size(), stripes, zero, [&](PatchIndex j, Field& sum) {
    for (PatchIndex i = 0; i < j; ++i) {
      const double difference = differences.at(i, j);
      if (difference != 0) add(i, j, difference, sum);
    }
  });
}

}  // namespace

Field random_errors(const HalfDifferences& differences, const FieldView& x, int draws, std::uint64_t seed) {
  assert(x.rows() == static_cast<Eigen::Index>(differences.size()) && draws >= 1 && draws <= 32);
  const std::uint32_t key = hash({seed, stream::signs_of_rows});
  const Eigen::Index columns = x.cols();
  const auto add = [&](PatchIndex i, PatchIndex j, double difference, Field& sum) {
    const std::uint32_t signs = hash(hash(i ^ key) + j);
    for (Eigen::Index draw = 0; draw < draws; ++draw) {
      const double error = (signs >> draw & 1) != 0 ? difference : -difference;
      for (Eigen::Index c = 0; c < columns; ++c) {
        sum(i, draw * columns + c) += error * x(j, c);
        sum(j, draw * columns + c) += error * x(i, c);
      }
    }
  };
  return sum_over_pairs(differences, Field::Zero(x.rows(), columns * draws), add);
}

Field by_variances(const HalfDifferences& differences, const FieldView& x) {
  assert(x.rows() == static_cast<Eigen::Index>(differences.size()));
  const auto add = [&](PatchIndex i, PatchIndex j, double difference, Field& sum) {
    sum.row(i) += difference * difference * x.row(j);
    sum.row(j) += difference * difference * x.row(i);
  };
  return sum_over_pairs(differences, Field::Zero(x.rows(), x.cols()), add);
}

}  // namespace patchlight
