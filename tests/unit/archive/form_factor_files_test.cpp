#include "archive/form_factor_files.h"

#include "patchlight/base/error.h"
#include "patchlight/simulate.h"

#include "archive/npy.h"
#include "archive/scene_file.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "unit/output/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace patchlight::form_factor_files_test {
namespace {

namespace fs = std::filesystem;
using namespace test;

Request coarse(bool close = true) {
  Request request;
  request.assembly.close = close;
  request.mesh.max_edge = 1;
  request.mesh.sides = Sides::front;
  request.solver.relative_error = 1e-9;
  return request;
}

// A closed room of 59 m^2 with a luminous box of 4.12 m^2 in it: every ray meets a patch.
Scene closed_room() {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10)});
  scene.materials[0].name = "wall";
  scene.materials[1].name = "lamp";
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
  return with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false, 1);
}

Scene without_a_wall(Scene scene) {
  scene.polygons.erase(scene.polygons.begin() + 2);
  return scene;
}

// Solved with form factors that were written to a folder and read again.
Simulation solved_from_folder(const Scene& scene, bool close) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const FormFactors found = find_form_factors(scene, coarse(close));
  write_form_factors(place, {scene, found, {}, "a command"});
  const FormFactorInfo info = read_form_factor_info(place);
  return simulate(scene, coarse(), {},
                  {.exchange = [&](const PatchMesh& mesh) { return read_exchange(place, info, mesh); }});
}

// A factor is rounded to float twice, 2^-24 each. Such errors in every entry of F change B by rho / (1 - rho) times as
// much: here 2 * 6e-8 * 0.5 / 0.5, plus the change by the closure. Raw factors are closed after reading, in an open
// scene by the errors of their entries.
class StoredFormFactors : public testing::TestWithParam<bool> {};

TEST_P(StoredFormFactors, GiveTheSameSolution) {
  for (const Scene& scene : {closed_room(), without_a_wall(closed_room())}) {
    const Simulation fresh = simulate(scene, coarse());
    const Simulation stored = solved_from_folder(scene, GetParam());
    const Field difference = stored.solution.irradiance - fresh.solution.irradiance;
    EXPECT_LT(difference.abs().maxCoeff(), 1e-6 * fresh.solution.irradiance.maxCoeff());
    EXPECT_EQ(stored.transport.closure, fresh.transport.closure);
    EXPECT_EQ(stored.transport.raw_row_sum, fresh.transport.raw_row_sum);
    EXPECT_EQ(stored.transport.lost.escaped, fresh.transport.lost.escaped);
    EXPECT_EQ(stored.transport.counts.shadow_rays, fresh.transport.counts.shadow_rays);
  }
}

INSTANTIATE_TEST_SUITE_P(RawAndClosed, StoredFormFactors, testing::Values(false, true));

// A folder with all optional contents. Every step is a sum of products with doubled numbers, which is exact.
TEST(StoredFormFactors, CarryTwiceTheLightOfTwiceTheExitance) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = closed_room();
  write_form_factors(place, {scene, find_form_factors(scene, coarse()), {}, "a command"});
  const FormFactorInfo info = read_form_factor_info(place);
  const auto irradiance = [&](double factor) {
    StoredScene stored = read_stored_scene(place);
    for (Material& material : stored.scene.materials) material.exitance *= factor;
    Request request = coarse();
    request.mesh.max_edge = info.max_edge;
    request.mesh.kept_sides = stored.sides;
    return simulate(stored.scene, request, {},
                    {.exchange = [&](const PatchMesh& mesh) { return read_exchange(place, info, mesh); }})
        .solution.irradiance;
  };
  const Field once = irradiance(1);
  EXPECT_GT(once.minCoeff(), 0);
  EXPECT_LE((irradiance(2) / once - 2).abs().maxCoeff(), 1e-12);
}

// The sums of closed rows are restored to the last digits, although each entry was stored as a float.
TEST(StoredFormFactors, OfAClosedRoomStayClosed) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = closed_room();
  const FormFactors found = find_form_factors(scene, coarse());
  write_form_factors(place, {scene, found, {}, "a command"});
  const ClosedExchangeAreas closed = close_exchange(read_exchange(place, read_form_factor_info(place), found.mesh));
  EXPECT_EQ(closed.method, found.exchange.closure);
  const Eigen::VectorXd sums = row_sums(closed.exchange_areas) + closed.remainder;
  EXPECT_LE((sums - found.exchange.area).cwiseQuotient(found.exchange.area).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LE(closed.remainder.cwiseQuotient(found.exchange.area).cwiseAbs().maxCoeff(), 3e-7);
}

TEST(StoredFormFactors, KnowHowTheyWereMade) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = closed_room();
  Request request = coarse();
  request.assembly.seed = ~std::uint64_t{0};
  request.assembly.samples = 32;
  const FormFactors found = find_form_factors(scene, request);
  write_form_factors(place, {scene, found, {}, "a command"});
  const FormFactorInfo info = read_form_factor_info(place);
  EXPECT_EQ(info.patches, found.mesh.size());
  EXPECT_EQ(info.max_edge, 1);
  EXPECT_EQ(info.sides, Sides::front);
  EXPECT_EQ(info.samples, 32);
  EXPECT_EQ(info.seed, request.assembly.seed);
  EXPECT_EQ(info.closure, "least squares");
}

// A folder without this key, as older versions wrote it.
TEST(StoredFormFactors, WithoutTheirEstimatorAreRead) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = closed_room();
  const FormFactors found = find_form_factors(scene, coarse());
  write_form_factors(place, {scene, found, {}, "a command"});
  nlohmann::json info = nlohmann::json::parse(content_of(place / "info.json"));
  info["options"].erase("estimator");
  put(place / "info.json", info.dump());
  const Exchange exchange = read_exchange(place, read_form_factor_info(place), found.mesh);
  EXPECT_EQ(exchange.counts.shadow_rays, found.exchange.counts.shadow_rays);
}

TEST(StoredFormFactors, HaveTheSamplingErrorsThatWereKept) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = closed_room();
  Request request = coarse();
  request.assembly.keep_errors = true;
  const FormFactors found = find_form_factors(scene, request);
  write_form_factors(place, {scene, found, {}, "a command"});
  const PatchIndex size = found.mesh.size();
  const Eigen::MatrixXd errors = read_npy(place / "sampling_error.npy", size, size);
  int differing = 0;
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) {
      const double expected = found.exchange.half_differences.at(i, j) / found.exchange.area[i];
      EXPECT_EQ(errors(i, j), static_cast<double>(static_cast<float>(expected)));
      differing += errors(i, j) != 0 ? 1 : 0;
    }
  }
  // Halves differ only where rays of a pair disagree.
  EXPECT_LE(differing, 2 * static_cast<int>(found.exchange.counts.partial_pairs));
  EXPECT_GT(differing, 0);
  // These belong to an earlier result.
  write_form_factors(place, {scene, find_form_factors(scene, coarse()), {}, "a command"});
  EXPECT_FALSE(fs::exists(place / "sampling_error.npy"));
}

// Stored factors can be read: with so few samples that rows are far from their sums, by every estimator, raw and
// closed, in an open and a closed room.
TEST(StoredFormFactors, OfEveryEstimatorAreTaken) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  for (const Scene& scene : {closed_room(), without_a_wall(closed_room())}) {
    for (const Estimator estimator :
         {Estimator::automatic, Estimator::area, Estimator::point_polygon, Estimator::hemisphere, Estimator::contour}) {
      for (const bool close : {false, true}) {
        Request request = coarse(close);
        request.assembly.estimator = estimator;
        request.assembly.samples = 4;
        const FormFactors found = find_form_factors(scene, request);
        write_form_factors(place, {scene, found, {}, "a command"});
        EXPECT_NO_THROW(read_exchange(place, read_form_factor_info(place), found.mesh))
            << name_of(estimator) << (close ? ", closed" : ", raw");
      }
    }
  }
}

// The first patch sees only the second, whose row is five times its maximum. So the row of the first patch is also cut
// to a fifth, although it was correct.
TEST(StoredFormFactors, BesideARowThatWasCutAreTaken) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = without_a_wall(closed_room());
  FormFactors found = find_form_factors(scene, coarse(false));
  Exchange& exchange = found.exchange;
  const Eigen::VectorXd& area = exchange.area;
  ExchangeAreas S = exchange.exchange_areas;
  for (PatchIndex j = 2; j < S.size(); ++j) {
    S.set(0, j, 0);
    S.set(1, j, static_cast<float>(5 * area[1] / (S.size() - 2)));
  }
  S.set(0, 1, static_cast<float>(0.9 * area[0]));
  exchange.raw_row_sum = row_sums(S).cwiseQuotient(area);
  ClosedExchangeAreas closed = close_exchange_areas(S, area, exchange.lost);
  EXPECT_LT(row_sums(closed.exchange_areas)[0], 0.2 * area[0]);
  exchange.exchange_areas = closed.exchange_areas;
  exchange.closure = closed.method;
  exchange.half_differences = {};
  write_form_factors(place, {scene, found, {}, "a command"});
  EXPECT_NO_THROW(read_exchange(place, read_form_factor_info(place), found.mesh));
}

// The bytes may have any value, but there must be a signed one for each pair.
TEST(StoredFormFactors, WithErrorsOfOtherPairsAreRefused) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  const Scene scene = without_a_wall(closed_room());
  const FormFactors found = find_form_factors(scene, coarse(false));
  write_form_factors(place, {scene, found, {}, "a command"});
  const std::string content = content_of(place / "half_differences.npy");
  const FormFactorInfo info = read_form_factor_info(place);
  EXPECT_NO_THROW(read_exchange(place, info, found.mesh));
  for (const std::string& damaged : {content.substr(0, content.size() - 1), content + '\0', std::string()}) {
    put(place / "half_differences.npy", damaged);
    EXPECT_THROW(read_exchange(place, info, found.mesh), InputError);
  }
  // Bytes without a sign are refused.
  std::string unsigned_bytes = content;
  unsigned_bytes.replace(content.find("|i1"), 3, "|u1");
  put(place / "half_differences.npy", unsigned_bytes);
  EXPECT_THROW(read_exchange(place, info, found.mesh), InputError);
  fs::remove(place / "half_differences.npy");
  EXPECT_EQ(read_exchange(place, info, found.mesh).half_differences.size(), 0U);
}

TEST(StoredFormFactors, OfAnotherGeometryAreRefused) {
  const TemporaryFolder folder;
  const fs::path place = folder.path() / "room.ff";
  Scene scene = furnished_room(0.5);
  Request request = coarse();
  request.mesh.contact_lines = false;
  const FormFactors found = find_form_factors(scene, request);
  write_form_factors(place, {scene, found, {}, "a command"});
  const FormFactorInfo info = read_form_factor_info(place);
  EXPECT_NO_THROW(read_exchange(place, info, found.mesh));
  // The last bit of one vertex.
  scene.vertices.back().x() = std::nextafter(scene.vertices.back().x(), 1e9);
  const PatchMesh moved = tessellate(scene, kept_sides(scene, Sides::front), 1);
  ASSERT_EQ(moved.size(), found.mesh.size());
  try {
    read_exchange(place, info, moved);
    FAIL() << "another geometry was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("lie elsewhere"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("patchlight form-factors MODEL -o"), std::string::npos);
  }
}

TEST(StoredFormFactors, DamagedFilesAreRefused) {
  const TemporaryFolder folder;
  const Scene scene = furnished_room(0.5);
  const FormFactors found = find_form_factors(scene, coarse());
  const fs::path place = folder.path() / "room.ff";
  const FormFactorResult result{scene, found, {}, "a command"};
  const auto damage = [&](const char* name, const auto& change) {
    write_form_factors(place, result);
    std::string content = content_of(place / name);
    change(content);
    put(place / name, content);
    EXPECT_THROW(read_exchange(place, read_form_factor_info(place), found.mesh), InputError) << name;
    fs::remove_all(place);
  };
  for (const char* name : {"F.npy", "area.npy", "lost_share.npy", "raw_row_sum.npy", "info.json"}) {
    damage(name, [](std::string& content) { content.resize(content.size() - 3); });
    damage(name, [](std::string& content) { content.clear(); });
  }
  // Reciprocity, and impossible values.
  damage("F.npy", [](std::string& content) { content.replace(content.size() - 40, 4, std::string("\0\0\0\x3f", 4)); });
  damage("F.npy", [](std::string& content) { content.replace(content.size() - 4, 4, "\xff\xff\xff\x7f"); });
  damage("area.npy", [](std::string& content) { content.replace(content.size() - 8, 8, std::string(8, '\0')); });
  damage("info.json", [](std::string& content) { content.replace(content.find("patchlight"), 10, "somebodies"); });
}

TEST(StoredFormFactors, ReplaceAnEarlierResultAndNothingElse) {
  const TemporaryFolder folder;
  const Scene scene = furnished_room(0.5);
  const FormFactors found = find_form_factors(scene, coarse(false));
  const fs::path place = folder.path() / "room.ff";
  const FormFactorResult result{scene, found, {}, "a command"};
  fs::create_directory(place);
  write_form_factors(place, result);
  write_form_factors(place, result);
  EXPECT_EQ(folder.entries(), 1U);
  put(place / "notes.txt", "mine");
  EXPECT_THROW(check_form_factors_writable(place), OutputError);
  EXPECT_THROW(write_form_factors(place, result), OutputError);
  EXPECT_EQ(content_of(place / "notes.txt"), "mine");
}

// In a closed room all light that leaves a group arrives somewhere, and the exchange of groups is symmetric.
TEST(GroupFactors, AreClosedAndReciprocal) {
  const Scene scene = closed_room();
  const FormFactors found = find_form_factors(scene, coarse());
  const GroupFactors groups = group_factors(scene, found, GroupBy::material);
  ASSERT_EQ(groups.names, (std::vector<std::string>{"wall", "lamp"}));
  EXPECT_NEAR(groups.area[0], 59, 1e-9);
  EXPECT_NEAR(groups.area[1], 4.12, 1e-9);
  // The rounding of a row to floats is below 1e-7.
  EXPECT_NEAR(groups.form_factor.row(0).sum(), 1, 2e-7);
  EXPECT_NEAR(groups.form_factor.row(1).sum(), 1, 2e-7);
  const Eigen::MatrixXd exchange = groups.area.asDiagonal() * groups.form_factor;
  EXPECT_NEAR(exchange(0, 1), exchange(1, 0), 1e-12);
  EXPECT_EQ(groups.form_factor(1, 1), 0);
}

TEST(GroupFactors, AreWrittenAsCsv) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "by_material.csv";
  Eigen::MatrixXd F(2, 2);
  F << 0.5, 0.5, 1, 0;
  write_groups(file, {GroupBy::material, {"a \"b\", c", "d"}, Eigen::Vector2d(2, 1), F});
  EXPECT_EQ(content_of(file), "from,area_m2,\"a \"\"b\"\", c\",d\n\"a \"\"b\"\", c\",2,0.5,0.5\nd,1,1,0\n");
}

}  // namespace
}  // namespace patchlight::form_factor_files_test
