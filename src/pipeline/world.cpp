#include "pipeline/world.h"

#include "plan/planned_scene.h"
#include "scene/coverings.h"

#include <cassert>
#include <mutex>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// Computed on first use.
class LightingOnDemand {
 public:
  const Lighting& of(const auto& make) {
    std::call_once(once_, [&] { lighting_.emplace(make()); });
    return *lighting_;
  }

 private:
  std::once_flag once_;
  std::optional<Lighting> lighting_;
};

}  // namespace

struct World::Later {
  LightingOnDemand planned, in_one_band, for_sensors, by_polygons;
};

World::World(std::shared_ptr<const Scene> scene, const Plan& plan)
    : scene_(std::move(scene)),
      planned_(scene_as_planned(scene_, plan)),
      for_sensors_(scene_for_sensors(scene_, plan)),
      lamp_color_(plan.lamp_colour),
      tracing_(*scene_, plan.coverings ? *plan.coverings : Coverings(), blockers_of(plan), reflections_of(plan)),
      later_(std::make_unique<Later>()) {}

World::~World() = default;

std::shared_ptr<const World> World::in_bands(const std::vector<Eigen::Index>& bands, const Plan& plan) const {
  return std::make_shared<const World>(std::make_shared<const Scene>(patchlight::in_bands(*scene_, bands)), plan);
}

const Lighting& World::lighting() const {
  return later_->planned.of([this] { return lighting_of(*planned_, tracing_); });
}

const Lighting& World::lighting_in_one_band() const {
  assert(lamp_color_.size() > 0);
  Eigen::Index brightest = 0;
  lamp_color_.maxCoeff(&brightest);
  return later_->in_one_band.of([&] { return lighting_of(in_one_band(*planned_, brightest), tracing_); });
}

const Lighting& World::sensor_lighting() const {
  if (for_sensors_ == planned_) return lighting();
  return later_->for_sensors.of([this] { return lighting_of(*for_sensors_, tracing_); });
}

const Lighting& World::lighting_by_polygons() const {
  return later_->by_polygons.of([this] {
    Lighting faces_alone = lighting();  // with the same chains of mirrors
    faces_alone.luminaires.clear();
    faces_alone.sun.reset();
    faces_alone.sky.reset();
    faces_alone.openings.clear();
    return faces_alone;
  });
}

}  // namespace patchlight
