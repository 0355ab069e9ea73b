#include "scene/openings.h"
#include "scene/repair.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <memory>
#include <utility>

namespace patchlight::solid_panes_test {
namespace {

using namespace test;

// A closed box of glass, 1.2 x 1 m, of this thickness, with its fronts outward.
Scene glass_box(double thickness) {
  Scene scene = empty_scene({grey(0.05)});
  scene.materials[0].transmittance = Spectrum::Constant(1, 0.8);
  return with_box(std::move(scene), Point(0, 0, 0), Point(1.2, 1, thickness), false);
}

Spectrum through(const Scene& scene, PolygonIndex polygon) {
  return scene.materials[scene.polygons[polygon].material].transmittance;
}

TEST(SolidPanes, CountOnce) {
  for (const double thickness : {0.004, 0.049}) {
    for (const Eigen::Affine3d& placing :
         {Eigen::Affine3d::Identity(), Eigen::Affine3d(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()))}) {
      const Scene scene = repair(moved(glass_box(thickness), placing));
      EXPECT_EQ(through(scene, 0)[0], 0.8);
      EXPECT_EQ(through(scene, 1)[0], 1);
      EXPECT_EQ(scene.materials[scene.polygons[1].material].reflectance[0], 0);
      EXPECT_FALSE(scene.materials[scene.polygons[0].material].second_face);
      EXPECT_TRUE(scene.materials[scene.polygons[1].material].second_face);
      for (PolygonIndex p = 2; p < 6; ++p) EXPECT_EQ(through(scene, p)[0], 0.8) << "the rim is farther apart";
      EXPECT_EQ(count_of(scene.diagnostics, DiagnosticCode::read_as_pane), 1);
    }
  }
}

TEST(SolidPanes, AreThinOfOneMaterialAndFaceOutward) {
  const auto expect_as_it_was = [](const Scene& scene) {
    const Scene found = with_solid_panes_as_one(scene);
    EXPECT_TRUE(found.diagnostics.empty());
    EXPECT_EQ(found.materials.size(), scene.materials.size());
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
      EXPECT_EQ(found.polygons[p].material, scene.polygons[p].material);
  };
  expect_as_it_was(glass_box(0.06));
  // An aquarium: its faces see each other.
  Scene inward = empty_scene({glass_box(0.01).materials[0]});
  expect_as_it_was(with_box(std::move(inward), Point(0, 0, 0), Point(1.2, 1, 0.01), true));
  Scene two_materials = glass_box(0.01);
  two_materials.materials.push_back(two_materials.materials[0]);
  two_materials.polygons[1].material = 1;
  expect_as_it_was(two_materials);
  // Double glazing of two panes, one face each, with the same orientation; and two panes side by side.
  Scene glazing = empty_scene({glass_box(0.01).materials[0]});
  const Quad pane{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  for (const Vector& at : {Vector(0, 0, 0), Vector(0, 0, 0.016), Vector(1, 0, 0.001)}) {
    Quad moved_pane = pane;
    for (Point& corner : moved_pane) corner += at;
    glazing = with_quad(std::move(glazing), moved_pane);
  }
  expect_as_it_was(glazing);
  expect_as_it_was(cube_room(0.5, 1));
}

// The two sides of a pane are cut along different diagonals, or one of them into strips. Light passes once at each
// point.
TEST(SolidPanes, CountOnceHoweverTheirSidesAreCut) {
  const auto at = [](double x, double y, double z) { return Point(1.2 * x, y, 0.02 * z); };
  const auto strips = [&](int count) {
    Scene scene = empty_scene({glass_box(0.01).materials[0]});
    scene = with_polygon(std::move(scene), {at(0, 0, 1), at(1, 0, 1), at(1, 1, 1)});
    scene = with_polygon(std::move(scene), {at(0, 0, 1), at(1, 1, 1), at(0, 1, 1)});
    for (int k = 0; k < count; ++k) {
      const double x = static_cast<double>(k) / count, end = static_cast<double>(k + 1) / count;
      scene = with_polygon(std::move(scene), {at(x, 1, 0), at(end, 1, 0), at(x, 0, 0)});
      scene = with_polygon(std::move(scene), {at(end, 1, 0), at(end, 0, 0), at(x, 0, 0)});
    }
    return scene;
  };
  for (const int count : {1, 2, 7}) {
    const Scene found = repair(strips(count));
    ASSERT_EQ(found.polygons.size(), static_cast<std::size_t>(2 + 2 * count));
    EXPECT_EQ(count_of(found.diagnostics, DiagnosticCode::read_as_pane), 1);
    for (PolygonIndex p = 0; p < found.polygons.size(); ++p) {
      EXPECT_EQ(through(found, p)[0], p < 2 ? 0.8 : 1) << p;
      EXPECT_EQ(found.polygons[p].back_material.has_value(), p < 2) << p;
    }
  }
  // Narrow double glazing with differently cut sheets: each of them counts once.
  Scene double_glazing = strips(3);
  for (const Polygon& polygon : strips(5).polygons) {
    Polygon moved_polygon = polygon;
    for (std::uint32_t& corner : moved_polygon.corners) {
      double_glazing.vertices.push_back(strips(5).vertices[corner] + Vector(0, 0, 0.025));
      corner = static_cast<std::uint32_t>(double_glazing.vertices.size() - 1);
    }
    double_glazing.polygons.push_back(moved_polygon);
  }
  const Scene two = repair(std::move(double_glazing));
  int counted_once = 0;
  for (const Polygon& polygon : two.polygons) counted_once += polygon.back_material.has_value();
  EXPECT_EQ(counted_once, 4) << "the two halves of the first side of each sheet";
  // A second side with a hole of a tenth of its area does not count.
  Scene open = strips(10);
  open.polygons.resize(open.polygons.size() - 2);
  const std::size_t materials = open.materials.size();
  EXPECT_EQ(with_solid_panes_as_one(std::move(open)).materials.size(), materials);
}

// A handle of the same glass on the back, 3 mm deep, and beside it a second pane without its back.
TEST(SolidPanes, CountOnceBesideSmallerPartsAndOpenPanes) {
  Scene scene = glass_box(0.01);
  scene = with_box(std::move(scene), Point(0.5, 0.5, 0.004), Point(0.52, 0.52, 0.0075), false);
  scene = with_quad(std::move(scene),
                    {Point(1.198, 0, 0.01), Point(2.4, 0, 0.01), Point(2.4, 1, 0.01), Point(1.198, 1, 0.01)});
  const Scene found = with_solid_panes_as_one(std::move(scene));
  EXPECT_EQ(through(found, 0)[0] * through(found, 1)[0], 0.8);
  EXPECT_EQ(through(found, 12)[0], 0.8) << "the open one";
}

// The second side has no spectra of its own, which would later replace its transmittance.
TEST(SolidPanes, LetSampledLightThroughOnce) {
  Scene scene = glass_box(0.01);
  scene.materials[0].spectra.transmittance = std::make_shared<const SampledSpectrum>();
  const Scene found = with_solid_panes_as_one(std::move(scene));
  EXPECT_TRUE(found.materials[found.polygons[1].material].second_face);
  EXPECT_EQ(found.materials[found.polygons[1].material].spectra.transmittance, nullptr);
}

TEST(SolidPanes, OfSeveralAreTakenInPairs) {
  // Three sheets of 6 mm, 10 mm apart. Pairs are the faces across 6 mm that face away from each other, not those across
  // gaps.
  Scene scene = empty_scene({glass_box(0.01).materials[0]});
  for (const double z : {0.0, 0.016, 0.032})
    scene = with_box(std::move(scene), Point(0, 0, z), Point(1, 1, z + 0.006), false);
  const Scene found = with_solid_panes_as_one(std::move(scene));
  double product = 1;
  for (PolygonIndex p = 0; p < found.polygons.size(); ++p)
    if (p % 6 < 2) product *= through(found, p)[0];
  EXPECT_NEAR(product, 0.8 * 0.8 * 0.8, 1e-15);
}

// Double glazing of two sheets of 6 mm, for any order of faces: the nearest ones are pairs.
TEST(SolidPanes, AreThoseWithTheNearestFaces) {
  const auto face = [](double z, bool up) {
    const Quad quad{Point(0, 0, z), Point(1, 0, z), Point(1, 1, z), Point(0, 1, z)};
    return up ? quad : Quad{quad[3], quad[2], quad[1], quad[0]};
  };
  std::array<std::pair<double, bool>, 4> sheets{{{0, false}, {0.006, true}, {0.016, false}, {0.022, true}}};
  do {
    Scene scene = empty_scene({glass_box(0.01).materials[0]});
    for (const auto& [z, up] : sheets) scene = with_quad(std::move(scene), face(z, up));
    const Scene found = with_solid_panes_as_one(std::move(scene));
    double product = 1;
    for (PolygonIndex p = 0; p < 4; ++p) product *= through(found, p)[0];
    EXPECT_NEAR(product, 0.8 * 0.8, 1e-15);
  } while (std::next_permutation(sheets.begin(), sheets.end()));
}

// Two sheets without thickness, 1 cm apart, with both sides drawn: each is already complete.
TEST(SolidPanes, AreNotMadeOfSheetsWithTwoSides) {
  Scene scene = empty_scene({glass_box(0.01).materials[0]});
  for (const double z : {0.0, 0.01}) {
    scene = with_quad(std::move(scene), {Point(0, 0, z), Point(1, 0, z), Point(1, 1, z), Point(0, 1, z)});
    scene = with_quad(std::move(scene), {Point(0, 1, z), Point(1, 1, z), Point(1, 0, z), Point(0, 0, z)});
  }
  const Scene found = repair(std::move(scene));
  ASSERT_EQ(found.polygons.size(), 2U);
  for (PolygonIndex p = 0; p < 2; ++p) EXPECT_EQ(through(found, p)[0], 0.8);
}

}  // namespace
}  // namespace patchlight::solid_panes_test
