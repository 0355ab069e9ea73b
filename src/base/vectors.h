#pragma once

#include "patchlight/base/field.h"

#include <Eigen/Core>
#include <span>

namespace patchlight {

// Sums, products and maxima over all patches, one per band (column). Every sum is taken in an order that follows from
// the number of patches and bands alone, so that it has the same bits for any number of threads.

/// sum_i x_i
Eigen::ArrayXd sum_over_patches(const FieldView& x);

/// sum_i A_i x_i: the flux of a radiosity or irradiance, W for W/m^2 and `area` in m^2.
Eigen::ArrayXd area_sum(const FieldView& x, const Eigen::VectorXd& area);

/// sum_i x_i y_i
Eigen::ArrayXd dot(const FieldView& x, const FieldView& y);

/// sum_i A_i x_i y_i
Eigen::ArrayXd inner_product(const FieldView& x, const FieldView& y, const Eigen::VectorXd& area);

/// The same of x with each of several fields of as many bands: a row for each. Several are read at the cost of one.
Eigen::ArrayXXd inner_products(const Field& x, std::span<const Field> with, const Eigen::VectorXd& area);

/// max_i x_i
Eigen::ArrayXd highest(const FieldView& x);

/// sum_i x_i, sum_i x_i y_i and max_i x_i of values without bands.
double total(const Eigen::VectorXd& x);
double scalar_product(const Eigen::VectorXd& x, const Eigen::VectorXd& y);
double largest(const Eigen::VectorXd& x);

/// a / b per band; 0 where b is 0: a band that is solved exactly has residual and direction 0, and takes no further
/// step.
Eigen::ArrayXd quotient(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b);

/// The rows of some patches, in their order.
Field chosen_rows(const FieldView& field, std::span<const PatchIndex> patches);

/// A field with each band multiplied by a factor.
Field scaled(const FieldView& field, const Eigen::ArrayXd& factors);

/// A field plus several others of as many bands, each band of these multiplied by a factor: a row for each.
Field plus_combination(Field field, std::span<const Field> others, const Eigen::ArrayXXd& factors);

}  // namespace patchlight
