#include "base/vectors.h"

#include "base/parallel.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace patchlight {
namespace {

// Rows that stay in the cache while other fields go by; the order of sums follows from them.
constexpr Eigen::Index rows_of_block = 2048;

// Calls body(block, first row, number of rows) for all blocks, spread over the threads.
void for_blocks(Eigen::Index rows, const auto& body) {
  parallel_for(static_cast<std::size_t>((rows + rows_of_block - 1) / rows_of_block), [&](std::size_t block) {
    const Eigen::Index first = static_cast<Eigen::Index>(block) * rows_of_block;
    body(block, first, std::min(rows_of_block, rows - first));
  });
}

// The values of a field of one band from a row on, which as a column are taken several at a time.
Eigen::Map<const Eigen::ArrayXd> single_band(const FieldView& field, Eigen::Index first, Eigen::Index rows) {
  return {field.data() + first, rows};
}

bool has_single_band(const FieldView& field) { return field.cols() == 1 && field.outerStride() == 1; }

}  // namespace

Eigen::ArrayXd sum_over_patches(const FieldView& x) { return x.colwise().sum().transpose(); }

Eigen::ArrayXd area_sum(const FieldView& x, const Eigen::VectorXd& area) {
  return (x.colwise() * area.array()).colwise().sum().transpose();
}

Eigen::ArrayXd dot(const FieldView& x, const FieldView& y) { return (x * y).colwise().sum().transpose(); }

Eigen::ArrayXd inner_product(const FieldView& x, const FieldView& y, const Eigen::VectorXd& area) {
  return ((x * y).colwise() * area.array()).colwise().sum().transpose();
}

Eigen::ArrayXXd inner_products(const Field& x, std::span<const Field> with, const Eigen::VectorXd& area) {
  const auto count = static_cast<Eigen::Index>(with.size());
  const Eigen::Index bands = x.cols();
  std::vector<Eigen::ArrayXXd> parts(static_cast<std::size_t>((x.rows() + rows_of_block - 1) / rows_of_block));
  for_blocks(x.rows(), [&](std::size_t block, Eigen::Index first, Eigen::Index rows) {
    const Field weighted = x.middleRows(first, rows).colwise() * area.segment(first, rows).array();
    Eigen::ArrayXXd& part = parts[block];
    part.resize(count, bands);
    for (Eigen::Index k = 0; k < count; ++k)
      part.row(k) = (weighted * with[static_cast<std::size_t>(k)].middleRows(first, rows)).colwise().sum();
  });
  Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(count, bands);
  for (const Eigen::ArrayXXd& part : parts) sum += part;
  return sum;
}

Eigen::ArrayXd highest(const FieldView& x) { return x.colwise().maxCoeff().transpose(); }

double total(const Eigen::VectorXd& x) { return x.sum(); }

double scalar_product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) { return x.dot(y); }

double largest(const Eigen::VectorXd& x) { return x.maxCoeff(); }

Eigen::ArrayXd quotient(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return (b != 0).select(a / b, 0.0); }

Field chosen_rows(const FieldView& field, std::span<const PatchIndex> patches) {
  Field rows(static_cast<Eigen::Index>(patches.size()), field.cols());
  for (std::size_t k = 0; k < patches.size(); ++k) rows.row(static_cast<Eigen::Index>(k)) = field.row(patches[k]);
  return rows;
}

Field scaled(const FieldView& field, const Eigen::ArrayXd& factors) {
  if (has_single_band(field)) return factors[0] * single_band(field, 0, field.rows());
  return field.rowwise() * factors.transpose();
}

Field plus_combination(Field field, std::span<const Field> others, const Eigen::ArrayXXd& factors) {
  assert(factors.rows() == static_cast<Eigen::Index>(others.size()) && factors.cols() == field.cols());
  const bool is_single = has_single_band(field);
  for_blocks(field.rows(), [&](std::size_t, Eigen::Index first, Eigen::Index rows) {
    auto block = field.middleRows(first, rows);
    for (Eigen::Index k = 0; k < factors.rows(); ++k) {
      const Field& other = others[static_cast<std::size_t>(k)];
      if (is_single) {
        Eigen::Map<Eigen::ArrayXd>(field.data() + first, rows) += factors(k, 0) * single_band(other, first, rows);
      } else {
        block += other.middleRows(first, rows).rowwise() * factors.row(k);
      }
    }
  });
  return field;
}

}  // namespace patchlight
