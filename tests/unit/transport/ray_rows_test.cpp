#include "transport/ray_rows.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "scene/coverings.h"
#include "support/assembled.h"
#include "support/scenes.h"
#include "transport/ray_transport.h"
#include "transport/row_tracer.h"
#include "visibility/occluder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace patchlight::ray_rows_test {
namespace {

using namespace test;

// A scene cut into patches. It cannot be moved, because traced rows refer to it.
struct Place {
  Place(const Scene& scene, double max_edge, Sides sides = Sides::both)
      : Place(scene, kept_sides(scene, sides), max_edge) {}
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  TracedRows rows(const RayOptions& options = {}) const { return trace_rows(mesh, occluder, none, options); }
  // With the patches of the first polygon as bright ones.
  TracedRows rows_toward_first_polygon(const RayOptions& options) const {
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(mesh.size());
    const PatchRange first = mesh.patches_on(0, Side::front);
    expected.segment(first.begin, first.end - first.begin).setOnes();
    return trace_rows(mesh, occluder, BrightPatches(mesh, expected, 1, occluder), options);
  }
  Eigen::VectorXd areas() const { return Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size()); }

  PatchMesh mesh;
  Occluder occluder;
  BrightPatches none;

 private:
  Place(const Scene& scene, const KeptSides& kept, double max_edge)
      : mesh(tessellate(scene, kept, max_edge)),
        occluder(scene, Occluder::Blockers::inside_hull, find_coverings(scene, kept)),
        none(mesh, Eigen::VectorXd::Zero(mesh.size()), 1, occluder) {}
};

// Values that differ from patch to patch, in (0, 1).
Field some_radiosity(PatchIndex size, int bands) {
  Field B(size, bands);
  for (PatchIndex i = 0; i < size; ++i) {
    for (int band = 0; band < bands; ++band) B(i, band) = std::abs(std::sin(1 + 0.7 * i + 2.3 * band));
  }
  return B;
}

double norm(const Field& x, const Eigen::VectorXd& area) {
  return std::sqrt((x.square().colwise() * area.array()).sum());
}

Scene open_room() {
  Scene scene = furnished_room(0.5);
  scene.polygons.erase(scene.polygons.begin() + 1);
  return scene;
}

// Closure: each half separately, with and without entries that have weights of their own.
TEST(RayRows, SumUpToWhatPatchesSee) {
  for (const Scene& scene : {furnished_room(0.5), open_room()}) {
    const Place place(scene, 0.4, Sides::front);
    for (const TracedRows& rows : {place.rows(), place.rows_toward_first_polygon({})}) {
      const Eigen::ArrayXd expected = expected_row_sum(rows.lost).array();
      const RayTransport transport(rows.halves);
      for (std::size_t half = 0; half < 2; ++half) {
        // Where almost only backs are visible, possibly none of 32 rays meets a patch.
        const Eigen::ArrayXd sums = transport.apply_half(half, Field::Ones(transport.size(), 1)).col(0);
        EXPECT_LT((sums == 0).select(0, sums - expected).abs().maxCoeff(), 1e-6) << half;
        EXPECT_LT((sums == 0).select(expected, 0).maxCoeff(), 0.1) << half;
      }
    }
  }
  EXPECT_LT(expected_row_sum(Place(open_room(), 0.4, Sides::front).rows().lost).minCoeff(), 0.7);
}

TEST(RayRows, OfAClosedRoomLoseNothing) {
  const Scene scene = with_box(cube_room(0.5, 0), Point(0.3, 0.3, 0.3), Point(0.6, 0.7, 0.5), false);
  const TracedRows rows = Place(scene, 0.1, Sides::front).rows();
  const Field sums = RayTransport(rows.halves).apply(Field::Ones(rows.area.size(), 1));
  EXPECT_TRUE((RayTransport(rows.halves).row_sums().array() == sums.col(0)).all()) << "to the bit";
  EXPECT_LT((sums - 1).abs().maxCoeff(), 1e-9);
  EXPECT_TRUE(rows.lost.closed());
}

// Theorem: the halves are independent and unbiased, so half their difference has the variance of their mean. The
// reference is closed exchange areas, whose own error is about a hundredth of that. Over about 800 patches the ratio of
// both norms scatters by about 5 %.
TEST(RayRows, ErrAsTheirHalvesTell) {
  const Assembled exact = assembled(furnished_room(0.5), 0.3);
  const Place place(furnished_room(0.5), 0.3, Sides::automatic);
  ASSERT_EQ(place.mesh.size(), exact.mesh.size());
  const Field B = some_radiosity(exact.mesh.size(), 1);
  const Field expected = exact.transport->apply(B);
  for (const TracedRows& rows : {place.rows(), place.rows_toward_first_polygon({})}) {
    const RayTransport transport(rows.halves);
    const Eigen::VectorXd area = place.areas();
    const double stated = norm(0.5 * (transport.apply_half(0, B) - transport.apply_half(1, B)), area);
    const double true_error = norm(transport.apply(B) - expected, area);
    EXPECT_GT(true_error, 0.003 * norm(expected, area));
    EXPECT_NEAR(stated / true_error, 1, 0.2);
  }
}

// Rays towards bright patches change the error, not the mean. The error of light from these patches alone decreases by
// a large factor.
TEST(RayRows, FindTheLightOfBrightPatchesWithLessError) {
  const Assembled exact = assembled(furnished_room(0.5), 0.3);
  const Place place(furnished_room(0.5), 0.3, Sides::automatic);
  const PatchRange bright = place.mesh.patches_on(0, Side::front);
  Field B = Field::Zero(place.mesh.size(), 1);
  B.middleRows(bright.begin, bright.end - bright.begin) = 1;
  const Field expected = exact.transport->apply(B);
  const auto error = [&](const TracedRows& rows) {
    return norm(RayTransport(rows.halves).apply(B) - expected, place.areas()) / norm(expected, place.areas());
  };
  // 32 additional rays to 64: where most of the light comes from these patches, the error decreases at least by the
  // root of 1.5.
  EXPECT_LT(error(place.rows_toward_first_polygon({})), 0.8 * error(place.rows()));
  EXPECT_LT(error(place.rows_toward_first_polygon({.rays = 512, .toward_bright = 256})), 0.02);
}

// In a closed room every ray meets a patch. Rows of the others stay the same, to the last bit.
TEST(RayRows, TakeMoreRaysWhereTheyAreDoubled) {
  const Place place(cube_room(0.5, 1), 0.25);
  RayOptions options;
  const TracedRows usual = place.rows(options);
  options.doublings.assign(place.mesh.size(), 0);
  options.doublings[3] = 2;
  const TracedRows doubled = place.rows(options);
  for (std::size_t half = 0; half < 2; ++half) {
    const RayRows& before = usual.halves[half];
    const RayRows& after = doubled.halves[half];
    for (PatchIndex i = 0; i < place.mesh.size(); ++i) {
      const std::uint64_t rays = before.first_hit[i + 1] - before.first_hit[i];
      ASSERT_EQ(after.first_hit[i + 1] - after.first_hit[i], i == 3 ? 4 * rays : rays);
      if (i == 3) continue;
      const auto first = before.hits.begin() + static_cast<std::ptrdiff_t>(before.first_hit[i]);
      EXPECT_TRUE(std::equal(first, first + static_cast<std::ptrdiff_t>(rays),
                             after.hits.begin() + static_cast<std::ptrdiff_t>(after.first_hit[i])));
      EXPECT_EQ(after.hit_weight[i], before.hit_weight[i]);
    }
    EXPECT_NEAR(after.hit_weight[3], before.hit_weight[3] / 4, 1e-12);
  }
}

// H = F B is linear. Sums of a few hundred positive terms round by about 1e-14.
TEST(RayRows, CarryLightLinearly) {
  const Place place(furnished_room(0.5), 0.5);
  const TracedRows rows = place.rows_toward_first_polygon({});
  const RayTransport transport(rows.halves);
  const Field a = some_radiosity(transport.size(), 2);
  const Field b = a.square();
  const Field together = transport.apply(2 * a + 3 * b);
  EXPECT_LT((together - 2 * transport.apply(a) - 3 * transport.apply(b)).abs().maxCoeff(), 1e-13);
  EXPECT_FALSE(transport.is_reciprocal());
}

// Bands are computed side by side, with separate loops for one and for three.
TEST(RayRows, CarryEachBandAlike) {
  const Place place(furnished_room(0.5), 0.5);
  const TracedRows rows = place.rows_toward_first_polygon({});
  const RayTransport transport(rows.halves);
  const Field B = some_radiosity(transport.size(), 3);
  const Field H = transport.apply(B);
  for (int band = 0; band < 3; ++band)
    EXPECT_LT((transport.apply(B.col(band)) - H.col(band)).abs().maxCoeff(), 1e-14) << band;
  EXPECT_LT((transport.apply(B.leftCols(2)) - H.leftCols(2)).abs().maxCoeff(), 1e-14);
}

bool same_rows(const RayRows& a, const RayRows& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return same(a.first_hit, b.first_hit) && same(a.hits, b.hits) && same(a.hit_weight, b.hit_weight) &&
         same(a.first_entry, b.first_entry) && same(a.entries, b.entries);
}

TEST(RayRows, HaveTheSameBitsForAnyNumberOfThreads) {
  const Place place(furnished_room(0.5), 0.25);
  const auto traced = [&](int threads) {
    const ThreadLimit limit(threads);
    return place.rows_toward_first_polygon({});
  };
  const TracedRows one = traced(1);
  const TracedRows two = traced(2);
  for (std::size_t half = 0; half < 2; ++half) EXPECT_TRUE(same_rows(one.halves[half], two.halves[half]));
  const Field B = some_radiosity(place.mesh.size(), 3);
  const auto applied = [&](int threads) {
    const ThreadLimit limit(threads);
    return RayTransport(one.halves).apply(B);
  };
  EXPECT_TRUE((applied(1) == applied(2)).all());
  EXPECT_FALSE(same_rows(one.halves[0], one.halves[1]));
}

// More than two blocks of rows, with rays towards a lamp.
struct RowsInBlocks {
  const Place place{furnished_room(0.5), 0.08, Sides::front};
  std::map<std::size_t, std::vector<std::int32_t>> kept;
  int read = 0;  // existing blocks

  TracedRows rows() {
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(place.mesh.size());
    const PatchRange lamp = place.mesh.patches_on(static_cast<PolygonIndex>(12), Side::front);
    expected.segment(lamp.begin, lamp.end - lamp.begin).setOnes();
    std::mutex lock;
    const RowBlocks blocks{[&](std::size_t block) -> std::optional<std::vector<std::int32_t>> {
                             const auto found = kept.find(block);
                             if (found == kept.end()) return std::nullopt;
                             ++read;
                             return found->second;
                           },
                           [&](std::size_t block, std::span<const std::int32_t> words) {
                             const std::scoped_lock one(lock);
                             kept[block].assign(words.begin(), words.end());
                           }};
    const BrightPatches bright(place.mesh, expected, 1, place.occluder);
    return trace_rows(place.mesh, place.occluder, bright, {.rays = 32, .toward_bright = 32}, {}, &blocks);
  }
};

void expect_same(const TracedRows& a, const TracedRows& b) {
  for (std::size_t half = 0; half < 2; ++half) EXPECT_TRUE(same_rows(a.halves[half], b.halves[half]));
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.lost.escaped, b.lost.escaped);
  EXPECT_EQ(a.shadow_rays, b.shadow_rays);
}

TEST(RayRows, GoOnFromTheBlocksThatWereKept) {
  RowsInBlocks run;
  ASSERT_GT(run.place.mesh.size(), 2 * RowBlocks::patches_of_a_block);
  const TracedRows whole = run.rows();
  EXPECT_EQ(run.read, 0);
  const auto all = run.kept;
  ASSERT_EQ(all.size(), 1 + (run.place.mesh.size() - 1) / RowBlocks::patches_of_a_block);
  for (std::size_t missing = 0; missing < all.size(); ++missing) {
    run.read = 0;
    run.kept = all;
    run.kept.erase(missing);
    expect_same(run.rows(), whole);
    EXPECT_EQ(run.read, static_cast<int>(all.size() - 1));
    EXPECT_EQ(run.kept, all);
  }
}

TEST(RayRows, AreTracedAgainWhereBlocksAreDamaged) {
  // Truncated, longer, with invalid patches and counts, empty, and with an invalid distance, number of rays and form
  // factor.
  constexpr auto nan = std::bit_cast<std::int32_t>(std::numeric_limits<float>::quiet_NaN());
  RowsInBlocks run;
  const TracedRows whole = run.rows();
  const auto all = run.kept;
  const std::size_t size = all.at(0).size();
  for (int damage = 0; damage < 8; ++damage) {
    std::vector<std::int32_t>& block = run.kept.at(0);
    if (damage == 0) block.resize(size / 2);
    if (damage == 1) block.push_back(1);
    if (damage == 2) std::fill(block.begin() + static_cast<std::ptrdiff_t>(size / 2), block.end(), -1);
    if (damage == 3) std::fill(block.begin(), block.end(), std::numeric_limits<std::int32_t>::max());
    if (damage == 4) block.clear();
    if (damage == 5) block[2] = nan;
    if (damage == 6) block[0] = 1'000'000;
    if (damage == 7) block.back() = nan;
    expect_same(run.rows(), whole);
    EXPECT_EQ(run.kept, all);
  }
}

// Sample points depend on the positions of patches in the scene. So a model that is moved, rotated and scaled has the
// same rows, except for rays so close to an edge that rounding decides. A few of about 50,000 hits may differ.
TEST(RayRows, StayTheSameWhenTheModelIsMovedAndScaled) {
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
  motion.translate(Vector(30, -20, 7)).rotate(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized())).scale(1e-3);
  const TracedRows here = Place(furnished_room(0.5), 0.4, Sides::both).rows();
  const TracedRows there = Place(moved(furnished_room(0.5), motion), 0.4e-3, Sides::both).rows();
  const auto& a = here.halves[0].hits;
  const auto& b = there.halves[0].hits;
  ASSERT_EQ(a.size(), b.size());
  std::size_t differing = 0;
  for (std::size_t k = 0; k < a.size(); ++k) differing += a[k] != b[k] ? 1 : 0;
  EXPECT_LT(static_cast<double>(differing), 0.01 * static_cast<double>(a.size()));
}

// Backs of one-sided faces have no patches: rays that meet them are lost.
TEST(RayRows, LoseWhatMeetsBacks) {
  // A lamp 1 cm below the ceiling, whose back the ceiling above it sees.
  const Place place(furnished_room(0.5), 0.5, Sides::front);
  const TracedRows rows = place.rows();
  EXPECT_GT(rows.lost.at_backs.maxCoeff(), 0.5);
  EXPECT_EQ(rows.lost.escaped.maxCoeff(), 0);
  for (const PatchIndex hit : rows.halves[0].hits) ASSERT_LT(hit, place.mesh.size());
}

TEST(RayCounts, ArePowersOfTwoThatGrowWithTheArea) {
  PatchMesh mesh;
  for (int k = 0; k < 2000; ++k) mesh.area.push_back(std::exp(0.0025 * k));
  const std::vector<std::uint32_t> counts = ray_counts(mesh.area, 64);
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_TRUE(std::has_single_bit(counts[i]));
    EXPECT_GE(counts[i], counts[i > 0 ? i - 1 : 0]);
    sum += 2 * counts[i];
  }
  EXPECT_NEAR(sum / 2000, 64, 1);
  // e^5 in area is e^2 = 7.4 in rays.
  EXPECT_EQ(counts.back() / counts.front(), 8U);
}

// Rounded, the number is within a factor of the root of 2 of the requested one.
TEST(RayCounts, OfEqualPatchesAreEqual) {
  PatchMesh mesh;
  mesh.area.assign(100, 0.3);
  EXPECT_EQ(ray_counts(mesh.area, 64), std::vector<std::uint32_t>(100, 32));
  EXPECT_EQ(ray_counts(mesh.area, 256), std::vector<std::uint32_t>(100, 128));
  EXPECT_EQ(ray_counts(mesh.area, 1 << 20), std::vector<std::uint32_t>(100, most_rays));
}

}  // namespace
}  // namespace patchlight::ray_rows_test
