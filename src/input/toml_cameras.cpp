#include "input/toml_cameras.h"

#include "scene/projection.h"

#include <cmath>
#include <string>
#include <utility>

namespace patchlight {
namespace {

void require_no(const TomlValue& table, const char* key, Projection projection) {
  const TomlValue* const value = find(table, key);
  if (value == nullptr) return;
  refuse(*value, std::string("none with the projection '") + name_of(projection) + "'\nhint: leave it out");
}

// With what its picture shows: an angle, or a height.
Camera with_projection(Camera camera, const TomlValue& table, double metres_per_unit) {
  using enum Projection;
  if (const TomlValue* const projection = find(table, "projection")) {
    camera.projection = choice<Projection>(*projection, {{name_of(perspective), perspective},
                                                         {name_of(orthographic), orthographic},
                                                         {name_of(angular), angular},
                                                         {name_of(hemispherical), hemispherical},
                                                         {name_of(panorama), panorama}});
  }
  if (camera.projection == orthographic) {
    require_no(table, "field_of_view", camera.projection);
    camera.height = metres_per_unit * positive(required(table, "height", "the height of what the picture shows"));
    return camera;
  }
  require_no(table, "height", camera.projection);
  camera.vertical_field_of_view = usual_field_of_view(camera.projection);
  if (const TomlValue* const angle = find(table, "field_of_view")) {
    camera.vertical_field_of_view = number(*angle);
    const std::string largest = std::to_string(std::lround(largest_field_of_view(camera.projection))) + " degrees";
    const std::string most = camera.projection == perspective ? "below " + largest : "up to " + largest;
    if (!has_extent(camera)) refuse(*angle, "an angle above 0 and " + most);
  }
  return camera;
}

}  // namespace

std::vector<Camera> cameras_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<Camera> cameras;
  for (const TomlValue& table : tables(find(root, "camera"))) {
    allow_keys(table, {"name", "eye", "target", "field_of_view", "projection", "height"});
    const TomlValue* const name = find(table, "name");
    const TomlValue& target = required(table, "target", "the point [x, y, z] that is looked at");
    Camera camera;
    camera.name = name ? text(*name) : "camera " + std::to_string(cameras.size() + 1);
    camera.eye = frame.metres_per_unit * vector(required(table, "eye", "the point [x, y, z] that is looked from"));
    camera.target = frame.metres_per_unit * vector(target);
    if (camera.eye == camera.target) refuse(target, "a point other than the eye");
    camera = with_projection(std::move(camera), table, frame.metres_per_unit);
    for (const Camera& other : cameras) {
      if (other.name == camera.name) refuse(name ? *name : table, "a name that no other camera has");
    }
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace patchlight
