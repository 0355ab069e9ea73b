#include "pipeline/solve_with_rays.h"

#include "accuracy/errors.h"
#include "base/disjoint_sets.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/vectors.h"
#include "form_factor/patch_shape.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "transport/smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace patchlight {
namespace {

// The response is multiplied by the missing flux, which is some thousandths of the light.
constexpr double error_of_response = 0.01;  // by its residual

void join_patches(DisjointSets& components, const RayRows& rows) {
  for (PatchIndex i = 0; i + 1 < rows.first_hit.size(); ++i) {
    for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k) components.join(i, rows.hits[k]);
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
      if (rows.entries[k].form_factor > 0) components.join(i, rows.entries[k].patch);
  }
}

// Sums over the patches of each closed space: a row for each space, a column for each band.
Field sum_by_space(const ClosedSpaces& spaces, const Field& values, const Eigen::VectorXd& weight) {
  Field sums = Field::Zero(spaces.count, values.cols());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const std::uint32_t space = spaces.space_of[static_cast<std::size_t>(i)];
    if (space != ClosedSpaces::open) sums.row(space) += weight[i] * values.row(i);
  }
  return sums;
}

// Each patch gets the value of its space, times its own.
Field times_of_space(const ClosedSpaces& spaces, Field values, const Field& of_spaces) {
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const std::uint32_t space = spaces.space_of[static_cast<std::size_t>(i)];
    if (space == ClosedSpaces::open)
      values.row(i) = 0;
    else
      values.row(i) *= of_spaces.row(space);
  }
  return values;
}

// sum_j A_j s_j B_j - sum_i A_i (F B)_i, W per space and band.
Field missing(const ConservedFlux& flux, const Field& gathered, const Field& radiosity, const Eigen::VectorXd& area) {
  return sum_by_space(flux.spaces, radiosity, flux.seen_area) - sum_by_space(flux.spaces, gathered, area);
}

std::array<Field, 2> gathered_by_halves(const RaysWithPockets& transport, const Field& radiosity) {
  return {transport.rays().apply_half(0, radiosity), transport.rays().apply_half(1, radiosity)};
}

Field mean_of(const std::array<Field, 2>& halves) { return 0.5 * (halves[0] + halves[1]); }

// The light of a RayLight and its errors, some of it without a value.
std::array<const Field*, 7> fields_of(const RayLight& light) {
  return {&light.lit.problem.exitance,     &light.by_emitters[0],        &light.by_emitters[1],
          &light.emitter_standard_error,   &light.in_mirrors.irradiance, &light.in_mirrors.standard_error,
          &light.lit.direct_standard_error};
}

// True when each band of a field is its factor times its source band, up to rounding.
bool follows(const Field& field, const SolvedBands& bands) {
  for (Eigen::Index i = 0; i < field.rows(); ++i) {
    for (Eigen::Index band = 0; band < field.cols(); ++band) {
      const auto& [from, factor] = bands.sources[static_cast<std::size_t>(band)];
      const double expected = factor * field(i, bands.solved[static_cast<std::size_t>(from)]);
      if (!(std::abs(field(i, band) - expected) <= 16 * std::numeric_limits<double>::epsilon() * expected))
        return false;
    }
  }
  return true;
}

// Bands differ by a factor where all lights do.
SolvedBands needed_bands(const RayLight& light, const SolverOptions& options) {
  const RadiosityProblem& all = light.lit.problem;
  if (options.every_band || options.reference) return all_bands(all);
  const Field& direct = all.direct_irradiance;
  SolvedBands bands =
      solved_bands({all.scattering, direct.size() > 0 ? Field(all.exitance + direct) : all.exitance, all.area, {}});
  const auto fields = fields_of(light);
  const bool all_follow = follows(direct, bands) && std::all_of(fields.begin(), fields.end(), [&](const Field* field) {
                            return follows(*field, bands);
                          });
  return all_follow ? bands : all_bands(all);
}

Field squares_in(const SolvedBands& bands, const Field& error) { return reduced(error, bands).square(); }

// B = E + rho o H for light that is reflected once. H is the irradiance by separate lamps plus the light of other
// emitters in the rows.
ConservingSolution gathered_once(const RaysWithPockets& transport, const RadiosityProblem& problem) {
  std::array<Field, 2> gathered = gathered_by_halves(transport, problem.exitance);
  Solution solution = reflected_once(problem, mean_of(gathered) + problem.direct_irradiance);
  solution.history = {{.work = 1}};
  return {std::move(solution), {}, std::move(gathered)};
}

// The square of the bias of smoothing over the variance that it leaves, of all patches together, per band: (S - H) of
// one half times that of the other has the square of the bias as its mean, as the halves are independent.
Eigen::ArrayXd bias_over_variance(const SmoothedHalves& smooth, const std::array<Field, 2>& raw,
                                  const RadiosityProblem& problem) {
  const auto weighted = [&](const Field& irradiance_squared) {
    return area_sum(reflected_variance(problem.scattering, irradiance_squared), problem.area);
  };
  const Eigen::ArrayXd bias = weighted((smooth.halves[0] - raw[0]) * (smooth.halves[1] - raw[1])).max(0.0);
  return quotient(bias, weighted(smooth.variance));
}

// The parts of a last gather.
struct Gather {
  const PatchMesh& mesh;
  const RaysWithPockets& transport;
  const RayLight& light;
  const NeededLight& needed;
  const TransportFacts& facts;
};

// Independent errors of single patches' irradiances, W/m^2.
struct SingleErrors {
  Field of_rows;    // half of the difference of the two halves
  Field of_lights;  // standard errors of lamps and of lights that are no patches
};

// A mean square over n draws has a relative standard error of sqrt(2 / n). Draws cost more with many patches.
std::uint64_t number_of_draws(PatchIndex patches) {
  return patches > very_many_patches ? 4 : patches > many_patches ? 8 : 16;
}

// Equally likely errors by reflection: each draw gives the error n_i of every patch a random sign, and follows it,
// e = n + F R e. The part F R e is common to all patches that see the same light, so that it does not average out over
// a room. Closed spaces have shared out the flux that n adds. Signs are common to all bands.
std::vector<Field> draw_reflected_errors(const Gather& by, const ConservedFlux& flux, const SingleErrors& single) {
  const RadiosityProblem& problem = by.needed.problem;
  const std::vector<std::uint32_t> keys = patch_keys(by.mesh);
  const auto with_signs = [&](Field error, std::uint64_t draw, stream::Stream signs) {
    for (PatchIndex i = 0; i < by.mesh.size(); ++i)
      if ((hash({keys[i], draw, signs}) & 1U) != 0) error.row(i) *= -1;
    return error;
  };
  const Field none = Field::Zero(single.of_rows.rows(), single.of_rows.cols());
  std::vector<Field> errors;
  for (std::uint64_t draw = 0; draw < number_of_draws(by.mesh.size()); ++draw)
    errors.push_back(flux.completed(with_signs(single.of_rows, draw, stream::signs_of_rows), none, problem.area) +
                     with_signs(single.of_lights, draw, stream::signs_of_lights));
  std::vector<Field> reflected = followed(by.transport, problem, errors);
  for (std::size_t draw = 0; draw < errors.size(); ++draw) reflected[draw] -= errors[draw];
  return reflected;
}

// The variance of the irradiance by bright patches that no ray was sent towards, of n rays over the hemisphere: its
// mean over all patches is sum_j A_j s_j B_j^2 / (n A), which rays that all miss them do not show. One value per band.
Eigen::ArrayXd variance_of_missed(const RayLight& light, const Field& sources, const Eigen::VectorXd& row_sum) {
  const Eigen::VectorXd& area = light.lit.problem.area;
  Field squares = sources.square();
  for (Eigen::Index i = 0; i < squares.rows(); ++i)
    if (light.is_missed[static_cast<std::size_t>(i)] == 0) squares.row(i) = 0;
  return area_sum(squares, area.cwiseProduct(row_sum)) / (light.rays_per_patch * total(area));
}

// The relative variance of the sum of each row. A share s estimated by n independent rays has a variance of s (1 - s) /
// n, and s n of them hit patches. Shadow rays towards bright patches count as well, although the sum does not depend on
// them. The reason: hemisphere rays are stratified, so their number alone would make the bars too wide
// (tests/property/rays_test.cpp). Where backs are visible, the rays that searched for them count.
Eigen::ArrayXd variance_of_row_sums(const RaysWithPockets& transport, const PatchMesh& mesh,
                                    const Eigen::VectorXd& row_sum, const LostShare& lost) {
  const double small = small_area(mesh);
  const Eigen::ArrayXd rays = rays_of_patches(lost, mesh.size());
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(row_sum.size());
  for (Eigen::Index i = 0; i < row_sum.size(); ++i) {
    const double s = row_sum[i];
    const auto row = static_cast<std::size_t>(i);
    double met = 0;
    for (const RayRows* half : {&transport.rays().rows(0), &transport.rays().rows(1)})
      met += static_cast<double>(half->first_hit[row + 1] - half->first_hit[row] + half->first_entry[row + 1] -
                                 half->first_entry[row]);
    if (!(s > 0 && met > 0)) continue;
    const bool sees_backs = lost.rays_per_patch > 0 && (lost.at_backs[i] > 0 || lost.covered[i] > 0);
    const double to_backs = mesh.area[row] < small ? rays[i] / 4 : rays[i];
    variance[i] = std::max(0.0, 1 - s) / (sees_backs ? std::min(met, s * to_backs) : met);
  }
  return variance;
}

// Both halves are scaled to the same row sums, so that their difference does not show the error of these: it is added
// to one half of each patch, by a hash of its key, and taken from the other.
std::array<Field, 2> with_errors_of_row_sums(std::array<Field, 2> halves, const PatchMesh& mesh,
                                             const Eigen::ArrayXd& variance) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  Eigen::ArrayXd drawn = variance.sqrt();
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    if ((hash({keys[i], stream::signs_of_row_sums}) & 1U) != 0) drawn[i] = -drawn[i];
  const Field error = mean_of(halves).colwise() * drawn;
  halves[0] += error;
  halves[1] -= error;
  return halves;
}

// An observer of a solution that is not the one of the run.
Observer without_iterates(const Observer& observer) {
  if (!observer) return {};
  return [&observer](const Progress& progress) {
    return observer({.stage = progress.stage, .fraction = progress.fraction});
  };
}

// The irradiance from other patches in the bands that need it, its variance with that of all lights, and the part of
// its error that patches have in common, as equally likely draws.
struct GatheredLight {
  Field irradiance;
  Field variance;
  std::vector<Field> correlated_errors;
};

// A solution in the needed bands; flux is null where no light is reflected twice.
struct SolvedInBands {
  const Solution& solution;
  const ConservedFlux* flux;
};

// The last gather, by each half, smoothed, and how far that may be off.
GatheredLight gathered_light(const Gather& by, const SolvedInBands& solved, std::array<Field, 2> gathered) {
  const RadiosityProblem& problem = by.needed.problem;
  const Eigen::VectorXd& row_sum = by.facts.row_sum;

  // 1. The halves, smoothed.
  const Field& sources = solved.flux ? solved.solution.radiosity : problem.exitance;
  if (solved.flux)
    for (Field& half : gathered) half = solved.flux->completed(std::move(half), sources, problem.area);
  const std::array<Field, 2> raw = with_errors_of_row_sums(
      std::move(gathered), by.mesh, variance_of_row_sums(by.transport, by.mesh, row_sum, by.facts.lost));
  SmoothedHalves smooth = smoothed(by.mesh, by.light.distance, raw);

  // 2. The scatter of that, and its bias where irradiance is not linear.
  const Eigen::ArrayXd bias = bias_over_variance(smooth, raw, problem);
  GatheredLight found{mean_of(smooth.halves).max(0.0), scaled(smooth.variance, 1 + bias), {}};
  // Two halves may agree by chance, or both miss a bright gap that rays of patches around meet. Variances are compared
  // by as many rays; those to lamps are as many for all.
  const Field& of_lamps = by.needed.of_lamps;
  const Eigen::ArrayXd times = multiples(by.facts.lost.doublings, by.mesh.size());
  const Field around = mean_around(by.mesh, problem.area, found.variance.colwise() * times);
  found.variance =
      found.variance.max(around.colwise() / times) + of_lamps.max(mean_around(by.mesh, problem.area, of_lamps));
  if (!by.light.is_missed.empty())
    found.variance.rowwise() += variance_of_missed(by.light, sources, row_sum).transpose();
  Field of_lights = of_lamps;
  if (by.needed.of_others.size() > 0) {
    found.variance += by.needed.of_others;
    of_lights += by.needed.of_others;
  }
  if (!solved.flux || !solved.solution.trapped.empty()) return found;

  // 3. Errors of single patches are in the light of all bounces.
  found.correlated_errors = draw_reflected_errors(by, *solved.flux, {0.5 * (raw[0] - raw[1]), of_lights.sqrt()});
  found.variance += mean_square(found.correlated_errors);
  return found;
}

}  // namespace

ClosedSpaces find_closed_spaces(const RayTransport& rays, const RadiosityProblem& problem,
                                const Eigen::VectorXd& row_sum) {
  const Eigen::VectorXd& area = problem.area;
  // 1. Connected components.
  const PatchIndex size = rays.size();
  DisjointSets components(size);
  for (const std::size_t half : {0U, 1U}) join_patches(components, rays.rows(half));
  const Scattering& scattering = problem.scattering;
  if (!scattering.is_diagonal())
    for (PatchIndex i = 0; i < size; ++i) components.join(i, scattering.other_side[i]);

  // 2. The area and the loss of each, by its root.
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size);
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(size);
  for (PatchIndex i = 0; i < size; ++i) {
    all[components.root(i)] += area[i];
    lost[components.root(i)] += area[i] * (1 - row_sum[i]);
  }

  // 3. Number those that are closed. Patches that reach into solids lose some tenths of a percent at their backs, and
  //    rooms with a window some percent.
  ClosedSpaces found;
  std::map<PatchIndex, std::uint32_t> number;
  for (PatchIndex i = 0; i < size; ++i) {
    const PatchIndex root = components.root(i);
    const bool is_closed = all[root] > 0 && lost[root] <= 0.02 * all[root];
    found.space_of.push_back(is_closed
                                 ? number.try_emplace(root, static_cast<std::uint32_t>(number.size())).first->second
                                 : ClosedSpaces::open);
  }
  found.count = static_cast<Eigen::Index>(number.size());
  return found;
}

Field ConservedFlux::completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const {
  if (spaces.count == 0) return gathered;
  const Field watts = missing(*this, gathered, radiosity, area);
  gathered += times_of_space(spaces, shape, watts);
  return gathered;
}

ConservingSolution conserving_flux(const RaysWithPockets& transport, const RadiosityProblem& problem, Solution solution,
                                   const Eigen::VectorXd& row_sum, const Observer& observer) {
  // 1. The missing flux of each closed space, and its distribution.
  const Eigen::VectorXd& area = problem.area;
  std::array<Field, 2> halves = gathered_by_halves(transport, solution.radiosity);
  const Field gathered = mean_of(halves);
  ConservedFlux flux{find_closed_spaces(transport.rays(), problem, row_sum), area.cwiseProduct(row_sum), {}};
  const auto unchanged = [&] {
    flux.shape = Field::Zero(gathered.rows(), gathered.cols());
    return ConservingSolution{std::move(solution), std::move(flux), std::move(halves)};
  };
  if (flux.spaces.count == 0 || !solution.converged) return unchanged();
  const Field arriving = sum_by_space(flux.spaces, gathered, area);
  flux.shape = times_of_space(flux.spaces, gathered, (arriving > 0).select(arriving.inverse(), 0.0));
  const Field lacking = missing(flux, gathered, solution.radiosity, area);

  // 2. The response to a watt in each space, B' = R shape + R F B', which lacks some flux again. Closed spaces exchange
  //    no light, so that one solution has the responses of all.
  const RadiosityProblem of_a_watt{problem.scattering, problem.scattering.reflect(flux.shape), area};
  const SolverOptions loosely{.solver = Solver::gmres,
                              .relative_error = error_of_response,
                              .max_iterations = 100,  // white faces that trap light leave the flux uncorrected
                              .largest_row_sum = std::numeric_limits<double>::infinity(),
                              .patch_bounds = false};
  const Solution response = solve(transport, of_a_watt, loosely, observer);
  const std::array<Field, 2> by_a_watt = gathered_by_halves(transport, response.radiosity);
  const Field lacking_again = missing(flux, mean_of(by_a_watt), response.radiosity, area);
  if (!response.converged || (lacking_again > 0.5).any()) return unchanged();

  // 3. The corrected solution.
  const Field watts = lacking / (1 - lacking_again);
  const Field added = times_of_space(flux.spaces, response.radiosity, watts);
  solution.radiosity += added;
  for (std::size_t half = 0; half < 2; ++half) halves[half] += times_of_space(flux.spaces, by_a_watt[half], watts);
  if (solution.error.size() > 0) solution.error += error_of_response * added.abs();
  return {std::move(solution), std::move(flux), std::move(halves)};
}

NeededLight needed_light(const RayLight& light, const SolverOptions& options) {
  const RadiosityProblem& all = light.lit.problem;
  NeededLight needed{.bands = needed_bands(light, options), .problem = {}, .of_lamps = {}, .of_others = {}};
  const SolvedBands& bands = needed.bands;
  needed.problem = {of_bands(all.scattering, bands.solved), reduced(emitted_in_rows(light), bands), all.area,
                    reduced(direct_of(light), bands)};
  needed.of_lamps = squares_in(bands, light.emitter_standard_error);
  for (const Field* error : {&light.lit.direct_standard_error, &light.in_mirrors.standard_error}) {
    if (error->size() == 0) continue;
    if (needed.of_others.size() == 0) needed.of_others = Field::Zero(error->rows(), needed.of_lamps.cols());
    needed.of_others += squares_in(bands, *error);
  }
  return needed;
}

RaySolution solve_with_rays(const Run& run, const PatchMesh& mesh, const RaysWithPockets& transport,
                            const RayLight& light, const TransportFacts& facts, const SolverOptions& options) {
  // 1. Solve for the light of the rows, without losing any of it, in the bands that need it.
  const NeededLight needed = needed_light(light, options);
  const RadiosityProblem& problem = needed.problem;
  const bool reflects_twice = simulates(run.plan, Effect::interreflection);
  const Observer observer = telling_all_bands(run.observer, needed.bands);
  auto [solution, flux, halves] =
      reflects_twice ? conserving_flux(transport, problem, solve(transport, problem, options, observer), facts.row_sum,
                                       without_iterates(run.observer))
                     : gathered_once(transport, problem);

  // 2. Gather once more.
  const GatheredLight gathered = gathered_light({mesh, transport, light, needed, facts},
                                                {solution, reflects_twice ? &flux : nullptr}, std::move(halves));

  // 3. B = E + R H in all bands, with all that is emitted.
  const RadiosityProblem& all = light.lit.problem;
  for (Field* field : {&solution.direct_irradiance, &solution.ambient, &solution.error})
    *field = expanded(*field, needed.bands);
  solution.irradiance = expanded(gathered.irradiance + problem.direct_irradiance, needed.bands);
  solution.radiosity = radiosity_from(all, solution.irradiance);
  RaySolution found{std::move(solution), expanded(gathered.variance.sqrt(), needed.bands), {}};
  for (const Field& draw : gathered.correlated_errors) found.correlated_errors.push_back(expanded(draw, needed.bands));
  return found;
}

}  // namespace patchlight
