#pragma once

#include "support/scenes.h"

#include <utility>

// A room by day, in one band.
namespace patchlight::test {

inline Spectrum watts(double value) { return Spectrum::Constant(1, value); }

inline Material named(const std::string& name, double reflectance, double transmittance = 0) {
  Material material = grey(reflectance);
  material.name = name;
  if (transmittance > 0) material.transmittance = watts(transmittance);
  return material;
}

// A closed office of 4 x 5 x 3 m whose wall at low y is one pane. It has a desk, a luminaire below the ceiling, and
// ground outside. The sun is in the south-west, and the sky is overcast.
inline Scene daylight_office() {
  Scene scene = empty_scene({named("plaster", 0.6), named("pane", 0.1, 0.8), named("desk", 0.4), named("ground", 0.2)});
  scene.groups = {"room", "furniture", "outside"};
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 5, 3), true);
  scene.polygons[2].material = 1;
  scene = with_box(std::move(scene), Point(1, 2, 0.4), Point(2.6, 3, 0.8), false, 2);
  for (PolygonIndex p = 6; p < 12; ++p) scene.polygons[p].group = 1;
  scene = with_quad(std::move(scene),
                    {Point(-4, -6, -0.2), Point(8, -6, -0.2), Point(8, -0.1, -0.2), Point(-4, -0.1, -0.2)}, 3);
  scene.polygons.back().group = 2;
  Luminaire lamp;
  lamp.position = Point(2, 3.5, 2.6);
  lamp.light = PointLight{watts(2)};
  scene.luminaires = {lamp};
  scene.sun = Sun{Vector(-0.3, -0.6, 0.6).normalized(), watts(30)};
  Sky sky;
  sky.kind = SkyKind::cie_overcast;
  sky.horizontal_irradiance = watts(20);
  scene.sky = sky;
  return scene;
}

// The scene turned and in another unit. Irradiances stay the same, as intensities scale with the square of lengths.
inline Scene turned(Scene scene, double scale) {
  const Eigen::AngleAxisd turn(0.7, Vector(1, 2, 3).normalized());
  for (Point& vertex : scene.vertices) vertex = scale * (turn * vertex);
  for (Luminaire& luminaire : scene.luminaires) {
    luminaire.position = scale * (turn * luminaire.position);
    if (auto* point = std::get_if<PointLight>(&luminaire.light)) point->intensity *= scale * scale;
    if (auto* sphere = std::get_if<SphericalLamp>(&luminaire.light)) sphere->radius *= scale;
  }
  if (scene.sun) scene.sun->direction = turn * scene.sun->direction;
  if (scene.sky) scene.sky->sun_direction = turn * scene.sky->sun_direction;
  scene.up = turn * scene.up;
  scene.north = turn * scene.north;
  return scene;
}

}  // namespace patchlight::test
