#include "patchlight/annual/annual.h"

#include "patchlight/base/error.h"
#include "patchlight/transport/lost_share.h"

#include "annual/adjoint_light.h"
#include "annual/seen_patches.h"
#include "annual/sun_year.h"
#include "annual/year_scene.h"
#include "base/parallel.h"
#include "base/tolerances.h"
#include "gather/sensor_places.h"
#include "lighting/mirror_paths.h"
#include "pipeline/run.h"
#include "pipeline/world.h"
#include "plan/choose_storage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// Sensors whose columns are solved together.
constexpr std::size_t sensors_at_once = 32;

// A year with all that its light does straight.
struct StraightLight {
  SkyDivisions divisions;
  SunsOfYear suns;
  std::vector<SparseCoefficients> sky_on_patches;  // per band
  std::vector<SparseSunlight> sun_on_patches;      // per band
};

// What the sensors get, summed up by the weights of the bands: per division of the sky (column) by luminance 1, and
// from each sun (column), as a share of its normal illuminance.
struct AtSensors {
  Eigen::MatrixXf by_sky, by_sun_straight, by_sun_reflected;
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

std::vector<SurfacePoint> points_of(const std::vector<Sensor>& sensors) {
  std::vector<SurfacePoint> points;
  for (const Sensor& sensor : sensors) points.push_back({sensor.point, sensor.normal});
  return points;
}

// The share of each patch's geometric area that holds light from all directions alike: g of radiosities of the
// geometric area is this share times g of those of the solved transport.
Eigen::ArrayXd solved_share(const Simulation& simulation, const SolvedTransport& solved) {
  const Eigen::ArrayXd geometric = simulation.problem.area.array();
  return (geometric > 0).select(solved.area.array() / geometric, 0.0);
}

// The columns of one block, for the bands of one transport.
struct Block {
  std::size_t begin, end;  // sensors
};

// Adds what the light on patches sends to the sensors of a block by all reflections.
void add_reflected(const Field& weights, const std::vector<Eigen::Index>& bands, const YearScene& year,
                   const StraightLight& light, Block block, AtSensors& at) {
  const auto count = static_cast<Eigen::Index>(block.end - block.begin);
  const auto own = static_cast<Eigen::Index>(bands.size());
  using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (Eigen::Index b = 0; b < own; ++b) {
    const auto band = static_cast<std::size_t>(bands[static_cast<std::size_t>(b)]);
    Weights of_band(weights.rows(), count);
    for (Eigen::Index k = 0; k < count; ++k) of_band.col(k) = weights.col(k * own + b).cast<float>().matrix();
    const auto of_sky = static_cast<float>(year.scene.bands[band].luminous_weight);
    const auto of_sun = static_cast<float>(year.sun_weights[band]);
    const Weights scaled = of_sky * of_band;
    // D^T = H^T W^T, row by row of H.
    const SparseCoefficients& H = light.sky_on_patches[band];
    Weights by_division = Weights::Zero(H.cols(), count);
    for (Eigen::Index patch = 0; patch < H.rows(); ++patch)
      for (SparseCoefficients::InnerIterator entry(H, patch); entry; ++entry)
        by_division.row(entry.col()) += entry.value() * scaled.row(patch);
    at.by_sky.middleRows(static_cast<Eigen::Index>(block.begin), count) += by_division.transpose();
    // All suns, many at once.
    const SparseSunlight& S = light.sun_on_patches[band];
    constexpr Eigen::Index at_once = 256;
    parallel_for(static_cast<std::size_t>((S.rows() + at_once - 1) / at_once), [&](std::size_t task) {
      const Eigen::Index first = static_cast<Eigen::Index>(task) * at_once;
      for (Eigen::Index sun = first; sun < std::min(S.rows(), first + at_once); ++sun) {
        Eigen::RowVectorXf sum = Eigen::RowVectorXf::Zero(count);
        for (SparseSunlight::InnerIterator entry(S, sun); entry; ++entry) sum += entry.value() * of_band.row(entry.col());
        at.by_sun_reflected.col(sun).segment(static_cast<Eigen::Index>(block.begin), count) += of_sun * sum.transpose();
      }
    });
  }
}

// Adds the light that patches reflect to the sensors, block by block.
void add_all_reflected(const Simulation& simulation, const YearScene& year, const StraightLight& light,
                       const std::vector<Sensor>& sensors, const AnnualOptions& options, const Observer& observer,
                       AtSensors& at) {
  const World& world = *simulation.world;
  const Lighting& lighting = world.sensor_lighting();
  const Occluder& occluder = world.all_faces();
  const Eigen::Index bands = number_of_bands(year.scene);
  const HemisphereRays hemisphere(simulation.mesh, occluder, *lighting.paths.optics(), bands,
                                  simulation.plan.assembly.seed, lighting.mirrors ? &lighting.mirrors->aim : nullptr);
  const auto each = static_cast<std::uint32_t>(options.rays / most_replicates);
  const double tolerance = tolerance_of_shapes / occluder.frame().scale;
  const Eigen::ArrayXd factor = over_exposed_part(simulation.mesh, simulation.transport.lost, simulation.problem.area);
  const std::vector<PatchPlane> planes = planes_of(simulation.mesh, occluder, observer);
  std::vector<AdjointLight> adjoints;
  for (const SolvedTransport& solved : simulation.transports) adjoints.emplace_back(solved);
  for (std::size_t begin = 0; begin < sensors.size(); begin += sensors_at_once) {
    const Block block{begin, std::min(sensors.size(), begin + sensors_at_once)};
    if (observer && !observer({.stage = Stage::solve, .fraction = static_cast<double>(begin) / static_cast<double>(sensors.size())})) throw Canceled();
    const Field seen = seen_patches(hemisphere, simulation.mesh, planes, std::span(sensors).subspan(begin, block.end - begin),
                                    bands, each, tolerance);
    for (std::size_t t = 0; t < adjoints.size(); ++t) {
      const SolvedTransport& solved = simulation.transports[t];
      std::vector<Eigen::Index> columns, own;
      for (std::size_t k = 0; k < block.end - begin; ++k)
        for (std::size_t b = 0; b < solved.bands.size(); ++b) {
          columns.push_back(static_cast<Eigen::Index>(k) * bands + solved.bands[b]);
          own.push_back(static_cast<Eigen::Index>(b));
        }
      Field of_colour = seen(Eigen::all, columns);
      of_colour.colwise() *= solved_share(simulation, solved);
      Field weights = adjoints[t].weights(of_colour, own, options.tolerance);
      weights.colwise() *= factor;
      add_reflected(weights, solved.bands, year, light, block, at);
    }
  }
}

void require_memory_for(const Scene& scene, const Request& request, const Year& year, const AnnualOptions& options) {
  const double sensors = static_cast<double>(all_sensors(scene.sensors).size());
  const double hours = static_cast<double>(year.hours.size());
  const double divisions = 144.0 * options.sky_division * options.sky_division + 2;
  // Two results and three parts of them for half of the hours, coefficients of sensors, and the sky.
  const double bytes = 4 * (3.5 * sensors * hours + 2 * sensors * divisions + hours * divisions);
  if (bytes > usable_memory(request.resources))
    throw MemoryError("a year at " + std::to_string(static_cast<std::size_t>(sensors)) + " sensors " +
                      memory_refused(bytes, request.resources) + "\nhint: fewer sensors, or --sky-division 1");
}

HourlyValues no_light(const Year& year, std::size_t sensors) {
  return HourlyValues::Zero(static_cast<Eigen::Index>(year.hours.size()), static_cast<Eigen::Index>(sensors));
}

}  // namespace

AnnualLight simulate_year(std::shared_ptr<const Scene> read, const Year& year, const Request& request,
                          const AnnualOptions& options, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  require_memory_for(*read, request, year, options);
  AnnualLight result;

  // 1. Solve the scene under a reference sky: mesh, form factors, materials, and the errors of all that.
  const YearScene of_year = scene_of_year(*read, year);
  const Simulation simulation = simulate(std::make_shared<const Scene>(of_year.scene), request, observer,
                                         {.keeps_transport = true});
  result.costs = simulation.costs;
  result.notes = merged({simulation.plan.notes, simulation.notes});
  result.patches = simulation.mesh.size();
  StageClock clock;
  const SensorView reference = read_sensors(simulation, observer);
  clock.finish(Stage::gather);

  // 2. Straight light on patches and at sensors: of all divisions of the sky, and of all suns.
  const World& world = *simulation.world;
  const FreeSensors free = free_sensors(simulation);
  const std::vector<SurfacePoint> points = points_of(free.sensors);
  const Scene& scene = of_year.scene;
  const SkyCoefficientOptions sampling{options.sky_samples, simulation.plan.assembly.seed};
  StraightLight light{SkyDivisions(options.sky_division, scene.up, scene.north), suns_of(year, *read), {}, {}};
  light.sky_on_patches = sky_coefficients(world.lighting(), simulation.mesh, light.divisions, sampling, observer);
  const auto count = static_cast<Eigen::Index>(points.size());
  const auto suns = static_cast<Eigen::Index>(light.suns.hours.size());
  AtSensors at{Eigen::MatrixXf::Zero(count, static_cast<Eigen::Index>(light.divisions.size())),
               Eigen::MatrixXf::Zero(count, suns), Eigen::MatrixXf::Zero(count, suns)};
  const auto sky_at_sensors = sky_coefficients(world.sensor_lighting(), points, light.divisions, sampling, observer);
  for (std::size_t band = 0; band < sky_at_sensors.size(); ++band)
    at.by_sky += static_cast<float>(scene.bands[band].luminous_weight) * Eigen::MatrixXf(sky_at_sensors[band]);
  clock.finish(Stage::direct_light);
  const auto sun_at_sensors = sunlight_at({world.sensor_lighting(), world.sensor_scene(), world.tracing()}, points, light.suns.directions, observer);
  for (std::size_t band = 0; band < sun_at_sensors.size(); ++band)
    at.by_sun_straight += static_cast<float>(of_year.sun_weights[band]) * sun_at_sensors[band].transpose();
  light.sun_on_patches =
      sunlight_on({world.lighting(), world.planned_scene(), world.tracing()}, simulation.mesh, light.sky_on_patches[0],
                  light.divisions, light.suns.directions, sampling.seed, observer);
  clock.finish(Stage::trace_paths);

  // 3. All reflections of both.
  add_all_reflected(simulation, of_year, light, free.sensors, options, observer, at);
  clock.finish(Stage::solve);

  // 4. Hour by hour.
  const std::size_t all = all_sensors(scene.sensors).size();
  result.illuminance = no_light(year, all);
  result.sunlight = no_light(year, all);
  const SkiesOfYear skies = skies_of(year, *read, light.divisions, observer);
  const Eigen::MatrixXf by_skies = at.by_sky * skies.luminance;
  for (std::size_t k = 0; k < skies.hours.size(); ++k)
    for (Eigen::Index i = 0; i < count; ++i)
      result.illuminance(static_cast<Eigen::Index>(skies.hours[k]), free.numbers[static_cast<std::size_t>(i)]) =
          by_skies(i, static_cast<Eigen::Index>(k));
  for (Eigen::Index k = 0; k < suns; ++k) {
    const auto hour = static_cast<Eigen::Index>(light.suns.hours[static_cast<std::size_t>(k)]);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index sensor = free.numbers[static_cast<std::size_t>(i)];
      result.sunlight(hour, sensor) = light.suns.illuminance[k] * at.by_sun_straight(i, k);
      result.illuminance(hour, sensor) +=
          light.suns.illuminance[k] * (at.by_sun_straight(i, k) + at.by_sun_reflected(i, k));
    }
  }
  result.sun_hours = light.suns.hours.size();
  result.sky_hours = skies.hours.size();

  // 5. The reference sky by both ways.
  const double ground = year.ground_reflectance / 3.14159265358979 * reference_illuminance;
  const Eigen::VectorXf factors =
      at.by_sky * luminances_of(*scene.sky, reference_illuminance, ground, light.divisions, scene.up);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  result.daylight_factor = result.solved_daylight_factor = result.relative_error =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(all), nan);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index sensor = free.numbers[static_cast<std::size_t>(i)];
    const SensorValue value = sensor_value(reference.readings, static_cast<std::size_t>(sensor));
    result.daylight_factor[sensor] = 100 * static_cast<double>(factors[i]) / reference_illuminance;
    result.solved_daylight_factor[sensor] = 100 * value.value / reference_illuminance;
    result.relative_error[sensor] = value.value > 0 ? value.standard_error / value.value : 0;
  }
  for (std::size_t k = 0, next = 0; k < all; ++k) {
    if (next < free.numbers.size() && free.numbers[next] == static_cast<Eigen::Index>(k)) {
      ++next;
      continue;
    }
    result.illuminance.col(static_cast<Eigen::Index>(k)).setConstant(std::numeric_limits<float>::quiet_NaN());
    result.sunlight.col(static_cast<Eigen::Index>(k)).setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  clock.finish(Stage::gather);
  result.costs.insert(result.costs.end(), clock.costs().begin(), clock.costs().end());
  return result;
}

}  // namespace patchlight
