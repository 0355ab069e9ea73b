#include "patchlight/transport/closure.h"

#include "patchlight/base/error.h"
#include "patchlight/base/parallel.h"

#include "transport/narrow.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

// Relative standard error of an entry, for weighing entries against a measured lost share. docs/theory.md section 6.
constexpr double entry_error = 0.02;

// Row sums of a closed scene are met to this share of the area; narrowing to float then loses more than that.
constexpr double row_tolerance = 1e-10;
constexpr int max_iterations = 2000;

Field column(const Eigen::VectorXd& x) { return x.array(); }

void report(const Observer& observer, double fraction) {
  if (observer && !observer({.stage = Stage::closure, .fraction = fraction})) throw Cancelled();
}

// What the rows should sum up to, and how well that is known.
struct Target {
  Eigen::VectorXd sum;       // a_i = A_i (1 - lost_i), m^2
  Eigen::VectorXd variance;  // of a_i, m^4
};

Target target_of(const Eigen::VectorXd& area, const LostShare& lost) {
  if (lost.closed()) return {area, Eigen::VectorXd::Zero(area.size())};
  const Eigen::ArrayXd share = (lost.escaped + lost.at_backs).array();
  // Binomial variance; half a ray is added so that a share of 0 or 1 is not taken for certain.
  const double n = lost.rays_per_patch;
  const Eigen::ArrayXd p = (n * share + 0.5) / (n + 1);
  return {area.array() * (1 - share), area.array().square() * p * (1 - p) / n};
}

// Solves (W + diag(W 1) + diag(s^2)) lambda = a - S 1 with W_ij = (entry_error S_ij)^2 by conjugate gradients with
// diagonal preconditioning. Rows without entries keep lambda = 0. Nothing if the sums cannot be met.
std::optional<Eigen::VectorXd> row_multipliers(const ExchangeAreas& S, const Eigen::VectorXd& defect,
                                               const Target& target, const Eigen::VectorXd& area,
                                               const Observer& observer) {
  const double w = entry_error * entry_error;
  const Eigen::Index n = defect.size();
  const Eigen::VectorXd weight_sum = w * multiply(S, Field::Ones(n, 1), 2).matrix();
  const Eigen::VectorXd diagonal = weight_sum + target.variance;
  const Eigen::ArrayXd active = (weight_sum.array() > 0).cast<double>();
  const Eigen::ArrayXd inverse = (weight_sum.array() > 0).select(diagonal.array().inverse(), 0.0);
  const auto apply = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return w * multiply(S, column(x), 2).matrix() + diagonal.cwiseProduct(x);
  };

  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd r = (defect.array() * active).matrix();
  Eigen::VectorXd z = (r.array() * inverse).matrix();
  Eigen::VectorXd p = z;
  double rz = r.dot(z);
  for (int k = 0; k < max_iterations; ++k) {
    if ((r.array().abs() <= row_tolerance * area.array()).all()) return lambda;
    report(observer, 0);
    const Eigen::VectorXd q = apply(p);
    const double step = rz / p.dot(q);
    if (!std::isfinite(step)) return std::nullopt;
    lambda += step * p;
    r -= step * q;
    z = (r.array() * inverse).matrix();
    const double rz_next = r.dot(z);
    p = z + rz_next / rz * p;
    rz = rz_next;
  }
  return std::nullopt;
}

// Every entry S_ij replaced by value(i, j, S_ij), narrowed toward zero.
using Change = std::function<double(PatchIndex, PatchIndex, double)>;

ExchangeAreas changed(ExchangeAreas S, const Change& value) {
  const PatchIndex blocks = S.blocks();
  parallel_for(blocks, [&](std::size_t row) {
    const auto I = static_cast<PatchIndex>(row);
    for (PatchIndex J = I; J < blocks; ++J) {
      const std::span<float> tile = S.tile(I, J);
      for (PatchIndex k = 0; k < edge * edge; ++k) {
        if (tile[k] == 0) continue;
        tile[k] = narrow_toward_zero(value(I * edge + k / edge, J * edge + k % edge, static_cast<double>(tile[k])));
      }
    }
  });
  return S;
}

// Does S_ij + w S_ij^2 (lambda_i + lambda_j) stay above 0 for every entry?
bool stays_positive(const ExchangeAreas& S, const Eigen::VectorXd& lambda, double w) {
  const PatchIndex size = S.size();
  std::vector<std::uint8_t> positive(S.blocks(), 1);
  parallel_for(S.blocks(), [&](std::size_t row) {
    const auto I = static_cast<PatchIndex>(row);
    for (PatchIndex J = I; J < S.blocks(); ++J) {
      const std::span<const float> tile = S.tile(I, J);
      for (PatchIndex i = I * edge; i < std::min(size, (I + 1) * edge); ++i) {
        for (PatchIndex j = J * edge; j < std::min(size, (J + 1) * edge); ++j) {
          const double entry = tile[static_cast<std::size_t>(i % edge) * edge + j % edge];
          if (1 + w * entry * (lambda[i] + lambda[j]) < 0) positive[row] = 0;
        }
      }
    }
  });
  return std::all_of(positive.begin(), positive.end(), [](std::uint8_t p) { return p != 0; });
}

// Symmetric Sinkhorn scaling D S D with row sums a. Nothing if it does not settle.
std::optional<Eigen::VectorXd> row_scales(const ExchangeAreas& S, const Eigen::VectorXd& target,
                                          const Observer& observer) {
  Eigen::ArrayXd d = Eigen::ArrayXd::Ones(target.size());
  for (int k = 0; k < max_iterations; ++k) {
    report(observer, 0);
    const Eigen::ArrayXd sums = d * multiply(S, column(d.matrix())).col(0);
    const Eigen::ArrayXd ratio = (sums > 0).select(target.array() / sums, 1.0);
    if (((ratio - 1).abs() <= row_tolerance).all()) return d.matrix();
    d *= ratio.sqrt();
  }
  return std::nullopt;
}

// No patch sees more than its hemisphere: rows that add up to far more than their area are cut down to it, by the
// smaller of both patches' factors, which keeps the matrix symmetric. Without this, light could grow from bounce to
// bounce. Rows that exceed it by less stay, as noise raises as many as it lowers: cutting these alone would take light
// away.
ClosedExchangeAreas limited(ExchangeAreas raw, const Eigen::VectorXd& area, const Eigen::VectorXd& sums) {
  constexpr double gross_excess = 1.1;
  const Eigen::VectorXd factor =
      (sums.array() > gross_excess * area.array()).select(area.array() / sums.array(), 1.0).matrix();
  ExchangeAreas S = changed(
      std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) { return entry * std::min(factor[i], factor[j]); });
  return {std::move(S), Eigen::VectorXd::Zero(area.size()),
          "rows above 1.1 cut to 1: open scene, and the least change has negative entries"};
}

}  // namespace

ClosedExchangeAreas keep_exchange_areas(ExchangeAreas raw, const std::string& reason) {
  const Eigen::Index n = raw.size();
  return {std::move(raw), Eigen::VectorXd::Zero(n), "none: " + reason};
}

ClosedExchangeAreas close_exchange_areas(ExchangeAreas raw, const Eigen::VectorXd& area, const LostShare& lost,
                                         const Observer& observer) {
  const Target target = target_of(area, lost);
  const Eigen::VectorXd raw_sums = row_sums(raw);
  const double w = entry_error * entry_error;

  // 1. The least change: S_ij += W_ij (lambda_i + lambda_j).
  const auto lambda = row_multipliers(raw, target.sum - raw_sums, target, area, observer);
  if (!lambda)
    return keep_exchange_areas(std::move(raw),
                               "no symmetric exchange areas with this pattern have the wanted row sums");
  const Eigen::VectorXd change = w * (lambda->cwiseProduct(multiply(raw, Field::Ones(area.size(), 1), 2).matrix()) +
                                      multiply(raw, column(*lambda), 2).matrix());
  if (stays_positive(raw, *lambda, w)) {
    ExchangeAreas closed = changed(std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) {
      return entry + w * entry * entry * ((*lambda)[i] + (*lambda)[j]);
    });
    const Eigen::VectorXd remainder = (raw_sums + change - row_sums(closed)).cwiseMax(0.0);
    return {std::move(closed), remainder, lost.closed() ? "least squares" : "least squares, open scene"};
  }

  // 2. Scaling keeps every entry positive, but needs exact targets.
  if (!lost.closed()) return limited(std::move(raw), area, raw_sums);
  const auto scale = row_scales(raw, target.sum, observer);
  if (!scale) return keep_exchange_areas(std::move(raw), "no symmetric scaling has the wanted row sums");
  ExchangeAreas closed = changed(
      std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) { return (*scale)[i] * entry * (*scale)[j]; });
  const Eigen::VectorXd remainder = (target.sum - row_sums(closed)).cwiseMax(0.0);
  return {std::move(closed), remainder, "scaling"};
}

}  // namespace patchlight
