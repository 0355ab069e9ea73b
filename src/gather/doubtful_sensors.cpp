#include "gather/doubtful_sensors.h"

#include "base/parallel.h"
#include "base/tolerances.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <sstream>

namespace patchlight {
namespace {

constexpr std::size_t most_sentences = 5;

std::vector<PatchIndex> patches_with_pictures(const Scene& scene, const PatchMesh& mesh) {
  std::vector<PatchIndex> found;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (!scene.materials[mesh.material[i]].texture) continue;
    if (texture_map_on(scene, scene.polygons[mesh.polygon[i]], mesh.side[i]) != nullptr) found.push_back(i);
  }
  return found;
}

// Is it nearer than one and a half widths, twice the largest distance of a corner from the middle?
bool looks_at_from_close(const Sensor& sensor, const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  const std::span<const Point> points = corners;
  const auto farthest = [&](const Point& from) {
    double distance = 0;
    for (const Point& corner : points) distance = std::max(distance, (corner - from).norm());
    return distance;
  };
  const Point& middle = mesh.centroid[patch];
  const double width = 2 * farthest(middle);
  if ((sensor.point - middle).norm() > 1.5 * width) return false;
  if (!(mesh.normal[patch].dot(sensor.point - middle) > tolerance_of_coordinates * width)) return false;
  return std::any_of(points.begin(), points.end(), [&](const Point& corner) {
    return sensor.normal.dot(corner - sensor.point) > tolerance_of_coordinates * width;
  });
}

Diagnostic finding(const SensorGroup& group, std::size_t k, Standing standing) {
  std::ostringstream text;
  const Point& point = group.sensors[k].point;
  text << place_of(group, k) << " at " << point.x() << ", " << point.y() << ", " << point.z() << " m "
       << (standing == Standing::inside_wall
               ? "lies inside a wall, or in a closed room without a lamp, where nothing is to be read, and is left out "
                 "of minimum, mean and maximum. Move it into the room, or give the room a lamp"
               : "lies in a surface without facing along its normal, so rounding decides its side. Move it away by at "
                 "least a millimeter");
  return {DiagnosticCode::doubtful_sensor, text.str()};
}

}  // namespace

Diagnostics doubtful_sensors(const std::vector<SensorGroup>& sensors, std::span<const SensorPlace> places) {
  Diagnostics found;
  std::size_t doubtful = 0;
  std::size_t place = 0;
  for (const SensorGroup& group : sensors) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k, ++place) {
      const Standing standing = places[place].standing;
      if (standing == Standing::free) continue;
      if (++doubtful <= most_sentences) found.push_back(finding(group, k, standing));
    }
  }
  assert(place == places.size());
  if (doubtful > most_sentences) {
    found.push_back({DiagnosticCode::doubtful_sensor,
                     std::to_string(doubtful - most_sentences) + " more sensors lie inside walls or in surfaces",
                     doubtful - most_sentences});
  }
  return found;
}

Diagnostics sensors_far_off(const Scene& scene, const std::vector<SensorGroup>& sensors) {
  const Box box = bounds(scene);
  const double length = box.diagonal().norm();
  std::string first;
  std::size_t count = 0;
  for (const SensorGroup& group : sensors) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k) {
      if (box.exteriorDistance(group.sensors[k].point) <= length) continue;
      if (count++ == 0) first = place_of(group, k);
    }
  }
  if (count == 0) return {};
  return {{DiagnosticCode::doubtful_sensor,
           (count == 1 ? "1 sensor lies" : std::to_string(count) + " sensors lie") +
               " farther from the model than the model is long (the first: " + first +
               "). Are they in the model's unit? Points in a scene file are in meters, independent of its unit",
           count}};
}

Diagnostics sensors_close_to_pictures(const Scene& scene, const std::vector<SensorGroup>& sensors,
                                      const PatchMesh& mesh) {
  const std::vector<PatchIndex> patches = patches_with_pictures(scene, mesh);
  if (patches.empty()) return {};
  std::string first;
  std::size_t count = 0;
  for (const SensorGroup& group : sensors) {
    std::vector<std::uint8_t> is_close(group.sensors.size(), 0);
    parallel_for(group.sensors.size(), [&](std::size_t k) {
      is_close[k] = std::any_of(patches.begin(), patches.end(),
                                [&](PatchIndex i) { return looks_at_from_close(group.sensors[k], mesh, i); });
    });
    const auto found = std::find(is_close.begin(), is_close.end(), 1);
    if (found != is_close.end() && first.empty())
      first = place_of(group, static_cast<std::size_t>(found - is_close.begin()));
    count += static_cast<std::size_t>(std::accumulate(is_close.begin(), is_close.end(), 0));
  }
  if (count == 0) return {};
  return {{DiagnosticCode::doubtful_sensor,
           (count == 1 ? "1 sensor looks" : std::to_string(count) + " sensors look") +
               " at textured patches from less than 1.5 times their width (the first: " + first +
               "): a patch emits the mean of its part of the texture, and error bars of sensors do not include the "
               "differences between texels. Use smaller patches, e.g. with --max-edge",
           count}};
}

}  // namespace patchlight
