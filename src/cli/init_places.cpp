#include "cli/init_places.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/sides.h"

#include "accuracy/spaces.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "gather/sensor_places.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/toml/toml_sensors.h"
#include "output/file/whole_file.h"
#include "plan/survey.h"
#include "scene/solids.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>

namespace patchlight::cli {
namespace {

constexpr double work_plane = 0.8;  // meters above the floor
constexpr double eye_height = 1.6;  // meters
constexpr double bad = -1;          // marks an invalid place, instead of a height

// Adds a ground four times as wide as the scene, for models of rooms without slabs.
Scene over_ground(Scene scene) {
  const Box box = bounds(scene);
  const double size = box.diagonal().norm();
  const Vector x = 2 * size * scene.up.unitOrthogonal(), y = scene.up.cross(x);
  const Point below = box.center() - (box.sizes().dot(scene.up.cwiseAbs()) / 2 + 1e-3 * size) * scene.up;
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(scene.vertices.end(), {below - x - y, below + x - y, below + x + y, below - x + y});
  scene.materials.push_back(default_material());
  scene.polygons.push_back({.corners = {first, first + 1, first + 2, first + 3},
                            .material = static_cast<MaterialIndex>(scene.materials.size() - 1)});
  return scene;
}

// A scene for testing places.
class Trial {
 public:
  explicit Trial(const Scene& scene)
      : scene_(over_ground(scene)),
        faces_(scene_, Occluder::Blockers::all),
        sides_(kept_sides(scene_, Sides::automatic)) {
    for (PolygonIndex p = 0; p < scene_.polygons.size(); ++p) {
      if (is_opening(scene_, p)) openings_.push_back(p);
    }
  }

  const Scene& scene() const { return scene_; }

  // For each place of all groups in sequence: height above the next face below, meters, or `bad`.
  std::vector<double> heights(const std::vector<SensorGroup>& groups) const {
    Scene scene = scene_;
    scene.sensors = groups;
    std::vector<FacingPlace> facing;
    std::vector<Ray> down;
    for (const Sensor& sensor : all_sensors(groups)) {
      facing.push_back({sensor.point, scene.up});
      down.push_back({sensor.point, -scene.up});
    }
    const std::vector<SensorPlace> places = place_sensors(scene, scene.sensors, sides_, faces_);
    const std::vector<std::uint8_t> enclosed = enclosed_places(scene, faces_, facing);
    const std::vector<std::optional<Hit>> floor = faces_.first_hits(down);
    std::vector<double> heights;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const bool is_good = enclosed[k] != 0 && places[k].standing == Standing::free;
      const double height = floor[k] ? floor[k]->distance : std::numeric_limits<double>::infinity();
      heights.push_back(is_good ? height : bad);
    }
    return heights;
  }

  bool is_in_sight(const Point& from, const Point& to) const {
    const std::vector<Segment> way = {{from, to}};
    return faces_.occluded(way)[0] == 0;
  }

  // Visible glass near a point: the sum of area / (distance^2 + area).
  double glass_near(const Point& point) const {
    std::vector<Segment> ways;
    for (const PolygonIndex p : openings_)
      ways.push_back({point, area_centroid(corner_points(scene_, p)), no_polygon, p});
    const std::vector<std::uint8_t> hidden = faces_.occluded(ways);
    double sum = 0;
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const double area = area_vector(corner_points(scene_, openings_[k])).norm();
      if (!hidden[k]) sum += area / ((ways[k].to - point).squaredNorm() + area);
    }
    return sum;
  }

 private:
  Scene scene_;
  Occluder faces_;
  KeptSides sides_;
  std::vector<PolygonIndex> openings_;
};

// A tested grid: the number of good places, and of those directly above the floor. Half of the places must be good.
struct TriedGrid {
  std::size_t places = 0;
  std::size_t good = 0;
  std::size_t over_floor = 0;

  bool has_enough(std::size_t count) const {
    return count > 0 && static_cast<double>(count) >= 0.5 * static_cast<double>(places);
  }
};

std::vector<TriedGrid> tried(const Trial& trial, const std::vector<SensorGroup>& groups) {
  const std::vector<double> heights = trial.heights(groups);
  std::vector<TriedGrid> all;
  auto height = heights.begin();
  for (const SensorGroup& group : groups) {
    TriedGrid grid{group.sensors.size()};
    for (std::size_t k = 0; k < group.sensors.size(); ++k, ++height) {
      grid.good += *height != bad;
      grid.over_floor += std::abs(*height - work_plane) <= 0.01;
    }
    all.push_back(grid);
  }
  return all;
}

void note_bad_places(LeftOut& notes, const std::string& floor, const TriedGrid& grid) {
  if (grid.good < grid.places)
    notes.add("floors with sensors in open air or in a solid",
              floor + " " + std::to_string(grid.places - grid.good) + " of " + std::to_string(grid.places),
              DiagnosticCode::missing_sensors);
}

FloorGrid standard_work_plane() {
  FloorGrid grid;
  grid.name = "work plane";
  grid.height = work_plane;
  return grid;
}

// Empty for a floor with more than 20,000 places, e.g. in a model with a wrong unit.
SensorGroup grid_to_try(const Floor& floor, const FloorGrid& grid, const std::vector<Solid>& solids) {
  const bool is_sensible = !floor.outlines.empty() && most_cells(floor, standard_grid(floor)) <= 2e4;
  return is_sensible ? grid_over(floor, grid, solids).group : SensorGroup();
}

// Sensors for the rooms that have places for them.
NewPlaces sensors_in_rooms(const Trial& trial, LeftOut& notes) {
  const Scene& scene = trial.scene();
  FloorGrid grid = standard_work_plane();
  const std::vector<Solid> solids = dark_solids(scene);
  std::vector<SensorGroup> groups;
  for (const NamedRoom& room : scene.rooms) {
    const Floor floor = floor_of_room(room.faces, scene.up);
    groups.push_back(in_room(grid_to_try(floor, grid, solids), room));
  }
  const std::vector<TriedGrid> grids = tried(trial, groups);
  std::set<std::string> without;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const std::string& name = scene.rooms[k].name;
    if (grids[k].has_enough(grids[k].good)) {
      grid.rooms.push_back(name);
      note_bad_places(notes, name, grids[k]);
    } else if (without.insert(name).second) {
      notes.add("rooms without sensors, as they are open to the sky, too narrow or without a level floor", name,
                DiagnosticCode::missing_sensors);
    }
  }
  NewPlaces places;
  places.rooms_without = {without.begin(), without.end()};
  if (!without.empty()) std::erase_if(grid.rooms, [&](const std::string& name) { return without.count(name) > 0; });
  if (without.empty()) grid.rooms = {"*"};
  if (!grid.rooms.empty()) places.grid = std::move(grid);
  return places;
}

// Sensors over the group with the largest floor area below closed rooms, among the 50 largest.
NewPlaces sensors_over_group(const Trial& trial, std::span<const NamedFloor> floors, LeftOut& notes) {
  FloorGrid grid = standard_work_plane();
  grid.from_walls = 0.5;
  const std::vector<Solid> solids = dark_solids(trial.scene());
  std::vector<SensorGroup> groups;
  for (const NamedFloor& floor : floors.first(std::min<std::size_t>(floors.size(), 50)))
    groups.push_back(grid_to_try(floor.floor, grid, solids));
  const std::vector<TriedGrid> grids = tried(trial, groups);
  NewPlaces places;
  double largest = 0;
  TriedGrid best;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    const auto [all, good, over_floor] = grids[k];
    const double area = all > 0 ? area_of(groups[k]) * static_cast<double>(over_floor) / static_cast<double>(all) : 0;
    if (!grids[k].has_enough(over_floor) || !(area > largest)) continue;
    largest = area;
    best = grids[k];
    grid.group = floors[k].name;
    places.grid = grid;
  }
  note_bad_places(notes, grid.group, best);
  return places;
}

// Camera positions in a room, away from walls.
std::vector<Point> eyes_in(const Trial& trial, const NamedFloor& place) {
  const double spacing = std::max(0.5, std::sqrt(area_of(place.floor)) / 20);
  const GridSize size{spacing, standard_grid(place.floor).from_walls};
  if (!(most_cells(place.floor, size) <= 5000)) return {};
  const SensorGroup grid = floor_grid(place.floor, eye_height, size);
  const std::vector<double> heights = trial.heights({grid});
  std::vector<Point> eyes;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (heights[k] != bad) eyes.push_back(grid.sensors[k].point);
  }
  return eyes;
}

// A view toward the glass. Eye and target are the most distant pair of positions with a free line of sight.
std::optional<Camera> camera_in(const Trial& trial, const NamedFloor& place) {
  struct Way {
    double length = 0;
    std::size_t from = 0, to = 0;
  };
  const std::vector<Point> eyes = eyes_in(trial, place);
  std::vector<double> glass;
  for (const Point& eye : eyes) glass.push_back(trial.glass_near(eye));
  std::vector<Way> ways;
  for (std::size_t from = 0; from < eyes.size(); ++from) {
    for (std::size_t to = 0; to < eyes.size(); ++to) {
      const bool is_towards_glass = glass[from] < glass[to] || (glass[from] == glass[to] && from < to);
      if (is_towards_glass) ways.push_back({(eyes[to] - eyes[from]).norm(), from, to});
    }
  }
  // Rounding keeps the order of equal lengths.
  const auto rounded_length = [](const Way& way) { return std::llround(1e6 * way.length); };
  std::stable_sort(ways.begin(), ways.end(),
                   [&](const Way& a, const Way& b) { return rounded_length(a) > rounded_length(b); });
  const Vector lower = (eye_height - 1.3) * place.floor.up;  // the target is 1.3 m above the floor
  for (const Way& way : ways) {
    const Camera camera{eyes[way.from], eyes[way.to] - lower, 70, place.name};
    if (trial.is_in_sight(camera.eye, camera.target)) return camera;
  }
  return std::nullopt;
}

// Three views, in the twelve rooms with the largest windows. Rooms with equal windows, e.g. none, keep their order.
std::vector<Camera> cameras_in(const Trial& trial, std::vector<NamedFloor> floors) {
  std::stable_sort(floors.begin(), floors.end(),
                   [](const NamedFloor& a, const NamedFloor& b) { return a.window_area > b.window_area; });
  if (floors.size() > 12) floors.resize(12);
  std::vector<Camera> cameras;
  std::set<std::string> names;
  for (const NamedFloor& place : floors) {
    if (cameras.size() == 3 || names.count(place.name) > 0) continue;
    std::optional<Camera> camera = camera_in(trial, place);
    if (!camera) continue;
    names.insert(place.name);
    cameras.push_back(std::move(*camera));
  }
  return cameras;
}

}  // namespace

TriedPlaces new_places(const Scene& lit) {
  const Trial trial(lit);
  const std::vector<NamedFloor> floors = named_floors(lit);
  TriedPlaces tried;
  LeftOut notes;
  if (lit.sensors.empty())
    tried.places = lit.rooms.empty() ? sensors_over_group(trial, floors, notes) : sensors_in_rooms(trial, notes);
  if (!lit.rooms.empty() && lit.cameras.empty()) {
    std::vector<NamedFloor> inside = floors;
    const std::vector<std::string>& without = tried.places.rooms_without;
    std::erase_if(inside, [&](const NamedFloor& place) {
      return std::find(without.begin(), without.end(), place.name) != without.end();
    });
    tried.places.cameras = cameras_in(trial, std::move(inside));
  }
  tried.notes = notes.on({}).diagnostics;
  return tried;
}

ExitCode run(const InitArguments& arguments) {
  std::error_code error;
  if (std::filesystem::exists(arguments.output, error))
    throw OutputError(arguments.output.string(), "already exists\nhint: choose another name, or delete it");
  check_writable(arguments.output);
  const Scene scene = read_scene(arguments.models, arguments.read);
  for (const Diagnostic& problem : problems_with_size(scene)) print_diagnostic("note", problem);
  const NewLight light = new_light(scene);
  const TriedPlaces tried = new_places(with_new_light(scene, light));
  for (const Diagnostic& note : tried.notes) print_diagnostic("note", note);
  const std::string text =
      new_scene_file(scene, light, tried.places, arguments.models, arguments.read.metres_per_unit, arguments.output);
  const WritingGuard guard;
  write_bytes(arguments.output, text);
  std::cout << "wrote " << arguments.output.string() << "; next: patchlight solve " << arguments.output.string()
            << " -o result.vtp --json result.json --picture result.png\n"
            << std::flush;
  return good;
}

}  // namespace patchlight::cli
