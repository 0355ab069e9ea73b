#include "solve/pocket.h"

#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace patchlight {
namespace {

// A pocket of at most so many patches is solved by elimination.
constexpr Eigen::Index few_patches = 512;
// Of the incomplete factors: what is dropped, relative to its row, and their size, relative to the matrix.
constexpr float dropped_share = 0.01F;
constexpr int size_of_factors = 2;

// So many bands go through the matrix together: it is reading this that takes time.
constexpr Eigen::Index bands_at_once = 4;
using BandRow = Eigen::Array<double, 1, bands_at_once>;
using BandBlock = Eigen::Array<double, Eigen::Dynamic, bands_at_once, Eigen::RowMajor>;
using SingleBandBlock = Eigen::Array<float, Eigen::Dynamic, bands_at_once, Eigen::RowMajor>;

// Eigen's factors, which it keeps to itself (3.4: m_lu has L before the diagonal of each row, and U from there on).
class Ilut : public Eigen::IncompleteLUT<float> {
 public:
  using Eigen::IncompleteLUT<float>::IncompleteLUT;
  const Eigen::SparseMatrix<float, Eigen::RowMajor>& factors() const { return m_lu; }
  // Row k of the factors is that of this one.
  int row(int k) const { return m_P.indices()[k]; }
};

// F x
BandBlock arriving_of(const SparseRows& form_factors, const BandBlock& x) {
  BandBlock sums(x.rows(), bands_at_once);
  for (Eigen::Index row = 0; row < form_factors.rows(); ++row) {
    BandRow sum = BandRow::Zero();
    for (SparseRows::InnerIterator entry(form_factors, row); entry; ++entry) sum += entry.value() * x.row(entry.col());
    sums.row(row) = sum;
  }
  return sums;
}

// U^-1 L^-1 x, in single precision: what is dropped changes more than that. Scaled, so that no band gets lost in it.
BandBlock by_factors(const IncompleteFactors& by, const BandBlock& x) {
  using Row = Eigen::SparseMatrix<float, Eigen::RowMajor>::InnerIterator;
  const auto size = static_cast<Eigen::Index>(by.order.size());
  const BandRow scale = x.abs().colwise().maxCoeff().max(std::numeric_limits<double>::min());
  const BandRow inverse = scale.inverse();
  SingleBandBlock y(size, bands_at_once);
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Array<float, 1, bands_at_once> sum = (x.row(by.order[static_cast<std::size_t>(k)]) * inverse).cast<float>();
    for (Row entry(by.factors, k); entry && entry.col() < k; ++entry) sum -= entry.value() * y.row(entry.col());
    y.row(k) = sum;
  }
  BandBlock found(size, bands_at_once);
  for (Eigen::Index k = size - 1; k >= 0; --k) {
    Eigen::Array<float, 1, bands_at_once> sum = y.row(k);
    float diagonal = 1;
    for (Row entry(by.factors, k); entry; ++entry) {
      if (entry.col() == k) diagonal = entry.value();
      if (entry.col() > k) sum -= entry.value() * y.row(entry.col());
    }
    y.row(k) = sum / diagonal;
    found.row(by.order[static_cast<std::size_t>(k)]) = y.row(k).cast<double>() * scale;
  }
  return found;
}

// sum_i x_i y_i per band.
BandRow sum_of_products(const BandBlock& x, const BandBlock& y) { return (x * y).colwise().sum(); }

// a / b, 0 where b is 0: a band that is solved stays as it is.
BandRow ratio_or_zero(const BandRow& a, const BandRow& b) { return (b != 0).select(a / b, 0.0); }

BandBlock times_each(const BandBlock& x, const BandRow& factors) { return x.rowwise() * factors; }

// An iterate of up to four bands, each of which goes on until its own residual is small enough.
struct BandIterate {
  BandBlock found;
  BandBlock residual;
  BandBlock shadow;
  BandBlock direction;
  BandBlock moved;  // the system applied to it, preconditioned
  BandRow rho = BandRow::Ones();
  BandRow alpha = BandRow::Ones();
  BandRow omega = BandRow::Ones();
};

// The next direction. Where the residual has come to be at right angles to its shadow, but for rounding, the search
// begins anew.
void turn(BandIterate& at) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  BandRow rho = sum_of_products(at.shadow, at.residual);
  BandRow beta = ratio_or_zero(rho, at.rho) * ratio_or_zero(at.alpha, at.omega);
  const BandRow least = epsilon * epsilon * sum_of_products(at.shadow, at.shadow);
  for (Eigen::Index band = 0; band < bands_at_once; ++band) {
    if (!(std::abs(rho[band]) < least[band])) continue;
    at.shadow.col(band) = at.residual.col(band);
    rho[band] = at.residual.col(band).square().sum();
    beta[band] = 0;
  }
  at.rho = rho;
  at.direction = at.residual + times_each(at.direction - times_each(at.moved, at.omega), beta);
}

// Up to four bands by BiCGSTAB, preconditioned. Bands that are solved take steps of length 0.
BandBlock iterated(const Pocket& pocket, const BandBlock& reflectance, const BandBlock& right, double tolerance) {
  constexpr int most_iterations = 200;
  const auto apply = [&](const BandBlock& x) -> BandBlock {
    return x - arriving_of(pocket.form_factors, reflectance * x);
  };
  const BandRow enough = tolerance * tolerance * sum_of_products(right, right);
  const BandBlock zero = BandBlock::Zero(right.rows(), bands_at_once);
  BandIterate at{.found = zero, .residual = right, .shadow = right, .direction = zero, .moved = zero};
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const BandRow goes_on = (sum_of_products(at.residual, at.residual) > enough).cast<double>();
    if (!(goes_on > 0).any()) break;
    turn(at);
    const BandBlock toward = by_factors(pocket.nearly_solved, at.direction);
    at.moved = apply(toward);
    at.alpha = goes_on * ratio_or_zero(at.rho, sum_of_products(at.shadow, at.moved));
    at.residual -= times_each(at.moved, at.alpha);
    const BandBlock rest = by_factors(pocket.nearly_solved, at.residual);
    const BandBlock moved = apply(rest);
    at.omega = goes_on * ratio_or_zero(sum_of_products(moved, at.residual), sum_of_products(moved, moved));
    at.found += times_each(toward, at.alpha) + times_each(rest, at.omega);
    at.residual -= times_each(moved, at.omega);
  }
  return at.found;
}

}  // namespace

PocketSystem system_within(const SparseRows& form_factors, const FieldView& reflectance) {
  PocketSystem system{.reflectance = reflectance, .factors = {}};
  const Eigen::Index size = form_factors.rows();
  if (size > few_patches) return system;
  for (Eigen::Index band = 0; band < reflectance.cols(); ++band)
    system.factors.emplace_back(Eigen::MatrixXd::Identity(size, size) -
                                form_factors * reflectance.col(band).matrix().asDiagonal());
  return system;
}

IncompleteFactors incomplete_factors(const SparseRows& form_factors, const Eigen::VectorXd& reflectance) {
  SparseRows one(form_factors.rows(), form_factors.cols());
  one.setIdentity();
  Ilut ilut;
  ilut.setDroptol(dropped_share);
  ilut.setFillfactor(size_of_factors);
  const Eigen::SparseMatrix<float, Eigen::RowMajor> matrix =
      SparseRows(one - form_factors * reflectance.asDiagonal()).cast<float>();
  ilut.compute(matrix);
  IncompleteFactors found{ilut.factors(), {}};
  for (int k = 0; k < static_cast<int>(matrix.rows()); ++k) found.order.push_back(ilut.row(k));
  return found;
}

Field arriving_within(const Pocket& pocket, const Field& radiosity) {
  using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Dense arriving = pocket.form_factors * radiosity.matrix();
  return arriving.array();
}

Field residual_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, const FieldView& x) {
  return right - x + arriving_within(pocket, system.reflectance * x);
}

Field solution_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, double tolerance) {
  assert(right.cols() == system.reflectance.cols());
  Field found(right.rows(), right.cols());
  if (system.is_eliminated()) {
    for (Eigen::Index band = 0; band < right.cols(); ++band)
      found.col(band) = system.factors[static_cast<std::size_t>(band)].solve(right.col(band).matrix()).array();
    return found;
  }
  for (Eigen::Index first = 0; first < right.cols(); first += bands_at_once) {
    const Eigen::Index bands = std::min(bands_at_once, right.cols() - first);
    const auto block_of = [&](const FieldView& field) {
      BandBlock block = BandBlock::Zero(field.rows(), bands_at_once);
      block.leftCols(bands) = field.middleCols(first, bands);
      return block;
    };
    found.middleCols(first, bands) =
        iterated(pocket, block_of(system.reflectance), block_of(right), tolerance).leftCols(bands);
  }
  return found;
}

}  // namespace patchlight
