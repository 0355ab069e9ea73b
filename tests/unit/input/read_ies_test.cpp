#include "patchlight/base/error.h"

#include "input/tables/read_tables.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

namespace patchlight::read_ies_test {
namespace {

constexpr double pi = std::numbers::pi;

const LuminaireFrame down{-Vector::UnitZ(), Vector::UnitX()};

// A file of the 2002 standard with one candela value below. The tests change it.
std::string downlight() {
  return "IESNA:LM-63-2002\n"
         "[TEST] none\n"
         "[MANUFAC] nobody\n"
         "TILT=NONE\n"
         "1 100 1 3 1 1 2 0.5 0.25 0.1\n"
         "1 1 12\n"
         "0 45 90\n"
         "0\n"
         "10 5 0\n";
}

std::string with(std::string text, const std::string& old_part, const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << old_part;
  return text.replace(at, old_part.size(), new_part);
}

void expect_refusal(const std::string& text, const std::string& place, const std::string& what) {
  try {
    parse_ies(text, "lamp.ies");
    ADD_FAILURE() << "expected a refusal: " << what;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("lamp.ies:" + place + ": ", 0), 0U) << error.what();
    EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
  }
}

TEST(ReadIes, HasWhatTheFileSays) {
  const PhotometricWeb web = parse_ies(downlight(), "lamp.ies");
  EXPECT_EQ(web.type, PhotometricType::c);
  EXPECT_EQ(web.vertical, (std::vector<double>{0, 45, 90}));
  EXPECT_EQ(web.horizontal, std::vector<double>{0});
  EXPECT_EQ(web.candela, (std::vector<double>{10, 5, 0}));
  EXPECT_EQ(web.opening, Vector(0.5, 0.25, 0.1));
  EXPECT_EQ(web.lamp_lumens, 100);
  EXPECT_EQ(web.watts, 12);
  EXPECT_EQ(tilt_factor(web, 20), 1);
}

TEST(ReadIes, KnowsRoundOpeningsByTheirSigns) {
  const auto read = [](const std::string& opening) {
    return parse_ies(with(downlight(), "0.5 0.25 0.1", opening), "lamp.ies");
  };
  EXPECT_EQ(read("0.5 0.25 0.1").shape, OpeningShape::box);
  EXPECT_EQ(read("-0.5 -0.5 0.1").shape, OpeningShape::upright_cylinder);
  EXPECT_EQ(read("-0.5 -0.5 -0.5").shape, OpeningShape::ellipsoid);
  EXPECT_EQ(read("-0.1 1.2 -0.1").shape, OpeningShape::cylinder_by_length);
  EXPECT_EQ(read("1.2 -0.1 -0.1").shape, OpeningShape::cylinder_by_width);
  EXPECT_EQ(read("-0.5 0 -0.5").shape, OpeningShape::ellipsoid);
  // LM-63-1995 states only the diameter of a circle.
  EXPECT_EQ(read("-0.5 0 0").shape, OpeningShape::upright_cylinder);
  EXPECT_EQ(read("-0.5 0 0").opening, Vector(0.5, 0.5, 0));
}

TEST(ReadIes, MultipliesTheFactors) {
  // 2 (multiplier) x 0.9 (ballast) x 0.5 (ballast-lamp)
  std::string text = with(downlight(), "1 100 1 3", "2 100 2 3");
  text = with(text, "1 1 12", "0.9 0.5 12");
  const PhotometricWeb web = parse_ies(text, "lamp.ies");
  EXPECT_NEAR(web.candela[0], 9, 1e-12);
  EXPECT_EQ(web.lamp_lumens, 200);
}

TEST(ReadIes, KnowsFeetAndAbsolutePhotometry) {
  std::string text = with(downlight(), "1 1 2 0.5", "1 1 1 0.5");
  text = with(text, "1 100 1", "1 -1 1");
  const PhotometricWeb web = parse_ies(text, "lamp.ies");
  EXPECT_NEAR(web.opening.x(), 0.5 * 0.3048, 1e-12);
  EXPECT_EQ(web.lamp_lumens, 0);
  EXPECT_EQ(web.candela[0], 10);
}

TEST(ReadIes, TakesTheOldestFormAndNumbersInAnyLines) {
  // LM-63-1986 has no first line of its own. Numbers may continue on any line, and commas may separate them.
  const PhotometricWeb web =
      parse_ies("a luminaire\r\nTILT=NONE\r\n1,100,1\r\n3 1 1 2\r\n0 0 0 1 1 12 0 45\r\n90 0 10,5,0\r\n", "old.ies");
  EXPECT_EQ(web.candela, (std::vector<double>{10, 5, 0}));
}

TEST(ReadIes, TypesAAndB) {
  std::string text = with(downlight(), "3 1 1 2", "3 2 2 2");
  text = with(text, "0 45 90\n0\n10 5 0\n", "-90 0 90\n0 90\n1 2 3 4 5 6\n");
  EXPECT_EQ(parse_ies(text, "lamp.ies").type, PhotometricType::b);
  EXPECT_EQ(parse_ies(with(text, "3 2 2 2", "3 2 3 2"), "lamp.ies").type, PhotometricType::a);
}

TEST(ReadIes, TiltIsTakenFromTheFile) {
  const std::string text = with(downlight(), "TILT=NONE\n", "TILT=INCLUDE\n1\n3\n0 45 90\n1.0 0.9 0.8\n");
  const PhotometricWeb web = parse_ies(text, "lamp.ies");
  EXPECT_NEAR(tilt_factor(web, 22.5), 0.95, 1e-12);
  EXPECT_EQ(web.candela[0], 10);
  expect_refusal(with(downlight(), "TILT=NONE", "TILT=tilt.dat"), "4", "TILT=tilt.dat");
}

TEST(ReadIes, FluxOfALambertianLuminaireIsItsLumens) {
  // I = 1000 / pi cos v cd is 1000 lm. The chords of a table of 2.5 degrees are too low by (2.5 degrees)^2 / 12 =
  // 1.6e-4.
  std::string text = "IESNA91\nTILT=NONE\n1 1000 1 37 1 1 2 0 0 0\n1 1 10\n";
  for (int k = 0; k <= 36; ++k) text += std::to_string(2.5 * k) + (k % 10 == 9 ? "\n" : " ");
  text += "\n0\n";
  for (int k = 0; k <= 36; ++k) text += std::to_string(1000 / pi * std::cos(2.5 * k * pi / 180)) + "\n";
  const PhotometricWeb web = parse_ies(text, "lamp.ies");
  EXPECT_NEAR(luminous_flux(web), web.lamp_lumens, 0.3);
}

TEST(ReadIes, FluxOfADirectAndIndirectLuminaireIsItsLumensTimesItsEfficiency) {
  // Two lamps of 2,900 lm, imperial units, and a table of a quadrant in steps of 2.5 and 22.5 degrees, the usual steps
  // of manufacturers. I = I0 (1 + sin^2 v cos 2h) with I0 = 0.9 x 5800 / (4 pi) cd, an efficiency of 0.9. Chords of
  // 22.5 degrees omit at most 1 % of the second term, whose integral over h is 0 by symmetry.
  std::string text = "IESNA95\nTILT=NONE\n2 2900 1 73 5 1 1 0.85 4.04 .292\n1 1 63.7\n";
  for (int k = 0; k <= 72; ++k) text += std::to_string(2.5 * k) + "\n";
  text += "0 22.5 45 67.5 90\n";
  for (int j = 0; j <= 4; ++j) {
    for (int k = 0; k <= 72; ++k) {
      const double sine = std::sin(2.5 * k * pi / 180);
      text += std::to_string(0.9 * 5800 / (4 * pi) * (1 + sine * sine * std::cos(45.0 * j * pi / 180))) + "\n";
    }
  }
  const PhotometricWeb web = parse_ies(text, "office.ies");
  EXPECT_EQ(web.lamp_lumens, 5800);
  EXPECT_NEAR(luminous_flux(web), 0.9 * 5800, 0.001 * 5800);
}

TEST(ReadIes, RefusesWithFileAndLine) {
  expect_refusal("v 0 0 0\nf 1 2 3\n", "2", "TILT=");
  expect_refusal("\nTILT=, ", "2", "TILT=nothing");
  expect_refusal("TILT=,\n\n,,\n", "1", "TILT=nothing");
  expect_refusal(with(downlight(), "3 1 1 2", "3 1.0000001 1 2"), "5", "found 1.0000001 for");
  expect_refusal(with(downlight(), "10 5 0", "10 five 0"), "9", "'five'");
  expect_refusal(with(downlight(), "10 5 0", "10 -5 0"), "9", "-5");
  expect_refusal(with(downlight(), "10 5 0", "10 5"), "9", "ends before");
  expect_refusal(with(downlight(), "10 5 0", "10 5 0 7"), "9", "'7'");
  expect_refusal(with(downlight(), "0 45 90", "0 45 45"), "7", "ascending");
  expect_refusal(with(downlight(), "0 45 90", "0 45 80"), "7", "vertical angles");
  expect_refusal(with(downlight(), "90\n0\n", "90\n5\n"), "8", "horizontal angles");
  expect_refusal(with(downlight(), "3 1 1 2", "3 1 4 2"), "5", "photometric type");
  expect_refusal(with(downlight(), "3 1 1 2", "3.5 1 1 2"), "5", "whole number");
  expect_refusal(with(downlight(), "1 100 1", "1 -100 1"), "5", "lumens");
}

TEST(ReadIes, RefusesAFileThatIsNotThere) { EXPECT_THROW(read_ies("/nowhere/lamp.ies"), InputError); }

}  // namespace
}  // namespace patchlight::read_ies_test
