#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The scene as it was solved.
struct SceneFacts {
  std::string file;
  std::string sha256;  ///< of all its files
  std::size_t polygons = 0;
  std::size_t materials = 0;
  std::vector<Luminaire> luminaires;  ///< as the scene has them
  double metres_per_unit = 1;
  Vector up = Vector::UnitZ();
  bool up_stated = true;         ///< else it was guessed: upright_axis()
  Vector size = Vector::Zero();  ///< of the bounds, m
  Diagnostics warnings;          ///< problems that can make all results wrong
  Diagnostics notes;             ///< other problems and remarks
  Bands bands = {};              ///< of its spectra
};

/// Sums over the patches of one material; spectra have a value per band.
struct MaterialLight {
  std::string name;
  double area = 0;       ///< m^2
  Spectrum reflectance;  ///< as the scene has it
  Spectrum exitance;     ///< as the scene has it, W/m^2
  Spectrum emitted;      ///< W
  Spectrum absorbed;     ///< W
  Spectrum lowest;       ///< irradiance, W/m^2; infinite without patches
  Spectrum mean;         ///< irradiance by area, W/m^2; not a number without patches
  Spectrum highest;      ///< irradiance, W/m^2; minus infinity without patches
  Spectrum radiance;     ///< by area, W/(m^2 sr); not a number without patches
};

/// The readings of sensors.
struct SensorFacts {
  std::vector<GroupReadings> groups;
  std::string unit;       ///< of their values
  bool daylight = false;  ///< they have daylight factors
  Diagnostics warnings;   ///< a sentence for each sensor whose place is in doubt
};

/// A surface of a room, by the way it faces.
enum class RoomSurface : std::uint8_t { floor, walls, ceiling };

/// "floor", "walls" or "ceiling".
const char* name_of(RoomSurface surface);

/// Illuminance of one of them, as EN 12464-1 has it, in Report::unit.
struct SurfaceLight {
  RoomSurface surface = RoomSurface::floor;
  double area = 0;         ///< of its patches, m^2; 0: there is none
  double min = 0;          ///< of the patches' means
  double mean = 0;         ///< by area
  double uniformity = 0;   ///< U0 = min / mean; 0 in the dark
  bool is_coarse = false;  ///< smaller patches may give a lower `min`, and so U0. A patch less than twice as bright
                           ///< is larger than a cell of the EN 12464-1 grid. Or points of it are darker than `min`
                           ///< by more than a tenth, by its display error
};

/// The light on the surfaces of a room.
struct RoomLight {
  std::string name;
  std::array<SurfaceLight, 3> surfaces{};  ///< at the place of each RoomSurface
};

/// The sums of the rows of form factors.
struct RowSumFacts {
  double min = 0;
  double mean = 0;  ///< by area
  double max = 0;
  double rms_defect = 0;  ///< by area, against 1 - lost
};

/// A patch whose form factors, before closure, are far off.
struct WorstPatch {
  PatchIndex patch = 0;
  std::string place;       ///< file and line of its polygon
  std::uint32_t face = 0;  ///< number of its polygon in the model's files, from 0
  std::string group;
  std::string material;
  Point centre = Point::Zero();  ///< m
  double area = 0;               ///< m^2
  double row_sum = 0;
  double expected = 0;  ///< of the row sum: 1 - lost
};

/// Facts of the form factors.
struct FormFactorFacts {
  std::optional<AssemblyCounts> counts;    ///< nothing with rows on demand
  std::optional<double> rays_per_second;   ///< shadow rays over the seconds of the form factors, where these took any
  double bare_rays_per_second = 0;         ///< the rate without anything else; 0 where not known
  std::uint64_t lost_share_rays = 0;       ///< in all
  std::optional<double> ray_error;         ///< Simulation::ray_standard_error over the reflected light; of rows of rays
  std::string closure;                     ///< the method that has closed the rows
  std::optional<RowSumFacts> raw_row_sum;  ///< before closure; nothing with rows on demand
  std::optional<RowSumFacts> row_sum;      ///< after closure; nothing with rows on demand
  std::vector<WorstPatch> worst;           ///< the five with the largest defect times area
  double escaped = 0;                      ///< mean lost share by area
  double at_backs = 0;                     ///< mean lost share by area
};

/// How the solution came about.
struct SolutionFacts {
  bool converged = false;
  std::string trapped;             ///< Solution::trapped
  double patch_bound = 0;          ///< Solution::patch_bound
  std::vector<Iteration> history;  ///< from iteration 0
  double highest_reflectance = 0;  ///< of all patches and bands
  bool stopped_by_rows = false;    ///< not converged, as SolverOptions::max_rows ended it before
  bool unfinished = false;         ///< Simulation::unfinished
};

/// All facts of a run. Text, JSON and whatever else prints a run take their numbers from here.
struct Report {
  SceneFacts scene;
  Request request;
  Plan plan;
  Diagnostics notes;  ///< Simulation::notes
  PatchIndex patches = 0;
  std::size_t vertices = 0;
  double area = 0;  ///< of all patches, m^2
  std::vector<MaterialLight> materials;
  std::vector<RoomLight> rooms;
  std::string unit;  ///< of their illuminance: "lx", or "W/m^2" where lights are not photometric
  SensorFacts sensors;
  FormFactorFacts form_factors;
  EnergyBalance balance;  ///< its defect is the row sums' and means nothing where these are not known
  SolutionFacts solution;
  std::vector<AccuracyStep> accuracy;  ///< Simulation::accuracy
  std::vector<SpaceErrors> spaces;     ///< Simulation::spaces
  std::vector<StageCost> costs;
};

/// The readings of groups of sensors as facts.
SensorFacts sensor_facts(std::span<const SensorGroup> groups, const Readings& readings, Diagnostics warnings);

/// Works out the report of a run; costs are those noted so far. O(patches log patches).
Report report_of(const Scene& scene, const Request& request, const Simulation& simulation, SensorFacts sensors = {});

/// False if an accuracy was requested and the error bars are above it.
bool is_accurate(const Report& report);

}  // namespace patchlight
