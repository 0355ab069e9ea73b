#include "accuracy/errors.h"

#include "patchlight/solve/solve.h"

#include "accuracy/refinement.h"
#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "base/vectors.h"
#include "form_factor/patch_shape.h"
#include "mesh/interpolate.h"
#include "transport/random_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// Up to this number of bands are solved as they are.
constexpr Eigen::Index few_bands = 3;

// x_a . x_b of bands that have norm 1, or 0 where all is 0.
Eigen::MatrixXd cosines_between(const FieldView& field, const Eigen::VectorXd& area, Eigen::VectorXd& norm) {
  const Eigen::MatrixXd weighed = (field.colwise() * area.array().sqrt()).matrix();
  norm = weighed.colwise().norm();
  const Eigen::VectorXd inverse = (norm.array() > 0).select(norm.array().inverse(), 0.0);
  return inverse.asDiagonal() * (weighed.transpose() * weighed) * inverse.asDiagonal();
}

// Pivoted Cholesky decomposition: picks the band with the largest residual until every residual is below `tolerance`.
std::vector<Eigen::Index> pivots(const Eigen::MatrixXd& G, double tolerance) {
  Eigen::VectorXd left = G.diagonal();  // squares of the residuals
  Eigen::MatrixXd L(G.rows(), 0);
  std::vector<Eigen::Index> chosen;
  Eigen::Index next = 0;
  while (left.maxCoeff(&next) > tolerance * tolerance) {
    const Eigen::VectorXd column = (G.col(next) - L * L.row(next).transpose()) / std::sqrt(left[next]);
    L.conservativeResize(Eigen::NoChange, L.cols() + 1);
    L.rightCols(1) = column;
    left -= column.cwiseAbs2();
    left[next] = 0;
    chosen.push_back(next);
  }
  return chosen;
}

SpanningBands each_its_own(Eigen::Index bands) {
  SpanningBands spanning;
  for (Eigen::Index band = 0; band < bands; ++band) spanning.bands.push_back(band);
  spanning.weights = Eigen::MatrixXd::Identity(bands, bands);
  return spanning;
}

}  // namespace

Field SpanningBands::of(const FieldView& field) const { return field(Eigen::all, bands); }

Field SpanningBands::all_bands(const FieldView& in_bands) const {
  assert(in_bands.cols() == weights.rows());
  return spans_all() ? Field(in_bands) : Field(in_bands.matrix() * weights);
}

SpanningBands spanning_bands(const FieldView& field, const Eigen::VectorXd& area, double tolerance) {
  if (field.cols() <= few_bands) return each_its_own(field.cols());
  // 1. Which.
  SpanningBands spanning;
  Eigen::VectorXd norm;
  const Eigen::MatrixXd G = cosines_between(field, area, norm);
  spanning.bands = pivots(G, tolerance);
  if (spanning.bands.size() == static_cast<std::size_t>(field.cols())) return each_its_own(field.cols());

  // 2. The combinations nearest to the others, by their normal equations.
  const Eigen::MatrixXd with_all = G(spanning.bands, Eigen::all);
  const Eigen::MatrixXd of_chosen = with_all(Eigen::all, spanning.bands);
  spanning.weights = of_chosen.llt().solve(with_all) * norm.asDiagonal();
  for (Eigen::Index k = 0; k < spanning.weights.rows(); ++k)
    spanning.weights.row(k) /= norm[spanning.bands[static_cast<std::size_t>(k)]];
  return spanning;
}

InNeededBands in_needed_bands(const SolvedProblem& solved) {
  const RadiosityProblem& problem = solved.problem;
  SolvedBands bands =
      solved_bands({problem.scattering, source_radiosity(problem), problem.area, problem.direct_irradiance});
  RadiosityProblem needed{of_bands(problem.scattering, bands.solved), reduced(problem.exitance, bands), problem.area,
                          reduced(problem.direct_irradiance, bands)};
  Solution solution;
  solution.radiosity = reduced(solved.solution.radiosity, bands);
  solution.irradiance = reduced(solved.solution.irradiance, bands);
  return {std::move(bands), std::move(needed), std::move(solution)};
}

Field mesh_errors(const NestedMesh& mesh, const RowTransport& transport, const SolvedProblem& solved,
                  const FieldView& radiosity_of_parents) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const Field difference = solved.solution.radiosity - of_parents(mesh, radiosity_of_parents);
  const Field error = scale * transport.apply(difference).abs();
  return error.max(means_around(mesh.patches, solved.problem.area, error));
}

Field display_errors(const NestedMesh& mesh, const SolvedProblem& solved) {
  const Field& H = solved.solution.irradiance;
  const Eigen::VectorXd& area = solved.problem.area;
  const Field differences = H - of_parents(mesh, means_by_parent(mesh, H, area));
  const Field of_parts = means_by_parent(mesh, differences.square(), area).sqrt() / std::sqrt(3.0);
  const Eigen::VectorXd of_parent = summed_by_parent(mesh, area.array()).col(0).matrix();
  return of_parents(mesh, means_around(mesh.parents, of_parent, of_parts));
}

namespace {

// A face opposite at this share of a patch's edge takes `allowed` of its hemisphere.
constexpr double near = 0.6;
constexpr double allowed = 0.35;

// True when patch j is nearer to patch i than this share of its edge and looks back at it.
bool is_near(const PatchMesh& mesh, PatchIndex i, PatchIndex j, double within) {
  if (mesh.normal[i].dot(mesh.normal[j]) > -0.5) return false;
  const double distance = (mesh.centroid[i] - mesh.centroid[j]).dot(mesh.normal[j]);
  return distance >= 0 && distance < within * std::sqrt(mesh.area[i]);
}

// The sources of a patch: the share of its hemisphere with near faces that look back, and the range of radiosities.
class SeenSources {
 public:
  SeenSources(const PatchMesh& mesh, const Field& radiosity, double within)
      : mesh_(mesh),
        radiosity_(radiosity),
        within_(within),
        least_(Spectrum::Constant(radiosity.cols(), std::numeric_limits<double>::infinity())),
        largest_(Spectrum::Zero(radiosity.cols())) {}

  void add(PatchIndex i, PatchIndex j, double form_factor) {
    if (!(form_factor > 0)) return;
    sum_ += form_factor;
    if (is_near(mesh_, i, j, within_)) near_ += form_factor;
    least_ = least_.min(radiosity_.row(j));
    largest_ = largest_.max(radiosity_.row(j));
  }
  // The rest of the hemisphere is dark. Row sums are 1 in closed rooms, except for single-precision rounding and leaks.
  Spectrum range() const { return sum_ < 1 - 1e-3 ? largest_ : Spectrum(largest_ - least_); }
  double near_share() const { return near_; }

 private:
  const PatchMesh& mesh_;
  const Field& radiosity_;
  double within_;
  double sum_ = 0, near_ = 0;
  Spectrum least_, largest_;
};

void add_row(SeenSources& seen, const RayRows& rows, PatchIndex i, double weight) {
  for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k)
    seen.add(i, rows.hits[k], weight * rows.hit_weight[i]);
  for (const RayEntry& entry : rows.entries_of(i))
    seen.add(i, entry.patch, weight * static_cast<double>(entry.form_factor));
}

// Half of the wrong light of a patch in a gap, as measured in ten rooms, times the share of near faces beyond that of
// one face. Sources of equal radiosity cause no error, wherever their light comes from. So the error is limited by the
// range of radiosities and the direct light.
template <typename AddSources>
Field errors_in_gaps(const PatchMesh& mesh, const SolvedProblem& solved, double within, const AddSources& add_sources) {
  const Field& H = solved.solution.irradiance;
  const Field& direct = solved.problem.direct_irradiance;
  Field errors(H.rows(), H.cols());
  parallel_for(mesh.size(), [&](std::size_t row) {
    const auto i = static_cast<PatchIndex>(row);
    SeenSources seen(mesh, solved.solution.radiosity, within);
    add_sources(seen, i);
    const double share = std::clamp((seen.near_share() - allowed) / (1 - allowed), 0.0, 1.0);
    Spectrum uneven = seen.range();
    if (direct.size() > 0) uneven += direct.row(i);
    errors.row(i) = 0.5 * share * uneven.min(H.row(i));
  });
  return errors;
}

}  // namespace

Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved) {
  return errors_in_gaps(mesh, solved, near, [&](SeenSources& seen, PatchIndex i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j)
      seen.add(i, j, static_cast<double>(S.at(std::min(i, j), std::max(i, j))) / solved.problem.area[i]);
  });
}

Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved, int cuts) {
  return errors_in_gaps(mesh, solved, std::ldexp(near, -cuts), [&](SeenSources& seen, PatchIndex i) {
    for (const std::size_t half : {0U, 1U}) add_row(seen, transport.rows(half), i, 0.5);
  });
}

namespace {

// The largest error of a propagated error, as a share of its reflected part.
constexpr double bar_tolerance = 0.05;

// The largest residual, relative to the first, for a transport that is not reciprocal.
constexpr double residual_tolerance = 0.02;

// The share that solved bands leave out of those that they span: the others are combined, and checked.
constexpr double left_out = 0.3;

// Several irradiances are followed together, unless they are larger than 16 MB: one pass over the rows serves them all.
// The solver holds about a dozen fields of that size.
constexpr Eigen::Index values_at_once = 1 << 21;

Solution solution_of(const TransportOperator& transport, const RadiosityProblem& problem,
                     std::optional<double> largest_row_sum) {
  // Only a reciprocal transport has a bound that is cheap to find. The residual of others is relative to the first one,
  // the light that one reflection adds: its noise is less than that of the source, so that light which is even over a
  // room stands out.
  const bool has_bound = transport.is_reciprocal();
  if (!has_bound) largest_row_sum = std::numeric_limits<double>::infinity();
  // Few directions: by a million patches these take most of the memory.
  return solve(transport, problem,
               {.solver = usual_solver(transport, problem),
                .relative_error = has_bound ? bar_tolerance : residual_tolerance,
                .restart = 8,
                .largest_row_sum = largest_row_sum,
                .patch_bounds = false});
}

RadiosityProblem in_bands(const RadiosityProblem& problem, const std::vector<Eigen::Index>& bands) {
  return {of_bands(problem.scattering, bands), problem.exitance(Eigen::all, bands), problem.area};
}

// Solutions y in some bands, with F y: others may be combinations of these.
struct KnownBands {
  Field radiosity;
  Field irradiance;
};

Field side_by_side(const Field& one, const Field& other) {
  Field both(other.rows(), one.cols() + other.cols());
  both << one, other;
  return both;
}

// The combination of known solutions with the least residual in a band, ||r||_A.
struct Combination {
  Eigen::ArrayXd irradiance;  // F y
  Eigen::ArrayXd residual;    // r = E + R F y - y
  bool is_good;               // by the bound ||r||_A / (1 - kappa)
};

Combination combined(const KnownBands& known, const RadiosityProblem& of_band, double kappa) {
  const Eigen::ArrayXd root = of_band.area.array().sqrt();
  const std::vector<Eigen::Index> repeated(static_cast<std::size_t>(known.radiosity.cols()), 0);
  const Field reflected = of_bands(of_band.scattering, repeated).reflect(known.irradiance);
  const Eigen::MatrixXd left = ((known.radiosity - reflected).colwise() * root).matrix();
  const Eigen::VectorXd right = (of_band.exitance.col(0) * root).matrix();
  const Eigen::VectorXd c = (left.transpose() * left).ldlt().solve(left.transpose() * right);
  const Eigen::VectorXd residual = right - left * c;
  const double added = ((known.radiosity.matrix() * c).array() * root - right.array()).matrix().norm();
  return {(known.irradiance.matrix() * c).array(), residual.array() / root,
          residual.norm() / (1 - kappa) <= bar_tolerance * added};
}

// Light y = E + R F y in many bands, of which few are solved.
class InBands {
 public:
  InBands(const TransportOperator& transport, const RadiosityProblem& problem, double largest_row_sum)
      : transport_(transport),
        problem_(problem),
        row_sum_(largest_row_sum),
        kappa_(problem.scattering.norm_bound() * largest_row_sum),
        irradiance_(Field::Zero(problem.exitance.rows(), problem.exitance.cols())) {
    known_.radiosity = known_.irradiance = Field(problem.exitance.rows(), 0);
    for (Eigen::Index band = 0; band < problem.exitance.cols(); ++band) rest_.push_back(band);
  }

  // F y.
  Field irradiance();

 private:
  void solve_bands(std::vector<Eigen::Index> bands);
  Field combine_others();

  const TransportOperator& transport_;
  const RadiosityProblem& problem_;
  double row_sum_;
  Eigen::ArrayXd kappa_;
  KnownBands known_;
  Field irradiance_;
  std::vector<Eigen::Index> rest_;  // bands that are not found yet
};

void InBands::solve_bands(std::vector<Eigen::Index> bands) {
  const Field radiosity = solution_of(transport_, in_bands(problem_, bands), row_sum_).radiosity;
  const Field irradiance = transport_.apply(radiosity);
  for (std::size_t k = 0; k < bands.size(); ++k) {
    irradiance_.col(bands[k]) = irradiance.col(static_cast<Eigen::Index>(k));
    std::erase(rest_, bands[k]);
  }
  known_ = {side_by_side(known_.radiosity, radiosity), side_by_side(known_.irradiance, irradiance)};
}

// Combines known solutions where they reach the tolerance; returns the residuals of the other bands.
Field InBands::combine_others() {
  Field residuals(problem_.exitance.rows(), static_cast<Eigen::Index>(rest_.size()));
  std::vector<std::uint8_t> found(rest_.size());
  parallel_for(rest_.size(), [&](std::size_t k) {
    const Combination of_band = combined(known_, in_bands(problem_, {rest_[k]}), kappa_[rest_[k]]);
    found[k] = of_band.is_good ? 1 : 0;
    if (of_band.is_good) irradiance_.col(rest_[k]) = of_band.irradiance;
    residuals.col(static_cast<Eigen::Index>(k)) = of_band.residual;
  });
  std::vector<Eigen::Index> left;
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] != 0) continue;
    left.push_back(rest_[k]);
    columns.push_back(static_cast<Eigen::Index>(k));
  }
  rest_ = std::move(left);
  return residuals(Eigen::all, columns);
}

// Solve the bands that span the sources first, then bands that span the residuals of the others.
Field InBands::irradiance() {
  Field missing = problem_.exitance;
  while (!rest_.empty()) {
    std::vector<Eigen::Index> next;
    const SpanningBands spanning = spanning_bands(missing, problem_.area, left_out);
    // When half of the bands are solved so may be the rest.
    if (2 * (known_.radiosity.cols() + spanning.weights.rows()) <= irradiance_.cols())
      for (const Eigen::Index k : spanning.bands) next.push_back(rest_[static_cast<std::size_t>(k)]);
    solve_bands(next.empty() ? rest_ : next);
    missing = combine_others();
  }
  return std::move(irradiance_);
}

}  // namespace

Field followed(const TransportOperator& transport, const RadiosityProblem& problem, const Field& irradiance) {
  const RadiosityProblem of_irradiance{problem.scattering, problem.scattering.reflect(irradiance), problem.area};
  const auto directly = [&]() -> Field {
    return irradiance + solution_of(transport, of_irradiance, std::nullopt).irradiance;
  };
  if (irradiance.cols() <= few_bands || !transport.is_reciprocal()) return directly();
  // Independent draws are no combinations of each other.
  const Eigen::Index spanning = spanning_bands(of_irradiance.exitance, problem.area, left_out).weights.rows();
  if (2 * spanning > irradiance.cols()) return directly();
  const double row_sum = highest(transport.apply(Field::Ones(irradiance.rows(), 1)))[0];
  if (!(problem.scattering.norm_bound().maxCoeff() * row_sum < 1)) return directly();
  return irradiance + InBands(transport, of_irradiance, row_sum).irradiance();
}

std::vector<Field> followed(const TransportOperator& transport, const RadiosityProblem& problem,
                            std::vector<Field> irradiances) {
  if (irradiances.empty()) return {};
  const Eigen::Index bands = irradiances.front().cols();
  const Eigen::Index size = std::max<Eigen::Index>(1, irradiances.front().size());
  const auto at_once = static_cast<std::size_t>(std::max<Eigen::Index>(1, values_at_once / size));
  // Many bands are combinations of a few of them.
  const std::size_t most = bands > few_bands ? 1 : at_once;
  for (std::size_t first = 0; first < irradiances.size(); first += most) {
    const std::span<Field> some = std::span(irradiances).subspan(first, std::min(most, irradiances.size() - first));
    Field together(irradiances.front().rows(), static_cast<Eigen::Index>(some.size()) * bands);
    std::vector<Eigen::Index> band_of_column;
    for (std::size_t k = 0; k < some.size(); ++k) {
      together.middleCols(static_cast<Eigen::Index>(k) * bands, bands) = some[k];
      for (Eigen::Index band = 0; band < bands; ++band) band_of_column.push_back(band);
    }
    const Field of_some =
        followed(transport, {of_bands(problem.scattering, band_of_column), {}, problem.area}, together);
    for (std::size_t k = 0; k < some.size(); ++k)
      some[k] = of_some.middleCols(static_cast<Eigen::Index>(k) * bands, bands);
  }
  return irradiances;
}

namespace {

// Draws of the errors: a root mean square over eight is right to 25 %.
constexpr int draws = 8;
constexpr std::uint64_t seed = 1;

// A closed matrix has had its rows corrected by S_ij (lambda_i + lambda_j): the same for the draws. Solves
// (S + 1.02 diag(S 1)) lambda = -D 1 for every draw, by conjugate gradients with the diagonal as preconditioner. Damped
// by 2 %, as the matrix is nearly singular where patches fall into two kinds that only see each other.
Field row_corrections(const RowTransport& transport, const Eigen::VectorXd& area, const Field& row_errors) {
  constexpr double tolerance = 1e-2;
  const Eigen::ArrayXd A = area.array();
  const Field row_sum = transport.apply(Field::Ones(area.size(), 1)).colwise() * A;
  const Eigen::ArrayXd diagonal = row_sum.col(0).max(tolerance_of_arithmetic * A);
  const Eigen::ArrayXd damped = (1 + 0.02) * diagonal;

  Field lambda = Field::Zero(row_errors.rows(), row_errors.cols());
  ConjugateDirections<Field> method(-row_errors, [&](const Field& r) -> Field { return r.colwise() / diagonal; });
  const Eigen::ArrayXd first = method.square();
  for (int k = 0; k < 50 && (method.square() > tolerance * tolerance * first).any(); ++k) {
    const Field& p = method.direction();
    const Field q = (transport.apply(p).colwise() * A) + (p.colwise() * damped);
    const Eigen::ArrayXd step = method.length(q);
    lambda += scaled(p, step);
    method.advance(q, step);
  }
  return lambda;
}

// The changes of the light by draws of the errors, (D + S (lambda_i + lambda_j)) B = D B + lambda o (S B) + S (lambda o
// B), as irradiance.
struct Draws {
  const RowTransport& transport;
  const RadiosityProblem& problem;
  Field B;
  Field drawn;   // D B, a column for each band of B and one for D 1, for one draw after the other
  Field lambda;  // a column for each draw; none where nothing is closed
  Field H;       // F B, the same

  Field of(Eigen::Index draw) const;
};

// The change of the irradiance by one draw.
Field Draws::of(Eigen::Index draw) const {
  Field irradiance = drawn.middleCols(draw * (B.cols() + 1), B.cols()).colwise() / problem.area.array();
  if (lambda.size() > 0) irradiance += H.colwise() * lambda.col(draw) + transport.apply(B.colwise() * lambda.col(draw));
  return irradiance;
}

}  // namespace

Field mean_square(std::span<const Field> draws) {
  Field squares = draws.front().square();
  for (const Field& draw : draws.subspan(1)) squares += draw.square();
  return squares / static_cast<double>(draws.size());
}

std::vector<Field> draw_form_factor_errors(const HalfDifferences& differences, const RowTransport& transport,
                                           const SolvedProblem& solved) {
  const RadiosityProblem& problem = solved.problem;
  const Field& B = solved.solution.radiosity;
  // Few bands leave out far less of the light than draws are sure of.
  const SpanningBands spanning = spanning_bands(B, problem.area, 1e-3);
  // 1. D B and D 1.
  const Field light = spanning.of(B);
  Field x(light.rows(), light.cols() + 1);
  x << light, Field::Ones(light.rows(), 1);
  Draws drawn{transport, problem, light, random_errors(differences, x, draws, seed), {}, {}};
  // 2. With rows closed.
  if (solved.closed) {
    const Field of_ones = drawn.drawn(Eigen::all, Eigen::seqN(light.cols(), draws, light.cols() + 1));
    drawn.lambda = row_corrections(transport, problem.area, of_ones);
    drawn.H = transport.apply(light);
  }
  // 3. Through all reflections.
  std::vector<Field> errors;
  for (Eigen::Index draw = 0; draw < draws; ++draw) errors.push_back(spanning.all_bands(drawn.of(draw)));
  return followed(transport, problem, std::move(errors));
}

std::vector<Field> draw_errors_of_lights(const PatchMesh& mesh, const RowTransport& transport,
                                         const RadiosityProblem& problem, const Field& standard_error) {
  if (standard_error.isZero(0)) return std::vector<Field>(draws, standard_error);
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  std::vector<Field> errors(draws, standard_error);
  for (std::uint64_t draw = 0; draw < draws; ++draw)
    for (PatchIndex i = 0; i < mesh.size(); ++i)
      if ((hash({seed, keys[i], draw, stream::signs_of_direct_light}) & 1) != 0) errors[draw].row(i) *= -1;
  return followed(transport, problem, std::move(errors));
}

namespace {

// P x: the mean over the parent of each patch.
Field means_over_parents(const NestedMesh& mesh, const FieldView& x, const Eigen::VectorXd& area) {
  return of_parents(mesh, means_by_parent(mesh, x, area));
}

// H = P F B: light between patches twice as large, which know only the mean of the arriving light.
class ParentTransport : public TransportOperator {
 public:
  ParentTransport(const NestedMesh& mesh, const TransportOperator& of_patches, const Eigen::VectorXd& area)
      : mesh_(mesh), of_patches_(of_patches), area_(area) {}

  PatchIndex size() const override { return of_patches_.size(); }
  Field apply(const FieldView& radiosity) const override {
    return means_over_parents(mesh_, of_patches_.apply(radiosity), area_);
  }
  bool is_reciprocal() const override { return false; }

 private:
  const NestedMesh& mesh_;
  const TransportOperator& of_patches_;
  const Eigen::VectorXd& area_;
};

}  // namespace

Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const RadiosityProblem& problem = solved.problem;
  const Field difference = differences_from_parents(mesh, solved);
  const ParentTransport between_parents(mesh, transport, problem.area);
  // F (1 - P) B + F R e, e = P F (1 - P) B + P F R e.
  const auto through_reflections = [&](std::size_t half) -> Field {
    const Field straight = transport.apply_half(half, difference);
    const Field e = followed(between_parents, problem, means_over_parents(mesh, straight, problem.area));
    return straight + transport.apply(problem.scattering.reflect(e));
  };
  const Field square = through_reflections(0) * through_reflections(1);
  // Where the two differ in sign the error is not known any better than that.
  return scale * square.abs().max(mean_around(mesh.patches, problem.area, square).abs()).sqrt();
}

}  // namespace patchlight
