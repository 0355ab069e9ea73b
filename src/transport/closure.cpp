#include "transport/closure.h"

#include "patchlight/base/error.h"
#include "patchlight/transport/exchange.h"

#include "base/parallel.h"
#include "base/vectors.h"
#include "transport/random_errors.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace patchlight {

std::vector<RowDefect> worst_rows(const Eigen::VectorXd& row_sum, const LostShare& lost, const Eigen::VectorXd& area,
                                  std::size_t count) {
  if (row_sum.size() == 0) return {};
  assert(row_sum.size() == area.size() && row_sum.size() == lost.escaped.size());
  const Eigen::ArrayXd expected = expected_row_sum(lost);
  const Eigen::ArrayXd defect = area.array() * (row_sum.array() - expected).abs();

  std::vector<PatchIndex> order(static_cast<std::size_t>(row_sum.size()));
  std::iota(order.begin(), order.end(), PatchIndex{0});
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), end, order.end(),
                    [&](PatchIndex a, PatchIndex b) { return defect[a] != defect[b] ? defect[a] > defect[b] : a < b; });

  std::vector<RowDefect> worst;
  for (auto patch = order.begin(); patch != end; ++patch) {
    worst.push_back({*patch, row_sum[*patch], expected[*patch]});
  }
  return worst;
}

namespace {

// Relative standard error of an entry of which nothing is known, for weighing entries against a measured lost share.
// docs/theory/closure.md.
constexpr double entry_error = 0.02;

// Row sums of a closed scene are met to this share of the area; narrowing to float then loses more than that.
constexpr double row_tolerance = 1e-10;
constexpr int max_iterations = 2000;

Field column(const Eigen::VectorXd& x) { return x.array(); }

void report(const Observer& observer) {
  if (observer && !observer({.stage = Stage::closure, .fraction = 0})) throw Canceled();
}

// The sums that the rows should have, and how well they are known.
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

// The variances of the entries, W_ij = r_i r_j S_ij^2 with the relative errors r of the rows. The difference of a
// single pair is too noisy for its weight, and rays that agree by chance leave none.
class EntryWeights {
 public:
  EntryWeights(const ExchangeAreas& S, Eigen::VectorXd relative_errors) : S_(S), r_(std::move(relative_errors)) {}

  double at(PatchIndex i, PatchIndex j, double entry) const { return r_[i] * r_[j] * entry * entry; }
  Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    return r_.cwiseProduct(multiply(S_, column(r_.cwiseProduct(x)), 2).matrix());
  }

 private:
  const ExchangeAreas& S_;
  Eigen::VectorXd r_;
};

// r_i^2 = sum_j D_ij^2 / sum_j S_ij^2, or the same for all rows where the differences D do not count. Quadrature and
// rounding leave 1e-4 of entries that were found without shadow rays.
Eigen::VectorXd relative_errors(const ExchangeAreas& S, const LostShare& lost, const HalfDifferences& differences) {
  // In a closed scene only the ratios of the weights count, and far too different ones take many iterations. So do
  // those of many patches.
  if (differences.size() != S.size() || !weighs_by_errors(lost, S.size()))
    return Eigen::VectorXd::Constant(S.size(), entry_error);
  const Field ones = Field::Ones(S.size(), 1);
  const Eigen::ArrayXd squares = multiply(S, ones, 2).col(0);
  const Eigen::ArrayXd variances = by_variances(differences, ones).col(0);
  return (squares > 0).select(variances / squares, 0.0).sqrt().max(1e-4).matrix();
}

// Solves (W + diag(W 1) + diag(s^2)) lambda = a - S 1 by conjugate gradients with diagonal preconditioning. Rows
// without entries keep lambda = 0. Nothing if the sums cannot be met.
std::optional<Eigen::VectorXd> row_multipliers(const EntryWeights& W, const Eigen::VectorXd& defect,
                                               const Target& target, const Eigen::VectorXd& area,
                                               const Observer& observer) {
  const Eigen::Index n = defect.size();
  const Eigen::VectorXd weight_sum = W.times(Eigen::VectorXd::Ones(n));
  const Eigen::VectorXd diagonal = weight_sum + target.variance;
  const Eigen::ArrayXd active = (weight_sum.array() > 0).cast<double>();
  const Eigen::ArrayXd inverse = (weight_sum.array() > 0).select(diagonal.array().inverse(), 0.0);
  const auto apply = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return W.times(x) + diagonal.cwiseProduct(x); };

  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n);
  ConjugateDirections<Eigen::VectorXd> method(
      (defect.array() * active).matrix(),
      [&](const Eigen::VectorXd& r) -> Eigen::VectorXd { return (r.array() * inverse).matrix(); });
  for (int k = 0; k < max_iterations; ++k) {
    if ((method.residual().array().abs() <= row_tolerance * area.array()).all()) return lambda;
    report(observer);
    const Eigen::VectorXd q = apply(method.direction());
    const double step = method.length(q);
    if (!std::isfinite(step)) return std::nullopt;
    lambda += step * method.direction();
    method.advance(q, step);
  }
  return std::nullopt;
}

// Does S_ij + W_ij (lambda_i + lambda_j) stay above 0 for every entry?
bool stays_positive(const ExchangeAreas& S, const Eigen::VectorXd& lambda, const EntryWeights& W) {
  std::vector<std::uint8_t> positive(entry_parts(S), 1);
  parallel_for(positive.size(), [&](std::size_t part) {
    for_entries(S, static_cast<PatchIndex>(part), [&](PatchIndex i, PatchIndex j, double entry) {
      if (entry + W.at(i, j, entry) * (lambda[i] + lambda[j]) < 0) positive[part] = 0;
    });
  });
  return std::all_of(positive.begin(), positive.end(), [](std::uint8_t p) { return p != 0; });
}

// Symmetric Sinkhorn scaling D S D with row sums a. Nothing if it does not settle.
std::optional<Eigen::VectorXd> row_scales(const ExchangeAreas& S, const Eigen::VectorXd& target,
                                          const Observer& observer) {
  Eigen::ArrayXd d = Eigen::ArrayXd::Ones(target.size());
  for (int k = 0; k < max_iterations; ++k) {
    report(observer);
    const Eigen::ArrayXd sums = d * multiply(S, column(d.matrix())).col(0);
    const Eigen::ArrayXd ratio = (sums > 0).select(target.array() / sums, 1.0);
    if (((ratio - 1).abs() <= row_tolerance).all()) return d.matrix();
    d *= ratio.sqrt();
  }
  return std::nullopt;
}

// No patch sees more than its hemisphere. A row sum above the area by more than three standard errors is an error of
// the sample, not noise: the row is scaled down to that limit. Entries take the smaller factor of their two rows, so
// that the matrix stays symmetric. Smaller excesses stay, because noise lowers as many rows as it raises: if only those
// above were cut, light would be lost. `variances` are those of the sums, m^4.
ClosedExchangeAreas limited(ExchangeAreas raw, const Eigen::VectorXd& area, const Eigen::VectorXd& variances) {
  const Eigen::ArrayXd sums = row_sums(raw).array();
  const Eigen::ArrayXd most = area.array() + 3 * variances.array().sqrt();
  const Eigen::VectorXd factor = (sums > most).select(most / sums, 1.0).matrix();
  ExchangeAreas S = changed(
      std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) { return entry * std::min(factor[i], factor[j]); });
  return {std::move(S), Eigen::VectorXd::Zero(area.size()),
          std::string(cut_row_sums) + ": open scene, and the least change has negative entries"};
}

}  // namespace

ClosedExchangeAreas close_exchange_areas(ExchangeAreas raw, const Eigen::VectorXd& area, const LostShare& lost,
                                         const HalfDifferences& differences, const Observer& observer) {
  const Target target = target_of(area, lost);
  const Eigen::VectorXd raw_sums = row_sums(raw);
  const EntryWeights W(raw, relative_errors(raw, lost, differences));

  // 1. The least change: S_ij += W_ij (lambda_i + lambda_j).
  const auto lambda = row_multipliers(W, target.sum - raw_sums, target, area, observer);
  if (!lambda)
    return keep_exchange_areas(std::move(raw),
                               "no symmetric exchange areas with this pattern have the expected row sums");
  const Eigen::VectorXd variances = W.times(Eigen::VectorXd::Ones(area.size()));
  const Eigen::VectorXd change = lambda->cwiseProduct(variances) + W.times(*lambda);
  if (stays_positive(raw, *lambda, W)) {
    ExchangeAreas closed = changed(std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) {
      return entry + W.at(i, j, entry) * ((*lambda)[i] + (*lambda)[j]);
    });
    const Eigen::VectorXd remainder = (raw_sums + change - row_sums(closed)).cwiseMax(0.0);
    return {std::move(closed), remainder, lost.closed() ? "least squares" : "least squares, open scene"};
  }

  // 2. Scaling keeps every entry positive, but needs exact targets.
  if (!lost.closed()) return limited(std::move(raw), area, variances);
  const auto scale = row_scales(raw, target.sum, observer);
  if (!scale) return keep_exchange_areas(std::move(raw), "no symmetric scaling has the expected row sums");
  ExchangeAreas closed = changed(
      std::move(raw), [&](PatchIndex i, PatchIndex j, double entry) { return (*scale)[i] * entry * (*scale)[j]; });
  const Eigen::VectorXd remainder = (target.sum - row_sums(closed)).cwiseMax(0.0);
  return {std::move(closed), remainder, "scaling"};
}

ClosedExchangeAreas keep_exchange_areas(ExchangeAreas raw, const std::string& reason) {
  const Eigen::Index n = raw.size();
  return {std::move(raw), Eigen::VectorXd::Zero(n), "none: " + reason};
}

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
  // The loss by narrowing, and the exchange of the patches of a parent among themselves.
  const Field rows = summed_by_parent(mesh, (row_sums(S) + closed.remainder).array());
  Eigen::VectorXd remainder = rows.col(0).matrix() - row_sums(sums);
  return {std::move(sums), std::move(remainder), closed.method};
}

Eigen::VectorXd effects_of_parts(const ExchangeAreas& S, const NestedMesh& mesh, const FieldView& difference,
                                 const FieldView& weight) {
  const PatchIndex count = mesh.parents.size();
  if (difference.isZero(0)) return Eigen::VectorXd::Zero(count);
  const Effects effects{S, difference, weight};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(count);
  return sum_over_stripes(count, 16, zero, [&](PatchIndex G, Eigen::VectorXd& sum) {
    const PatchRange g = mesh.patches_of(G);
    for (PatchIndex H = 0; H < G; ++H) {
      const PatchRange h = mesh.patches_of(H);
      sum[G] += effects.of(g, h);
      sum[H] += effects.of(h, g);
    }
  });
}

Exchange trace_exchange(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                        const Observer& observer) {
  LostShare lost = measure_lost_share(mesh, occluder, options.lost_share_rays, options.seed, observer);
  AssemblyOptions keeping = options;
  const bool weighs = weighs_by_errors(lost, mesh.size()) && options.estimator == Estimator::automatic;
  keeping.keep_errors = options.keep_errors || weighs;
  return exchange_of(assemble_exchange_areas(mesh, occluder, keeping, observer), mesh, std::move(lost));
}

Exchange exchange_of(Assembly raw, const PatchMesh& mesh, LostShare lost) {
  const Eigen::VectorXd seen = row_sums(raw.exchange_areas);
  const Eigen::VectorXd area = exposed_area(mesh, lost, seen);
  return {std::move(raw.exchange_areas),   area, seen.cwiseQuotient(area), std::move(lost), raw.counts,
          std::move(raw.half_differences), {}};
}

Exchange exchange_on_demand(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer) {
  LostShare lost = measure_lost_share(mesh, occluder, options.lost_share_rays, options.seed, observer);
  const Eigen::VectorXd area = exposed_area(mesh, lost, Eigen::VectorXd::Zero(mesh.size()));
  return {ExchangeAreas(0), area, {}, std::move(lost), {}, {}, "none: rows on demand"};
}

// Rows of more entries are known so much better than the lost share that hardly anything is moved, whatever the
// weights.
bool weighs_by_errors(const LostShare& lost, PatchIndex patches) { return !lost.closed() && patches <= 4096; }

ClosedExchangeAreas close_exchange(Exchange exchange, const Observer& observer) {
  const Eigen::Index n = exchange.area.size();
  if (!exchange.closure.empty() && !exchange.lost.closed()) {
    return {std::move(exchange.exchange_areas), Eigen::VectorXd::Zero(n), exchange.closure};
  }
  if (!exchange.closure.empty()) {
    const Eigen::VectorXd missing = exchange.area - row_sums(exchange.exchange_areas);
    // Entries of a closed row are narrowed toward zero (2^-23 of each), stored as the nearest floats F_ij (2^-24) and
    // narrowed once more when they are read (2^-23).
    if ((missing.array().abs() <= 5 * 0x1p-24 * exchange.area.array()).all())
      return {std::move(exchange.exchange_areas), missing, exchange.closure};
  }
  return close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost,
                              exchange.half_differences, observer);
}

}  // namespace patchlight
