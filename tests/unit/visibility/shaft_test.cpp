#include "visibility/shaft.h"

#include "base/sampling.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <gtest/gtest.h>

namespace patchlight::shaft_test {
namespace {

using namespace test;

Quad square_at(const Point& corner, const Vector& along_u, const Vector& along_v) {
  return {corner, corner + along_u, corner + along_u + along_v, corner + along_v};
}

std::vector<Point> points_of(const Quad& quad) { return {quad.begin(), quad.end()}; }

// Squares all over the faces of the furnished room.
std::vector<Quad> some_squares(const Scene& scene) {
  std::vector<Quad> squares;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> c = corner_points(scene, p);
    for (const double u : {0.1, 0.6}) {
      for (const double v : {0.1, 0.6}) {
        const Vector along_u = c[1] - c[0];
        const Vector along_v = c.back() - c[0];
        squares.push_back(square_at(c[0] + u * along_u + v * along_v, 0.3 * along_u, 0.3 * along_v));
      }
    }
  }
  return squares;
}

// Every ray passes a shaft that the culler reports as empty.
TEST(ShaftCuller, NothingStandsInAnEmptyShaft) {
  const Eigen::Affine3d motion(Eigen::Translation3d(50, 60, 70) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  for (const Scene& scene : {furnished_room(0.5), moved(furnished_room(0.5), motion)}) {
    const Occluder occluder(scene);
    const std::vector<Quad> squares = some_squares(scene);
    int empty = 0;
    int not_empty = 0;
    for (std::size_t a = 0; a < squares.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const ShaftCuller& culler = occluder.shafts();
        if (!culler.is_empty(culler.slabs(squares[a]), culler.slabs(squares[b]), {}, {})) {
          ++not_empty;
          continue;
        }
        ++empty;
        std::vector<Segment> segments;
        for (const auto& [u, v, s, t] : scrambled_sobol(64, 1)) {
          segments.push_back({square_to_quad({squares[a][0], squares[a][1], squares[a][2], squares[a][3]}, u, v),
                              square_to_quad({squares[b][0], squares[b][1], squares[b][2], squares[b][3]}, s, t)});
        }
        for (const std::uint8_t blocked : occluder.occluded(segments)) ASSERT_EQ(blocked, 0);
      }
    }
    EXPECT_GT(empty, 100);
    EXPECT_GT(not_empty, 100);
  }
}

// A wall across a room hides its halves from each other. A wall with a door does not where the door is visible through,
// and neither does a wall that is slightly too small.
TEST(Occluder, HidesWhatOnePolygonCutsOff) {
  const Scene room = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 4, 4), true);
  const std::vector<Point> left = points_of(square_at(Point(0, 1, 1), Vector(0, 1, 0), Vector(0, 0, 1)));
  const std::vector<Point> right = points_of(square_at(Point(4, 1, 1), Vector(0, 1, 0), Vector(0, 0, 1)));
  const auto hides = [&](const Scene& scene) { return Occluder(scene).hides(left, right); };
  EXPECT_FALSE(hides(room));
  EXPECT_TRUE(hides(with_quad(room, square_at(Point(2, 0, 0), Vector(0, 4, 0), Vector(0, 0, 4)))));
  EXPECT_TRUE(hides(with_quad(room, square_at(Point(2, 0.99, 0.99), Vector(0, 1.02, 0), Vector(0, 0, 1.02)))));
  EXPECT_FALSE(hides(with_quad(room, square_at(Point(2, 1.01, 0.99), Vector(0, 1.02, 0), Vector(0, 0, 1.02)))));
  const auto with_door = [&](double y) {
    return with_polygon(
        room, {Point(2, 0, 0), Point(2, 4, 0), Point(2, 4, 4), Point(2, 0, 4), Point(2, 0, 0), Point(2, y, 0.5),
               Point(2, y, 3), Point(2, y + 0.5, 3), Point(2, y + 0.5, 0.5), Point(2, y, 0.5)});
  };
  EXPECT_FALSE(hides(with_door(1.2)));
  EXPECT_TRUE(hides(with_door(3)));
}

// Rounding has bent a face, so its patches lie behind it in places. It does not hide them.
TEST(Occluder, DoesNotHidePatchesByTheirOwnPolygon) {
  const Scene room = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 4, 4), true);
  const std::vector<Point> left = points_of(square_at(Point(0.5, 1, 1), Vector(0, 1, 0), Vector(0, 0, 1)));
  const std::vector<Point> right = points_of(square_at(Point(4, 1, 1), Vector(0, 1, 0), Vector(0, 0, 1)));
  const auto plate = [](double x) { return square_at(Point(x, 0.5, 0.5), Vector(0, 2, 0), Vector(0, 0, 2)); };
  const PolygonIndex own = 6;
  const PolygonIndex no_other = 5;
  const Scene before = with_quad(room, plate(0.501));
  EXPECT_TRUE(Occluder(before).hides(left, right));
  EXPECT_TRUE(Occluder(before).hides(left, right, {&no_other, 1}));
  EXPECT_FALSE(Occluder(before).hides(left, right, {&own, 1}));
  // Another face does, in either orientation.
  EXPECT_TRUE(Occluder(with_quad(before, plate(2))).hides(left, right, {&own, 1}));
}

TEST(ShaftCuller, FindsAThinPlateAndSmallThings) {
  const Scene room = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 4, 4), true);
  const std::vector<Point> floor = points_of(square_at(Point(1.5, 1.5, 0), Vector(1, 0, 0), Vector(0, 1, 0)));
  const std::vector<Point> ceiling = points_of(square_at(Point(1.5, 1.5, 4), Vector(0, 1, 0), Vector(1, 0, 0)));
  const auto is_empty = [&](const Scene& scene) {
    const ShaftCuller culler(scene, std::vector<std::uint8_t>(scene.polygons.size(), 0));
    return culler.is_empty(culler.slabs(floor), culler.slabs(ceiling), HalfSpace{Vector(0, 0, 1), 0},
                           HalfSpace{Vector(0, 0, -1), -4});
  };
  EXPECT_TRUE(is_empty(room));
  const Quad plate = square_at(Point(1.9, 1.9, 2), Vector(0.1, 0, 0), Vector(0, 0.1, 0));
  EXPECT_FALSE(is_empty(with_quad(room, plate)));
  const Quad speck = square_at(Point(2, 2, 2), Vector(1e-4, 0, 0), Vector(0, 0, 1e-4));
  EXPECT_FALSE(is_empty(with_quad(room, speck)));
  const Quad beside = square_at(Point(3, 1, 1), Vector(0, 2, 0), Vector(0, 0, 2));
  EXPECT_TRUE(is_empty(with_quad(room, beside)));
}

TEST(Occluder, PacketsAgreeWithSegments) {
  const Scene scene = furnished_room(0.5);
  const Occluder occluder(scene);
  const auto [centre, scale] = occluder.frame();
  const Box box = bounds(scene);
  std::vector<Segment> segments;
  for (const auto& [u, v, s, t] : scrambled_sobol(4096, 3)) {
    const Vector low = box.min() + Vector(u, v, s).cwiseProduct(box.sizes());
    const Vector high = box.min() + Vector(t, u, 1 - v).cwiseProduct(box.sizes());
    segments.push_back({low, high});
  }
  const std::vector<std::uint8_t> expected = occluder.occluded(segments);
  int different = 0;
  for (std::size_t k = 0; k < segments.size(); k += ShadowPacket::size) {
    ShadowPacket packet;
    packet.from_polygon.fill(no_polygon);
    packet.to_polygon.fill(no_polygon);
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
      const Eigen::Vector3f from = (scale * (segments[k + lane].from - centre)).cast<float>();
      const Eigen::Vector3f toward = (scale * (segments[k + lane].to - segments[k + lane].from)).cast<float>();
      packet.from_x[lane] = from.x();
      packet.from_y[lane] = from.y();
      packet.from_z[lane] = from.z();
      packet.toward_x[lane] = toward.x();
      packet.toward_y[lane] = toward.y();
      packet.toward_z[lane] = toward.z();
    }
    const unsigned blocked = occluder.occluded(packet);
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
      different += (blocked >> lane & 1) != expected[k + lane] ? 1 : 0;
    }
  }
  // An edge passes within the rounding of 1e-7 of a random ray with a probability of about 1e-6.
  EXPECT_LE(different, 1);
}

}  // namespace
}  // namespace patchlight::shaft_test
