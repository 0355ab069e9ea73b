#include "input/placed.h"

#include <algorithm>

namespace patchlight {

Scene placed(Scene scene, const Eigen::Affine3d& placement) {
  for (Point& vertex : scene.vertices) vertex = placement * vertex;
  for (SensorGroup& group : scene.sensors) {
    for (Sensor& sensor : group.sensors) {
      sensor.point = placement * sensor.point;
      sensor.normal = (placement.linear() * sensor.normal).normalized();
    }
  }
  for (Camera& camera : scene.cameras) {
    camera.eye = placement * camera.eye;
    camera.target = placement * camera.target;
  }
  for (NamedRoom& room : scene.rooms)
    for (std::vector<Point>& face : room.faces)
      for (Point& corner : face) corner = placement * corner;
  const auto turn = [&](Vector& direction) { direction = (placement.linear() * direction).normalized(); };
  for (Luminaire& luminaire : scene.luminaires) {
    luminaire.position = placement * luminaire.position;
    turn(luminaire.aim);
    turn(luminaire.zero_plane);
  }
  turn(scene.north);
  if (scene.sun) turn(scene.sun->direction);
  // L x + o = L A^-1 (x' - t) + o for x' = A x + t.
  const Eigen::Matrix3d back = placement.linear().inverse();
  for (TextureMap& map : scene.texture_maps) {
    map.linear = map.linear * back;
    map.offset -= map.linear * placement.translation();
  }
  if (placement.linear().determinant() >= 0) return scene;
  for (Polygon& polygon : scene.polygons) std::reverse(polygon.corners.begin(), polygon.corners.end());
  return scene;
}

}  // namespace patchlight
