#include "patchlight/transport/random_errors.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"

#include <cassert>
#include <vector>

namespace patchlight {
namespace {

// Partial sums are kept per stripe of rows; their number is fixed, so that the bits do not depend on the threads.
constexpr PatchIndex stripes = 8;

// Adds what the entries of row j and the columns before it contribute.
void add_row(const EntryErrors& errors, PatchIndex j, const FieldView& x, std::uint32_t seed, Field& sum) {
  const Eigen::Index columns = x.cols();
  const Eigen::Index draws = sum.cols() / columns;
  for (PatchIndex i = 0; i < j; ++i) {
    const double sigma = errors.standard_error(i, j);
    if (sigma == 0) continue;
    const std::uint32_t signs = hash(hash(i ^ seed) + j);
    for (Eigen::Index draw = 0; draw < draws; ++draw) {
      const double error = (signs >> draw & 1) != 0 ? sigma : -sigma;
      for (Eigen::Index c = 0; c < columns; ++c) {
        sum(i, draw * columns + c) += error * x(j, c);
        sum(j, draw * columns + c) += error * x(i, c);
      }
    }
  }
}

}  // namespace

Field random_errors(const EntryErrors& errors, const FieldView& x, int draws, std::uint64_t seed) {
  assert(x.rows() == static_cast<Eigen::Index>(errors.size()) && draws >= 1 && draws <= 32);
  const std::uint32_t mixed = hash({seed, 0x64726177});
  std::vector<Field> partial(stripes, Field::Zero(x.rows(), x.cols() * draws));
  parallel_for(stripes, [&](std::size_t stripe) {
    for (auto j = static_cast<PatchIndex>(stripe); j < errors.size(); j += stripes) {
      add_row(errors, j, x, mixed, partial[stripe]);
    }
  });
  for (std::size_t stripe = 1; stripe < stripes; ++stripe) partial[0] += partial[stripe];
  return partial[0];
}

}  // namespace patchlight
