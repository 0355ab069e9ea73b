#include "patchlight/annual/annual.h"
#include "patchlight/base/error.h"
#include "patchlight/transport/lost_share.h"

#include "annual/adjoint_light.h"
#include "annual/sun_year.h"
#include "annual/year_scene.h"
#include "base/parallel.h"
#include "base/tolerances.h"
#include "gather/planes.h"
#include "gather/sensor_places.h"
#include "gather/sources.h"
#include "lighting/mirror_paths.h"
#include "pipeline/world.h"
#include "plan/choose_storage.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// How the radiosity at a point of a patch follows from that of the patches around: B_j + d . sum_i a_i (B_i - B_j), d
// the way from the centroid. Geometry alone decides it, so that readings are linear in radiosity.
struct PatchPlane {
  std::vector<PatchIndex> around;
  Eigen::Matrix3Xd slopes;  // a_i, 1/m
};

// Those of all patches; patches between which something stands do not count. Throws Canceled.
std::vector<PatchPlane> planes_of(const PatchMesh& mesh, const Occluder& occluder, const Observer& observer) {
  const PlaneFits fits(mesh, occluder);
  std::vector<PatchPlane> planes(mesh.size());
  parallel_for(mesh.size(), Stage::gather, observer, [&](std::size_t k) {
    const auto j = static_cast<PatchIndex>(k);
    planes[k].around = fits.in_sight(j, fits.patches_around(j));
    planes[k].slopes = fits.slopes(j, planes[k].around);
  });
  return planes;
}

// How sensors look at patches.
struct SeenBy {
  HemisphereRays hemisphere;
  const PatchMesh& mesh;
  std::vector<PatchPlane> planes;
  Eigen::Index bands = 1;
  double tolerance = 0;  // a sensor nearer to the plane of a patch lies in it, m
};

// The irradiance at each sensor by a radiosity of 1 on each patch, straight or through panes and mirrors: a row for
// each patch, for each sensor one column after the other for its bands. `each` rays in each of most_replicates.
Field seen_patches(const SeenBy& by, std::span<const Sensor> sensors, std::uint32_t each) {
  const PatchMesh& mesh = by.mesh;
  Field seen = Field::Zero(mesh.size(), static_cast<Eigen::Index>(sensors.size()) * by.bands);
  parallel_for(sensors.size(), [&](std::size_t k) {
    const Sensor& sensor = sensors[k];
    const auto first = static_cast<Eigen::Index>(k) * by.bands;
    const auto add = [&](PatchIndex j, const Spectrum& weight) { seen.row(j).segment(first, by.bands) += weight; };
    for (const HemisphereHit& hit : by.hemisphere.hits(sensor, each, 0).all) {
      // A sensor on a face does not see the patches of that face.
      const double height = mesh.normal[hit.patch].dot(sensor.point - mesh.centroid[hit.patch]);
      if (!hit.is_mirrored && height <= by.tolerance) continue;
      add(hit.patch, hit.weight);
      const PatchPlane& plane = by.planes[hit.patch];
      const Vector way = hit.point - mesh.centroid[hit.patch];
      for (std::size_t n = 0; n < plane.around.size(); ++n) {
        const double share = way.dot(plane.slopes.col(static_cast<Eigen::Index>(n)));
        add(plane.around[n], share * hit.weight);
        add(hit.patch, -share * hit.weight);
      }
    }
  });
  return seen;
}

// Sensors whose columns are solved together.
constexpr std::size_t sensors_at_once = 32;

// The light of a year on patches, before any reflection between them: a matrix for each band.
struct LightOnPatches {
  std::vector<SparseCoefficients> sky;
  std::vector<SparseSunlight> sun;
};

// The light at the sensors, summed up by the weights of the bands: per division of the sky (column) by luminance 1, and
// from each sun (column), as a share of its normal illuminance.
struct LightAtSensors {
  Eigen::MatrixXf by_sky, by_sun_straight, by_sun_reflected;
  bool converged = true;  // all adjoint solutions
};

// All that the steps share.
struct RunOfYear {
  const YearScene& year;
  const Simulation& simulation;
  const AnnualOptions& options;
  const Observer& observer;
  SkyDivisions divisions;
  SunsOfYear suns;

  const World& world() const { return *simulation.world; }
  std::uint64_t seed() const { return simulation.plan.assembly.seed; }
  SkyCoefficientOptions sampling() const { return {options.sky_samples, seed()}; }
  float sky_weight(std::size_t band) const { return static_cast<float>(year.scene.bands[band].luminous_weight); }
  float sun_weight(std::size_t band) const { return static_cast<float>(year.sun_weights[band]); }
};

// The sensors that are not inside walls, with their numbers among all.
struct FreeSensors {
  std::vector<Sensor> sensors;
  std::vector<Eigen::Index> numbers;
};

FreeSensors free_sensors(const Simulation& simulation) {
  const Scene& scene = simulation.world->scene();
  const std::vector<SensorPlace> places =
      place_sensors(scene, scene.sensors, simulation.plan.sides, simulation.world->all_faces());
  FreeSensors found;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (places[k].standing == Standing::inside_wall) continue;
    found.sensors.push_back(places[k].sensor);
    found.numbers.push_back(static_cast<Eigen::Index>(k));
  }
  return found;
}

// The share of each patch's geometric area that holds light from all directions alike: g of radiosities of the solved
// transport is this share times g of those of the geometric area.
Eigen::ArrayXd solved_share(const Simulation& simulation, const SolvedTransport& solved) {
  const Eigen::ArrayXd geometric = simulation.problem.area.array();
  return (geometric > 0).select(solved.area.array() / geometric, 0.0);
}

// Sensors whose columns are solved together.
struct Block {
  std::size_t begin = 0, end = 0;

  std::size_t size() const { return end - begin; }
};

using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// sum_j W_ij H_jd of the sensors of a block, row by row of H.
void add_reflected_sky(const Weights& weights, const SparseCoefficients& H, Block block, LightAtSensors& at) {
  Weights by_division = Weights::Zero(H.cols(), weights.cols());
  for (Eigen::Index patch = 0; patch < H.rows(); ++patch)
    for (SparseCoefficients::InnerIterator entry(H, patch); entry; ++entry)
      by_division.row(entry.col()) += entry.value() * weights.row(patch);
  at.by_sky.middleRows(static_cast<Eigen::Index>(block.begin), weights.cols()) += by_division.transpose();
}

// sum_j W_ij H_sun,j of all suns.
void add_reflected_sun(const Weights& weights, const SparseSunlight& H, Block block, LightAtSensors& at) {
  constexpr Eigen::Index at_once = 256;
  const auto first_sensor = static_cast<Eigen::Index>(block.begin);
  parallel_for(static_cast<std::size_t>((H.rows() + at_once - 1) / at_once), [&](std::size_t task) {
    const Eigen::Index first = static_cast<Eigen::Index>(task) * at_once;
    for (Eigen::Index sun = first; sun < std::min(H.rows(), first + at_once); ++sun) {
      Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(weights.cols());
      for (SparseSunlight::InnerIterator entry(H, sun); entry; ++entry) sum += entry.value() * weights.row(entry.col());
      at.by_sun_reflected.col(sun).segment(first_sensor, weights.cols()) += sum.transpose();
    }
  });
}

// The columns of `seen` for the bands of a transport, sensor by sensor, and the band of each within them.
struct ColumnsOfColor {
  std::vector<Eigen::Index> columns, bands;
};

ColumnsOfColor columns_of(const SolvedTransport& solved, std::size_t sensors, Eigen::Index bands) {
  ColumnsOfColor found;
  for (std::size_t k = 0; k < sensors; ++k)
    for (std::size_t b = 0; b < solved.bands.size(); ++b) {
      found.columns.push_back(static_cast<Eigen::Index>(k) * bands + solved.bands[b]);
      found.bands.push_back(static_cast<Eigen::Index>(b));
    }
  return found;
}

// Adds the light that patches reflect to the sensors of a block in the bands of one transport. `seen` is that of
// seen_patches(), `exposed` the factor from the mean over a patch to that over its exposed part.
void add_reflected(const RunOfYear& run, const SolvedTransport& solved, const AdjointLight& adjoint, const Field& seen,
                   const Eigen::ArrayXd& exposed, const LightOnPatches& light, Block block, LightAtSensors& at) {
  const auto own = static_cast<Eigen::Index>(solved.bands.size());
  const auto [columns, bands] = columns_of(solved, block.size(), number_of_bands(run.year.scene));
  Field of_color = seen(Eigen::all, columns);
  of_color.colwise() *= solved_share(run.simulation, solved);
  auto [weights, converged] = adjoint.weights(of_color, bands, run.options.tolerance);
  at.converged = at.converged && converged;
  weights.colwise() *= exposed;
  for (Eigen::Index b = 0; b < own; ++b) {
    const auto band = static_cast<std::size_t>(solved.bands[static_cast<std::size_t>(b)]);
    Weights of_band(weights.rows(), static_cast<Eigen::Index>(block.size()));
    for (Eigen::Index k = 0; k < of_band.cols(); ++k) of_band.col(k) = weights.col(k * own + b).cast<float>().matrix();
    add_reflected_sky(run.sky_weight(band) * of_band, light.sky[band], block, at);
    add_reflected_sun(run.sun_weight(band) * of_band, light.sun[band], block, at);
  }
}

// How the sensors of a run see its patches.
class LookOfSensors {
 public:
  explicit LookOfSensors(const RunOfYear& run)
      : lighting_(run.world().sensor_lighting()),
        by_{HemisphereRays(run.simulation.mesh, run.world().all_faces(), *lighting_.paths.optics(),
                           number_of_bands(run.year.scene), run.seed(),
                           lighting_.mirrors ? &lighting_.mirrors->aim : nullptr),
            run.simulation.mesh, planes_of(run.simulation.mesh, run.world().all_faces(), run.observer),
            number_of_bands(run.year.scene), tolerance_of_shapes / run.world().all_faces().frame().scale} {}

  // seen_patches() by about so many rays.
  Field seen(std::span<const Sensor> sensors, int rays) const {
    return seen_patches(by_, sensors, static_cast<std::uint32_t>(rays) / most_replicates);
  }

 private:
  const Lighting& lighting_;
  SeenBy by_;
};

// Calls use(block) for all sensors.
void for_blocks(const RunOfYear& run, std::size_t sensors, const std::function<void(Block)>& use) {
  for (std::size_t begin = 0; begin < sensors; begin += sensors_at_once) {
    const double done = static_cast<double>(begin) / static_cast<double>(sensors);
    if (run.observer && !run.observer({.stage = Stage::solve, .fraction = done})) throw Canceled();
    use({begin, std::min(sensors, begin + sensors_at_once)});
  }
}

// The light that all patches reflect to the sensors, block by block.
void add_all_reflected(const RunOfYear& run, const LookOfSensors& look, const LightOnPatches& light,
                       const std::vector<Sensor>& sensors, LightAtSensors& at) {
  const Simulation& simulation = run.simulation;
  const Eigen::ArrayXd exposed = over_exposed_part(simulation.mesh, simulation.transport.lost, simulation.problem.area);
  std::vector<AdjointLight> adjoints;
  for (const SolvedTransport& solved : simulation.transports) adjoints.emplace_back(solved);
  for_blocks(run, sensors.size(), [&](Block block) {
    const Field seen = look.seen(std::span(sensors).subspan(block.begin, block.size()), run.options.rays);
    for (std::size_t t = 0; t < adjoints.size(); ++t)
      add_reflected(run, simulation.transports[t], adjoints[t], seen, exposed, light, block, at);
  });
}

// The patches whose sunlight takes its exact share, 1 for each. The sum over all sensors of what light on a patch adds,
// relative to their own light, follows from one adjoint solution. A patch that one ray finds all lit or all dark is off
// by up to half of its sunlight. In the square root of the sum of squares the others may be off by a thousandth of the
// mean sensor.
std::vector<std::uint8_t> important_patches(const RunOfYear& run, const LookOfSensors& look, const FreeSensors& free,
                                            const Readings& reference) {
  constexpr int few_rays = 512;
  constexpr double brightest_sun = 100'000, allowed = 1e-3;
  const Simulation& simulation = run.simulation;
  const Eigen::Index bands = number_of_bands(run.year.scene);
  Field seen = Field::Zero(simulation.mesh.size(), bands);
  for_blocks(run, free.sensors.size(), [&](Block block) {
    const Field of_block = look.seen(std::span(free.sensors).subspan(block.begin, block.size()), few_rays);
    for (std::size_t k = 0; k < block.size(); ++k) {
      const auto number = static_cast<std::size_t>(free.numbers[block.begin + k]);
      const double own = std::max(1.0, sensor_value(reference, number).value);
      seen += of_block.middleCols(static_cast<Eigen::Index>(k) * bands, bands) / own;
    }
  });
  Eigen::ArrayXd importance = Eigen::ArrayXd::Zero(simulation.mesh.size());
  for (const SolvedTransport& solved : simulation.transports) {
    std::vector<Eigen::Index> own(solved.bands.size());
    std::iota(own.begin(), own.end(), Eigen::Index{0});
    Field of_color = seen(Eigen::all, solved.bands);
    of_color.colwise() *= solved_share(simulation, solved);
    const Field weights = AdjointLight(solved).weights(of_color, own, 0.01).values;
    for (const Eigen::Index b : own)
      importance +=
          static_cast<double>(run.sun_weight(static_cast<std::size_t>(solved.bands[static_cast<std::size_t>(b)]))) *
          weights.col(b).max(0.0);
  }
  std::vector<std::size_t> order(simulation.mesh.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return importance[static_cast<Eigen::Index>(a)] < importance[static_cast<Eigen::Index>(b)];
  });
  std::vector<std::uint8_t> is_important(order.size(), 1);
  double squares = 0;
  const double limit = std::pow(allowed * static_cast<double>(free.sensors.size()), 2);
  for (const std::size_t patch : order) {
    squares += std::pow(0.5 * brightest_sun * importance[static_cast<Eigen::Index>(patch)], 2);
    if (squares > limit) break;
    is_important[patch] = 0;
  }
  return is_important;
}

LightOnPatches light_on_patches(const RunOfYear& run, std::span<const std::uint8_t> is_important) {
  const World& world = run.world();
  LightOnPatches light;
  light.sky = sky_coefficients(world.lighting(), run.simulation.mesh, run.divisions, run.sampling(), run.observer);
  light.sun = sunlight_on({world.lighting(), world.planned_scene(), world.tracing()}, run.simulation.mesh, light.sky[0],
                          run.divisions, run.suns.directions, {is_important, run.seed()}, run.observer);
  return light;
}

// The light of sky and suns that gets to the sensors without reflections between patches.
LightAtSensors straight_light(const RunOfYear& run, const std::vector<Sensor>& sensors) {
  const World& world = run.world();
  std::vector<SurfacePoint> points;
  for (const Sensor& sensor : sensors) points.push_back({sensor.point, sensor.normal});
  const auto count = static_cast<Eigen::Index>(points.size());
  const auto suns = static_cast<Eigen::Index>(run.suns.hours.size());
  LightAtSensors at{Eigen::MatrixXf::Zero(count, static_cast<Eigen::Index>(run.divisions.size())),
                    Eigen::MatrixXf::Zero(count, suns), Eigen::MatrixXf::Zero(count, suns)};
  const auto by_sky = sky_coefficients(world.sensor_lighting(), points, run.divisions, run.sampling(), run.observer);
  for (std::size_t band = 0; band < by_sky.size(); ++band)
    at.by_sky += run.sky_weight(band) * Eigen::MatrixXf(by_sky[band]);
  const auto by_sun = sunlight_at({world.sensor_lighting(), world.sensor_scene(), world.tracing()}, points,
                                  run.suns.directions, run.observer);
  for (std::size_t band = 0; band < by_sun.size(); ++band)
    at.by_sun_straight += run.sun_weight(band) * by_sun[band].transpose();
  return at;
}

void check(const AnnualOptions& options) {
  const int f = options.sky_division;
  if (f != 1 && f != 2 && f != 4) throw InputError("options.sky_division", std::to_string(f) + ": expected 1, 2 or 4");
  if (options.rays < static_cast<int>(most_replicates) || options.sky_samples < 1)
    throw InputError("options.rays",
                     "expected at least " + std::to_string(most_replicates) + " rays and one sample of the sky");
}

void require_memory_for(const Scene& scene, const Request& request, const Year& year, const AnnualOptions& options) {
  const auto sensors = static_cast<double>(all_sensors(scene.sensors).size());
  const auto hours = static_cast<double>(year.hours.size());
  const SkyDivisions sky(options.sky_division, scene.up, scene.north);
  const auto divisions = static_cast<double>(sky.size());
  // Two results and three parts of them for half of the hours, coefficients of sensors, and the sky.
  const double bytes = 4 * (3.5 * sensors * hours + 2 * sensors * divisions + hours * divisions);
  if (bytes > usable_memory(request.resources))
    throw MemoryError("a year at " + std::to_string(static_cast<std::size_t>(sensors)) + " sensors " +
                      memory_refused(bytes, request.resources) + "\nhint: fewer sensors, or --sky-division 1");
}

// Illuminances hour by hour; not numbers at sensors inside walls.
void put_hours(const SunsOfYear& suns, const SkiesOfYear& skies, const LightAtSensors& at, const FreeSensors& free,
               AnnualLight& result) {
  const auto put = [&](Eigen::Index i, HourlyValues& values, std::size_t hour, float value) {
    values(static_cast<Eigen::Index>(hour), free.numbers[static_cast<std::size_t>(i)]) += value;
  };
  for (const Eigen::Index number : free.numbers) {
    result.illuminance.col(number).setZero();
    result.sunlight.col(number).setZero();
  }
  const Eigen::MatrixXf by_skies = at.by_sky * skies.luminance;
  for (Eigen::Index i = 0; i < at.by_sky.rows(); ++i) {
    for (std::size_t k = 0; k < skies.hours.size(); ++k)
      put(i, result.illuminance, skies.hours[k], by_skies(i, static_cast<Eigen::Index>(k)));
    for (std::size_t k = 0; k < suns.hours.size(); ++k) {
      const auto sun = static_cast<Eigen::Index>(k);
      const float straight = suns.illuminance[sun] * at.by_sun_straight(i, sun);
      put(i, result.sunlight, suns.hours[k], straight);
      put(i, result.illuminance, suns.hours[k], straight + suns.illuminance[sun] * at.by_sun_reflected(i, sun));
    }
  }
}

// The light of the reference sky by its divisions and as solved, and the errors of the latter.
void put_daylight_factors(const RunOfYear& run, double ground_reflectance, const LightAtSensors& at,
                          const FreeSensors& free, const Readings& reference, AnnualLight& result) {
  const Scene& scene = run.year.scene;
  const double ground = ground_reflectance / std::numbers::pi * reference_illuminance;
  const Eigen::VectorXf illuminance =
      at.by_sky * luminances_of(*scene.sky, reference_illuminance, ground, run.divisions, scene.up);
  for (Eigen::Index i = 0; i < illuminance.size(); ++i) {
    const Eigen::Index sensor = free.numbers[static_cast<std::size_t>(i)];
    const SensorValue solved = sensor_value(reference, static_cast<std::size_t>(sensor));
    result.daylight_factor[sensor] = 100 * static_cast<double>(illuminance[i]) / reference_illuminance;
    result.solved_daylight_factor[sensor] = 100 * solved.value / reference_illuminance;
    // Coefficients are estimated by rays of their own.
    const double difference = static_cast<double>(illuminance[i]) - solved.value;
    result.relative_error[sensor] = solved.value > 0 ? std::hypot(solved.standard_error, difference) / solved.value : 0;
  }
}

AnnualLight nothing_known(const Year& year, std::size_t sensors) {
  const auto count = static_cast<Eigen::Index>(sensors);
  const auto hours = static_cast<Eigen::Index>(year.hours.size());
  AnnualLight light;
  light.illuminance = light.sunlight = HourlyValues::Constant(hours, count, std::numeric_limits<float>::quiet_NaN());
  light.daylight_factor = light.solved_daylight_factor = light.relative_error =
      Eigen::VectorXd::Constant(count, std::numeric_limits<double>::quiet_NaN());
  return light;
}

// The costs of phases, one after the other.
class PhaseClock {
 public:
  explicit PhaseClock(AnnualLight& result) : result_(result) {}
  void finish(const char* phase) {
    result_.costs.push_back({phase, wall_seconds() - wall_, cpu_seconds() - cpu_});
    wall_ = wall_seconds();
    cpu_ = cpu_seconds();
  }

 private:
  AnnualLight& result_;
  double wall_ = wall_seconds();
  double cpu_ = cpu_seconds();
};

}  // namespace

AnnualLight simulate_year(const Scene& scene, const Year& year, const Request& request, const AnnualOptions& options,
                          const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  check(options);
  require_memory_for(scene, request, year, options);
  AnnualLight result = nothing_known(year, all_sensors(scene.sensors).size());
  PhaseClock clock(result);

  // 1. Solve the scene under a reference sky: mesh, form factors, materials, and the errors of all that.
  const YearScene of_year = scene_of_year(scene, year);
  const Simulation simulation =
      simulate(std::make_shared<const Scene>(of_year.scene), request, observer, {.keeps_transport = true});
  clock.finish("mesh and form factors");
  const SensorView reference = read_sensors(simulation, observer);
  clock.finish("sensors under an overcast sky");

  // 2. Straight light of all divisions of the sky and all suns at the sensors.
  const RunOfYear run{of_year,
                      simulation,
                      options,
                      observer,
                      SkyDivisions(options.sky_division, of_year.scene.up, of_year.scene.north),
                      suns_of(year, scene)};
  const FreeSensors free = free_sensors(simulation);
  LightAtSensors at = straight_light(run, free.sensors);
  clock.finish("sky and sun at sensors");

  // 3. The same on the patches, and all reflections of it. Without interreflection sensors see no light that patches
  //    have reflected, as in read_sensors().
  if (simulates(simulation.plan, Effect::interreflection)) {
    const LookOfSensors look(run);
    const std::vector<std::uint8_t> is_important = important_patches(run, look, free, reference.readings);
    clock.finish("importance of patches");
    const LightOnPatches light = light_on_patches(run, is_important);
    clock.finish("sky and sun on patches");
    add_all_reflected(run, look, light, free.sensors, at);
    clock.finish("reflections");
  }

  // 4. Hour by hour.
  const SkiesOfYear skies = skies_of(year, scene, run.divisions, observer);
  put_hours(run.suns, skies, at, free, result);
  put_daylight_factors(run, year.ground_reflectance, at, free, reference.readings, result);
  clock.finish("hours");
  result.converged = at.converged && simulation.solution.converged;
  const std::optional<double>& asked = simulation.plan.accuracy.relative_error;
  result.is_accurate = !asked || (!simulation.accuracy.empty() && simulation.accuracy.back().total <= *asked);
  result.patches = simulation.mesh.size();
  result.sun_hours = run.suns.hours.size();
  result.sky_hours = skies.hours.size();
  result.notes = simulation.notes;
  result.warnings = reference.warnings;
  return result;
}

}  // namespace patchlight
