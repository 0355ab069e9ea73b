
#include "patchlight/solve/solve.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "solve/pockets.h"

#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace patchlight::pocket_transport_test {
namespace {

// A room of gray patches, a pocket of white ones that a thousandth of their light leaves, and closed white ones.
constexpr PatchIndex in_room = 180;
constexpr PatchIndex in_pocket = 12;
constexpr PatchIndex in_closed = 3;
constexpr PatchIndex patches = in_room + in_pocket + in_closed;
constexpr double leak = 1e-3;

using Rows = std::vector<std::vector<RayEntry>>;

RayRows of(const Rows& rows) {
  RayRows made;
  made.first_hit.assign(rows.size() + 1, 0);
  made.hit_weight.assign(rows.size(), 0);
  made.first_entry = {0};
  for (const auto& row : rows) {
    for (const RayEntry& entry : row) made.entries.push_back(entry);
    made.first_entry.push_back(made.entries.size());
  }
  return made;
}

// Each patch of the room sees sixteen others, and some see a patch of the pocket.
Rows rows_of_building() {
  Rows rows(patches);
  constexpr std::uint32_t seen = 16;
  for (PatchIndex i = 0; i < in_room; ++i) {
    const bool sees_pocket = i < in_pocket;
    const double rest = sees_pocket ? 1 - leak : 1;
    for (std::uint32_t k = 0; k < seen; ++k)
      rows[i].push_back({hash({i, k}) % in_room, static_cast<float>(rest / seen)});
    if (sees_pocket) rows[i].push_back({in_room + i, static_cast<float>(leak)});
  }
  for (PatchIndex k = 0; k < in_pocket; ++k) {
    const PatchIndex i = in_room + k;
    // Along the pocket, back and forth.
    rows[i].push_back({in_room + (k + 1) % in_pocket, static_cast<float>((1 - leak) / 2)});
    rows[i].push_back({in_room + (k + in_pocket - 1) % in_pocket, static_cast<float>((1 - leak) / 2)});
    rows[i].push_back({k, static_cast<float>(leak)});
  }
  for (PatchIndex k = 0; k < in_closed; ++k) {
    const PatchIndex first = in_room + in_pocket;
    rows[first + k].push_back({first + (k + 1) % in_closed, 0.5F});
    rows[first + k].push_back({first + (k + 2) % in_closed, 0.5F});
  }
  return rows;
}

RayTransport building() { return RayTransport({of(rows_of_building()), of(rows_of_building())}); }

// A problem of this many bands, with light on a tenth of the room.
RadiosityProblem lit(Eigen::Index bands) {
  RadiosityProblem problem{
      {Field::Constant(patches, bands, 1)}, Field::Zero(patches, bands), Eigen::VectorXd::LinSpaced(patches, 1, 2)};
  for (Eigen::Index band = 0; band < bands; ++band) {
    problem.scattering.reflectance.col(band).head(in_room) = 0.3 + 0.1 * static_cast<double>(band);
    // White only in the first band.
    problem.scattering.reflectance.col(band).segment(in_room, in_pocket) = 1 / (1.0 + static_cast<double>(band));
    problem.exitance.col(band).head(in_room / 10) = 1 + 0.2 * static_cast<double>(band * band);
  }
  return problem;
}

Eigen::VectorXd highest_of(const RadiosityProblem& problem) {
  return problem.scattering.reflectance.rowwise().maxCoeff();
}

RaysWithPockets with_its_pockets(const RadiosityProblem& problem) { return {building(), highest_of(problem)}; }

// B = (I - R F)^-1 E without the closed patches, which no light reaches.
Field by_elimination(const TransportOperator& transport, const RadiosityProblem& problem) {
  const Eigen::Index reached = in_room + in_pocket;
  const Eigen::MatrixXd F =
      transport.apply(Eigen::MatrixXd::Identity(patches, patches).array()).topLeftCorner(reached, reached).matrix();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(reached, reached);
  Field B = Field::Zero(patches, problem.exitance.cols());
  for (Eigen::Index band = 0; band < B.cols(); ++band) {
    const Eigen::VectorXd rho = problem.scattering.reflectance.col(band).head(reached);
    const Eigen::VectorXd E = problem.exitance.col(band).head(reached);
    B.col(band).head(reached) = (I - rho.asDiagonal() * F).partialPivLu().solve(E).array();
  }
  return B;
}

TEST(Pockets, AreThePatchesThatKeepTheirLight) {
  const RadiosityProblem problem = lit(1);
  const RaysWithPockets transport = with_its_pockets(problem);
  ASSERT_NE(transport.pockets(highest_of(problem)), nullptr);
  std::vector<PatchIndex> pocket(in_pocket);
  std::vector<PatchIndex> closed(in_closed);
  std::iota(pocket.begin(), pocket.end(), in_room);
  std::iota(closed.begin(), closed.end(), in_room + in_pocket);
  ASSERT_EQ(transport.pockets(highest_of(problem))->each.size(), 1);
  EXPECT_EQ(transport.pockets(highest_of(problem))->each[0].patches, pocket);
  EXPECT_EQ(transport.pockets(highest_of(problem))->closed, closed);
}

TEST(Pockets, AreNoneOfARoomThatIsWhiteAltogether) {
  EXPECT_EQ(pockets_of(building(), Eigen::VectorXd::Constant(patches, 0.99)), nullptr);
  EXPECT_EQ(pockets_of(building(), Eigen::VectorXd::Constant(patches, 0.5)), nullptr);
}

// Light takes thousands of bounces to leave the pocket. If these are followed separately, every patch has a valid
// bound, for any number of bands. For a loose solution the bound is close to the error.
TEST(PocketTransport, GivesTheSolutionWithABoundThatHolds) {
  for (const Eigen::Index bands : {1, 2, 5}) {
    const RadiosityProblem problem = lit(bands);
    const RaysWithPockets transport = with_its_pockets(problem);
    const Field exact = by_elimination(transport, problem);
    ASSERT_GT(exact(in_room, 0), 0.01 * exact.maxCoeff()) << "the pocket is lit from the room";
    for (const Solver solver : {Solver::gmres, Solver::bicgstab, Solver::jacobi}) {
      for (const double tolerance : {1e-2, 1e-5}) {
        const SolverOptions options{.solver = solver, .relative_error = tolerance, .every_band = true};
        const Solution found = solve(transport, problem, options);
        ASSERT_TRUE(found.converged) << name_of(solver);
        ASSERT_EQ(found.error.rows(), exact.rows()) << name_of(solver);
        const Field off = (found.radiosity - exact).abs();
        // Light in pockets is followed to a hundredth of the tolerance.
        const double followed = 0.01 * tolerance * exact.maxCoeff();
        EXPECT_LE((off - found.error).maxCoeff(), followed) << name_of(solver);
        EXPECT_LE(found.error.maxCoeff(), tolerance * 30 * exact.maxCoeff()) << name_of(solver);
        EXPECT_LE(relative_error(exact, found.radiosity, problem), 1.01 * tolerance) << name_of(solver);
        const Field again = problem.exitance + problem.scattering.reflect(found.irradiance);
        EXPECT_LT((again - found.radiosity).abs().maxCoeff(), 1e-12 * exact.maxCoeff()) << "B = E + R H";
        EXPECT_LT((found.direct_irradiance - transport.apply(problem.exitance)).abs().maxCoeff(),
                  1e-12 * exact.maxCoeff())
            << "F E";
      }
    }
  }
}

// Without pockets the bounces hardly decrease, and nothing bounds the error.
TEST(PocketTransport, IsWhatTheBoundRestsOn) {
  const RadiosityProblem problem = lit(1);
  EXPECT_EQ(solve(building(), problem, {.solver = Solver::gmres, .relative_error = 1e-5}).error.size(), 0);
}

// A lamp within the pocket, and light that arrives there from no patch.
TEST(PocketTransport, TakesWhatStartsInThePocket) {
  RadiosityProblem problem = lit(1);
  problem.exitance(in_room + 3, 0) = 0.5;
  const RaysWithPockets transport = with_its_pockets(problem);
  const Field exact = by_elimination(transport, problem);
  const SolverOptions tight{.solver = Solver::gmres, .relative_error = 1e-8};
  EXPECT_LT(relative_error(exact, solve(transport, problem, tight).radiosity, problem), 1e-5);
  RadiosityProblem arriving = problem;
  arriving.direct_irradiance = problem.exitance;
  arriving.exitance.setZero();
  problem.exitance = arriving.scattering.reflect(arriving.direct_irradiance);
  const Field from_nowhere = by_elimination(transport, problem);
  const Solution found = solve(transport, arriving, tight);
  EXPECT_LT((found.radiosity - from_nowhere).abs().maxCoeff(), 1e-5 * from_nowhere.maxCoeff());
  EXPECT_LT((found.irradiance - transport.apply(found.radiosity) - arriving.direct_irradiance).abs().maxCoeff(),
            1e-5 * from_nowhere.maxCoeff())
      << "H = F B + H_direct";
}

// Light on closed patches is trapped if these reflect all of it. Otherwise the remaining pockets are followed anyway.
TEST(PocketTransport, SaysWhatIsTrappedInClosedOnes) {
  RadiosityProblem problem = lit(1);
  problem.exitance(patches - 1, 0) = 1;
  EXPECT_FALSE(solve(with_its_pockets(problem), problem, {.solver = Solver::gmres}).trapped.empty());
  RadiosityProblem absorbing = problem;
  absorbing.scattering.reflectance.bottomRows(in_closed) = 0.5;
  const Solution found = solve(with_its_pockets(problem), absorbing, {.solver = Solver::gmres, .relative_error = 1e-6});
  EXPECT_TRUE(found.trapped.empty());
  EXPECT_TRUE(found.converged);
  // 1 + rho/2 + ... of three patches, each of which sees the two others.
  const double rho = 0.5;
  const double once = 1 / (1 - rho * rho / 2 / (1 - rho / 2));
  EXPECT_NEAR(found.radiosity(patches - 1, 0), once, 1e-5);
  EXPECT_EQ(found.error.rows(), found.radiosity.rows()) << "bounds are known";
}

// Only the last patch of the pocket's second half lets light out, and very little: millions of bounces. Each of the two
// is followed separately with its own bound.
TEST(PocketTransport, FollowsEachPocketByItself) {
  constexpr PatchIndex half = in_pocket / 2;
  constexpr double little = 4e-6;
  Rows rows = rows_of_building();
  for (PatchIndex k = 0; k < in_pocket; ++k) {
    const PatchIndex first = in_room + k / half * half;
    const double out = k < half ? leak : k + 1 == in_pocket ? little : 0;
    rows[in_room + k] = {{first + (k + 1) % half, static_cast<float>((1 - out) / 2)},
                         {first + (k + half - 1) % half, static_cast<float>((1 - out) / 2)}};
    if (out > 0) rows[in_room + k].push_back({k, static_cast<float>(out)});
  }
  const RadiosityProblem problem = lit(1);
  const RaysWithPockets transport(RayTransport({of(rows), of(rows)}), highest_of(problem));
  const Pockets* const pockets = transport.pockets(highest_of(problem));
  ASSERT_NE(pockets, nullptr);
  ASSERT_EQ(pockets->each.size(), 2);
  EXPECT_NEAR(pockets->each[0].bounces.mean(), 1 / leak, 1e-3 / leak);
  EXPECT_GT(pockets->each[1].bounces.minCoeff(), 0.9 * half / little);
  const Field exact = by_elimination(transport, problem);
  const Solution found = solve(transport, problem, {.solver = Solver::gmres, .relative_error = 1e-4});
  EXPECT_TRUE(found.converged);
  ASSERT_EQ(found.error.rows(), exact.rows());
  EXPECT_LE(((found.radiosity - exact).abs() - found.error).maxCoeff(), 1e-6 * exact.maxCoeff());
}

// A room, and a ring with more patches than the limit of elimination, in which light goes back and forth a thousand
// times.
constexpr PatchIndex in_large_room = 5000;
constexpr PatchIndex in_ring = 600;

RayTransport room_with_ring() {
  Rows rows(in_large_room + in_ring);
  for (PatchIndex i = 0; i < in_large_room; ++i)
    rows[i] = {{hash({i, 1}) % in_large_room, 0.5F}, {(i + 1) % (in_large_room + in_ring), 0.5F}};
  for (PatchIndex k = 0; k < in_ring; ++k)
    rows[in_large_room + k] = {{in_large_room + (k + 1) % in_ring, static_cast<float>((1 - leak) / 2)},
                               {in_large_room + (k + in_ring - 1) % in_ring, static_cast<float>((1 - leak) / 2)},
                               {k, static_cast<float>(leak)}};
  return RayTransport({of(rows), of(rows)});
}

// A problem of bands with white in the ring, less of it in others, and no light in the last one.
RadiosityProblem lit_ring(Eigen::Index bands) {
  const Eigen::Index size = in_large_room + in_ring;
  RadiosityProblem problem{{Field::Constant(size, bands, 0.5)}, Field::Zero(size, bands), Eigen::VectorXd::Ones(size)};
  for (Eigen::Index band = 0; band < bands; ++band) {
    problem.scattering.reflectance.col(band).tail(in_ring) = 1 - 0.1 * static_cast<double>(band);
    if (band == 0 || band + 1 < bands) problem.exitance.col(band).head(in_large_room / 10) = 1;
  }
  return problem;
}

// In a pocket too large for elimination the error is B - E - R F B, times the number of bounces at most.
TEST(PocketTransport, SolvesLargePocketsByIterations) {
  const RadiosityProblem problem = lit_ring(1);
  const RaysWithPockets transport(room_with_ring(), highest_of(problem));
  const Pockets* const pockets = transport.pockets(highest_of(problem));
  ASSERT_NE(pockets, nullptr);
  ASSERT_EQ(pockets->each.size(), 1);
  ASSERT_EQ(pockets->each[0].patches.size(), in_ring);
  ASSERT_NE(pockets->each[0].nearly_solved, nullptr);
  ASSERT_EQ(pockets->each[0].nearly_solved->rows(), in_ring);
  EXPECT_LT((pockets->each[0].bounces.array() * leak - 1).abs().maxCoeff(), 1e-3);
  const Solution found = solve(transport, problem, {.solver = Solver::gmres, .relative_error = 1e-5});
  EXPECT_TRUE(found.converged);
  const Field residual =
      problem.exitance + problem.scattering.reflect(transport.apply(found.radiosity)) - found.radiosity;
  // Light in pockets is followed to a hundredth of the tolerance. The residual times the bounces (1 / leak) is an
  // error, too.
  ASSERT_EQ(found.error.rows(), found.radiosity.rows());
  const double followed = 0.01 * 1e-5 * found.irradiance.maxCoeff();
  EXPECT_LE(residual.bottomRows(in_ring).abs().maxCoeff() / leak, 2 * found.error.maxCoeff() + followed);
}

// Some bands are solved long before others, one is dark, and one is not finite.
TEST(PocketTransport, SolvesEachBandToTheBitAsByItself) {
  constexpr Eigen::Index bands = 6;
  const RadiosityProblem problem = lit_ring(bands);
  const RaysWithPockets transport(room_with_ring(), highest_of(problem));
  const Pocket& pocket = transport.pockets(highest_of(problem))->each[0];
  const Field reflectance = problem.scattering.reflectance.bottomRows(in_ring);
  Field right = Field::Random(in_ring, bands);
  right.col(4) = 0;
  right(7, 3) = std::numeric_limits<double>::infinity();
  constexpr double tolerance = 1e-8;
  const Field together = solution_within(pocket, system_within(pocket.form_factors, reflectance), right, tolerance);
  for (const Eigen::Index band : {0, 1, 2, 4, 5}) {
    const PocketSystem alone = system_within(pocket.form_factors, reflectance.col(band));
    const Field by_itself = solution_within(pocket, alone, right.col(band), tolerance);
    EXPECT_TRUE((together.col(band) == by_itself.col(0)).all()) << band;
    const Field residual = residual_within(pocket, alone, right.col(band), by_itself);
    EXPECT_LE(residual.matrix().norm(), 1.001 * tolerance * right.col(band).matrix().norm()) << band;
  }
}

// Each band is followed as if it were alone, including a dark one; on one thread and on two.
TEST(PocketTransport, FollowsBandsAsEachByItself) {
  constexpr Eigen::Index bands = 3;
  constexpr double accuracy = 1e-6;
  const RadiosityProblem problem = lit_ring(bands);
  const RaysWithPockets transport(room_with_ring(), highest_of(problem));
  const Pockets& pockets = *transport.pockets(highest_of(problem));
  const PocketTransport together(transport, pockets, problem.scattering, true, accuracy);
  const Field found = together.apply(problem.exitance);
  EXPECT_LE(together.farthest_off(), accuracy);
  EXPECT_EQ(found.col(bands - 1).abs().maxCoeff(), 0);
  for (Eigen::Index band = 0; band < bands; ++band) {
    const Scattering of_band{problem.scattering.reflectance.col(band)};
    const PocketTransport alone(transport, pockets, of_band, true, accuracy);
    const Field by_itself = alone.apply(problem.exitance.col(band));
    EXPECT_LE((found.col(band) - by_itself.col(0)).abs().maxCoeff(), 2 * accuracy * by_itself.maxCoeff());
  }
  const ThreadLimit limit(1);
  EXPECT_TRUE((together.apply(problem.exitance) == found).all());
}

// Pockets do not apply to patches that reflect more than the limit of the search for pockets.
TEST(PocketTransport, IsForNoHigherReflectances) {
  RadiosityProblem problem = lit(1);
  const RaysWithPockets transport = with_its_pockets(problem);
  problem.scattering.reflectance(0, 0) += 0.01;
  EXPECT_EQ(transport.pockets(highest_of(problem)), nullptr);
  EXPECT_TRUE(solve(transport, problem, {.solver = Solver::gmres}).converged);
}

// A building without its pocket.
TEST(PocketTransport, TakesClosedOnesAlone) {
  Rows rows = rows_of_building();
  for (PatchIndex i = 0; i < in_room + in_pocket; ++i) rows[i] = {{(i + 7) % in_room, 1}};
  RadiosityProblem problem = lit(1);
  const RaysWithPockets transport(RayTransport({of(rows), of(rows)}), problem.scattering.reflectance.col(0).matrix());
  ASSERT_NE(transport.pockets(highest_of(problem)), nullptr);
  EXPECT_TRUE(transport.pockets(highest_of(problem))->each.empty());
  EXPECT_EQ(transport.pockets(highest_of(problem))->closed.size(), in_closed);
  const Solution found = solve(transport, problem, {.solver = Solver::gmres, .relative_error = 1e-6});
  EXPECT_TRUE(found.converged);
  EXPECT_TRUE(found.radiosity.isFinite().all());
  EXPECT_EQ(found.radiosity.bottomRows(in_closed).maxCoeff(), 0);
}

TEST(PocketTransport, HandsOnWhatIsNoNumber) {
  const RadiosityProblem problem = lit(1);
  const RaysWithPockets transport = with_its_pockets(problem);
  const PocketTransport around(transport, *transport.pockets(highest_of(problem)), problem.scattering, true, 1e-6);
  Field radiosity = Field::Ones(patches, 1);
  radiosity(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(around.apply(radiosity)(in_room, 0)));

  // Only the last patch of the ring connects it. Iterations follow it.
  const RadiosityProblem large = lit_ring(2);
  const RaysWithPockets with_ring(room_with_ring(), highest_of(large));
  const PocketTransport around_ring(with_ring, *with_ring.pockets(highest_of(large)), large.scattering, true, 1e-6);
  radiosity = Field::Ones(in_large_room + in_ring, 2);
  radiosity(in_ring - 1, 0) = std::numeric_limits<double>::quiet_NaN();
  const Field found = around_ring.apply(radiosity);
  EXPECT_TRUE(std::isnan(found(in_large_room, 0)));
  EXPECT_TRUE(found.col(1).tail(in_ring).isFinite().all()) << "the other band";
}

// An observer receives H of the iterate, in the pockets and elsewhere.
TEST(PocketTransport, TellsObserversAllLight) {
  RadiosityProblem problem = lit(1);
  problem.exitance(in_room + 3, 0) = 0.5;
  Field last;
  const Observer observer = [&](const Progress& progress) {
    if (progress.irradiance) last = progress.irradiance();
    return true;
  };
  const Solution found =
      solve(with_its_pockets(problem), problem, {.solver = Solver::gmres, .relative_error = 1e-8}, observer);
  EXPECT_LT((last - found.irradiance).topRows(in_room + in_pocket).abs().maxCoeff(), 1e-6);
}

TEST(PocketTransport, HasTheSameBitsOnAnyNumberOfThreads) {
  const RadiosityProblem problem = lit(3);
  const auto radiosity_on = [&](int threads) {
    const ThreadLimit limit(threads);
    return solve(with_its_pockets(problem), problem, {.solver = Solver::gmres, .every_band = true}).radiosity;
  };
  EXPECT_TRUE((radiosity_on(1) == radiosity_on(2)).all());
}

}  // namespace
}  // namespace patchlight::pocket_transport_test
