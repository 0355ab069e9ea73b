#include "archive/ray_row_files.h"

#include "patchlight/base/error.h"
#include "patchlight/simulate.h"

#include "archive/npy.h"
#include "archive/scene_hash.h"
#include "support/scenes.h"
#include "support/test_room.h"
#include "unit/output/temporary_folder.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight::ray_row_files_test {
namespace {

namespace fs = std::filesystem;
using namespace test;

Request by_rays() {
  Request request;
  request.mesh.max_edge = 0.4;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  return request;
}

// A point lamp just above the floor makes a patch so bright that rays are aimed at it. Their hits are entries.
Scene room_with_bright_spot() {
  Scene scene = test_room(0.6);
  Luminaire lamp;
  lamp.position = Point(0.6, 0.6, 0.1);
  lamp.light = PointLight{Spectrum::Constant(scene.materials[0].reflectance.size(), 0.5)};
  scene.luminaires = {lamp};
  return scene;
}

// A folder of the rows of the room.
class RayRowFiles : public testing::Test {
 protected:
  RayRowFiles() { write_ray_rows(place_, scene_, found_, "a command"); }

  RayExchange read() const { return read_ray_rows(place_, read_form_factor_info(place_), found_.mesh); }

  static Simulation solved(const Scene& scene, const RayExchangeOf& exchange) {
    Steps with;
    with.ray_exchange = exchange;
    return simulate(scene, by_rays(), {}, with);
  }

  // With the stored rows.
  Simulation relit(const Scene& scene) const {
    const FormFactorInfo info = read_form_factor_info(place_);
    return solved(scene, [&](const PatchMesh& mesh) { return read_ray_rows(place_, info, mesh); });
  }

  template <class Number>
  void overwrite(const char* name, std::size_t count, std::size_t place, Number value) {
    LargeArray<Number> values = read_npy_numbers<Number>(place_ / name, count);
    values.at(place) = value;
    write_npy_numbers(place_ / name, std::span<const Number>(values));
  }

  Scene scene_ = room_with_bright_spot();
  RayFormFactors found_ = find_ray_form_factors(scene_, by_rays());
  TemporaryFolder folder_;
  fs::path place_ = folder_.path() / "room.ff";
};

TEST_F(RayRowFiles, GiveBackEveryBit) {
  ASSERT_GT(found_.exchange.rows.halves[0].entries.size(), 0);
  const Simulation at_once = solved(scene_, [&](const PatchMesh&) { return found_.exchange; });
  const Simulation from_folder = relit(scene_);
  EXPECT_TRUE((from_folder.solution.radiosity == at_once.solution.radiosity).all());
  EXPECT_TRUE((from_folder.ray_standard_error == at_once.ray_standard_error).all());
  // No ray is traced, so the error from the size of the patches is unknown.
  EXPECT_EQ(from_folder.transport.counts.shadow_rays, 0);
  EXPECT_FALSE(from_folder.error_bars);
}

// A tent of mirrors on the floor. Rays under it meet only faces that touch the floor, unless mirrors redirect them.
// Rows and solutions cover the same patches.
TEST(RayRowFilesOfMirrors, AreOfTheSamePatchesAsASolution) {
  Scene scene = test_room(0.6);
  Material mirror = scene.materials[0];
  mirror.name = "mirror";
  mirror.reflectance *= 0;
  mirror.specular_reflectance = Spectrum::Constant(mirror.reflectance.size(), 0.9);
  scene.materials.push_back(mirror);
  const auto material = static_cast<MaterialIndex>(scene.materials.size() - 1);
  const Point ridge(0.7, 0.7, 0.2);
  const std::array<Point, 4> feet{Point(0.5, 0.5, 0), {0.9, 0.5, 0}, {0.9, 0.9, 0}, {0.5, 0.9, 0}};
  for (std::size_t k = 0; k < 4; ++k)
    scene = with_polygon(std::move(scene), {feet[k], feet[(k + 1) % 4], ridge}, material);
  const RayFormFactors found = find_ray_form_factors(scene, by_rays());
  Steps with;
  std::string hash;
  with.ray_exchange = [&](const PatchMesh& mesh) -> RayExchange {
    hash = geometry_hash(mesh);
    throw Canceled();
  };
  EXPECT_THROW(simulate(scene, by_rays(), {}, with), Canceled);
  EXPECT_EQ(hash, geometry_hash(found.mesh));
}

// B is linear in E: a lamp of twice the exitance gives exactly twice the light, because 2 is a power of two.
TEST_F(RayRowFiles, AreOfAnyLight) {
  Scene brighter = scene_;
  for (Material& material : brighter.materials) material.exitance = material.exitance * 2;
  for (Luminaire& lamp : brighter.luminaires) std::get<PointLight>(lamp.light).intensity *= 2;
  const Simulation once = relit(scene_);
  EXPECT_TRUE((relit(brighter).solution.radiosity == 2 * once.solution.radiosity).all());
}

// Other reflectances, compared with all pairs on the same mesh. The room has no luminaire, because the pair method
// refines its mesh around it. The bars are those of the rays alone.
TEST_F(RayRowFiles, AreOfAnyMaterial) {
  scene_.luminaires.clear();
  found_ = find_ray_form_factors(scene_, by_rays());
  write_ray_rows(place_, scene_, found_, "a command");
  Scene darker = scene_;
  for (Material& material : darker.materials) material.reflectance = material.reflectance * 0.5;
  const Simulation relit_room = relit(darker);
  Request pairs;
  pairs.mesh.max_edge = 0.4;
  pairs.assembly.samples = 16;
  const Simulation exact = simulate(darker, pairs);
  ASSERT_EQ(exact.mesh.size(), relit_room.mesh.size());
  const auto norm = [&](const Field& x) {
    return std::sqrt((x.square().colwise() * exact.problem.area.array()).sum());
  };
  const Field bars = relit_room.problem.scattering.reflectance * relit_room.ray_standard_error;
  const double ratio = norm(relit_room.solution.radiosity - exact.solution.radiosity) / norm(bars);
  EXPECT_LT(ratio, 1.5);
  EXPECT_GT(ratio, 0.3);
}

// The room with another lamp of 5 mm or 20 cm, with this flux in watts, or with that lamp alone.
Scene with_another_lamp(double size, double watts, bool alone) {
  Scene scene = test_room(0.6);
  if (alone)
    for (Material& material : scene.materials) material.exitance = Spectrum::Zero(material.exitance.size());
  scene.materials.push_back(grey(0.6, watts / (size * size)));
  scene.materials.back().name = "other lamp";
  const Point p(1, 0.8, 2.3);
  const auto material = static_cast<MaterialIndex>(scene.materials.size() - 1);
  return with_quad(std::move(scene),
                   {p, Point(p + Vector(0, size, 0)), Point(p + Vector(size, size, 0)), Point(p + Vector(size, 0, 0))},
                   material);
}

// Light of a lamp that was dark during the tracing, compared with all pairs. The error matches the stated one, which
// includes that lamp. Parameters: size; alone.
class NewLamp : public testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(NewLamp, IsFoundOrInTheBars) {
  const auto [size, alone] = GetParam();
  const RayFormFactors dark = find_ray_form_factors(with_another_lamp(size, 0, false), by_rays());
  const Scene lit = with_another_lamp(size, 4, alone);
  Steps with;
  with.ray_exchange = [&](const PatchMesh&) { return dark.exchange; };
  const Simulation relit = simulate(lit, by_rays(), {}, with);
  Request pairs;
  pairs.mesh.max_edge = 0.4;
  pairs.assembly.samples = 16;
  const Simulation exact = simulate(lit, pairs);
  ASSERT_EQ(exact.mesh.size(), relit.mesh.size());
  const auto norm = [&](const Field& x) {
    return std::sqrt((x.square().colwise() * exact.problem.area.array()).sum());
  };
  const Field bars = relit.problem.scattering.reflectance * relit.ray_standard_error;
  const double light = norm(exact.solution.radiosity - exact.problem.exitance);
  EXPECT_LT(norm(relit.solution.radiosity - exact.solution.radiosity), 1.5 * norm(bars));
  EXPECT_LT(norm(bars), 0.2 * light);
}

INSTANTIATE_TEST_SUITE_P(RayRows, NewLamp, testing::Combine(testing::Values(0.005, 0.2), testing::Bool()));

TEST_F(RayRowFiles, ReplaceAnEarlierFolderAndNothingElse) {
  EXPECT_NO_THROW(write_ray_rows(place_, scene_, found_, "again"));
  EXPECT_NO_THROW(check_form_factors_writable(place_));
  write_npy_numbers<double>(place_ / "mine.npy", std::vector<double>{1, 2});
  EXPECT_THROW(write_ray_rows(place_, scene_, found_, "again"), OutputError);
}

TEST_F(RayRowFiles, OfAnotherMeshAreRefused) {
  PatchMesh other = found_.mesh;
  other.vertices[0].x() += 0.01;
  EXPECT_THROW(read_ray_rows(place_, read_form_factor_info(place_), other), InputError);
}

TEST_F(RayRowFiles, ThatCannotBeAreRefused) {
  EXPECT_NO_THROW(read());
  const std::size_t patches = found_.mesh.size();
  const std::size_t hits = found_.exchange.rows.halves[0].hits.size();
  const std::size_t entries = found_.exchange.rows.halves[0].entries.size();
  ASSERT_GT(entries, 0);
  const double infinite = std::numeric_limits<double>::infinity();
  const auto expect_refused = [&](const auto& damage) {
    damage();
    EXPECT_THROW(read(), InputError);
    write_ray_rows(place_, scene_, found_, "a command");
  };
  expect_refused([&] { overwrite<std::int32_t>("hits_0.npy", hits, 5, static_cast<std::int32_t>(patches)); });
  expect_refused([&] { overwrite<std::int32_t>("hits_0.npy", hits, 5, -1); });
  expect_refused([&] { overwrite<std::int64_t>("hit_begin_0.npy", patches + 1, 1, -1); });
  expect_refused([&] { overwrite<std::int64_t>("hit_begin_0.npy", patches + 1, patches, 1'000'000'000'000'000); });
  expect_refused([&] { overwrite<double>("hit_weight_0.npy", patches, 3, 0); });
  expect_refused([&] { overwrite<double>("hit_weight_0.npy", patches, 3, infinite); });
  expect_refused([&] { overwrite<float>("entries_0.npy", entries, 0, 1e30F); });
  expect_refused([&] { overwrite<float>("entries_0.npy", entries, 0, -1); });
  expect_refused([&] { overwrite<std::int64_t>("lamps.npy", 2 * found_.exchange.emitters.size(), 0, -7); });
  expect_refused([&] { overwrite<float>("lamp_factors_1.npy", patches * found_.exchange.emitters.size(), 0, 1e30F); });
  expect_refused([&] { overwrite<float>("hit_distance.npy", patches, 0, -1); });
  expect_refused([&] { fs::remove(place_ / "entries_1.npy"); });
}

}  // namespace
}  // namespace patchlight::ray_row_files_test
