#include "input/new_cameras.h"

#include "input/toml_text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <sstream>

namespace patchlight {
namespace {

constexpr std::size_t most_cameras = 3;
constexpr double eye_height = 1.6;     // metres
constexpr double target_height = 1.3;  // metres
constexpr double from_walls = 0.5;     // metres

// From one of the two places of a floor that are farthest apart, away from walls, to the other.
std::optional<Camera> camera_in(const NamedFloor& place) {
  const double spacing = std::max(0.5, std::sqrt(area_of(place.floor)) / 20);
  constexpr double most_cells = 5000;
  const auto [corner, x, y] = rectangle_over(place.floor, 0);
  if (!(cells_along(x.norm(), spacing) * cells_along(y.norm(), spacing) <= most_cells)) return std::nullopt;
  const SensorGroup grid = floor_grid(place.floor, 0, spacing, from_walls);
  Camera camera{Point::Zero(), Point::Zero(), 70, place.name};
  double farthest = 0;
  for (const Sensor& from : grid.sensors) {
    for (const Sensor& to : grid.sensors) {
      const double distance = (to.point - from.point).norm();
      if (!(distance > (1 + 1e-9) * farthest)) continue;
      farthest = distance;
      camera.eye = from.point + eye_height * place.floor.up;
      camera.target = to.point + target_height * place.floor.up;
    }
  }
  if (!(farthest > 0)) return std::nullopt;
  return camera;
}

// Of how much glass is near, m^2 / m^2.
double glass_near(const Scene& scene, const Point& point) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_opening(scene, p)) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    const double area = area_vector(corners).norm();
    sum += area / ((corners[0] - point).squaredNorm() + area);
  }
  return sum;
}

std::vector<NamedFloor> by_windows(std::vector<NamedFloor> places) {
  std::stable_sort(places.begin(), places.end(),
                   [](const NamedFloor& a, const NamedFloor& b) { return a.window_area > b.window_area; });
  return places;
}

// What is said of the views, the first of which is in this place.
std::string heading(const NamedFloor& first) {
  return std::string("# Views for --view NAME, from inside the rooms with the largest ") +
         (first.window_area > 0 ? "windows towards these.\n" : "floors.\n");
}

}  // namespace

std::string camera_tables(const Scene& scene, const std::vector<NamedFloor>& places) {
  if (scene.rooms.empty() || !scene.cameras.empty()) return {};
  std::ostringstream text;
  std::set<std::string> names;
  for (const NamedFloor& place : by_windows(places)) {
    std::optional<Camera> camera = names.size() < most_cameras ? camera_in(place) : std::nullopt;
    if (!camera || !names.insert(camera->name).second) continue;
    if (glass_near(scene, camera->eye) > glass_near(scene, camera->target)) {
      const Vector lower = (eye_height - target_height) * place.floor.up;
      const Point eye = camera->target + lower;
      camera->target = camera->eye - lower;
      camera->eye = eye;
    }
    if (names.size() == 1) text << heading(place);
    text << "[[camera]]\nname = " << toml_text(camera->name) << "\neye = " << toml_text(camera->eye)
         << "\ntarget = " << toml_text(camera->target) << "\nfield_of_view = 70  # degrees, upright\n\n";
  }
  return text.str();
}

}  // namespace patchlight
