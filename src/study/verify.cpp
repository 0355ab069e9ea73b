#include "study/verify.h"

#include "accuracy/spaces.h"
#include "base/parallel.h"
#include "base/sampling.h"
#include "base/vectors.h"
#include "plan/planned_scene.h"
#include "solve/scattering.h"
#include "study/left_out.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Patches of one space: 1 for each, else 0.
struct Space {
  std::string name;
  Eigen::ArrayXd holds;
};

std::vector<Space> spaces_of(const Scene& scene, const Simulation& simulation) {
  const Eigen::ArrayXd inside = inside_patches(scene, simulation.mesh, simulation.enclosed).array();
  const double count = total(inside);
  if (count == 0 || count == static_cast<double>(inside.size())) return {{"all", Eigen::ArrayXd::Ones(inside.size())}};
  return {{"inside", inside}, {"outside", 1 - inside}};
}

// Without replacement, in proportion to the exposed area.
std::vector<PatchIndex> choose_by_area(const Eigen::VectorXd& area, const Space& space, std::size_t count,
                                       std::uint64_t seed) {
  const Eigen::VectorXd weight = area.cwiseProduct(space.holds.matrix());
  const auto drawn =
      drawn_by_weight({weight.data(), static_cast<std::size_t>(weight.size())}, count, {seed, 0x63686f6f7365});
  return {drawn.begin(), drawn.end()};
}

// As many of each space.
std::vector<PatchIndex> choose(const Eigen::VectorXd& area, const std::vector<Space>& spaces,
                               const VerifyOptions& options) {
  const std::size_t each = (options.checked + spaces.size() - 1) / spaces.size();
  std::vector<PatchIndex> all;
  for (const Space& space : spaces) {
    const std::vector<PatchIndex> chosen = choose_by_area(area, space, each, options.seed);
    all.insert(all.end(), chosen.begin(), chosen.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<PathReceiver> receivers_of(const PatchMesh& mesh, const std::vector<PatchIndex>& patches) {
  std::vector<PathReceiver> receivers;
  for (const PatchIndex i : patches) receivers.push_back({mesh.corner_points(i).points, mesh.polygon[i], mesh.side[i]});
  return receivers;
}

// The probability that a chi-square of so many degrees of freedom is this or larger.
double upper_tail(double chi_square, double degrees) {
  if (degrees == 0) return 1;
  if (!std::isfinite(chi_square)) return 0;
  return boost::math::gamma_q(degrees / 2, chi_square / 2);
}

// That of a normal deviate this far from 0 or farther, either way.
double both_tails(double deviate) { return std::isnan(deviate) ? 0 : std::erfc(std::abs(deviate) / std::sqrt(2.0)); }

// a / b per band; 0 where nothing is over nothing.
Eigen::ArrayXd ratio(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return (a == 0).select(a, a / b); }

// Two sums of the same light may differ by so much of it for rounding alone.
constexpr double rounding = 1e-10;

// The variance of Student's t beside that of the noise which batches tell. Of n paths that met no light the bound of 95
// % on the share that would have is 3 / n (Hanley and Lippman-Hand 1983): of the brightest light that was traced.
Field variance_of(const PathEstimate& paths) {
  constexpr double degrees = path_batches - 1;
  Field noise = paths.standard_error.square() * (degrees / (degrees - 2)) + (rounding * paths.irradiance).square();
  if (noise.rows() == 0) return noise;
  const Spectrum of_none = (3 * highest(paths.irradiance).transpose() / paths.paths).square();
  return (paths.irradiance == 0).select(of_none.replicate(noise.rows(), 1), noise);
}

Field rows_at(const Field& field, const std::vector<Eigen::Index>& rows) {
  Field chosen(static_cast<Eigen::Index>(rows.size()), field.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) chosen.row(static_cast<Eigen::Index>(k)) = field.row(rows[k]);
  return chosen;
}

VerifiedPart part_of(const Space& space, const Verification& result, const Simulation& simulation,
                     const FieldView& bars) {
  VerifiedPart part;
  part.name = space.name;
  for (std::size_t k = 0; k < result.patches.size(); ++k) {
    if (space.holds[result.patches[k]] != 0) part.rows.push_back(static_cast<Eigen::Index>(k));
  }
  const Field solved = rows_at(result.irradiance, part.rows);
  const Field traced = rows_at(result.paths.irradiance, part.rows);
  const Field bar = rows_at(result.bar, part.rows);
  const Field variance = rows_at(variance_of(result.paths), part.rows);
  part.dark = (solved == 0 && traced == 0).cast<double>().colwise().sum().transpose();
  part.chi_square = sum_over_patches(rows_at(deviations(result), part.rows).square());

  // The common offset. Bars of different patches hang together, one cannot say how: as if they were the same.
  const Eigen::ArrayXd difference = sum_over_patches(solved - traced);
  part.mean_difference = ratio(difference, sum_over_patches(traced));
  part.offset = ratio(difference, (sum_over_patches(variance) + sum_over_patches(bar).square()).sqrt());

  // How far patches are off: noise of the paths adds its squares to those of the differences.
  const Eigen::ArrayXd noise = sum_over_patches(rows_at(result.paths.standard_error, part.rows).square());
  const Eigen::ArrayXd light = (sum_over_patches(traced.square()) - noise).max(0.0);
  part.error = ratio((sum_over_patches((solved - traced).square()) - noise).max(0.0), light).sqrt();
  part.noise = ratio(noise, light).sqrt();

  // How much that would grant.
  const Eigen::VectorXd area = simulation.problem.area.cwiseProduct(space.holds.matrix());
  const Eigen::ArrayXd of_checked =
      ratio(sum_over_patches(bar.square()).sqrt(), sum_over_patches(traced.square()).sqrt());
  const Eigen::ArrayXd of_all = ratio(area_norm(bars, area), area_norm(simulation.solution.irradiance, area));
  const Eigen::ArrayXd of_noise = ratio(sum_over_patches(variance).sqrt(), sum_over_patches(traced));
  part.width = largest(of_checked.max(of_all).max(of_noise));
  return part;
}

// Bands and parts go together, so that they are not added up: the least likely one decides, among so many (Bonferroni).
Verification judged(Verification result) {
  double least = 1;
  double tests = 0;
  bool wide = false;
  for (const VerifiedPart& part : result.parts) {
    for (Eigen::Index band = 0; band < part.chi_square.size(); ++band) {
      const auto degrees = static_cast<double>(part.rows.size()) - part.dark[band];
      least = std::min({least, upper_tail(part.chi_square[band], degrees), both_tails(part.offset[band])});
      tests += 2;
    }
    wide = wide || !(part.width <= widest_bar);
  }
  result.probability = std::min(1.0, tests * least);
  const bool lit = std::any_of(result.left_out.begin(), result.left_out.end(), std::mem_fn(&LeftOutSide::is_lit));
  result.verdict = result.probability < least_probability || lit ? Verdict::disagrees
                   : wide                                        ? Verdict::inconclusive
                                                                 : Verdict::agrees;
  return result;
}

Verification compared(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                      const std::vector<Space>& spaces, const std::vector<PatchIndex>& patches,
                      const VerifyOptions& options, const Observer& observer) {
  Verification result;
  result.patches = patches;
  result.irradiance = chosen_rows(simulation.solution.irradiance, patches);
  result.bar = chosen_rows(bar, patches);
  const Scene seen = scene_for_sensors(scene, simulation.plan);
  const bool follows_reflections = reflections_of(simulation.plan) == Reflections::followed;
  result.paths = trace_irradiance(
      seen, simulation.plan.sides, receivers_of(simulation.mesh, patches),
      {.paths = options.paths, .seed = options.seed, .follows_reflections = follows_reflections}, observer);
  const Spectrum mean = result.paths.irradiance.colwise().mean();
  result.left_out = trace_left_out(seen, simulation.plan.sides, mean, options, follows_reflections, observer);
  for (const Space& space : spaces) result.parts.push_back(part_of(space, result, simulation, bar));
  return judged(std::move(result));
}

// With so many paths a comparison is not made again.
constexpr std::uint32_t enough_paths = 8192;

// Light that few paths meet, as by a door left ajar, is spread unevenly: most batches miss some of it, and their spread
// tells too little of that. True where most of chi-square is of patches whose paths scatter by a fifth of their bars or
// more.
bool is_by_noise(const Verification& verification) {
  if (!(verification.probability < least_probability)) return false;
  const Field squares = deviations(verification).square();
  constexpr double share = 0.2;
  const Field of_noise = (verification.paths.standard_error > share * verification.bar).select(squares, 0);
  return of_noise.sum() > squares.sum() / 2;
}

// Other ones, and more.
VerifyOptions more_paths(VerifyOptions options) {
  options.paths = std::max(16 * options.paths, enough_paths);
  options.seed = hash({options.seed, 0x61676169});
  return options;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::disagrees:
      return "disagrees";
    case Verdict::inconclusive:
      return "inconclusive";
  }
  return "";
}

Field irradiance_bar(const Simulation& simulation, double relative) {
  const Solution& solution = simulation.solution;
  const Eigen::VectorXd& area = simulation.problem.area;
  const Spectrum mean = area_sum(solution.irradiance, area).transpose() / total(area);
  Field bar = relative * solution.irradiance.max(mean.replicate(solution.irradiance.rows(), 1));
  if (solution.error.size() == 0) return bar;
  return bar + irradiance_errors(simulation.problem.scattering, solution.error);
}

Field deviations(const Verification& verification) {
  const Field noise = variance_of(verification.paths);
  const Field difference = verification.irradiance - verification.paths.irradiance;
  const Field none = Field::Zero(difference.rows(), difference.cols());
  return (difference == 0).select(none, difference / (noise + verification.bar.square()).sqrt());
}

Field deviations_by_noise(const Verification& verification) {
  const Field& noise = verification.paths.standard_error;
  const Field unknown = Field::Constant(noise.rows(), noise.cols(), std::numeric_limits<double>::quiet_NaN());
  const Field rounded = (noise.square() + (rounding * verification.paths.irradiance).square()).sqrt();
  return (noise > 0).select((verification.irradiance - verification.paths.irradiance) / rounded, unknown);
}

Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options, const Observer& observer) {
  assert(bar.rows() == simulation.mesh.size());
  const std::vector<Space> spaces = spaces_of(scene, simulation);
  const std::vector<PatchIndex> patches = choose(simulation.problem.area, spaces, options);
  VerifyOptions by = options;
  for (std::uint32_t first_paths = 0;; by = more_paths(by)) {
    Verification result = compared(scene, simulation, bar, spaces, patches, by, observer);
    result.first_paths = first_paths;
    if (by.paths >= enough_paths || !is_by_noise(result)) return result;
    if (first_paths == 0) first_paths = result.paths.paths;
  }
}

}  // namespace patchlight
