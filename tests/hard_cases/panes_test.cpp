#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

#include "mesh/mesher.h"
#include "optics/surface_optics.h"
#include "render/render.h"
#include "support/scenes.h"
#include "verify/path_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tuple>

namespace patchlight::panes_test {
namespace {

using namespace test;

// A scene in units of this many meters, optionally turned.
struct Placing {
  double unit = 1;
  bool turned = false;

  Eigen::Affine3d motion() const {
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    if (turned) motion.rotate(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
    motion.scale(unit);
    return motion;
  }
  Scene of(Scene scene) const {
    scene = moved(std::move(scene), motion());
    scene.up = motion().rotation() * scene.up;
    if (scene.sun) scene.sun->direction = motion().rotation() * scene.sun->direction;
    return scene;
  }
};

Material glass(double transmittance, double reflectance, double exitance = 0) {
  Material material = grey(reflectance, exitance);
  material.transmittance = Spectrum::Constant(1, transmittance);
  return material;
}

// The fraction of diffuse light that a pane does not transmit.
double held_by(double transmittance) {
  const Scene scene = with_quad(empty_scene({glass(transmittance, 0)}),
                                {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  return SurfaceOptics(scene).nonspecular_fraction(0, Side::front);
}

// An upright rectangle in a plane of constant x whose front faces -x or +x.
Quad across_x(double x, double y0, double y1, double z0, double z1, bool to_low_x) {
  Quad quad{Point(x, y0, z0), Point(x, y0, z1), Point(x, y1, z1), Point(x, y1, z0)};
  if (!to_low_x) std::swap(quad[1], quad[3]);
  return quad;
}

Scene with_wall_around_opening(Scene scene, double x, double z1, bool to_low_x) {
  for (const Quad& quad : {across_x(x, 0, 1, 0, z1, to_low_x), across_x(x, 2, 3, 0, z1, to_low_x),
                           across_x(x, 1, 2, 0, 0.5, to_low_x), across_x(x, 1, 2, 2, z1, to_low_x)})
    scene = with_quad(std::move(scene), quad);
  return scene;
}

// Two rooms of 4 x 3 x 2.5 and 3 x 3 x 2.5 m, joined by an opening of 1 x 1.5 m through a wall 0.2 m thick. A pane,
// material 1 and the last polygon, fills the middle of the opening. Material 2 is the ceiling of the larger room.
Scene joined_rooms(const Material& wall, const Material& pane, const Material& ceiling) {
  Scene scene = empty_scene({wall, pane, ceiling});
  std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 4, 5})
    scene = with_quad(std::move(scene), faces[k], k == 1 ? MaterialIndex{2} : MaterialIndex{0});
  faces = box_faces(Point(4.2, 0, 0), Point(7.2, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 3, 4}) scene = with_quad(std::move(scene), faces[k]);
  scene = with_wall_around_opening(std::move(scene), 4, 2.5, true);
  scene = with_wall_around_opening(std::move(scene), 4.2, 2.5, false);
  faces = box_faces(Point(4, 1, 0.5), Point(4.2, 2, 2), true);
  for (const std::size_t k : {0, 1, 2, 4}) scene = with_quad(std::move(scene), faces[k]);
  scene = with_quad(std::move(scene), across_x(4.1, 1, 2, 0.5, 2, true), 1);
  scene.polygons.back().back_material = 1;
  return scene;
}

// With pairs, which include the reflection of panes.
Request fronts(PatchIndex patches) {
  Request request;
  request.assembly.storage = Storage::tiles;
  request.mesh.sides = Sides::front;
  request.mesh.patches = patches;
  request.solver.relative_error = 1e-9;
  return request;
}

// A closed room of 4 x 3 x 2.5 m with a pane of 1.5 m^2 to the outside, the last polygon.
Scene room_with_window(double transmittance) {
  Scene scene = empty_scene({grey(0.6, 0.4), glass(transmittance, 0)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 4, 5}) scene = with_quad(std::move(scene), faces[k]);
  scene = with_wall_around_opening(std::move(scene), 4, 2.5, true);
  return with_quad(std::move(scene), across_x(4, 1, 2, 0.5, 2, true), 1);
}

// Transmittance and storage.
class Window : public testing::TestWithParam<std::tuple<double, Storage>> {};

// The pane sees only the room, sum_i A_i F_i,pane = A_pane, and transmits the fraction tau of diffuse light. Each of n
// rays of N patches escapes or not, so the sum has the variance tau A_pane A / (N n).
TEST_P(Window, LetsOutItsShareOfTheLight) {
  const auto [stated, storage] = GetParam();
  const double tau = 1 - held_by(stated);
  const Scene scene = room_with_window(stated);
  Request request = fronts(400);
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  const Simulation simulation = simulate(scene, request);
  const PatchRange pane = simulation.mesh.patches_on(static_cast<PolygonIndex>(scene.polygons.size() - 1), Side::front);
  const Eigen::Map<const Eigen::VectorXd> area(simulation.mesh.area.data(), simulation.mesh.size());
  const Eigen::VectorXd escaping = area.cwiseProduct(simulation.transport.lost.escaped);
  const double of_pane = escaping.segment(pane.begin, pane.end - pane.begin).sum();
  const double least_rays = 32;  // per patch
  const double expected = tau * 1.5;
  const double standard_error = std::sqrt(expected * area.sum() / (least_rays * simulation.mesh.size()));
  EXPECT_NEAR(escaping.sum() - of_pane, expected, 4 * standard_error);
  EXPECT_LT(4 * standard_error, 0.6 * expected) << "nothing would be seen";
}

INSTANTIATE_TEST_SUITE_P(HardCases, Window,
                         testing::Combine(testing::Values(0.3, 0.5, 0.8),
                                          testing::Values(Storage::tiles, Storage::rays)));

// Transmittance and reflectance of the pane; placing.
class FurnaceWithAPane : public testing::TestWithParam<std::tuple<std::pair<double, double>, Placing>> {};

TEST_P(FurnaceWithAPane, IsOneOnBothSides) {
  // All light is 1: walls emit E = 1 - rho. The pane emits E = h - rho, where h = 1 - tau is the fraction of diffuse
  // light that it does not transmit. So H = 1 everywhere, B = 1 on walls and B = h on the pane. Closure makes the row
  // sums exact up to rounding.
  const auto [of_pane, placing] = GetParam();
  const auto [stated, rho] = of_pane;
  const double held = held_by(stated);
  const Scene scene = placing.of(joined_rooms(grey(0.6, 0.4), glass(stated, rho, held - rho), grey(0.6, 0.4)));
  const Simulation simulation = simulate(scene, fronts(500));
  const PolygonIndex pane = static_cast<PolygonIndex>(scene.polygons.size() - 1);
  EXPECT_TRUE(simulation.transport.lost.closed());
  EXPECT_EQ(simulation.mesh.patches_on(pane, Side::front).end - simulation.mesh.patches_on(pane, Side::front).begin,
            simulation.mesh.patches_on(pane, Side::back).end - simulation.mesh.patches_on(pane, Side::back).begin);
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    const double expected = simulation.mesh.polygon[i] == pane ? held : 1;
    EXPECT_NEAR(simulation.solution.irradiance(i, 0), 1, 1e-6);
    EXPECT_NEAR(simulation.solution.radiosity(i, 0), expected, 1e-6);
  }
  EXPECT_LT(simulation.balance.imbalance, 1e-6);
  EXPECT_NEAR(simulation.transport.raw_row_sum.mean(), 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(HardCases, FurnaceWithAPane,
                         testing::Combine(testing::Values(std::pair(1.0, 0.0), std::pair(0.5, 0.5),
                                                          std::pair(0.7, 0.1)),
                                          testing::Values(Placing{1, false}, Placing{0.001, true})));

TEST(JoinedRooms, AreLitThroughAPaneAsByPaths) {
  // The ceiling of the larger room is the lamp; the walls of the smaller room get light through the pane only. Paths
  // have an error of 1 %, patches of 0.3 m one of 3 %.
  const Scene scene = joined_rooms(grey(0.6), glass(0.6, 0.2), grey(0.6, 10));
  const Simulation simulation = simulate(scene, fronts(1500));
  const KeptSides sides = kept_sides(scene, Sides::front);
  for (const PolygonIndex p :
       {PolygonIndex{5}, PolygonIndex{8}, static_cast<PolygonIndex>(scene.polygons.size() - 1)}) {
    const std::vector<Point> corners = corner_points(scene, p);
    const PathReceiver receiver{{corners[0], corners[1], corners[2], corners[3]}, p, Side::front};
    const PathEstimate paths =
        trace_irradiance(scene, sides, {&receiver, 1}, {.paths = 1 << 15, .follows_reflections = false});
    double flux = 0;
    double area = 0;
    const PatchRange range = simulation.mesh.patches_on(p, Side::front);
    for (PatchIndex i = range.begin; i < range.end; ++i) {
      flux += simulation.mesh.area[i] * simulation.solution.irradiance(i, 0);
      area += simulation.mesh.area[i];
    }
    EXPECT_GT(flux, 0);
    EXPECT_NEAR(flux / area, paths.irradiance(0, 0), 3 * paths.standard_error(0, 0) + 0.03 * paths.irradiance(0, 0))
        << p;
  }
}

// A room with a window of 1 x 1.5 m in its wall at x = 4. Outside, 6 x 9 m of ground lie in the sun, which does not
// shine into the room. The last polygon is the pane, material 1, unless the window is a hole.
Scene room_before_lit_ground(const std::optional<Material>& pane) {
  Scene scene = empty_scene({grey(0.5), pane.value_or(grey(0))});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const std::size_t k : {0, 1, 2, 4, 5}) scene = with_quad(std::move(scene), faces[k]);
  scene = with_wall_around_opening(std::move(scene), 4, 2.5, true);
  scene = with_quad(std::move(scene), {Point(4, -3, 0), Point(10, -3, 0), Point(10, 6, 0), Point(4, 6, 0)});
  scene.sun = Sun{Vector(-0.3, 0.2, 0.9).normalized(), Spectrum::Constant(1, 500)};
  if (!pane) return scene;
  scene = with_quad(std::move(scene), across_x(4, 1, 2, 0.5, 2, true), 1);
  scene.polygons.back().back_material = 1;
  return scene;
}

struct Readings {
  double mean = 0;  // irradiance of the room's patches, weighted by area
  Field desk;       // irradiance at sensors
};

Readings readings_of(const Scene& scene, const Placing& placing) {
  Request request = fronts(0);
  request.mesh.patches.reset();
  request.mesh.max_edge = 0.4 * placing.unit;
  const Simulation simulation = simulate(scene, request);
  Readings readings;
  double area = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (simulation.mesh.polygon[i] >= 9) continue;
    readings.mean += simulation.mesh.area[i] * simulation.solution.irradiance(i, 0);
    area += simulation.mesh.area[i];
  }
  readings.mean /= area;
  std::vector<Sensor> desk;
  for (const double x : {1.0, 2.0, 3.0, 3.5})
    desk.push_back({placing.motion() * Point(x, 1.4, 0.8), placing.motion().rotation() * Vector::UnitZ()});
  readings.desk =
      gather_irradiance(simulation.mesh, simulation.solution.radiosity, Occluder(scene, Occluder::Blockers::all), desk)
          .irradiance;
  return readings;
}

class PaneBeforeLitGround : public testing::TestWithParam<Placing> {};

TEST_P(PaneBeforeLitGround, LetsInWhatAHoleDoes) {
  // A pane that transmits everything changes nothing: within 1 % at patches and at a desk.
  const Placing placing = GetParam();
  const Readings hole = readings_of(placing.of(room_before_lit_ground({})), placing);
  EXPECT_GT(hole.mean, 1);
  const Readings pane = readings_of(placing.of(room_before_lit_ground(glass(1, 0))), placing);
  EXPECT_NEAR(pane.mean / hole.mean, 1, 0.01);
  for (Eigen::Index k = 0; k < hole.desk.rows(); ++k) EXPECT_NEAR(pane.desk(k, 0) / hole.desk(k, 0), 1, 0.01) << k;
}

INSTANTIATE_TEST_SUITE_P(HardCases, PaneBeforeLitGround, testing::Values(Placing{1, false}, Placing{0.001, true}));

// Cosine of the angle between the camera's view and the normal of the pane.
class PaneInAPicture : public testing::TestWithParam<double> {};

TEST_P(PaneInAPicture, ShowsItsOwnLightAndWhatIsBehind) {
  // A pane with B = 2 in front of a wall with B = 5 emits B (1 - T) / h and transmits T. Over a pixel of width 4e-4, T
  // varies by less than 1e-4 at 60 degrees.
  Scene scene = empty_scene({grey(0.5), glass(0.6, 0.4)});
  scene = with_quad(std::move(scene), across_x(2, -5, 5, -5, 5, true));
  scene = with_quad(std::move(scene), across_x(1, -5, 5, -5, 5, true), 1);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 10);
  const Occluder occluder(scene, Occluder::Blockers::all);
  Field radiosity(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = mesh.polygon[i] == 0 ? 5 : 2;
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  const double cosine = GetParam();
  const Image image = render(mesh, smooth(mesh, radiosity, area, occluder), occluder, occluder.optics(),
                             {Point(0, 0, 0), Point(cosine, std::sqrt(1 - cosine * cosine), 0), 0.1}, Vector::UnitZ(),
                             {.width = 4, .height = 4});
  const double T = transmittance(pane_of(1.52, 0.6), cosine);
  const double held = held_by(0.6);
  EXPECT_NEAR((image.pixels - (2 * (1 - T) / held + T * 5)).abs().maxCoeff(), 0, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(HardCases, PaneInAPicture, testing::Values(1.0, 0.5));

TEST(PanesOnTheWay, MultiplyForSegmentsAndPackets) {
  // Three panes and a wall between places 0 to 4 along x. Without panes the result has the same bits as occluded().
  Scene scene = empty_scene({grey(0.5), glass(0.5, 0), glass(0.8, 0)});
  for (int k = 0; k < 3; ++k)
    scene = with_quad(std::move(scene), across_x(k + 0.5, -5, 5, -5, 5, true), k == 1 ? 2 : 1);
  scene = with_quad(std::move(scene), across_x(3.5, -5, 5, -5, 5, true));
  const Occluder occluder(scene, Occluder::Blockers::all);
  const auto at = [](double x) { return Point(x, 0.3, 0.2); };
  const std::vector<Segment> segments{{at(0), at(1)}, {at(0), at(2)},   {at(3), at(0)},
                                      {at(0), at(4)}, {at(0.6), at(1)}, {at(0.5), at(2), 0, no_polygon}};
  // A segment that starts on a pane is weighted by the pane's directional emission relative to h.
  const std::vector<float> expected{0.5F, 0.4F, 0.2F, 0, 1, static_cast<float>(0.8 * 0.5 / held_by(0.5))};
  const std::vector<float> share = occluder.transmittance(segments);
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_FLOAT_EQ(share[k], expected[k]) << k;
  ShadowPacket packet{};
  for (std::size_t k = 0; k < ShadowPacket::size; ++k) {
    const Segment& segment = segments[k % segments.size()];
    const Point from = occluder.frame().scale * (segment.from - occluder.frame().centre);
    const Vector toward = occluder.frame().scale * (segment.to - segment.from);
    packet.from_x[k] = static_cast<float>(from.x());
    packet.from_y[k] = static_cast<float>(from.y());
    packet.from_z[k] = static_cast<float>(from.z());
    packet.toward_x[k] = static_cast<float>(toward.x());
    packet.toward_y[k] = static_cast<float>(toward.y());
    packet.toward_z[k] = static_cast<float>(toward.z());
    packet.from_polygon[k] = segment.from_polygon;
    packet.to_polygon[k] = segment.to_polygon;
  }
  const auto shares = occluder.transmittance(packet);
  for (std::size_t k = 0; k < ShadowPacket::size; ++k) EXPECT_FLOAT_EQ(shares[k], expected[k % expected.size()]) << k;
  EXPECT_FALSE(occluder.hides({&segments[0].from, 1}, {&segments[0].to, 1}));
  EXPECT_TRUE(occluder.hides({&segments[3].from, 1}, {&segments[3].to, 1}));
}

}  // namespace
}  // namespace patchlight::panes_test
