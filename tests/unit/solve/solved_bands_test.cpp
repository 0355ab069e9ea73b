#include "solve/scattering.h"

#include <gtest/gtest.h>

namespace patchlight::solved_bands_test {
namespace {

RadiosityProblem two_patches(const Field& reflectance, const Field& exitance) {
  return {{reflectance}, exitance, Eigen::Vector2d(1, 2)};
}

TEST(SolvedBands, LeaveOutBandsWithoutLight) {
  Field exitance(2, 3);
  exitance << 1, 0, 2, 0, 0, 5;
  const SolvedBands bands = solved_bands(two_patches(Field::Constant(2, 3, 0.5), exitance));
  EXPECT_EQ(bands.solved, (std::vector<Eigen::Index>{0, 2}));
  const Field all = expanded(reduced(exitance, bands), bands);
  EXPECT_TRUE((all == exitance).all());
}

TEST(SolvedBands, SolveMultiplesOnce) {
  Field exitance(2, 3);
  exitance << 1, 3, 1, 2, 6, 2;
  Field reflectance = Field::Constant(2, 3, 0.5);
  EXPECT_EQ(solved_bands(two_patches(reflectance, exitance)).solved, (std::vector<Eigen::Index>{0}));
  EXPECT_TRUE((expanded(exitance.leftCols(1), solved_bands(two_patches(reflectance, exitance))) == exitance).all());
  // Another reflectance, or lamps of different colors, give other systems.
  reflectance(1, 1) = 0.6;
  EXPECT_EQ(solved_bands(two_patches(reflectance, exitance)).solved, (std::vector<Eigen::Index>{0, 1}));
  exitance(1, 2) = 2.0000001;
  EXPECT_EQ(solved_bands(two_patches(reflectance, exitance)).solved, (std::vector<Eigen::Index>{0, 1, 2}));
}

TEST(SolvedBands, KeepOneWhenAllAreDark) {
  const SolvedBands bands = solved_bands(two_patches(Field::Constant(2, 2, 0.5), Field::Zero(2, 2)));
  EXPECT_EQ(bands.solved.size(), 1U);
  EXPECT_TRUE((expanded(Field::Ones(2, 1), bands) == 0).all());
}

// The second band is three times the first, and has its own irradiance by luminaires.
TEST(TellingAllBands, GivesEachItsFactorAndWhatComesBesides) {
  Field exitance(2, 2);
  exitance << 1, 3, 2, 6;
  const SolvedBands bands = solved_bands(two_patches(Field::Constant(2, 2, 0.5), exitance));
  ASSERT_EQ(bands.solved.size(), 1U);
  Field besides(2, 2);
  besides << 10, 20, 30, 40;
  Field told;
  int calls = 0;
  const Observer observer = [&](const Progress& progress) {
    ++calls;
    if (progress.irradiance) told = progress.irradiance();
    return true;
  };
  const Observer of_one = telling_all_bands(observer, bands, &besides);
  Progress progress;
  of_one(progress);
  EXPECT_EQ(told.size(), 0) << "there is none to tell";
  progress.irradiance = [] { return Field(Field::Constant(2, 1, 1.0)); };
  of_one(progress);
  Field expected(2, 2);
  expected << 11, 23, 31, 43;
  EXPECT_TRUE((told == expected).all()) << told;
  EXPECT_EQ(calls, 2);
  telling_all_bands(observer, bands)(progress);
  EXPECT_TRUE((told == expected - besides).all()) << told;
  EXPECT_FALSE(telling_all_bands({}, bands));
}

TEST(AllBands, TakesEachAsItIs) {
  const Field exitance = Field::Constant(2, 3, 1.0);
  const RadiosityProblem problem = two_patches(Field::Constant(2, 3, 0.5), exitance);
  EXPECT_EQ(all_bands(problem).solved, (std::vector<Eigen::Index>{0, 1, 2}));
  EXPECT_TRUE((expanded(exitance, all_bands(problem)) == exitance).all());
}

}  // namespace
}  // namespace patchlight::solved_bands_test
