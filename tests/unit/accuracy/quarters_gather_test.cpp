#include "accuracy/unseen_differences.h"
#include "form_factor/point_polygon.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight::quarters_gather_test {
namespace {

using namespace test;

// The gathered light in a room in which all surfaces send 1 W/m^2.
struct Gathered {
  PatchMesh mesh;
  GatheredQuarters rays;
};

GatheredQuarters gathered_of(const Scene& scene, const PatchMesh& mesh, const SolvedProblem& solved, int rays) {
  const Occluder occluder(scene, Occluder::Blockers::all);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size()));
  const LostShare lost{.escaped = zero, .at_backs = zero, .covered = zero};
  return gather_at_quarters({mesh, occluder, lost, solved}, {.rays = rays, .seed = 1}, {});
}

Gathered gathered(const Scene& scene, double max_edge, int rays) {
  Gathered found{tessellate(scene, kept_sides(scene, Sides::front), max_edge), {}};
  RadiosityProblem problem;
  problem.exitance = Field::Zero(found.mesh.size(), 1);
  Solution solution;
  solution.radiosity = solution.irradiance = Field::Ones(found.mesh.size(), 1);
  found.rays = gathered_of(scene, found.mesh, {problem, solution}, rays);
  return found;
}

// A floor of 4 x 4 m under a ceiling, and a board 2 cm above one half of it.
Scene board_over_half_a_floor() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 4, 2), true);
  for (const Quad& face : box_faces(Point(2.01, 0, 0.02), Point(4, 4, 0.04), false))
    scene = with_quad(std::move(scene), face);
  return scene;
}

// The part of a patch under the board is not visible from afar.
TEST(QuartersGather, IsOpenWhereNothingIsNear) {
  const auto [mesh, rays] = gathered(board_over_half_a_floor(), 0.2, 64);
  int free = 0;
  int under = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.normal[i].z() < 0.5 || mesh.centroid[i].z() > 0.01) continue;
    for (Eigen::Index q = 4 * Eigen::Index{i}; q < 4 * Eigen::Index{i} + 4; ++q) {
      if (mesh.centroid[i].x() > 2.2) {
        EXPECT_LT(rays.open[q], 0.1) << mesh.centroid[i].transpose();
        ++under;
      } else if (std::abs(mesh.centroid[i].x() - 1) < 0.3 && std::abs(mesh.centroid[i].y() - 2) < 0.8) {
        // Fewer than half of the rays meet the wall at 1 m.
        EXPECT_GT(rays.open[q], 0.5) << mesh.centroid[i].transpose();
        ++free;
      }
    }
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(under, 100);
}

// One byte stores the additional reflection at a point, to half of its step.
TEST(QuartersGather, KeepsWhatIsReflectedAtPoints) {
  EXPECT_FALSE(more_at_point(seen_as_quarter));
  EXPECT_FALSE(more_at_point(seen_as_whole));
  for (double more = -1; more <= 4; more += 0.1) EXPECT_NEAR(more_at_point(as_point(more)).value(), more, 0.0101);
  EXPECT_EQ(more_at_point(as_point(40)).value(), 4);
}

// A strip faces a close lamp of 25 patches, which are chosen by their flux. A dark plate between them faces the strip.
// Except for the plate and the lamp's edges, the strip's points see the lamp almost as its middle does. So the estimate
// from two rays and two shadow rays scatters little, though each ray may go to any patch of the lamp.
TEST(QuartersGather, TellsTheLightAtPointsBeforeManyLamps) {
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0, 1)}),
                          {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
  const std::vector<Point> lamp{Point(-.5, -.5, .02), Point(.5, -.5, .02), Point(.5, .5, .02), Point(-.5, .5, .02)};
  scene = with_quad(std::move(scene), {lamp[0], lamp[1], lamp[2], lamp[3]}, 1);
  scene = with_quad(std::move(scene),
                    {Point(-.2, -.02, .22), Point(-.2, .02, .22), Point(.2, .02, .22), Point(.2, -.02, .22)});
  scene = with_quad(std::move(scene),
                    {Point(-.02, -.02, .12), Point(.02, -.02, .12), Point(.02, .02, .12), Point(-.02, .02, .12)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.21);
  RadiosityProblem problem;
  problem.exitance = Field::Zero(mesh.size(), 1);
  Solution solution;
  solution.irradiance = Field::Zero(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] == 1) problem.exitance(i, 0) = 1;
    if (mesh.polygon[i] == 2) solution.irradiance(i, 0) = point_to_polygon(Point(0, 0, .22), -Vector::UnitZ(), lamp);
  }
  solution.radiosity = problem.exitance;
  const GatheredQuarters rays = gathered_of(scene, mesh, {problem, solution}, 64);
  double squares = 0;
  int points = 0;
  for (const std::uint8_t seen_as : rays.seen_as) {
    const std::optional<double> more = more_at_point(seen_as);
    if (!more) continue;
    squares += *more * *more;
    ++points;
  }
  EXPECT_GT(points, 20);
  // The ends of the strip get a tenth less. With shadow rays alone the root mean square is 0.6.
  EXPECT_LT(std::sqrt(squares / points), 0.3);
}

// A ray counts as far if its own patch is open and the patch that it meets is not near.
TEST(QuartersGather, SeesPatchesFromAfarOnlyFromWhereIsOpen) {
  const auto [mesh, rays] = gathered(board_over_half_a_floor(), 0.2, 16);
  int from_afar = 0;
  for (std::size_t ray = 0; ray < rays.met.size(); ++ray) {
    if (rays.seen_as[ray] != seen_as_whole) continue;
    ++from_afar;
    const auto patch = static_cast<PatchIndex>(ray / (4 * static_cast<std::size_t>(rays.rays)));
    EXPECT_GE(rays.open.segment<4>(4 * Eigen::Index{patch}).sum(), 4 * 0.5 - 1e-12);
    // Eight edges are at most 1.6 m long: an edge is no shorter than the root of half the area.
    const double distance = (mesh.centroid[rays.met[ray] / 4] - mesh.centroid[patch]).norm();
    EXPECT_GT(distance, 8 * std::sqrt(mesh.area[rays.met[ray] / 4]) - 2 * 0.3);
  }
  EXPECT_GT(from_afar, static_cast<int>(rays.met.size() / 8));
}

}  // namespace
}  // namespace patchlight::quarters_gather_test
