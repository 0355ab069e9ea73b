#include "output/plot/plot_ticks.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace patchlight::plot_ticks_test {
namespace {

std::string with_minus(std::string text) {
  const std::string sign = "\u2212";
  if (text.starts_with(sign)) text.replace(0, sign.size(), "-");
  return text;
}

// The value that a reader takes from a label: "5", "10" with a raised "-3", "2x10" with a raised "6".
double value_of_label(const Tick& tick) {
  if (tick.exponent.empty()) return std::stod(with_minus(tick.text));
  const double power = std::pow(10.0, std::stod(with_minus(tick.exponent)));
  const std::size_t times = tick.text.find("\u00d7");
  return times == std::string::npos ? power : std::stod(with_minus(tick.text.substr(0, times))) * power;
}

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> texts;
  for (const Tick& tick : ticks) {
    if (tick.text.empty()) continue;
    texts.push_back(tick.text + (tick.exponent.empty() ? "" : "^" + tick.exponent));
  }
  return texts;
}

using Labels = std::vector<std::string>;

TEST(LinearTicks, AreMultiplesOfOneTwoOrFivePowersOfTenAndReachTheEnds) {
  for (double span = 1e-12; span < 1e15; span *= 1.7) {
    for (const double lower : {0.0, -0.3 * span, 40 * span, -1000 * span}) {
      const double upper = lower + span;
      const AxisRange range = axis_range({upper, lower}, Scale::linear, 8);
      const std::vector<Tick> ticks = axis_ticks(range, Scale::linear, 8);
      ASSERT_GE(ticks.size(), 3U);
      ASSERT_LE(ticks.size(), 9U);
      const double step = ticks[1].value - ticks[0].value;
      const double digit = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
      // Values up to 1000 spans away are rounded to 1000 * 2^-52 of the span. Steps are a tenth of it.
      const double rounding = 1e-10 * step;
      EXPECT_LT(std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}), 1e-9) << step;
      EXPECT_NEAR(ticks.front().value, range.lower, rounding);
      EXPECT_NEAR(ticks.back().value, range.upper, rounding);
      EXPECT_LE(range.lower, lower + 1e-8 * step);
      EXPECT_GE(range.upper, upper - 1e-8 * step);
      for (std::size_t k = 0; k < ticks.size(); ++k) {
        EXPECT_NEAR(ticks[k].value, ticks[0].value + static_cast<double>(k) * step, 1e-9 * step);
        EXPECT_NEAR(value_of_label(ticks[k]), ticks[k].value, 1e-6 * step) << ticks[k].text << '^' << ticks[k].exponent;
      }
    }
  }
}

TEST(LinearTicks, HaveShortLabels) {
  EXPECT_EQ(labels(axis_ticks({0, 1}, Scale::linear, 8)), (Labels{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels(axis_ticks({-10, 10}, Scale::linear, 4)), (Labels{"\u221210", "\u22125", "0", "5", "10"}));
  EXPECT_EQ(labels(axis_ticks({0, 4e6}, Scale::linear, 2)), (Labels{"0", "2\u00d710^6", "4\u00d710^6"}));
  EXPECT_EQ(labels(axis_ticks({0, 2e-5}, Scale::linear, 2)), (Labels{"0", "1\u00d710^\u22125", "2\u00d710^\u22125"}));
}

TEST(LogarithmicTicks, AreThePowersOfTen) {
  const std::vector<Tick> ticks = axis_ticks({0.9e-8, 1.1}, Scale::logarithmic, 12);
  ASSERT_EQ(ticks.size(), 9U);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_NEAR(ticks[k].value * std::pow(10.0, 8 - static_cast<double>(k)), 1, 1e-12);
    EXPECT_EQ(ticks[k].text, "10");
    EXPECT_NEAR(value_of_label(ticks[k]) / ticks[k].value, 1, 1e-12);
  }
}

TEST(LogarithmicTicks, OfManyDecadesHaveLabelsAtEqualSteps) {
  const std::vector<Tick> ticks = axis_ticks({1e-30, 1}, Scale::logarithmic, 12);
  EXPECT_EQ(ticks.size(), 31U);
  const Labels expected{"10^\u221230", "10^\u221227", "10^\u221224", "10^\u221221", "10^\u221218", "10^\u221215",
                        "10^\u221212", "10^\u22129",  "10^\u22126",  "10^\u22123",  "10^0"};
  EXPECT_EQ(labels(ticks), expected);
}

TEST(LogarithmicTicks, OfFewDecadesHaveTheDigitsBetween) {
  const std::vector<Tick> ticks = axis_ticks({1, 1000}, Scale::logarithmic, 12);
  EXPECT_EQ(labels(ticks), (Labels{"10^0", "10^1", "10^2", "10^3"}));
  ASSERT_EQ(ticks.size(), 28U);  // 3 x 9 and the last
  EXPECT_DOUBLE_EQ(ticks[1].value, 2);
  EXPECT_DOUBLE_EQ(ticks[26].value, 900);
}

TEST(LogarithmicTicks, OfOneOrTwoDecadesHaveLabelsAtOneTwoFive) {
  EXPECT_EQ(labels(axis_ticks({0.9, 60}, Scale::logarithmic, 12)), (Labels{"1", "2", "5", "10", "20", "50"}));
  EXPECT_EQ(labels(axis_ticks({4e-7, 2e-6}, Scale::logarithmic, 12)),
            (Labels{"5\u00d710^\u22127", "10^\u22126", "2\u00d710^\u22126"}));
}

TEST(LogarithmicTicks, AreLinearInAShortRange) {
  EXPECT_EQ(labels(axis_ticks({3, 4}, Scale::logarithmic, 4)), (Labels{"3.0", "3.5", "4.0"}));
}

TEST(AxisRange, IsNeverEmpty) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  for (const Scale scale : {Scale::linear, Scale::logarithmic}) {
    for (const std::vector<double>& values : {std::vector<double>{},
                                              {7},
                                              {7, 7},
                                              {1e-200},
                                              {1e200},
                                              {1e-200, 1e200},
                                              {1e9, 1e9 * (1 + 1e-15)},
                                              {3, 3.001}}) {
      const AxisRange range = axis_range(values, scale, 8);
      ASSERT_LT(range.lower, range.upper);
      for (const double value : values) {
        ASSERT_TRUE(on_axis(value, scale));
        EXPECT_GE(place_on_axis(value, range, scale), 0);
        EXPECT_LE(place_on_axis(value, range, scale), 1);
      }
      EXPECT_GE(labels(axis_ticks(range, scale, 8)).size(), 2U);
    }
  }
  for (const std::vector<double>& values : {std::vector<double>{0}, {-5, -5}, {0, tiny}, {-1e200, 1e200}}) {
    const AxisRange range = axis_range(values, Scale::linear, 8);
    EXPECT_LT(range.lower, range.upper);
    EXPECT_GE(axis_ticks(range, Scale::linear, 8).size(), 3U);
  }
}

TEST(OnAxis, RefusesWhatCannotBeShown) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN(), 1e201, -1e201}) {
    EXPECT_FALSE(on_axis(value, Scale::linear)) << value;
    EXPECT_FALSE(on_axis(value, Scale::logarithmic)) << value;
  }
  for (const double value : {0.0, -1.0, 1e-201}) {
    EXPECT_TRUE(on_axis(value, Scale::linear)) << value;
    EXPECT_FALSE(on_axis(value, Scale::logarithmic)) << value;
  }
}

TEST(PlaceOnAxis, HalvesALogarithmicAxisAtTheGeometricMean) {
  EXPECT_DOUBLE_EQ(place_on_axis(5, {0, 20}, Scale::linear), 0.25);
  const AxisRange range{1e-8, 1e4};
  EXPECT_NEAR(place_on_axis(1e-8, range, Scale::logarithmic), 0, 1e-15);
  EXPECT_NEAR(place_on_axis(1e-2, range, Scale::logarithmic), 0.5, 1e-15);
  EXPECT_NEAR(place_on_axis(1e4, range, Scale::logarithmic), 1, 1e-15);
}

}  // namespace
}  // namespace patchlight::plot_ticks_test
