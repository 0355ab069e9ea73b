#include "study/verify.h"

#include "patchlight/gather/readings.h"
#include "patchlight/views/views.h"

#include "accuracy/spaces.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/vectors.h"
#include "pipeline/radiosity_errors.h"
#include "plan/planned_scene.h"
#include "report/room_light.h"
#include "scene/triangulate.h"
#include "solve/scattering.h"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// Two sums of the same light may differ by so much of it for rounding alone.
constexpr double rounding = 1e-10;

// The noise is estimated from few batches, which gives Student's t. If none of n paths met light, the share that does
// is below 3 / n with 95 % confidence (Hanley and Lippman-Hand 1983): of the brightest light that was traced.
Field variance_of(const PathEstimate& paths) {
  constexpr double degrees = path_batches - 1;
  Field noise = paths.standard_error.square() * (degrees / (degrees - 2)) + (rounding * paths.irradiance).square();
  if (noise.rows() == 0) return noise;
  const Spectrum of_none = (3 * highest(paths.irradiance).transpose() / paths.paths).square();
  return (paths.irradiance == 0).select(of_none.replicate(noise.rows(), 1), noise);
}

Field rows_at(const Field& field, const std::vector<Eigen::Index>& rows) { return field(rows, Eigen::all); }

// A stream of random numbers.
struct Drawing {
  std::uint64_t seed = 1;
  std::uint64_t purpose = 0;
};

// Keeps the front and back of every polygon; emission stays unchanged.
KeptSides all_sides(const Scene& scene, const KeptSides& kept) {
  KeptSides all;
  all.front.assign(scene.polygons.size(), 1);
  all.back = all.front;
  all.emit_from_back = kept.emit_from_back;
  all.geometry = kept.geometry;
  return all;
}

// The largest triangle of the polygon.
PathReceiver receiver_on(const Scene& scene, PolygonIndex polygon, Side side) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  PathReceiver receiver{{}, polygon, side};
  double largest = 0;
  for (const auto& [a, b, c] : triangulate(corners)) {
    const double area = (corners[b] - corners[a]).cross(corners[c] - corners[a]).norm() / 2;
    if (area <= largest) continue;
    largest = area;
    receiver.corners = {corners[a], corners[b], corners[c], corners[c]};
  }
  return receiver;
}

// The areas of the sides that are left out, in proportion; front and back of each polygon in turn; 0 for the others.
std::vector<double> areas_left_out(const Scene& scene, const KeptSides& kept) {
  std::vector<double> areas;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const double area = area_vector(corner_points(scene, p)).norm();
    areas.push_back(kept.front[p] != 0 ? 0 : area);
    areas.push_back(kept.back[p] != 0 ? 0 : area);
  }
  return areas;
}

// `count` of the indices of these weights, or all above 0 when there are fewer, without replacement: those with the
// largest log(u) / weight, u uniform in (0, 1) (Efraimidis and Spirakis 2006), in this order.
std::vector<std::uint32_t> drawn_by_weight(std::span<const double> weights, std::size_t count, const Drawing& drawing) {
  std::vector<std::pair<double, std::uint32_t>> keys;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const double u = (hash({drawing.seed, drawing.purpose, i}) + 0.5) * 0x1p-32;
    keys.emplace_back(-std::log(u) / weights[i], i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> drawn;
  for (std::size_t k = 0; k < std::min(count, keys.size()); ++k) drawn.push_back(keys[k].second);
  return drawn;
}

// VerifyOptions::left_out of the sides that are not kept, with the light that paths find there when all sides are.
// `mean` is the mean irradiance of the checked patches, W/m^2; reflections as PathOptions has it. Throws Canceled.
std::vector<LeftOutSide> trace_left_out(const Scene& scene, const KeptSides& kept, const Spectrum& mean,
                                        const VerifyOptions& options, bool follows_reflections,
                                        const Observer& observer) {
  if (options.left_out == 0) return {};
  std::vector<LeftOutSide> sides;
  std::vector<PathReceiver> receivers;
  for (const std::uint32_t k :
       drawn_by_weight(areas_left_out(scene, kept), options.left_out, {options.seed, stream::compared_left_out})) {
    const Side side = k % 2 == 0 ? Side::front : Side::back;
    sides.push_back({k / 2, side, {}, {}});
    receivers.push_back(receiver_on(scene, k / 2, side));
  }
  if (sides.empty()) return sides;
  const PathEstimate paths = trace_irradiance(
      scene, all_sides(scene, kept), receivers,
      {.paths = options.paths, .seed = options.seed, .follows_reflections = follows_reflections}, observer);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    LeftOutSide& side = sides[k];
    side.irradiance = paths.irradiance.row(static_cast<Eigen::Index>(k));
    side.standard_error = paths.standard_error.row(static_cast<Eigen::Index>(k));
    side.is_lit = (side.irradiance > (3 * side.standard_error).max(1e-3 * mean)).any();
  }
  return sides;
}

// A total shared by rooms or sensors: 2^16 paths each at most, no fewer than a patch gets.
std::uint32_t paths_each(const VerifyOptions& options, double shares_of_patches, std::size_t receivers) {
  const double total = shares_of_patches * static_cast<double>(options.checked * options.paths);
  const double each = std::min<double>(1 << 16, total / static_cast<double>(receivers));
  return std::max(options.paths, static_cast<std::uint32_t>(each));
}

// The goal region or the rest: 1 for each of its patches, else 0, and its share of the checked patches.
struct Region {
  std::string name;
  Eigen::ArrayXd holds;
  double share = 1;
};

std::vector<Region> regions_of(const Scene& scene, const Simulation& simulation) {
  const bool is_named = !simulation.plan.accuracy.interest.empty();
  const Eigen::ArrayXd goal =
      is_named ? interest_in(scene, simulation).array()
               : inside_patches(scene, simulation.plan.sides, simulation.mesh, simulation.enclosed).array();
  const double count = total(goal);
  if (count == 0 || count == static_cast<double>(goal.size())) return {{"all", Eigen::ArrayXd::Ones(goal.size())}};
  constexpr double of_goal = 7.0 / 8;
  return {{is_named ? "of interest" : "inside", goal, of_goal},
          {is_named ? "others" : "outside", 1 - goal, 1 - of_goal}};
}

// Exposed area times radiosity, a proxy of the importance. The mean radiosity is added, as dark patches are wrong too.
Eigen::ArrayXd drawing_weights(const Simulation& simulation) {
  const Eigen::ArrayXd area = simulation.problem.area.array();
  const Eigen::ArrayXd radiosity = simulation.solution.radiosity.rowwise().mean().max(0.0);
  const double mean = total(area * radiosity) / total(area);
  return mean > 0 ? Eigen::ArrayXd(area * (radiosity + mean)) : area;
}

std::vector<PatchIndex> draw(const Eigen::ArrayXd& weights, std::size_t count, std::uint64_t seed) {
  const auto drawn = drawn_by_weight({weights.data(), static_cast<std::size_t>(weights.size())}, count,
                                     {seed, stream::compared_patches});
  return {drawn.begin(), drawn.end()};
}

std::vector<PatchIndex> draw_patches(const Simulation& simulation, const std::vector<Region>& regions,
                                     const VerifyOptions& options) {
  const Eigen::ArrayXd weights = drawing_weights(simulation);
  std::vector<PatchIndex> all;
  for (const Region& region : regions) {
    const auto count = static_cast<std::size_t>(std::ceil(region.share * static_cast<double>(options.checked)));
    const std::vector<PatchIndex> drawn = draw(weights * region.holds, count, options.seed);
    all.insert(all.end(), drawn.begin(), drawn.end());
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

// Bands, parts and families are correlated. The least likely one decides, times the number of tests (Bonferroni).
Verification judged(Verification result) {
  double least = 1;
  double tests = 0;
  bool wide = false;
  std::vector<VerifiedPart> tested = result.parts;
  for (const VerifiedFamily& family : result.families) tested.push_back(family.part);
  for (const VerifiedPart& part : tested) {
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

std::vector<Eigen::Index> all_rows(const SolvedAndTraced& compared) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(compared.irradiance.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

// The scene as paths see it, and how they are traced.
struct Tracer {
  const Scene& whole;
  const Simulation& simulation;
  std::shared_ptr<const Scene> scene;
  PathOptions options;
  const Observer& observer;

  PathEstimate trace(const auto& receivers) const {
    return trace_irradiance(*scene, simulation.plan.sides, receivers, options, observer);
  }
};

// Bars of a room's patches are correlated by an unknown amount: their mean is the bar of the room's mean.
Spectrum mean_over(const FieldView& field, const std::vector<PatchIndex>& patches, const Eigen::VectorXd& area) {
  Spectrum sum = Spectrum::Zero(field.cols());
  double whole = 0;
  for (const PatchIndex i : patches) {
    sum += area[i] * field.row(i);
    whole += area[i];
  }
  return sum / whole;
}

// Rooms share half as many paths as the checked patches take.
std::optional<VerifiedFamily> verify_rooms(Tracer tracer, const FieldView& bar, const VerifyOptions& options) {
  const Simulation& simulation = tracer.simulation;
  const Eigen::VectorXd& area = simulation.problem.area;
  std::vector<RoomPatches> rooms = rooms_of(tracer.whole, simulation);
  for (RoomPatches& room : rooms) std::erase_if(room.patches, [&](PatchIndex i) { return !(area[i] > 0); });
  std::erase_if(rooms, [](const RoomPatches& room) { return room.patches.empty(); });
  if (rooms.size() > options.checked) rooms.resize(options.checked);
  if (rooms.empty()) return {};
  VerifiedFamily family;
  std::vector<PathRegion> regions;
  family.compared.irradiance.resize(static_cast<Eigen::Index>(rooms.size()), bar.cols());
  family.compared.bar = family.compared.irradiance;
  for (const RoomPatches& room : rooms) {
    const auto row = static_cast<Eigen::Index>(regions.size());
    family.names.push_back(room.name);
    family.compared.irradiance.row(row) = mean_over(simulation.solution.irradiance, room.patches, area);
    family.compared.bar.row(row) = mean_over(bar, room.patches, area);
    regions.push_back(PathRegion{receivers_of(simulation.mesh, room.patches)});
  }
  tracer.options.paths = paths_each(options, 0.5, rooms.size());
  family.compared.paths = tracer.trace(std::span<const PathRegion>(regions));
  family.part = verify_part("rooms", family.compared, all_rows(family.compared));
  return family;
}

std::vector<std::string> names_of_sensors(const Scene& scene) {
  std::vector<std::string> names;
  for (const SensorGroup& group : scene.sensors)
    for (std::size_t k = 0; k < group.sensors.size(); ++k) names.push_back(place_of(group, k));
  return names;
}

// Sensors share four times as many, as their bars are narrower than those of patches. Those inside walls read nothing.
std::optional<VerifiedFamily> verify_sensors(Tracer tracer, const VerifyOptions& options) {
  const std::vector<Sensor> all = all_sensors(tracer.whole.sensors);
  if (all.empty()) return {};
  const Readings readings = read_sensors(tracer.simulation, tracer.observer).readings;
  Eigen::ArrayXd weights = Eigen::ArrayXd::Ones(static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k)
    if (is_inside_wall(readings, k)) weights[static_cast<Eigen::Index>(k)] = 0;
  std::vector<PatchIndex> chosen = draw(weights, options.checked, options.seed);
  if (chosen.empty()) return {};
  std::sort(chosen.begin(), chosen.end());
  const std::vector<std::string> names = names_of_sensors(tracer.whole);
  VerifiedFamily family;
  std::vector<Sensor> sensors;
  for (const PatchIndex k : chosen) {
    family.names.push_back(names[k]);
    sensors.push_back(all[k]);
  }
  family.compared.irradiance = chosen_rows(readings.irradiance, chosen);
  if (options.relative_bar) {
    const Spectrum mean = family.compared.irradiance.colwise().mean();
    family.compared.bar =
        *options.relative_bar * family.compared.irradiance.max(mean.replicate(family.compared.irradiance.rows(), 1));
  } else {
    family.compared.bar = chosen_rows(readings.standard_error, chosen);
  }
  tracer.options.paths = paths_each(options, 4, sensors.size());
  family.compared.paths = tracer.trace(std::span<const Sensor>(sensors));
  family.part = verify_part("sensors", family.compared, all_rows(family.compared));
  return family;
}

// Bars on all patches of a region, as a share of its light, worst band.
double width_of_all(const Region& region, const Simulation& simulation, const FieldView& bars) {
  const Eigen::VectorXd area = simulation.problem.area.cwiseProduct(region.holds.matrix());
  return largest(ratio(area_norm(bars, area), area_norm(simulation.solution.irradiance, area)));
}

Verification compared(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                      const std::vector<Region>& regions, const std::vector<PatchIndex>& patches,
                      const VerifyOptions& options, std::uint64_t seed_of_paths, const Observer& observer) {
  const bool follows_reflections = reflections_of(simulation.plan) == Reflections::followed;
  const Tracer tracer{scene,
                      simulation,
                      scene_for_sensors(std::make_shared<const Scene>(scene), simulation.plan),
                      {.paths = options.paths, .seed = seed_of_paths, .follows_reflections = follows_reflections},
                      observer};
  Verification result;
  result.patches = patches;
  result.irradiance = chosen_rows(simulation.solution.irradiance, patches);
  result.bar = chosen_rows(bar, patches);
  const std::vector<PathReceiver> receivers = receivers_of(simulation.mesh, patches);
  result.paths = tracer.trace(std::span<const PathReceiver>(receivers));
  for (const Region& region : regions) {
    std::vector<Eigen::Index> rows;
    for (std::size_t k = 0; k < patches.size(); ++k)
      if (region.holds[patches[k]] != 0) rows.push_back(static_cast<Eigen::Index>(k));
    result.parts.push_back(verify_part(region.name, result, std::move(rows)));
    result.parts.back().width = std::max(result.parts.back().width, width_of_all(region, simulation, bar));
  }
  if (auto rooms = verify_rooms(tracer, bar, options)) result.families.push_back(std::move(*rooms));
  if (auto sensors = verify_sensors(tracer, options)) result.families.push_back(std::move(*sensors));
  const Spectrum mean = result.paths.irradiance.colwise().mean();
  result.left_out = trace_left_out(*tracer.scene, simulation.plan.sides, mean, options, follows_reflections, observer);
  return judged(std::move(result));
}

// With so many paths a comparison is not made again.
constexpr std::uint32_t enough_paths = 8192;

// Few paths meet light that comes by a door left ajar: most batches miss it, and their scatter underestimates the
// noise. True if most of chi-square comes from rows whose paths scatter by a fifth of their bars or more.
bool is_by_noise(const Verification& verification) {
  if (!(verification.probability < least_probability)) return false;
  double noisy = 0;
  double all = 0;
  const auto add = [&](const SolvedAndTraced& compared) {
    const Field squares = deviations(compared).square();
    const bool has_enough = compared.paths.paths >= enough_paths;
    noisy += has_enough ? 0 : (compared.paths.standard_error > 0.2 * compared.bar).select(squares, 0).sum();
    all += squares.sum();
  };
  add(verification);
  for (const VerifiedFamily& family : verification.families) add(family.compared);
  return noisy > all / 2;
}

VerifyOptions with_more_paths(VerifyOptions options) {
  options.paths = std::max(16 * options.paths, enough_paths);
  return options;
}

}  // namespace

Eigen::ArrayXd ratio(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b) { return (a == 0).select(a, a / b); }

VerifiedPart verify_part(const std::string& name, const SolvedAndTraced& compared, std::vector<Eigen::Index> rows) {
  VerifiedPart part;
  part.name = name;
  part.rows = std::move(rows);
  const Field solved = rows_at(compared.irradiance, part.rows);
  const Field traced = rows_at(compared.paths.irradiance, part.rows);
  const Field bar = rows_at(compared.bar, part.rows);
  const Field variance = rows_at(variance_of(compared.paths), part.rows);
  part.dark = (solved == 0 && traced == 0).cast<double>().colwise().sum().transpose();
  part.chi_square = sum_over_patches(rows_at(deviations(compared), part.rows).square());

  // The common offset. Bars are correlated by an unknown amount: assume all of it.
  const Eigen::ArrayXd difference = sum_over_patches(solved - traced);
  part.mean_difference = ratio(difference, sum_over_patches(traced));
  part.offset = ratio(difference, (sum_over_patches(variance) + sum_over_patches(bar).square()).sqrt());

  // The typical error. The noise of the paths adds its squares to those of the differences.
  const Eigen::ArrayXd noise = sum_over_patches(rows_at(compared.paths.standard_error, part.rows).square());
  const Eigen::ArrayXd light = (sum_over_patches(traced.square()) - noise).max(0.0);
  part.error = ratio((sum_over_patches((solved - traced).square()) - noise).max(0.0), light).sqrt();
  part.noise = ratio(noise, light).sqrt();

  const Eigen::ArrayXd of_bars = ratio(sum_over_patches(bar.square()).sqrt(), sum_over_patches(traced.square()).sqrt());
  const Eigen::ArrayXd of_noise = ratio(sum_over_patches(variance).sqrt(), sum_over_patches(traced));
  part.width = largest(of_bars.max(of_noise));
  return part;
}

Field deviations(const SolvedAndTraced& compared) {
  const Field noise = variance_of(compared.paths);
  const Field difference = compared.irradiance - compared.paths.irradiance;
  const Field none = Field::Zero(difference.rows(), difference.cols());
  return (difference == 0).select(none, difference / (noise + compared.bar.square()).sqrt());
}

Field deviations_by_noise(const SolvedAndTraced& compared) {
  const Field& noise = compared.paths.standard_error;
  const Field unknown = Field::Constant(noise.rows(), noise.cols(), std::numeric_limits<double>::quiet_NaN());
  const Field rounded = (noise.square() + (rounding * compared.paths.irradiance).square()).sqrt();
  return (noise > 0).select((compared.irradiance - compared.paths.irradiance) / rounded, unknown);
}

const char* name_of(Verdict verdict) {
  return std::array{"agrees", "disagrees", "inconclusive"}.at(static_cast<std::size_t>(verdict));
}

Field irradiance_bar(const Simulation& simulation, double relative) {
  const Solution& solution = simulation.solution;
  const Eigen::VectorXd& area = simulation.problem.area;
  const Spectrum mean = area_sum(solution.irradiance, area).transpose() / total(area);
  Field bar = relative * solution.irradiance.max(mean.replicate(solution.irradiance.rows(), 1));
  if (solution.error.size() == 0) return bar;
  return bar + irradiance_errors(simulation.problem.scattering, solution.error);
}

Verification verify(const Scene& scene, const Simulation& simulation, const FieldView& bar,
                    const VerifyOptions& options, const Observer& observer) {
  assert(bar.rows() == simulation.mesh.size());
  const std::vector<Region> regions = regions_of(scene, simulation);
  const std::vector<PatchIndex> patches = draw_patches(simulation, regions, options);
  Verification first = compared(scene, simulation, bar, regions, patches, options, options.seed, observer);
  if (!is_by_noise(first)) return first;
  // Again on the same patches, rooms and sensors, with other paths.
  Verification again = compared(scene, simulation, bar, regions, patches, with_more_paths(options),
                                hash({options.seed, stream::repeated_comparison}), observer);
  again.first_paths = first.paths.paths;
  return again;
}

}  // namespace patchlight
