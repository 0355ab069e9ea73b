#include "verify/path_tracer.h"

#include "base/parallel.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::path_tracer_test {
namespace {

using namespace test;

// The whole of one side of a polygon with four corners.
PathReceiver whole(const Scene& scene, PolygonIndex polygon, Side side = Side::front) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  return {{corners[0], corners[1], corners[2], corners[3]}, polygon, side};
}

std::vector<PathReceiver> whole_fronts(const Scene& scene) {
  std::vector<PathReceiver> receivers;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) receivers.push_back(whole(scene, p));
  return receivers;
}

// Four standard errors, estimated with 31 degrees of freedom: a correct value fails with a probability of 4e-4. The
// seeds are fixed, so the result is, too.
void expect_within_four_errors(const PathEstimate& estimate, double exact) {
  for (Eigen::Index i = 0; i < estimate.irradiance.rows(); ++i) {
    EXPECT_NEAR(estimate.irradiance(i, 0), exact, 4 * estimate.standard_error(i, 0) + 1e-12) << "receiver " << i;
  }
}

TEST(TraceIrradiance, FurnaceIsOne) {
  // A closed room with E = 1 - rho everywhere: B = E + rho H = 1 and H = 1 at every point, with any contents.
  for (const double reflectance : {0.0, 0.3, 0.9}) {
    Scene scene = empty_scene({grey(reflectance, 1 - reflectance)});
    scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
    scene = with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false);
    const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), whole_fronts(scene));
    expect_within_four_errors(estimate, 1);
    EXPECT_LT(estimate.standard_error.maxCoeff(), 0.03);
    EXPECT_GT(estimate.standard_error.minCoeff(), 0);
  }
}

TEST(TraceIrradiance, OneLampInABlackCubeGivesTheFormFactor) {
  // H = E F with the form factors of opposed unit squares at distance 1 (Howell C-11) and of squares that share an edge
  // (C-14). Beside the lamp, sampling points on it alone would have infinite variance.
  Scene scene = empty_scene({grey(0), grey(0, 7)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(1, 1, 1), true);
  for (std::size_t k = 0; k < faces.size(); ++k) scene = with_quad(std::move(scene), faces[k], k == 1 ? 1 : 0);
  const KeptSides sides = kept_sides(scene, Sides::front);
  const std::vector<PathReceiver> opposed{whole(scene, 0)};
  const std::vector<PathReceiver> touching{whole(scene, 2), whole(scene, 3), whole(scene, 4), whole(scene, 5)};
  expect_within_four_errors(trace_irradiance(scene, sides, opposed), 7 * 0.19982489569838732);
  expect_within_four_errors(trace_irradiance(scene, sides, touching), 7 * 0.20004377607540316);
}

TEST(TraceIrradiance, UniformCubeHasTheNeumannSeries) {
  // B = E + rho H with H = B on all sides: H = E / (1 - rho). Each band has its own throughput.
  Scene scene = cube_room(0, 0);
  scene.materials[0].reflectance = rgb(0.2, 0.5, 0.8);
  scene.materials[0].exitance = rgb(3, 1, 0.5);
  const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), whole_fronts(scene));
  const Spectrum exact = rgb(3 / 0.8, 1 / 0.5, 0.5 / 0.2);
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index band = 0; band < 3; ++band) {
      EXPECT_NEAR(estimate.irradiance(i, band), exact[band], 4 * estimate.standard_error(i, band));
    }
  }
  EXPECT_LT((estimate.standard_error.rowwise() / exact).maxCoeff(), 0.03);
}

TEST(TraceIrradiance, LampEmitsFromTheSidesThatSimulateSays) {
  // A lamp halfway between two black plates, each 1 m away: C-11 on the side that it shines on, nothing on the other.
  Scene scene = empty_scene({grey(0), grey(0, 7), grey(0, 2)});
  const auto square = [](double z) { return Quad{Point(0, 0, z), Point(1, 0, z), Point(1, 1, z), Point(0, 1, z)}; };
  scene = with_quad(std::move(scene), square(0));
  scene = with_quad(std::move(scene), square(1), 1);
  scene = with_quad(std::move(scene), square(2));
  const std::vector<PathReceiver> below_and_above{whole(scene, 0, Side::front), whole(scene, 2, Side::back)};
  const auto expect = [&](const KeptSides& sides, double below, double above) {
    const PathEstimate estimate = trace_irradiance(scene, sides, below_and_above);
    EXPECT_NEAR(estimate.irradiance(0, 0), below * 0.19982489569838732, 4 * estimate.standard_error(0, 0));
    EXPECT_NEAR(estimate.irradiance(1, 0), above * 0.19982489569838732, 4 * estimate.standard_error(1, 0));
  };
  KeptSides sides{.front = {1, 1, 1}, .back = {1, 1, 1}, .emit_from_back = false, .notes = {}};
  expect(sides, 0, 7);
  sides.emit_from_back = true;
  expect(sides, 7, 7);
  sides.emit_from_back = false;
  scene.polygons[1].back_material = 2;
  expect(sides, 2, 7);
  sides.front[1] = 0;
  expect(sides, 2, 0);
}

TEST(TraceIrradiance, SidesThatAreNotKeptAreBlack) {
  // In a closed room where one wall has no patches, its reflected light is missing, as if it were black.
  Scene black = cube_room(0.5, 1);
  black.materials.push_back(grey(0));
  black.polygons[3].material = 1;
  Scene without = black;
  without.polygons[3].material = 0;
  KeptSides sides = kept_sides(without, Sides::front);
  sides.front[3] = 0;
  const std::vector<PathReceiver> floor{whole(black, 0)};
  const Field expected = trace_irradiance(black, kept_sides(black, Sides::front), floor).irradiance;
  const PathEstimate estimate = trace_irradiance(without, sides, floor, {.seed = 2});
  EXPECT_NEAR(estimate.irradiance(0, 0), expected(0, 0), 4 * std::sqrt(2) * estimate.standard_error(0, 0));
  EXPECT_LT(expected(0, 0), 1.9);
}

TEST(TraceIrradiance, IsTheMeanOverWhatIsNotCovered) {
  // A furnace with a solid on the floor that covers a quarter of it: the exposed part still has 1.
  Scene scene = empty_scene({grey(0.5, 0.5)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(2, 2, 2), true);
  scene = with_box(std::move(scene), Point(0.5, 0.5, 0), Point(1.5, 1.5, 1), false);
  const std::vector<PathReceiver> floor{whole(scene, 0)};
  const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), floor);
  expect_within_four_errors(estimate, 1);
  EXPECT_LT(estimate.standard_error(0, 0), 0.02);
}

TEST(TraceIrradiance, StandardErrorIsTheScatterOverSeeds) {
  // With n seeds, the squared deviations from their mean are a chi-square of n - 1 degrees of freedom times the
  // variance. The variance is the mean of the n stated ones. The limit is four standard deviations, sqrt(2 (n - 1)), to
  // either side. With 32 paths many runs miss the surfaces lit by the small lamp and state small errors. The others
  // state large errors.
  constexpr int seeds = 64;
  const Scene scene = furnished_room(0.5);
  const KeptSides sides = kept_sides(scene, Sides::front);
  const std::vector<PathReceiver> receivers{whole(scene, 0), whole(scene, 6)};
  for (const std::uint32_t paths : {32U, 1024U}) {
    Field irradiance(seeds, 2);
    Field variance(seeds, 2);
    for (int k = 0; k < seeds; ++k) {
      const PathOptions options{.paths = paths, .seed = static_cast<std::uint64_t>(k)};
      const PathEstimate estimate = trace_irradiance(scene, sides, receivers, options);
      irradiance.row(k) = estimate.irradiance.transpose();
      variance.row(k) = estimate.standard_error.square().transpose();
    }
    const Field deviation = irradiance.rowwise() - irradiance.colwise().mean();
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double chi_square = deviation.col(i).square().sum() / variance.col(i).mean();
      EXPECT_NEAR(chi_square, seeds - 1, 4 * std::sqrt(2.0 * (seeds - 1))) << paths << " paths, receiver " << i;
    }
  }
}

TEST(TraceIrradiance, SameBitsWithAnyNumberOfThreads) {
  const Scene scene = furnished_room(0.5);
  const KeptSides sides = kept_sides(scene, Sides::front);
  const auto trace = [&](int threads) {
    const ThreadLimit limit(threads);
    return trace_irradiance(scene, sides, whole_fronts(scene), {.paths = 256});
  };
  const PathEstimate one = trace(1);
  const PathEstimate two = trace(2);
  EXPECT_TRUE((one.irradiance == two.irradiance).all());
  EXPECT_TRUE((one.standard_error == two.standard_error).all());
  EXPECT_EQ(one.rays, two.rays);
}

// Half of the light of a path continues after 34 bounces. Few paths remain in the end, with random numbers of their
// own.
TEST(TraceIrradiance, LongPathsHaveTheNeumannSeries) {
  Scene scene = cube_room(0.98, 1);
  const PathEstimate estimate =
      trace_irradiance(scene, kept_sides(scene, Sides::front), whole_fronts(scene), {.paths = 4096});
  expect_within_four_errors(estimate, 1 / 0.02);
  EXPECT_LT(estimate.standard_error.maxCoeff(), 0.03 / 0.02);
}

TEST(TraceIrradiance, EndsBetweenSurfacesThatAbsorbNothing) {
  const Scene scene = cube_room(1, 1);
  const std::vector<PathReceiver> floor{whole(scene, 0)};
  const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), floor, {.paths = 1});
  EXPECT_EQ(estimate.paths, 32U);
  EXPECT_GT(estimate.irradiance(0, 0), 100);
}

// The form factor from a point with a normal to a polygon before it: Lambert's contour sum.
double lambert_form_factor(const Sensor& sensor, const std::vector<Point>& corners) {
  double sum = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector a = corners[k] - sensor.point;
    const Vector b = corners[(k + 1) % corners.size()] - sensor.point;
    sum += std::atan2(a.cross(b).norm(), a.dot(b)) * a.cross(b).normalized().dot(sensor.normal);
  }
  return std::abs(sum) / (2 * std::numbers::pi);
}

TEST(TraceIrradiance, SensorUnderASquareReadsItsFormFactor) {
  const double half = 0.1;
  const double exitance = 7;
  Scene scene = empty_scene({grey(0, exitance)});
  const auto rectangle = [half](double left) {
    return Quad{Point(left, half, 0), Point(half, half, 0), Point(half, -half, 0), Point(left, -half, 0)};
  };
  scene = with_quad(std::move(scene), rectangle(-half));
  const Point below(0, 0, -0.7);
  const std::vector<Sensor> sensors{{below, Vector::UnitZ()}, {below, -Vector::UnitZ()}, {below, Vector::UnitX()}};
  const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), sensors);
  const auto expect = [&](Eigen::Index sensor, double left) {
    const Quad seen = rectangle(left);
    const double form_factor =
        lambert_form_factor(sensors[static_cast<std::size_t>(sensor)], {seen.begin(), seen.end()});
    EXPECT_NEAR(estimate.irradiance(sensor, 0), exitance * form_factor, 4 * estimate.standard_error(sensor, 0));
    EXPECT_LT(estimate.standard_error(sensor, 0), 0.02 * exitance * form_factor);
  };
  expect(0, -half);
  EXPECT_EQ(estimate.irradiance(1, 0), 0);
  expect(2, 0);  // the half in front of a sensor that faces sideways
}

TEST(TraceIrradiance, SensorsInAFurnaceReadOne) {
  // E = 1 - rho everywhere: H = 1 at every point and for every normal, in the air and on the surfaces.
  Scene scene = empty_scene({grey(0.6, 0.4)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene = with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false);
  const std::vector<Sensor> sensors{{Point(3, 2, 1.5), Vector(1, 2, -2).normalized()},
                                    {Point(0.5, 0.5, 0), Vector::UnitZ()},
                                    {Point(0.5, 0.5, -1e-7), Vector::UnitZ()},
                                    {Point(1.5, 1.5, 1.2), Vector::UnitZ()},
                                    {Point(1e-12, 2, 1), Vector::UnitX()}};
  const PathEstimate estimate = trace_irradiance(scene, kept_sides(scene, Sides::front), sensors);
  expect_within_four_errors(estimate, 1);
  EXPECT_LT(estimate.standard_error.maxCoeff(), 0.03);
}

}  // namespace
}  // namespace patchlight::path_tracer_test
