#include "patchlight/simulate.h"

#include "mesh/mesher.h"
#include "pipeline/problem_of.h"
#include "scene/less_detail.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>

namespace patchlight::textured_patches_test {
namespace {

// Rounding of a texel of at most 1 to single precision.
constexpr double of_floats = 6e-8;

const std::array<Spectrum, 3> of_rgb = {rgb(1, 0, 0), rgb(0, 1, 0), rgb(0, 0, 1)};

// A map of a unit square in x and y: u runs along x, v along y.
TextureMap map_along_axes() {
  TextureMap map;
  map.linear << 1, 0, 0, 0, 1, 0;
  map.offset.setZero();
  return map;
}

Polygon polygon(std::vector<std::uint32_t> corners, MaterialIndex material) {
  Polygon made;
  made.corners = std::move(corners);
  made.material = material;
  return made;
}

Material matt(const std::string& name, const Spectrum& reflectance) { return {name, reflectance, rgb(0, 0, 0)}; }

Material with_picture(Material material, Texture texture) {
  material.texture = {std::make_shared<const Texture>(std::move(texture)), of_rgb, {}};
  return material;
}

// A floor of 1 m x 1 m facing a lamp of the same size, 1 m above.
Scene floor_below_lamp(Material floor) {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  scene.materials = {std::move(floor), {"lamp", rgb(0.2, 0.3, 0.4), rgb(7, 8, 9)}};
  scene.groups = {"room"};
  scene.polygons = {polygon({0, 1, 2, 3}, 0), polygon({7, 6, 5, 4}, 1)};
  scene.polygons[0].texture_map = 0;
  scene.texture_maps = {map_along_axes()};
  scene.faces = 2;
  return scene;
}

// The floor in two parts, left and right of x = 1/2, in materials of their own.
Scene two_floors_below_lamp(const Material& left, const Material& right) {
  Scene scene = floor_below_lamp(left);
  scene.vertices.insert(scene.vertices.end(), {{0.5, 0, 0}, {0.5, 1, 0}});
  scene.materials.push_back(right);
  scene.polygons = {polygon({0, 8, 9, 3}, 0), polygon({8, 1, 2, 9}, 2), polygon({7, 6, 5, 4}, 1)};
  scene.texture_maps.clear();
  scene.faces = 3;
  return scene;
}

PatchMesh meshed(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

Request plain_request(double max_edge) {
  Request request;
  request.mesh.max_edge = max_edge;
  request.mesh.sides = Sides::front;
  request.solver.relative_error = 1e-10;
  return request;
}

Field reflectances(const Scene& scene, const PatchMesh& mesh) {
  Field reflectance(mesh.size(), 3);
  for (PatchIndex i = 0; i < mesh.size(); ++i) reflectance.row(i) = scene.materials[mesh.material[i]].reflectance;
  return with_textures(std::move(reflectance), scene, mesh);
}

Texture halves() { return {2, 1, {{1, 0, 0}, {1, 1, 1}}}; }

Texture checked() {
  return {3, 2, {{.1F, .2F, .3F}, {.9F, .8F, .7F}, {.5F, .1F, .6F}, {.3F, .3F, .9F}, {.2F, .7F, .1F}, {.8F, .6F, .4F}}};
}

TEST(TexturedPatches, OfAHalfRedAndHalfWhitePictureAreThoseOfTwoFaces) {
  const Scene one = floor_below_lamp(with_picture(matt("floor", rgb(1, 0.5, 0.5)), halves()));
  const PatchMesh mesh = meshed(one, 0.25);  // patches end at x = 1/2
  const Field rho = reflectances(one, mesh);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (mesh.polygon[i] != 0) continue;
    const bool red = mesh.centroid[i].x() < 0.5;
    EXPECT_TRUE((rho.row(i) - (red ? rgb(1, 0, 0) : rgb(1, 1, 1))).abs().maxCoeff() < 1e-12) << i;
  }
}

TEST(TexturedPatches, SendOutTheFluxOfTwoFaces) {
  const double half = 0.5;
  Texture texture{2, 1, {{.5F, .125F, .25F}, {.5F, .5F, .75F}}};
  const Scene one = floor_below_lamp(with_picture(matt("floor", rgb(.5, .3125, .5)), texture));
  const Scene two = two_floors_below_lamp(matt("left", rgb(.5, .125, .25)), matt("right", rgb(.5, .5, .75)));
  const auto flux = [half](const Scene& scene) {
    const Simulation simulation = simulate(scene, plain_request(0.25));
    Eigen::Array<double, 2, 3> sums = Eigen::Array<double, 2, 3>::Zero();
    for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
      if (simulation.mesh.centroid[i].z() > half) continue;
      sums.row(simulation.mesh.centroid[i].x() < half ? 0 : 1) +=
          simulation.mesh.area[i] * simulation.solution.radiosity.row(i);
    }
    return sums;
  };
  const auto of_one = flux(one);
  const auto of_two = flux(two);
  EXPECT_LT(((of_one - of_two) / of_two).abs().maxCoeff(), 1e-6);
}

// The mean over a face is the mean of its part of the texture, for any patches.
TEST(TexturedPatches, HaveTheMeanOfThePictureOverTheirFace) {
  const Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.5, 0.5, 0.5)), checked()));
  Spectrum expected = rgb(0, 0, 0);
  for (const auto& texel : scene.materials[0].texture->texture->texels)
    expected += rgb(texel[0], texel[1], texel[2]) / 6;
  for (const double max_edge : {2.0, 0.4, 0.13}) {
    const PatchMesh mesh = meshed(scene, max_edge);
    const Field rho = reflectances(scene, mesh);
    Spectrum mean = rgb(0, 0, 0);
    for (PatchIndex i = 0; i < mesh.size(); ++i)
      if (mesh.polygon[i] == 0) mean += mesh.area[i] * rho.row(i);
    EXPECT_LT((mean - expected).abs().maxCoeff(), 1e-12) << max_edge;
  }
}

// Mirrored and rotated by 90 degrees: the same texel lies at another corner.
TEST(TexturedPatches, FollowMirroredAndTurnedPictures) {
  const Texture corners{2, 2, {{.1F, 0, 0}, {.2F, 0, 0}, {.3F, 0, 0}, {.4F, 0, 0}}};  // at (u, v): 00, 10, 01, 11
  struct Case {
    Eigen::Matrix2d turn;
    std::array<double, 4> expected;  // of the quarters at (x, y): 00, 10, 01, 11
  };
  const auto rows = [](double a, double b, double c, double d) { return Eigen::Matrix2d{{a, b}, {c, d}}; };
  for (const Case& tried : {Case{rows(1, 0, 0, 1), {.1, .2, .3, .4}}, Case{rows(-1, 0, 0, 1), {.2, .1, .4, .3}},
                            Case{rows(1, 0, 0, -1), {.3, .4, .1, .2}}, Case{rows(0, 1, -1, 0), {.3, .1, .4, .2}},
                            Case{rows(0, -1, 1, 0), {.2, .4, .1, .3}}, Case{rows(0, 1, 1, 0), {.1, .3, .2, .4}}}) {
    Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.25, 0, 0)), corners));
    scene.texture_maps[0].linear.leftCols<2>() = tried.turn;
    const PatchMesh mesh = meshed(scene, 0.5);
    const Field rho = reflectances(scene, mesh);
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (mesh.polygon[i] != 0) continue;
      const std::size_t quarter = (mesh.centroid[i].x() > 0.5 ? 1 : 0) + (mesh.centroid[i].y() > 0.5 ? 2 : 0);
      EXPECT_NEAR(rho(i, 0), tried.expected[quarter], of_floats) << tried.turn << ", quarter " << quarter;
    }
  }
}

TEST(TexturedPatches, KeepTheEnergyBalanceAndBlackLampsTheirOwn) {
  const Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.5, 0.5, 0.5)), checked()));
  const Simulation simulation = simulate(scene, plain_request(0.3));
  EXPECT_LT(simulation.balance.imbalance, 1e-9);
  EXPECT_GT(simulation.problem.scattering.reflectance.col(0).maxCoeff(), 0.6) << "texels of 0.9 and 0.8 are there";
}

TEST(TexturedPatches, AreTheSameInAnyOrderOfFaces) {
  const Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.5, 0.5, 0.5)), checked()));
  Scene turned = scene;
  std::swap(turned.polygons[0], turned.polygons[1]);
  const Field one = reflectances(scene, meshed(scene, 0.3));
  const PatchMesh mesh = meshed(turned, 0.3);
  const Field other = reflectances(turned, mesh);
  const PatchRange floor = mesh.patches_on(1, Side::front);
  const auto count = static_cast<Eigen::Index>(floor.end - floor.begin);
  EXPECT_TRUE((one.topRows(count) == other.middleRows(floor.begin, count)).all());
}

TEST(TexturedPatches, HaveOneMeanForThePictureWhenTexturesAreSkipped) {
  const Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.5, 0.4, 0.3)), checked()));
  Request request = plain_request(0.3);
  request.effects.skip = {Effect::textures};
  Scene plain = scene;
  plain.materials[0].texture.reset();
  const Simulation skipped = simulate(scene, request);
  const Simulation without = simulate(plain, plain_request(0.3));
  EXPECT_TRUE((skipped.solution.radiosity == without.solution.radiosity).all());
}

TEST(TexturedPatches, SayHowManyMaterialsHavePicturesAndHowFarTexelsDiffer) {
  const Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(1, 0.5, 0.5)), halves()));
  const Simulation simulation = simulate(scene, plain_request(1));
  const auto& decisions = simulation.plan.decisions;
  const auto found =
      std::find_if(decisions.begin(), decisions.end(), [](const Decision& d) { return d.effect == Effect::textures; });
  ASSERT_NE(found, decisions.end());
  EXPECT_TRUE(found->simulate);
  EXPECT_EQ(found->reason,
            "1 of 2 materials has a texture; texels differ from the mean of their texture by up to 100 %, rms");
}

// Two triangles of one texture become a wall if the texture continues across their edge. Otherwise they stay separate.
TEST(TexturedPatches, LieOnFacesThatAreJoinedWhereThePictureGoesOn) {
  Scene scene = floor_below_lamp(with_picture(matt("floor", rgb(0.5, 0.5, 0.5)), checked()));
  scene.polygons[0].corners = {0, 1, 2};
  Polygon other = polygon({0, 2, 3}, 0);
  other.texture_map = 1;
  scene.polygons.push_back(other);
  scene.texture_maps.push_back(scene.texture_maps[0]);
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 2U);
  scene.texture_maps[1].offset.x() = 0.01;
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 3U);
  scene.polygons[2].texture_map = no_texture_map;
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 3U);
}

}  // namespace
}  // namespace patchlight::textured_patches_test
