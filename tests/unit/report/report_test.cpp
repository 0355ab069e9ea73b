#include "patchlight/report/report.h"

#include "unit/output/tiny_simulation.h"

#include <gtest/gtest.h>

namespace patchlight::report_test {
namespace {

// Emitted minus absorbed light: with B = E + rho o H, sum A E - sum A (1 - rho) H = sum A (B - H).
TEST(Report, LightOfTheMaterialsAddsUp) {
  const Simulation simulation = tiny_simulation();
  const Report report = report_of(tiny_scene(), {}, simulation);
  Eigen::Array3d net = Eigen::Array3d::Zero();
  for (const MaterialLight& material : report.materials) {
    net += (material.emitted - material.absorbed).transpose();
    EXPECT_TRUE((material.lowest <= material.mean * (1 + 1e-15)).all());
    EXPECT_TRUE((material.highest >= material.mean * (1 - 1e-15)).all());
  }
  const Field difference = simulation.solution.radiosity - simulation.solution.irradiance;
  const Eigen::Array3d expected = (difference.matrix().transpose() * simulation.problem.area).array();
  // Six products and sums of numbers up to 50, rounded to 1e-16 each.
  EXPECT_LT((net - expected).abs().maxCoeff(), 1e-13);
}

TEST(Report, KnowsNoCountsOfRowsOnDemand) {
  Simulation simulation = tiny_simulation();
  EXPECT_TRUE(report_of(tiny_scene(), {}, simulation).form_factors.counts.has_value());
  simulation.plan.assembly.storage = Storage::on_demand;
  EXPECT_FALSE(report_of(tiny_scene(), {}, simulation).form_factors.counts.has_value());
}

TEST(Report, RateOfShadowRaysIsThatOfTheFormFactorsAlone) {
  Simulation simulation = tiny_simulation();
  simulation.transport.counts.shadow_rays = 300;
  EXPECT_FALSE(report_of(tiny_scene(), {}, simulation).form_factors.rays_per_second.has_value());
  simulation.costs.push_back({Stage::form_factors, 1.5, 3});
  EXPECT_EQ(report_of(tiny_scene(), {}, simulation).form_factors.rays_per_second, 200);
}

// One iteration of progressive refinement is one shot per patch: three.
TEST(Report, TellsRowsFromIterationsAsTheEnd) {
  Simulation simulation = tiny_simulation();
  simulation.plan.solver.max_iterations = 1;
  simulation.plan.solver.max_rows = 0.5;
  simulation.solution.history.back().number = 2;
  simulation.solution.converged = false;
  EXPECT_TRUE(report_of(tiny_scene(), {}, simulation).solution.stopped_by_rows);
  simulation.solution.converged = true;
  EXPECT_FALSE(report_of(tiny_scene(), {}, simulation).solution.stopped_by_rows);
  simulation.solution.converged = false;
  simulation.solution.history.back().number = 3;
  EXPECT_FALSE(report_of(tiny_scene(), {}, simulation).solution.stopped_by_rows);
}

TEST(Report, IsAccurateWhenNothingElseWasAskedFor) {
  Simulation simulation = tiny_simulation_with_bars();
  EXPECT_TRUE(is_accurate(report_of(tiny_scene(), {}, simulation)));
  simulation.plan.accuracy.relative_error = 0.05;
  EXPECT_TRUE(is_accurate(report_of(tiny_scene(), {}, simulation)));
  simulation.plan.accuracy.relative_error = 0.04;
  EXPECT_FALSE(is_accurate(report_of(tiny_scene(), {}, simulation)));
}

}  // namespace
}  // namespace patchlight::report_test
