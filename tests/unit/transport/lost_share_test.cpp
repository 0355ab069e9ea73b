#include "patchlight/transport/lost_share.h"

#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "mesh/mesher.h"
#include "scene/coverings.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::lost_share_test {
namespace {

using namespace test;

// A room of 3 x 3 x 3 m. Its floor is one patch, on which a box without a bottom covers this rectangle.
LostShare lost_under_box(const Point& low, const Point& high) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(3, 3, 3), true);
  const std::vector<Quad> faces = box_faces(low, high, false);
  for (std::size_t face = 1; face < faces.size(); ++face) scene = with_quad(std::move(scene), faces[face]);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 9);
  return measure_lost_share(mesh, Occluder(scene), 1024, 1);
}

// Rays start from all over a patch, wherever it sees backs. The 128 starting points are stratified: they estimate the
// fraction of a rectangle to a few hundredths, 4 / 128.
TEST(LostShare, FindsTheCoveredShareAnywhere) {
  const double expected = 2.8 / 9;
  const std::array<std::pair<Point, Point>, 4> boxes{{{Point(0.1, 0.1, 0), Point(1.1, 2.9, 1)},
                                                      {Point(1.9, 0.1, 0), Point(2.9, 2.9, 1)},
                                                      {Point(0.1, 0.1, 0), Point(2.9, 1.1, 1)},
                                                      {Point(0.1, 1.9, 0), Point(2.9, 2.9, 1)}}};
  for (const auto& [low, high] : boxes) {
    const LostShare lost = lost_under_box(low, high);
    EXPECT_NEAR(lost.covered[0], expected, 4.0 / 128);
    EXPECT_EQ(lost.escaped.sum() + lost.at_backs.sum(), 0);
  }
}

// A cube of 3 m with one patch a side. A rotated box without a bottom on its floor leaves little, half or most exposed.
// The root mean square error of the covered fraction over 40 seeds matches the stated one within a factor of two. That
// is exposure_errors() times the exposed fraction. 40 errors alone estimate it to a ninth; the rest is the variation of
// edges.
TEST(LostShare, ErrsAsStated) {
  for (const double half : {0.4, 0.9, 1.3}) {
    for (const double turn : {0.0, 0.2, 0.5}) {
      const Point middle(1.5, 1.5, 0);
      const auto at = [&](double x, double y, double z) {
        const Vector turned(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y, z);
        return Point(middle + turned);
      };
      // Around a smaller box if it would extend out of the room.
      const double h = std::min(half, 1.49 / (std::cos(turn) + std::sin(turn)));
      Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(3, 3, 3), true);
      const std::vector<Quad> faces = box_faces(Point(-h, -h, 0), Point(h, h, 1), false);
      for (std::size_t face = 1; face < faces.size(); ++face) {
        Quad quad = faces[face];
        for (Point& corner : quad) corner = at(corner.x(), corner.y(), corner.z());
        scene = with_quad(std::move(scene), quad);
      }
      const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 9);
      const Occluder occluder(scene);
      const double expected = 4 * h * h / 9;
      double squares = 0;
      double stated = 0;
      constexpr int seeds = 40;
      for (int seed = 0; seed < seeds; ++seed) {
        const LostShare lost = measure_lost_share(mesh, occluder, 256, static_cast<std::uint64_t>(seed));
        squares += std::pow(lost.covered[0] - expected, 2) / seeds;
        stated += std::pow(exposure_errors(lost)[0] * (1 - lost.covered[0]), 2) / seeds;
      }
      EXPECT_GT(squares, stated / 4) << "half " << half << " turned by " << turn;
      EXPECT_LT(squares, 4 * stated) << "half " << half << " turned by " << turn;
    }
  }
}

// A lintel between two jambs at the walls of a room. Where lintel and jamb touch, nothing else sees them. Rays through
// the solids still end on faces that touch a wall of the room.
TEST(LostShare, FindsContactBetweenSolidsThatTouchWalls) {
  for (const double metres : {1.0, 0.001}) {
    Scene scene = empty_scene({grey(0.5)});
    const auto add = [&](const Point& low, const Point& high, bool inward) {
      scene = with_box(std::move(scene), metres * low, metres * high, inward);
    };
    add(Point(0, 0, 0), Point(6, 3, 2.5), true);
    add(Point(2.95, 0, 0), Point(3.05, 1, 2.5), false);
    add(Point(2.95, 1.9, 0), Point(3.05, 3, 2.5), false);
    add(Point(2.95, 1, 2.05), Point(3.05, 1.9, 2.5), false);
    const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.25 * metres);
    const LostShare lost = measure_lost_share(mesh, Occluder(scene), 256, 1);
    int in_contact = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      const bool of_lintel = mesh.polygon[i] >= 18 && std::abs(mesh.normal[i].y()) > 0.5;
      if (!of_lintel) continue;
      ++in_contact;
      EXPECT_EQ(lost.covered[i], 1) << "patch " << i;
    }
    EXPECT_GE(in_contact, 4);
  }
}

LostShare lost_among_overlapping(const Scene& scene, const KeptSides& kept, const PatchMesh& mesh) {
  return measure_lost_share(mesh, Occluder(scene, Occluder::Blockers::all, find_coverings(scene, kept)), 256, 1);
}

// A rug on a floor, possibly with an underside, lies over it and faces the same way. Before a wall whose back is
// visible, both are fully visible.
TEST(LostShare, TakesNoRugForContact) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene = with_quad(std::move(scene), {Point(1, 1, 0), Point(3, 1, 0), Point(3, 3, 0), Point(1, 3, 0)});
  // A table top above them that faces down, and a board with its back to them.
  scene = with_quad(std::move(scene), {Point(1, 1, 1), Point(1, 3, 1), Point(3, 3, 1), Point(3, 1, 1)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 0, 2), Point(0, 4, 2), Point(0, 4, 0)});
  std::vector<double> at_backs;
  for (const bool has_underside : {false, true}) {
    KeptSides kept = kept_sides(scene, Sides::front);
    kept.back[0] = has_underside ? 1 : 0;
    const PatchMesh mesh = tessellate(scene, kept, 9);
    const LostShare lost = lost_among_overlapping(scene, kept, mesh);
    const PatchIndex top = mesh.patches_on(2, Side::front).begin;
    EXPECT_EQ(lost.covered[top], 0);
    at_backs.push_back(lost.at_backs[top]);
  }
  // A twentieth of the light, known to sqrt(0.05 * 0.95 / 256) or better by 256 groups of rays. Two estimates differ by
  // less than twice the root of two of that.
  EXPECT_GT(at_backs[0], 0);
  EXPECT_LT(at_backs[0], 0.1);
  EXPECT_NEAR(at_backs[1], at_backs[0], 0.039);
}

// A board before a facade, both of which face outdoors. In a scene of 10 m a ray without a hit is traced again from 0.1
// mm behind the board, where the facade is before it. The board sees the sky anyway.
TEST(LostShare, TakesNothingBehindAPatchForContact) {
  const auto square_at = [](double x, double half) {
    return Quad{Point(x, 5 - half, 5 - half), Point(x, 5 + half, 5 - half), Point(x, 5 + half, 5 + half),
                Point(x, 5 - half, 5 + half)};
  };
  for (const double distance : {3e-5, 6e-5, 9e-5}) {
    Scene scene = with_quad(empty_scene({grey(0.5)}), square_at(0, 5));
    scene = with_quad(std::move(scene), square_at(distance, 0.5));
    const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 20);
    ASSERT_EQ(mesh.size(), 2U);
    const LostShare lost = measure_lost_share(mesh, Occluder(scene), 256, 1);
    EXPECT_EQ(lost.covered[1], 0) << distance;
    EXPECT_EQ(lost.escaped[1], 1) << distance;
    EXPECT_EQ(lost.at_backs[1], 0) << distance;
  }
}

// A floor outdoors and a rug in its plane: the rug sees only the sky.
TEST(LostShare, TakesNoFloorForContactWithARug) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene = with_quad(std::move(scene), {Point(1, 1, 0), Point(3, 1, 0), Point(3, 3, 0), Point(1, 3, 0)});
  for (const bool has_underside : {false, true}) {
    KeptSides kept = kept_sides(scene, Sides::front);
    kept.back[0] = has_underside ? 1 : 0;
    const PatchMesh mesh = tessellate(scene, kept, 9);
    const LostShare lost = lost_among_overlapping(scene, kept, mesh);
    const PatchIndex rug = mesh.patches_on(1, Side::front).begin;
    EXPECT_EQ(lost.covered[rug], 0) << has_underside;
    EXPECT_EQ(lost.escaped[rug], 1) << has_underside;
  }
}

// Known values are not measured again. Here they are made up.
TEST(LostShare, OfKnownPatchesIsTakenOver) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 1);
  LostShare before = measure_lost_share(mesh, occluder, 64, 1);
  std::vector<PatchIndex> place(mesh.size(), no_patch);
  EXPECT_EQ(measure_lost_share(mesh, occluder, KnownShares{before, place}, 1).escaped, before.escaped);
  before.escaped[3] = before.at_backs[3] = before.covered[3] = before.dark[3] = 0.25;
  place[5] = 3;
  const LostShare taken_over = measure_lost_share(mesh, occluder, KnownShares{before, place}, 1);
  EXPECT_EQ(taken_over.rays_per_patch, 64);
  for (const auto share : {&LostShare::escaped, &LostShare::at_backs, &LostShare::covered, &LostShare::dark}) {
    EXPECT_EQ((taken_over.*share)[5], 0.25);
    EXPECT_NE((taken_over.*share)[3], 0.25);
  }
}

// Patches that see backs skip the preliminary rays. With this information the same rays give the same shares.
TEST(LostShare, OfPatchesKnownToSeeBacksIsTheSame) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(3, 3, 3), true);
  const std::vector<Quad> faces = box_faces(Point(1, 1, 0), Point(2, 2, 1), false);
  for (std::size_t face = 1; face < faces.size(); ++face) scene = with_quad(std::move(scene), faces[face]);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.5);
  const Occluder occluder(scene);
  const LostShare all = measure_lost_share(mesh, occluder, 256, 1);
  std::vector<PatchIndex> place(mesh.size(), no_patch);
  int see_backs = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (all.covered[i] + all.at_backs[i] > 0)
      ++see_backs;
    else
      place[i] = i;
  }
  ASSERT_GT(see_backs, 0);
  ASSERT_LT(see_backs, static_cast<int>(mesh.size()));
  const LostShare told = measure_lost_share(mesh, occluder, KnownShares{all, place, false, true}, 1);
  for (const auto share : {&LostShare::escaped, &LostShare::at_backs, &LostShare::covered, &LostShare::dark})
    EXPECT_EQ(told.*share, all.*share);
}

// A patch that is doubled twice gets four times as many rays. The others keep their rays, and the same bits.
TEST(LostShare, OfDoubledPatchesIsThatOfAsManyMoreRays) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(3, 3, 3), true);
  const std::vector<Quad> faces = box_faces(Point(0.3, 0.4, 0), Point(2.2, 1.9, 1), false);
  for (std::size_t face = 1; face < faces.size(); ++face) scene = with_quad(std::move(scene), faces[face]);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 1);
  const Occluder occluder(scene);
  const std::vector<PatchIndex> nowhere(mesh.size(), no_patch);
  std::vector<std::uint8_t> doublings(mesh.size(), 0);
  for (PatchIndex i = 0; i < mesh.size(); i += 2) doublings[i] = 2;
  LostShare none;
  none.rays_per_patch = 64;
  const LostShare found =
      measure_lost_share(mesh, occluder, KnownShares{.lost = none, .place = nowhere, .doublings = doublings}, 1);
  const LostShare few = measure_lost_share(mesh, occluder, 64, 1);
  const LostShare many = measure_lost_share(mesh, occluder, 256, 1);
  ASSERT_GT((few.covered.array() > 0 && few.covered.array() < 1).count(), 2);
  for (PatchIndex i = 0; i < mesh.size(); ++i) EXPECT_EQ(found.covered[i], (i % 2 == 0 ? many : few).covered[i]);
  const Eigen::ArrayXd exposed = exposure_errors(found);
  for (PatchIndex i = 0; i < mesh.size(); ++i) EXPECT_EQ(exposed[i], exposure_errors(i % 2 == 0 ? many : few)[i]);
}

}  // namespace
}  // namespace patchlight::lost_share_test
