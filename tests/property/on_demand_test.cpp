
#include "patchlight/input/read_scene.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "support/meshes.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

namespace patchlight::on_demand_test {
namespace {

using namespace test;

// A scene cut into patches. It must not move, as transports refer to it.
struct Place {
  explicit Place(const Scene& scene, double max_edge) : Place(scene, kept_sides(scene, Sides::both), max_edge) {}
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  std::unique_ptr<RowTransport> on_demand(const AssemblyOptions& options = {}) const {
    return on_demand_transport(mesh, occluder, options, area);
  }
  std::unique_ptr<RowTransport> stored(const AssemblyOptions& options = {}) const {
    Assembly assembly = assemble_exchange_areas(mesh, occluder, options);
    return dense_transport(keep_exchange_areas(std::move(assembly.exchange_areas), "test"), area);
  }

  bool has_covered_patches() const {
    PatchIndex i = 0;
    while (i < mesh.size() && !occluder.is_covered_in_part(mesh.polygon[i], mesh.side[i])) ++i;
    return i < mesh.size();
  }

  PatchMesh mesh;
  Occluder occluder;
  Eigen::VectorXd area;

 private:
  Place(const Scene& scene, const KeptSides& kept, double max_edge)
      : mesh(tessellate(scene, kept, max_edge)),
        occluder(scene, Occluder::Blockers::inside_hull, find_coverings(scene, kept)),
        area(Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size())) {}
};

Scene model(const std::string& file) { return read_scene({mesh_folder() / file}); }

// A room with a rug drawn on its floor, and a box that stands on both.
Scene room_with_overlaps() {
  Scene scene = furnished_room(0.5);
  scene = with_quad(std::move(scene), {Point(2.2, 0.3, 0), Point(3.5, 0.3, 0), Point(3.5, 2.2, 0), Point(2.2, 2.2, 0)});
  return with_box(std::move(scene), Point(3, 1, 0), Point(3.7, 1.6, 0.8), false);
}

// Values in (0, 1) that differ from patch to patch.
Field some_radiosity(PatchIndex size, int bands) {
  Field B(size, bands);
  for (PatchIndex i = 0; i < size; ++i) {
    for (int band = 0; band < bands; ++band) B(i, band) = std::abs(std::sin(1 + 0.7 * i + 2.3 * band));
  }
  return B;
}

// The number of matrix entries whose bits differ in the rows, and the number of entries of each kind.
struct Comparison {
  std::size_t differing = 0;
  AssemblyCounts counts;
};

Comparison compare(const Place& place, const AssemblyOptions& options) {
  const Assembly assembly = assemble_exchange_areas(place.mesh, place.occluder, options);
  const PatchIndex size = place.mesh.size();
  // With areas of 1, form factors equal the exchange areas.
  const auto rows = on_demand_transport(place.mesh, place.occluder, options, Eigen::VectorXd::Ones(size));
  const Eigen::MatrixXd F = rows->form_factors({0, size}, {0, size});
  Comparison result{0, assembly.counts};
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) {
      result.differing += F(i, j) != static_cast<double>(assembly.exchange_areas.at(i, j)) ? 1 : 0;
    }
  }
  return result;
}

// Law: an entry depends only on its two patches, so a single row has the same bits as in the matrix.
TEST(OnDemand, RowsAreThoseOfTheMatrix) {
  const AssemblyOptions options{16, 3};
  AssemblyCounts counts;
  const auto expect_the_same = [&](const Scene& scene, double max_edge) {
    const Comparison comparison = compare(Place(scene, max_edge), options);
    EXPECT_EQ(comparison.differing, 0U) << scene.file << ' ' << max_edge;
    counts += comparison.counts;
  };
  for (const double max_edge : {0.8, 0.5}) expect_the_same(furnished_room(0.5), max_edge);
  expect_the_same(room_with_overlaps(), 0.8);
  expect_the_same(model("cornell_box.obj"), 0.25);
  expect_the_same(model("two_rooms.obj"), 1);
  // The scene has pairs of every kind.
  for (const auto count : {counts.near_pairs, counts.hidden_pairs, counts.free_pairs, counts.partial_pairs}) {
    EXPECT_GT(count, 100U);
  }
}

TEST(OnDemand, RowsAreThoseOfTheMatrixWithoutShortCuts) {
  const Place place(furnished_room(0.5), 0.6);
  for (int left_out = 0; left_out < 3; ++left_out) {
    const ShortCuts short_cuts{left_out != 0, left_out != 1, left_out != 2};
    const Comparison comparison = compare(place, {.samples = 32, .short_cuts = short_cuts});
    EXPECT_EQ(comparison.differing, 0U) << left_out;
    EXPECT_GT(comparison.counts.facing_pairs, 100U);
  }
}

// Shooting sums in the same order as with a stored matrix, so the bits are equal.
TEST(OnDemand, ShootsLikeTheStoredMatrix) {
  const Place place(room_with_overlaps(), 0.5);
  const Field B = some_radiosity(place.mesh.size(), 3);
  const auto stored = place.stored();
  const auto on_demand = place.on_demand();
  ASSERT_EQ(on_demand->size(), place.mesh.size());
  EXPECT_TRUE(place.has_covered_patches());
  const PatchIndex size = stored->size();
  for (const PatchRange sources :
       {PatchRange{0, 1}, PatchRange{17, 21}, PatchRange{5, 5}, PatchRange{size - 3, size}}) {
    const Field some = B.middleRows(sources.begin, sources.end - sources.begin);
    EXPECT_TRUE((on_demand->shoot(sources, some) == stored->shoot(sources, some)).all()) << sources.begin;
  }
}

// Gathering sums in another order: each of the two sums has at most 2 size roundings of relative size epsilon / 2, and
// all terms are positive.
TEST(OnDemand, GathersLikeTheStoredMatrix) {
  const Place place(room_with_overlaps(), 0.5);
  const Field B = some_radiosity(place.mesh.size(), 2);
  const double rounding = 2.0 * place.mesh.size() * std::numeric_limits<double>::epsilon();
  const Field expected = place.stored()->apply(B);
  const auto on_demand = place.on_demand();
  EXPECT_TRUE(((on_demand->apply(B) - expected).abs() <= rounding * expected).all());
  const Field some = on_demand->gather({30, 40}, B);
  EXPECT_TRUE(((some - expected.middleRows(30, 10)).abs() <= rounding * expected.middleRows(30, 10)).all());
}

// Reciprocity: with S symmetric, sum_i A_i X_i (F B)_i = sum_j A_j B_j (F X)_j for all B and X. Here X is 1 at the
// receivers and B is nonzero at the sources, so the exchange is equal in both directions.
TEST(OnDemand, ShootingIsTheTransposeOfGathering) {
  const Place place(model("cornell_box.obj"), 0.2);
  const auto transport = place.on_demand();
  const PatchIndex size = transport->size();
  const PatchIndex i = size / 3;
  const Field B = some_radiosity(size, 1);
  // From all patches to patch i, and from patch i to all, weighted by their B.
  const double gathered = place.area[i] * transport->gather({i, i + 1}, B)(0, 0);
  const Field shot = transport->shoot({i, i + 1}, Field::Ones(1, 1));
  const double received = (place.area.array() * B.col(0) * shot.col(0)).sum();
  EXPECT_GT(gathered, 0);
  EXPECT_NEAR(received, gathered, 2.0 * size * std::numeric_limits<double>::epsilon() * gathered);
}

TEST(OnDemand, HasTheSameBitsForAnyNumberOfThreads) {
  const Place place(furnished_room(0.5), 0.3);
  const auto transport = place.on_demand();
  const Field B = some_radiosity(transport->size(), 2);
  const auto results = [&](int threads) {
    const ThreadLimit limit(threads);
    Field all(transport->size() + 50, 2);
    all << transport->shoot({3, 23}, B.topRows(20)), transport->gather({10, 60}, B);
    return all;
  };
  EXPECT_TRUE((results(1) == results(2)).all());
}

}  // namespace
}  // namespace patchlight::on_demand_test
