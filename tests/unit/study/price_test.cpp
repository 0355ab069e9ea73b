#include "study/study.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace patchlight::price_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

StudySetting setting(PatchIndex patches, double seconds, double error) {
  StudySetting made;
  made.patches = patches;
  made.samples = 16;
  made.tolerance = 1e-6;
  made.costs = {{Stage::form_factors, seconds, seconds}};
  made.matrix_bytes = 2.0 * patches * patches;
  made.error = error;
  made.own_error = error;
  return made;
}

// A made-up study with a known solution: the error decreases as n^(-p/2), and seconds grow with n^2.
Study made_up(double order, double error_of_finest) {
  StudySweep sweep{"patch size", Swept::patch_size, {}};
  for (const PatchIndex n : {100, 400, 1600}) {
    const double coarser = 1600.0 / n;
    sweep.settings.push_back(setting(n, 16 / (coarser * coarser), error_of_finest * std::pow(coarser, order / 2)));
  }
  Study study;
  study.reference.closed_form = true;
  study.sweeps = {with_orders(sweep, infinity)};
  study.parts.mesh = error_of_finest;
  study.parts.worst_place = "floor";
  study.parts.worst_share = 0.5;
  return with_fronts(study);
}

TEST(Order, IsThatOfThePowerWithWhichErrorsFall) {
  for (const double p : {0.5, 1.0, 1.5, 2.0}) {
    const StudySweep sweep = made_up(p, 0.01).sweeps[0];
    EXPECT_TRUE(std::isnan(sweep.settings[0].order));
    EXPECT_NEAR(sweep.settings[1].order, p, 1e-12);
    EXPECT_NEAR(sweep.settings[2].order, p, 1e-12);
  }
}

TEST(Order, AllowsForTheErrorOfTheReference) {
  // e(n) = n^(-p/2) - m^(-p/2) for a reference of m patches: the difference of two errors of the same shape.
  for (const double p : {0.5, 1.0, 1.7}) {
    const auto error = [p](double n, double m) { return std::pow(n, -p / 2) - std::pow(m, -p / 2); };
    const StudySetting coarse = setting(400, 1, error(400, 6400));
    const StudySetting fine = setting(1600, 1, error(1600, 6400));
    EXPECT_TRUE(std::isnan(order_in_edge(coarse, fine, 6400)))
        << "the edges of the finer one are two of the reference's";
    StudySweep sweep{"patch size", Swept::patch_size, {coarse, fine}};
    // The bar is the reference's own error.
    EXPECT_NEAR(richardson_bar(sweep, 6400), std::pow(6400, -p / 2), 1e-5 * std::pow(6400, -p / 2));
  }
}

// Errors like those of the lit cube. With a reference of 64 times the patches the plain ratio is nearly free of its
// error.
TEST(Order, IsThePlainRatioOfErrorsFarFromTheReference) {
  const StudySetting coarse = setting(100, 1, 0.08);
  const StudySetting fine = setting(400, 1, 0.08 / std::pow(2, 1.2));
  EXPECT_NEAR(order_in_edge(coarse, fine, 6400), 1.2, 1e-12);
  EXPECT_TRUE(std::isnan(order_in_edge(coarse, fine, 6399)));
}

TEST(Order, IsNotKnownWhereErrorsDoNotFall) {
  EXPECT_TRUE(std::isnan(order_in_edge(setting(100, 1, 0.1), setting(400, 1, 0.1), 1600)));
  EXPECT_TRUE(std::isnan(order_in_edge(setting(100, 1, 0), setting(400, 1, 0), 1600)));
  // The bar then uses the least order, 1/2: e / (2^(1/2) - 1).
  const StudySweep sweep{"patch size", Swept::patch_size, {setting(100, 1, 0.1), setting(400, 1, 0.1)}};
  EXPECT_NEAR(richardson_bar(sweep, 1600), 0.1 / (std::sqrt(2) - 1), 1e-12);
}

TEST(Order, OfSamplesAndTolerances) {
  StudySweep sweep{"samples", Swept::samples, {setting(1, 1, 0.4), setting(1, 1, 0.2)}};
  sweep.settings[1].samples = 64;
  EXPECT_NEAR(with_orders(sweep, 1).settings[1].order, 0.5, 1e-12);
  sweep.swept = Swept::tolerance;
  sweep.settings[1].tolerance = 5e-7;
  EXPECT_NEAR(with_orders(sweep, 1).settings[1].order, 1, 1e-12);
}

TEST(ParetoFront, HoldsWhatNothingElseIsBetterThan) {
  const std::vector<bool> front = pareto_front({{1, 10}, {2, 5}, {3, 6}, {4, 5}, {5, 1}, {5, 1}});
  EXPECT_EQ(front, (std::vector<bool>{true, true, false, false, true, true}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(ParetoFront, LeavesOutWhatDoesNotCompete) {
  Study study = made_up(1, 0.01);
  study.sweeps.push_back({"estimator", Swept::samples, {setting(1600, 0.1, 1e-4)}, false});
  study = with_fronts(study);
  for (const StudySetting& one : study.sweeps[0].settings) EXPECT_TRUE(one.on_time_front && one.on_memory_front);
  EXPECT_FALSE(study.sweeps[1].settings[0].on_time_front);
}

TEST(Price, IsInterpolatedInLogarithms) {
  // Errors 4 %, 2 %, 1 % at 1/16, 1 and 16 seconds: seconds = (2 % / error)^4.
  const Study study = made_up(1, 0.01);
  const Price price = price_of(0.015, study);
  EXPECT_EQ(price.finding, Finding::interpolated);
  EXPECT_NEAR(price.cpu_seconds, std::pow(2 / 1.5, 4), 1e-9);
  EXPECT_EQ(price_of(0.05, study).finding, Finding::at_most);
  EXPECT_NEAR(price_of(0.05, study).cpu_seconds, 1.0 / 16, 1e-12);
}

TEST(Price, IsExtrapolatedByTheObservedOrderAndNoFartherThanSixteenTimesThePatches) {
  const Study study = made_up(1, 0.01);
  const Price price = price_of(0.005, study);  // four times the patches, sixteen times the seconds
  EXPECT_EQ(price.finding, Finding::extrapolated);
  EXPECT_NEAR(price.cpu_seconds, 256, 1e-6);
  EXPECT_NEAR(price.order, 1, 1e-9);
  EXPECT_EQ(price_of(0.0024, study).finding, Finding::not_reached);
}

TEST(Price, CountsTheBarOfTheReference) {
  Study study = made_up(1, 0.01);
  study.reference.bar = 0.005;
  EXPECT_NEAR(price_of(0.025, study).cpu_seconds, 1, 1e-9);  // 2 % and 0.5 %
}

TEST(Price, IsNotKnownWhereTheReferenceIsNoBetter) {
  // An error of 1.9 % relative to a reference of 4.55 %: a distance of 1 % cannot be determined.
  Study study = made_up(2, 0.019);
  study.reference.bar = 0.0455;
  EXPECT_EQ(price_of(0.01, study).finding, Finding::not_known);
  EXPECT_EQ(price_of(0.0455, study).finding, Finding::not_known);
  EXPECT_NE(price_of(0.1, study).finding, Finding::not_known);
  EXPECT_EQ(
      conclusion(study),
      "the cost of 1 % is not known, as the error of the reference is no smaller, the cost of 0.3 % is not known, "
      "as the error of the reference is no smaller; the largest error comes from the size of the patches (1.9 % of the "
      "light at the finest setting), by a reference that is itself good to 4.5 %, most of all on `floor`, 50 % of "
      "the squared error.");
}

TEST(Conclusion, SaysPricesAndWhatLimits) {
  EXPECT_EQ(
      conclusion(made_up(1, 0.01)),
      "1 % costs 16 s of CPU time here, 0.3 % costs about 1975 s of CPU time (by the observed order 1); the largest "
      "error comes from the size of the patches (1 % of the light at the finest setting), most of all on `floor`, 50 % "
      "of "
      "the squared error.");
  Study study = made_up(0.5, 0.1);
  study.parts.form_factors = 0.2;
  EXPECT_EQ(conclusion(study),
            "1 % is not reached within 1600 patches, 0.3 % is not reached within 1600 patches; the largest "
            "error comes from the "
            "sampling of the form factors (20 % of the light at the finest setting).");
  study.parts.solver = 0.3;
  EXPECT_NE(conclusion(study).find("the solver's tolerance (30 %"), std::string::npos);
}

}  // namespace
}  // namespace patchlight::price_test
