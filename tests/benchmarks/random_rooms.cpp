// Rooms at random, solved by `patchlight solve` with its default settings, against path tracing: the table of
// docs/benchmarks/random_rooms.md.
// usage: benchmark_random_rooms [OPTION VALUE]... [-- OPTIONS OF patchlight solve]
//   --daylight N, --lamps N   rooms by daylight and by lamps [default: 60, 40]
//   --seed S                  seed of the rooms [default: 1]
//   --only TEXT               only rooms whose name contains the text, e.g. overhang_03
//   --paths P                 most paths per sensor; a pilot decides how many [default: 524288]
//   --probes N                patches per room whose error is compared with the stated total [default: 12]
//   --pixels N                instead compares sensors, pixels of final pictures and paths at N places per room, on its
//                             surfaces; every other room has colored panes, mirrors and sheets [default: 0, off]
//   --references FOLDER       keeps results of path tracing, so that later runs need not repeat it
//   --write FOLDER            writes the rooms in which a sensor or the total is outside its error bar
//   --markdown FILE           writes the table as a page
#include "support/random_rooms.h"

#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/vectors.h"
#include "cli/arguments.h"
#include "cli/solve_input.h"
#include "files/sha256.h"
#include "output/file/whole_file.h"
#include "pipeline/radiosity_errors.h"
#include "pipeline/world.h"
#include "random_room_pixels.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <variant>
#include <vector>

namespace patchlight {
namespace {

using std::filesystem::path;
using test::RandomRoom;

// Results are compared in the green band.
constexpr Eigen::Index band = 1;

// Number of paths of the pilot, and the relative standard error that determines the number of paths after it.
constexpr std::uint32_t pilot_paths = 2048;
constexpr double wanted_error = 0.006;

struct Options {
  std::size_t daylight = 60;
  std::size_t lamps = 40;
  std::uint64_t seed = 1;
  std::string only;
  std::uint32_t paths = 524288;
  std::size_t probes = 12;
  std::size_t pixels = 0;
  path references;
  path write;
  path markdown;
  std::vector<std::string> solve;  // options of `patchlight solve`
};

Options parse(int count, char** values) {
  Options options;
  for (int k = 1; k < count; k += 2) {
    const std::string name = values[k];
    if (name == "--") {
      options.solve.assign(values + k + 1, values + count);
      return options;
    }
    if (k + 1 == count) throw std::invalid_argument(name + ": value missing");
    const std::string value = values[k + 1];
    if (name == "--daylight")
      options.daylight = std::stoul(value);
    else if (name == "--lamps")
      options.lamps = std::stoul(value);
    else if (name == "--seed")
      options.seed = std::stoull(value);
    else if (name == "--only")
      options.only = value;
    else if (name == "--paths")
      options.paths = static_cast<std::uint32_t>(std::stoul(value));
    else if (name == "--probes")
      options.probes = std::stoul(value);
    else if (name == "--pixels")
      options.pixels = std::stoul(value);
    else if (name == "--references")
      options.references = value;
    else if (name == "--write")
      options.write = value;
    else if (name == "--markdown")
      options.markdown = value;
    else
      throw std::invalid_argument("unknown option " + name);
  }
  return options;
}

// The arguments that the tool itself derives from `patchlight solve FILE` and these options.
cli::SolveArguments tool_arguments(const path& scene_file, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"patchlight", "solve", scene_file.string(), "--points-output", "sensors.csv"};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<const char*> values;
  for (const std::string& word : words) values.push_back(word.c_str());
  return std::get<cli::SolveArguments>(cli::parse_arguments(static_cast<int>(values.size()), values.data()));
}

// Irradiance by path tracing, W/m^2.
struct Reference {
  double irradiance = 0;
  double standard_error = 0;
};

// References by place, kept in a file whose first line identifies the scene and the number of paths.
class ReferenceFile {
 public:
  ReferenceFile(path file, std::string identity) : file_(std::move(file)), identity_(std::move(identity)) {
    std::ifstream stream(file_);
    std::string line;
    if (file_.empty() || !std::getline(stream, line) || line != identity_) return;
    std::string place;
    for (Reference reference; stream >> place >> reference.irradiance >> reference.standard_error;)
      references_[place] = reference;
  }
  const Reference* find(const std::string& place) const {
    const auto found = references_.find(place);
    return found == references_.end() ? nullptr : &found->second;
  }
  void add(const std::string& place, const Reference& reference) { references_[place] = reference; }
  void save() const {
    if (file_.empty()) return;
    write_whole_file(file_, [&](const path& temporary) {
      std::ofstream stream(temporary);
      stream.precision(12);
      stream << identity_ << "\n";
      for (const auto& [place, reference] : references_)
        stream << place << " " << reference.irradiance << " " << reference.standard_error << "\n";
    });
  }

 private:
  path file_;
  std::string identity_;
  std::map<std::string, Reference> references_;
};

std::string text_of(const path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

ReferenceFile open_references(const path& scene_file, const Options& options) {
  if (options.references.empty()) return {{}, {}};
  std::filesystem::create_directories(options.references);
  std::vector<std::string> texts;
  for (const char* extension : {".toml", ".obj", ".mtl"})
    texts.push_back(text_of(path(scene_file).replace_extension(extension)));
  const std::string name = scene_file.stem().string() + "_seed" + std::to_string(options.seed) + ".txt";
  return {options.references / name, sha256(texts) + " " + std::to_string(pilot_paths) + " " +
                                         std::to_string(wanted_error) + " " + std::to_string(options.paths)};
}

std::string place_name(std::span<const Point> points, const Vector& normal) {
  std::string name;
  std::array<char, 96> text{};
  const auto add = [&](const Vector& vector) {
    std::snprintf(text.data(), text.size(), "%.6f,%.6f,%.6f;", vector.x(), vector.y(), vector.z());
    name += text.data();
  };
  for (const Point& point : points) add(point);
  add(normal);
  return name;
}

std::string place_name(const Sensor& sensor) { return place_name({&sensor.point, 1}, sensor.normal); }

std::string place_name(const PathReceiver& patch) {
  return place_name(patch.corners, patch.side == Side::front ? Vector::UnitZ() : Vector(-Vector::UnitZ()));
}

// Traces paths to places of one kind. A pilot determines the number of paths of each place. Its results are discarded,
// which keeps the estimate unbiased.
template <class Place>
std::vector<Reference> trace(const Scene& scene, const KeptSides& sides, const std::vector<Place>& places,
                             PathOptions by, std::uint32_t most_paths) {
  std::vector<Reference> references(places.size());
  if (places.empty()) return references;
  by.paths = pilot_paths;
  by.seed = 1;
  const PathEstimate pilot = trace_irradiance(scene, sides, std::span<const Place>(places), by);
  std::map<std::uint32_t, std::vector<std::size_t>> by_paths;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double light = pilot.irradiance(row, band);
    const double error = light > 0 ? pilot.standard_error(row, band) / (wanted_error * light) : most_paths;
    const double needed = pilot_paths * std::max(1.0, error * error);
    by_paths[needed < most_paths ? std::bit_ceil(static_cast<std::uint32_t>(needed)) : most_paths].push_back(k);
  }
  by.seed = 2;
  for (const auto& [paths, chosen] : by_paths) {
    std::vector<Place> some;
    for (const std::size_t k : chosen) some.push_back(places[k]);
    by.paths = paths;
    const PathEstimate found = trace_irradiance(scene, sides, std::span<const Place>(some), by);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      references[chosen[k]] = {found.irradiance(row, band), found.standard_error(row, band)};
    }
  }
  return references;
}

// The same, unless the file already has the result.
template <class Place>
std::vector<Reference> find_references(const Simulation& simulation, const std::vector<Place>& places,
                                       ReferenceFile& file, const Options& options) {
  std::vector<Place> missing;
  for (const Place& place : places)
    if (file.find(place_name(place)) == nullptr) missing.push_back(place);
  const PathOptions by{.follows_reflections = simulation.world->tracing().reflections() == Reflections::followed};
  const std::vector<Reference> traced =
      trace(simulation.world->sensor_scene(), simulation.plan.sides, missing, by, options.paths);
  for (std::size_t k = 0; k < missing.size(); ++k) file.add(place_name(missing[k]), traced[k]);
  std::vector<Reference> references;
  for (const Place& place : places) references.push_back(*file.find(place_name(place)));
  return references;
}

// The reading of a sensor by the solver and by paths, W/m^2.
struct Comparison {
  std::string room;
  double irradiance = 0;
  double standard_error = 0;
  Reference reference;
  double scale = 0;  // the larger of the reference and a tenth of its mean in the room

  double difference() const { return irradiance - reference.irradiance; }
  double z() const {
    const double error = std::hypot(standard_error, reference.standard_error);
    return difference() == 0 ? 0 : difference() / error;
  }
};

// The relative error of the solution, as stated and as measured.
struct TotalError {
  double stated = 0;
  double square = 0;  // of the measured error, without the noise of the paths; may be negative
  double noise = 0;   // standard deviation of `square` if the stated errors of all patches hold
  double z = 0;       // root mean square over the probes of (H - H_ref) / standard error

  bool is_covered() const { return square - 2 * noise <= stated * stated; }
};

struct RoomResult {
  std::string name, kind;
  std::vector<Comparison> sensors;
  std::optional<TotalError> total;  // nothing where the run states none
  PatchIndex patches = 0;
  double cpu_seconds = 0;  // of solving and reading the sensors
  double path_cpu_seconds = 0;
};

std::size_t count_outside(std::span<const Comparison> sensors, double errors) {
  return static_cast<std::size_t>(
      std::count_if(sensors.begin(), sensors.end(), [&](const Comparison& c) { return !(std::abs(c.z()) <= errors); }));
}

// A patch at which the error is measured.
struct Probe {
  PatchIndex patch = 0;
  double weight = 0;  // its share of the area, divided by the probability of drawing it
};

// Draws patches that the stated total includes: half in proportion to their area, half in proportion to their part of
// the squared stated error. Few patches hold most of this square, so draws by area alone would have a standard
// deviation of several times the mean.
std::vector<Probe> draw_probes(const Simulation& simulation, const Eigen::VectorXd& area,
                               const Eigen::ArrayXd& variance, const Options& options) {
  const Eigen::ArrayXd by_area = area.array() / area.sum();
  const Eigen::ArrayXd by_error = by_area * variance;
  const Eigen::ArrayXd density =
      by_error.sum() > 0 ? Eigen::ArrayXd(0.5 * (by_area + by_error / by_error.sum())) : by_area;
  std::vector<double> upto(static_cast<std::size_t>(simulation.mesh.size()));
  double sum = 0;
  for (std::size_t i = 0; i < upto.size(); ++i) upto[i] = sum += density[static_cast<Eigen::Index>(i)];
  std::vector<Probe> probes;
  for (std::size_t k = 0; k < options.probes; ++k) {
    const double u = (static_cast<double>(k) + hash({options.seed, k}) * 0x1p-32) / static_cast<double>(options.probes);
    const auto i = static_cast<PatchIndex>(std::upper_bound(upto.begin(), upto.end(), u * sum) - upto.begin());
    probes.push_back({i, by_area[i] / density[i]});
  }
  return probes;
}

// ||B - B_true||_A / ||B - E||_A: the mean of rho^2 (H - H_ref)^2 over the probes, without the variance of the
// reference, over the mean of rho^2 H^2 over all patches.
class TotalErrorMeter {
 public:
  TotalErrorMeter(const Scene& scene, const Simulation& simulation, const Options& options)
      : simulation_(simulation),
        rho_(simulation.problem.scattering.reflectance.col(band)),
        variance_((rho_ * simulation.error_bars->total().col(band)).square()) {
    const Eigen::VectorXd area = simulation.problem.area.cwiseProduct(interest_in(scene, simulation));
    const Eigen::ArrayXd share = area.array() / area.sum();
    light_ = (share * (rho_ * simulation.solution.irradiance.col(band)).square()).sum();
    stated_ = (share * variance_).sum();
    probes_ = draw_probes(simulation, area, variance_, options);
  }

  std::vector<PathReceiver> places() const {
    std::vector<PathReceiver> receivers;
    const PatchMesh& mesh = simulation_.mesh;
    for (const Probe& probe : probes_)
      receivers.push_back({mesh.corner_points(probe.patch).points, mesh.polygon[probe.patch], mesh.side[probe.patch]});
    return receivers;
  }

  // If a stated error is the standard deviation s of a normal error, (H - H_ref)^2 has the mean s^2 + n^2. Its variance
  // is 2 (s^2 + n^2)^2, where n is the noise of the paths. Probes add the spread of s^2 among patches.
  TotalError measure(const std::vector<Reference>& references) const {
    const auto count = static_cast<double>(probes_.size());
    double square = 0, variance = 0, z = 0, reflecting = 0;
    for (std::size_t k = 0; k < probes_.size(); ++k) {
      const auto [i, weight] = probes_[k];
      const double noise = std::pow(rho_[i] * references[k].standard_error, 2);
      const double off = std::pow(rho_[i] * (simulation_.solution.irradiance(i, band) - references[k].irradiance), 2);
      square += weight * (off - noise) / count;
      variance += std::pow(weight * (variance_[i] + noise), 2) * 2 / count;
      variance += std::pow(weight * variance_[i] - stated_, 2) / count;
      if (off == 0) continue;  // black patches have neither light nor error
      z += off / (variance_[i] + noise);
      ++reflecting;
    }
    return {simulation_.accuracy.back().total, square / light_, std::sqrt(variance / count) / light_,
            reflecting > 0 ? std::sqrt(z / reflecting) : 0};
  }

 private:
  const Simulation& simulation_;
  Eigen::ArrayXd rho_;
  Eigen::ArrayXd variance_;  // of each patch's radiosity, as stated
  double light_ = 0;         // mean square of the reflected radiosity
  double stated_ = 0;        // mean of `variance_`
  std::vector<Probe> probes_;
};

RoomResult judge(const RandomRoom& room, const path& scene_file, const Options& options) {
  const cli::SolveArguments arguments = tool_arguments(scene_file, options.solve);
  const cli::SolveInput input = cli::read_input(arguments);
  const ThreadLimit limit(arguments.request.resources.threads);
  const double begin = cpu_seconds();
  const Simulation simulation = simulate(input.scene, input.request);
  const SensorView view = read_sensors(simulation);
  RoomResult result{room.name, room.kind, {}, {}, simulation.mesh.size(), cpu_seconds() - begin, 0};

  ReferenceFile file = open_references(scene_file, options);
  const std::vector<Sensor> sensors = all_sensors(input.scene.sensors);
  const std::vector<Reference> references = find_references(simulation, sensors, file, options);
  double mean = 0;
  for (const Reference& reference : references) mean += reference.irradiance / static_cast<double>(references.size());
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    result.sensors.push_back({room.name, view.readings.irradiance(row, band), view.readings.standard_error(row, band),
                              references[k], std::max(references[k].irradiance, mean / 10)});
  }
  if (options.probes > 0 && simulation.error_bars && !simulation.accuracy.empty()) {
    const TotalErrorMeter meter(input.scene, simulation, options);
    result.total = meter.measure(find_references(simulation, meter.places(), file, options));
  }
  file.save();
  result.path_cpu_seconds = cpu_seconds() - begin - result.cpu_seconds;
  return result;
}

// ---- Tables

// Sensors and rooms of one kind, or of several.
struct Group {
  std::string name;
  std::size_t rooms = 0;
  std::vector<Comparison> sensors;
  std::vector<TotalError> totals;
  double cpu_seconds = 0;
};

Group make_group(const std::string& name, const std::vector<RoomResult>& results,
                 const std::vector<std::string>& kinds) {
  Group group{.name = name, .sensors = {}, .totals = {}};
  for (const RoomResult& result : results) {
    if (std::find(kinds.begin(), kinds.end(), result.kind) == kinds.end()) continue;
    ++group.rooms;
    group.sensors.insert(group.sensors.end(), result.sensors.begin(), result.sensors.end());
    if (result.total) group.totals.push_back(*result.total);
    group.cpu_seconds += result.cpu_seconds;
  }
  return group;
}

std::string formatted(const char* format, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

constexpr const char* table_head =
    "| rooms | number | sensors | within 2 | within 3 | mean z | rms z | worst z | true error, rms | stated / true | "
    "totals that cover | rms z of patches | CPU s per room |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

double rms_z(const std::vector<TotalError>& totals) {
  double sum = 0;
  for (const TotalError& total : totals) sum += total.z * total.z;
  return totals.empty() ? 0 : std::sqrt(sum / static_cast<double>(totals.size()));
}

std::string table_row(const Group& group) {
  const auto count = static_cast<double>(group.sensors.size());
  double mean = 0, square = 0, stated = 0, difference = 0;
  const Comparison* worst = &group.sensors.front();
  for (const Comparison& c : group.sensors) {
    mean += c.z() / count;
    square += c.z() * c.z() / count;
    stated += std::pow(c.standard_error / c.scale, 2) / count;
    difference += (std::pow(c.difference(), 2) - std::pow(c.reference.standard_error, 2)) / (c.scale * c.scale) / count;
    if (!(std::abs(c.z()) <= std::abs(worst->z()))) worst = &c;
  }
  const auto covered = std::count_if(group.totals.begin(), group.totals.end(),
                                     [](const TotalError& total) { return total.is_covered(); });
  const auto within = [&](double errors) {
    return 100 - 100 * static_cast<double>(count_outside(group.sensors, errors)) / count;
  };
  return "| " + group.name + " | " + std::to_string(group.rooms) + " | " + std::to_string(group.sensors.size()) +
         " | " + formatted("%.1f %%", within(2)) + " | " + formatted("%.1f %%", within(3)) + " | " +
         formatted("%+.2f", mean) + " | " + formatted("%.2f", std::sqrt(square)) + " | " +
         formatted("%+.1f", worst->z()) + " (" + worst->room + ") | " +
         (difference > 0 ? formatted("%.1f %%", 100 * std::sqrt(difference)) : "below noise") + " | " +
         (difference > 0 ? formatted("%.2f", std::sqrt(stated / difference)) : "-") + " | " + std::to_string(covered) +
         " of " + std::to_string(group.totals.size()) + " | " + formatted("%.2f", rms_z(group.totals)) + " | " +
         formatted("%.1f", group.cpu_seconds / static_cast<double>(group.rooms)) + " |\n";
}

std::string make_table(const std::vector<RoomResult>& results) {
  std::string table = table_head;
  const auto add = [&](const std::string& name, const std::vector<std::string>& kinds) {
    const Group group = make_group(name, results, kinds);
    if (group.rooms > 0) table += table_row(group);
  };
  const std::vector<std::string> daylight = test::daylight_kinds(), lamps = test::lamp_kinds();
  for (const std::string& kind : daylight) add(kind, {kind});
  add("**daylight**", daylight);
  for (const std::string& kind : lamps) add(kind, {kind});
  add("**lamps**", lamps);
  return table;
}

void print_room(const RoomResult& room) {
  double mean = 0, worst = 0, off = 0, light = 0;
  for (const Comparison& c : room.sensors) {
    mean += c.z() / static_cast<double>(room.sensors.size());
    if (!(std::abs(c.z()) <= std::abs(worst))) worst = c.z();
    off += c.difference() / c.scale / static_cast<double>(room.sensors.size());
    light += c.reference.standard_error / c.scale / static_cast<double>(room.sensors.size());
  }
  std::printf(
      "%-16s %6u patches %5.1f s  beyond 2: %2zu  3: %2zu  mean z %+5.2f  worst %+6.1f  mean %+5.1f %%  paths %.1f %%",
      room.name.c_str(), room.patches, room.cpu_seconds, count_outside(room.sensors, 2), count_outside(room.sensors, 3),
      mean, worst, 100 * off, 100 * light);
  if (room.total) {
    const TotalError& total = *room.total;
    std::printf("  total %.1f %% stated, %.1f %% true, rms z of patches %.2f%s", 100 * total.stated,
                100 * std::sqrt(std::max(0.0, total.square)), total.z, total.is_covered() ? "" : " NOT COVERED");
  }
  std::puts("");
  std::fflush(stdout);
}

// Writes the room as a scene file, and the readings of its sensors.
void write_failure(const RandomRoom& room, const RoomResult& result, const path& folder) {
  write_random_room(room, folder);
  std::ofstream truth(folder / (room.name + ".truth.txt"));
  truth << "# sensors in their order: solver, its standard error, paths, their standard error, z (green, W/m^2)\n";
  for (const Comparison& c : result.sensors)
    truth << c.irradiance << " " << c.standard_error << " " << c.reference.irradiance << " "
          << c.reference.standard_error << " " << c.z() << "\n";
}

std::string make_page(const std::string& table, const Options& options) {
  std::string more;
  for (const std::string& word : options.solve) more += " " + word;
  return "# Random rooms against path tracing\n\n"
         "This page is generated: `benchmark_random_rooms --daylight " +
         std::to_string(options.daylight) + " --lamps " + std::to_string(options.lamps) + " --seed " +
         std::to_string(options.seed) + " --markdown FILE`" + (more.empty() ? "" : ", options" + more) +
         ".\n\n"
         "The program makes rooms at random and solves each with the default settings of `patchlight solve`. It "
         "compares\n"
         "15 sensors per room with the path tracer of `patchlight crosscheck`: nine on a work plane, four near walls, "
         "one\n"
         "that faces a wall and one below the ceiling. Half of the rooms are rotated, and a third is in "
         "millimeters.\n\n" +
         table +
         "\nHow to read the table:\n\n"
         "- *z* is the difference between solver and paths, divided by their combined standard error. Normal errors "
         "put\n"
         "  95.4 % of the sensors within 2 and 99.7 % within 3.\n"
         "- *True error* is the rms relative difference without the noise of the paths. The reference of a sensor is "
         "at\n"
         "  least a tenth of the room's mean.\n"
         "- *Stated / true* is the rms standard error of the sensors divided by the true error.\n"
         "- *Totals that cover* counts the rooms whose stated total is at least their true relative error. The "
         "program\n"
         "  measures it at " +
         std::to_string(options.probes) +
         " patches per room, half drawn by area and half by stated error. It allows two\n"
         "  standard deviations of that measurement.\n"
         "- *Rms z of patches* is the root mean square of (solver - paths) / standard error over these patches.\n"
         "- *CPU s* covers solving and reading the sensors, without reading the model and without path tracing.\n";
}

std::vector<RandomRoom> make_rooms(const Options& options) {
  std::vector<RandomRoom> rooms;
  const auto add = [&](const std::vector<std::string>& kinds, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t number = k / kinds.size();
      const bool is_mixed = options.pixels > 0 && (k + number) % 2 == 1;
      RandomRoom room = test::make_random_room(kinds[k % kinds.size()], number, options.seed,
                                               is_mixed ? test::RoomOptics::mixed : test::RoomOptics::plain);
      if (room.name.find(options.only) != std::string::npos) rooms.push_back(std::move(room));
    }
  };
  add(test::daylight_kinds(), options.daylight);
  add(test::lamp_kinds(), options.lamps);
  return rooms;
}

// One line for each comparison in which two of sensor, pixel and path differ by more than three standard errors.
void print_outliers(const std::vector<PixelComparison>& comparisons) {
  for (const PixelComparison& c : comparisons) {
    const double rounding = 1e-6 * c.path;
    const double sensor = (c.sensor - c.path) / std::hypot(c.sensor_error, c.path_error, rounding);
    const double pixel = (c.pixel - c.path) / std::hypot(c.pixel_error, c.sensor_error + rounding, c.path_error);
    if (!(std::abs(sensor) > 3 || std::abs(pixel) > 3)) continue;
    std::printf("  %s %s  sensor %.5g +- %.2g  pixel %.5g +- %.2g  path %.5g +- %.2g  z %+.1f %+.1f\n", c.kind.c_str(),
                c.place.c_str(), c.sensor, c.sensor_error, c.pixel, c.pixel_error, c.path, c.path_error, sensor, pixel);
  }
}

void run_pixels(const Options& options) {
  const path folder = std::filesystem::temp_directory_path() / ("patchlight-pixels-" + std::to_string(getpid()));
  std::vector<PixelComparison> all;
  for (const RandomRoom& room : make_rooms(options)) {
    const cli::SolveArguments arguments = tool_arguments(write_random_room(room, folder), options.solve);
    const cli::SolveInput input = cli::read_input(arguments);
    const ThreadLimit limit(arguments.request.resources.threads);
    const double begin = cpu_seconds();
    const Simulation simulation = simulate(input.scene, input.request);
    const double solved = cpu_seconds();
    const auto found = compare_pixels(room, simulation, options.pixels, options.paths, options.seed);
    std::printf("%s %u patches, CPU %.1f s + %.1f s\n", room.name.c_str(), simulation.mesh.size(), solved - begin,
                cpu_seconds() - solved);
    print_outliers(found);
    std::fflush(stdout);
    all.insert(all.end(), found.begin(), found.end());
    if (!options.write.empty()) write_random_room(room, options.write);
    std::filesystem::remove_all(folder);
  }
  std::printf("\n%s", table_of(all).c_str());
}

void run(const Options& options) {
  if (options.pixels > 0) return run_pixels(options);
  const path folder = std::filesystem::temp_directory_path() / ("patchlight-random-rooms-" + std::to_string(getpid()));
  std::vector<RoomResult> results;
  for (const RandomRoom& room : make_rooms(options)) {
    const RoomResult result = judge(room, write_random_room(room, folder), options);
    print_room(result);
    const bool fails = count_outside(result.sensors, 3) > 0 || (result.total && !result.total->is_covered());
    if (fails && !options.write.empty()) write_failure(room, result, options.write);
    results.push_back(result);
    std::filesystem::remove_all(folder);
  }
  const std::string table = make_table(results);
  double solves = 0, paths = 0;
  for (const RoomResult& result : results) solves += result.cpu_seconds, paths += result.path_cpu_seconds;
  std::printf("\n%s\nCPU seconds: %.0f of solving, %.0f of path tracing\n", table.c_str(), solves, paths);
  if (options.markdown.empty()) return;
  if (options.markdown.has_parent_path()) std::filesystem::create_directories(options.markdown.parent_path());
  write_whole_file(options.markdown,
                   [&](const path& temporary) { std::ofstream(temporary) << make_page(table, options); });
}

}  // namespace
}  // namespace patchlight

int main(int count, char** values) {
  try {
    patchlight::run(patchlight::parse(count, values));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
