#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "lighting/lighting.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace patchlight {

/// A scene with the data derived from it for a plan, computed once: rays, and the light of luminaires, sun and sky. All
/// steps of a run and all views of its solution share it. Immutable; thread-safe.
class World {
 public:
  /// `scene` is the scene as read; `plan` is made from it.
  World(std::shared_ptr<const Scene> scene, const Plan& plan);
  ~World();

  /// The same faces with only some of the bands, in this order; in_bands() has the rules.
  std::shared_ptr<const World> in_bands(const std::vector<Eigen::Index>& bands, const Plan& plan) const;

  /// The scene as read.
  const Scene& scene() const { return *scene_; }

  /// The scene with the lights and colors that the plan simulates: scene_as_planned().
  const Scene& planned_scene() const { return *planned_; }

  /// The scene for sensors, which may stand where no patch is: scene_for_sensors().
  const Scene& sensor_scene() const { return *for_sensors_; }

  /// The ray tracers, shared by the two scenes above.
  const Tracing& tracing() const { return tracing_; }

  /// For rays between points of patches.
  const Occluder& between_patches() const { return tracing_.between_patches(); }

  /// For points that may lie anywhere: every polygon blocks.
  const Occluder& all_faces() const { return tracing_.all_faces(); }

  /// The light of planned_scene(). Computed at the first call, as are the others.
  const Lighting& lighting() const;

  /// The light of planned_scene() in its brightest band, if Plan::lamp_colour shows that all light has one color.
  const Lighting& lighting_in_one_band() const;

  /// The light of sensor_scene().
  const Lighting& sensor_lighting() const;

  /// Mirrors and clear faces for the light of polygons: planned_scene() without luminaires, sun and sky.
  const Lighting& lighting_by_polygons() const;

 private:
  struct Later;

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Scene> planned_;
  std::shared_ptr<const Scene> for_sensors_;
  Spectrum lamp_color_;
  Tracing tracing_;
  std::unique_ptr<Later> later_;
};

}  // namespace patchlight
