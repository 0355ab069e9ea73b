#pragma once

#include "patchlight/base/field.h"

#include <Eigen/Core>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>

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

/// Conjugate gradients (Hestenes and Stiefel 1952) with a preconditioner M, as in Saad 2003, algorithm 9.1, for A x = b
/// with A and M symmetric and positive: the residual r, the direction p, and how far to go along it. Knows neither A
/// nor x. In each step the caller finds q = A p, adds length(q) p to x, and calls advance(). `Vector` is a Field, each
/// band of which has scalars of its own, or an Eigen::VectorXd.
template <typename Vector>
class ConjugateDirections {
 public:
  using Scalars = std::conditional_t<std::is_same_v<Vector, Field>, Eigen::ArrayXd, double>;
  using Preconditioner = std::function<Vector(const Vector& r)>;

  /// Starts at an x with b - A x = `residual`. `preconditioner` gives M^-1 r; empty: r itself.
  explicit ConjugateDirections(Vector residual, Preconditioner preconditioner = {})
      : preconditioner_(std::move(preconditioner)),
        r_(std::move(residual)),
        p_(preconditioned()),
        rz_(product(r_, p_)) {}

  const Vector& residual() const { return r_; }
  const Vector& direction() const { return p_; }
  /// r . M^-1 r
  const Scalars& square() const { return rz_; }

  /// (r . M^-1 r) / (p . q); 0 for a band that is solved; of a single vector not finite, then.
  Scalars length(const Vector& q) const { return ratio(rz_, product(p_, q)); }

  /// The residual after that step, and the direction after it.
  void advance(const Vector& q, const Scalars& length) {
    r_ -= times(length, q);
    const Vector z = preconditioned();
    const Scalars rz = product(r_, z);
    p_ = z + times(ratio(rz, rz_), p_);
    rz_ = rz;
  }

  /// Takes so much of z out of the direction, as deflation does.
  void take_out(const Vector& z, const Scalars& multiple) { p_ -= times(multiple, z); }

 private:
  static Eigen::ArrayXd product(const Field& x, const Field& y) { return dot(x, y); }
  static double product(const Eigen::VectorXd& x, const Eigen::VectorXd& y) { return scalar_product(x, y); }
  static Eigen::ArrayXd ratio(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return quotient(a, b); }
  static double ratio(double a, double b) { return a / b; }
  static Field times(const Eigen::ArrayXd& factors, const Field& x) { return scaled(x, factors); }
  static Eigen::VectorXd times(double factor, const Eigen::VectorXd& x) { return factor * x; }

  Vector preconditioned() const { return preconditioner_ ? preconditioner_(r_) : r_; }

  Preconditioner preconditioner_;
  Vector r_;
  Vector p_;
  Scalars rz_;
};

}  // namespace patchlight
