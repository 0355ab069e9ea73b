#include "base/vectors.h"

namespace patchlight {

Eigen::ArrayXd sum_over_patches(const FieldView& x) { return x.colwise().sum().transpose(); }

Eigen::ArrayXd area_sum(const FieldView& x, const Eigen::VectorXd& area) {
  return (x.colwise() * area.array()).colwise().sum().transpose();
}

Eigen::ArrayXd dot(const FieldView& x, const FieldView& y) { return (x * y).colwise().sum().transpose(); }

Eigen::ArrayXd inner_product(const FieldView& x, const FieldView& y, const Eigen::VectorXd& area) {
  return ((x * y).colwise() * area.array()).colwise().sum().transpose();
}

Eigen::ArrayXd highest(const FieldView& x) { return x.colwise().maxCoeff().transpose(); }

double total(const Eigen::VectorXd& x) { return x.sum(); }

double scalar_product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) { return x.dot(y); }

double largest(const Eigen::VectorXd& x) { return x.maxCoeff(); }

Eigen::ArrayXd quotient(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return (b != 0).select(a / b, 0.0); }

Field scaled(const FieldView& field, const Eigen::ArrayXd& factors) { return field.rowwise() * factors.transpose(); }

}  // namespace patchlight
