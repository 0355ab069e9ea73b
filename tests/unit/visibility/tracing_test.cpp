
#include "patchlight/simulate.h"

#include "lighting/lighting.h"
#include "pipeline/world.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <dlfcn.h>
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

namespace patchlight::tracing_test {
namespace {

using namespace test;

int scenes_of_embree = 0;

// Number of Embree scenes built during a call.
template <typename Do>
int built_by(const Do& something) {
  const int before = scenes_of_embree;
  something();
  return scenes_of_embree - before;
}

Scene daylit_room() {
  Scene scene = furnished_room(0.5);
  scene.sky = Sky{.kind = SkyKind::uniform, .horizontal_irradiance = Spectrum::Ones(1)};
  return scene;
}

Scene with_pane(Scene scene) {
  Material glass = grey(0.1);
  glass.transmittance = Spectrum::Constant(1, 0.8);
  scene.materials.push_back(glass);
  scene.polygons.back().material = static_cast<MaterialIndex>(scene.materials.size() - 1);
  return scene;
}

TEST(Tracing, BuildsOneSceneForEachSetOfBlockersInARun) {
  const Scene scene = daylit_room();
  Request request;
  request.mesh.patches = 100;
  request.accuracy.relative_error = 0.006;
  Simulation simulation;
  // Three scenes. The first has all faces, which rays meet and which block the light from outside. The second has the
  // faces that can stand between patches. The third has all faces for the plan, which finds the goal of a daylight run
  // before it has the blockers.
  EXPECT_EQ(built_by([&] { simulation = simulate(scene, request); }), 3);
  ASSERT_GT(simulation.accuracy.size(), 1U);
  EXPECT_EQ(built_by([&] {
              simulation.world->all_faces();
              simulation.world->lighting();
              simulation.world->all_faces();
            }),
            0);
}

TEST(Tracing, BuildsOneSceneMoreForOpaqueAndForClearFaces) {
  const Scene scene = with_pane(daylit_room());
  const Tracing tracing(scene);
  // The scene of all opaque faces. The panes weaken its light.
  EXPECT_EQ(built_by([&] { lighting_of(scene, tracing), lighting_of(scene, tracing); }), 2);
  EXPECT_EQ(built_by([&] { tracing.all_faces(), tracing.all_faces(); }), 2);
}

TEST(Tracing, HasNoClearFacesWithoutOpenings) {
  const Scene scene = furnished_room(0.5);
  const Tracing tracing(scene);
  EXPECT_EQ(tracing.clear_faces(), nullptr);
  EXPECT_EQ(tracing.opaque_faces().get(), &tracing.all_faces());
}

TEST(Tracing, SeesFromAnywhereWhatAnOccluderOfItsOwnSees) {
  for (const Scene& scene : {furnished_room(0.5), with_pane(furnished_room(0.5))}) {
    const Tracing tracing(scene);
    const Occluder own(scene, Occluder::Blockers::all);
    std::vector<Segment> segments;
    for (int k = 0; k < 1000; ++k) {
      const auto at = [k](int salt) { return std::fmod(0.618 * k * salt, 1.0); };
      segments.push_back({{at(1) - 0.3, at(2), at(3)}, {at(5), at(7) + 0.3, at(11)}});
    }
    EXPECT_EQ(tracing.all_faces().transmittance(segments), own.transmittance(segments));
  }
}

}  // namespace
}  // namespace patchlight::tracing_test

// Replaces Embree's own function, and calls it.
extern "C" RTCScene rtcNewScene(RTCDevice device) {
  ++patchlight::tracing_test::scenes_of_embree;
  using Function = RTCScene (*)(RTCDevice);
  static const auto embree = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "rtcNewScene"));
  return embree(device);
}
