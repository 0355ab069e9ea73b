#pragma once

#include "patchlight/simulate.h"

#include "support/scenes.h"

#include <algorithm>
#include <utility>

// Scenes made for one effect each, and requests with and without it.
namespace patchlight::test {

/// An empty room of 4 x 3 x 2.5 m whose ceiling is the lamp, so that nothing can block a pair of patches.
inline Scene lit_box(double reflectance) {
  Scene scene = empty_scene({grey(reflectance), grey(reflectance, 10)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene.polygons[1].material = 1;
  return scene;
}

inline Scene with_point_light(Scene scene, const Spectrum& intensity) {
  Luminaire luminaire;
  luminaire.position = {0.5, 0.5, 2};
  luminaire.light = PointLight{intensity};
  scene.luminaires = {luminaire};
  return scene;
}

/// The furnished room in three bands, with a luminaire besides its lamp.
inline Scene in_colours(const Spectrum& reflectance, const Spectrum& lamp, const Spectrum& luminaire) {
  Scene scene = furnished_room(0.5);
  const Spectrum none = Spectrum::Zero(3);
  scene.materials = {{"wall", reflectance, none}, {"lamp", none, lamp}};
  return with_point_light(std::move(scene), luminaire);
}

/// Number of polygons of the lit room in two_rooms().
inline constexpr PolygonIndex polygons_of_lit_room = 13;

/// The furnished room beside a dark room with a box in it; the normals of both point inward.
inline Scene two_rooms(double reflectance) {
  Scene scene = furnished_room(reflectance);
  scene = with_box(std::move(scene), Point(5, 0, 0), Point(8, 3, 2.5), true);
  return with_box(std::move(scene), Point(6, 1, 0.5), Point(7, 2, 1.5), false);
}

/// The scene with a sun at an altitude of 40 degrees and a uniform sky.
inline Scene with_daylight(Scene scene) {
  scene.sun = Sun{Vector(0.48, 0.6, 0.64), Spectrum::Constant(1, 20)};
  Sky sky;
  sky.horizontal_irradiance = Spectrum::Constant(1, 10);
  scene.sky = sky;
  return scene;
}

/// A request for the front sides of a scene in patches of this size, meters.
inline Request coarse(double max_edge = 0.4) {
  Request request;
  request.mesh.max_edge = max_edge;
  request.mesh.sides = Sides::front;
  return request;
}

inline Request forcing(Effect effect, Request request) {
  request.effects.force.push_back(effect);
  return request;
}

inline Request skipping(Effect effect, Request request) {
  request.effects.skip.push_back(effect);
  return request;
}

inline const Decision& decision(const Simulation& simulation, Effect effect) {
  return *std::find_if(simulation.plan.decisions.begin(), simulation.plan.decisions.end(),
                       [effect](const Decision& decision) { return decision.effect == effect; });
}

}  // namespace patchlight::test
