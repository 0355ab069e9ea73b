#include "patchlight/gather/gather.h"

#include "form_factor/point_polygon.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

// A room of 4 x 2 x 2 m with a wall across its middle, x = 0. Surfaces behind the wall have a radiosity of 1, all
// others 0. Every ray through an opening meets light. So the irradiance of a sensor before the wall is the form factor
// of the wall's openings, in closed form.

namespace patchlight::openings_test {
namespace {

using namespace test;

// A wall, seen from x > 0, and its openings.
struct Wall {
  std::vector<Quad> parts;
  std::vector<Quad> openings;
};

Quad upright(double y0, double y1, double z0, double z1) {
  return {Point(0, y0, z0), Point(0, y1, z0), Point(0, y1, z1), Point(0, y0, z1)};
}

// Horizontal slits, one in the middle of each of `count` strips.
Wall slits(int count, double open) {
  Wall wall;
  const double strip = 2.0 / count;
  const double slit = open * strip;
  double below = 0;
  for (int k = 0; k < count; ++k) {
    const double z = k * strip + (strip - slit) / 2;
    wall.parts.push_back(upright(-1, 1, below, z));
    wall.openings.push_back(upright(-1, 1, z, z + slit));
    below = z + slit;
  }
  wall.parts.push_back(upright(-1, 1, below, 2));
  return wall;
}

// A square hole in the middle of each of count x count squares.
Wall perforated(int count, double open) {
  Wall wall;
  const double pitch = 2.0 / count;
  const double edge = (1 - std::sqrt(open)) * pitch / 2;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double y = -1 + i * pitch, z = j * pitch, y1 = y + pitch, z1 = z + pitch;
      wall.parts.push_back(upright(y, y1, z, z + edge));
      wall.parts.push_back(upright(y, y1, z1 - edge, z1));
      wall.parts.push_back(upright(y, y + edge, z + edge, z1 - edge));
      wall.parts.push_back(upright(y1 - edge, y1, z + edge, z1 - edge));
      wall.openings.push_back(upright(y + edge, y1 - edge, z + edge, z1 - edge));
    }
  }
  return wall;
}

// Sensors before the wall that face it, face up, or face obliquely.
std::vector<Sensor> sensors_before_wall() {
  return {{Point(1, 0.1, 0.9), -Vector::UnitX()},
          {Point(0.4, -0.3, 0.2), Vector::UnitZ()},
          {Point(1.7, 0.5, 1.3), Vector(-1, 0.4, -0.3).normalized()}};
}

struct Case {
  const char* name;
  Wall wall;
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
};

Eigen::Affine3d turned(double scale) {
  return Eigen::Scaling(scale) * Eigen::AngleAxisd(0.7, Vector(1, 2, -0.5).normalized()) *
         Eigen::Translation3d(0.3, -2, 1);
}

std::vector<Case> cases() {
  return {{"20 slits, 2 %", slits(20, 0.02)},
          {"20 slits, 10 %", slits(20, 0.1)},
          {"railing, 98 %", slits(20, 0.98)},
          {"perforated, 2 %", perforated(10, 0.02)},
          {"perforated, 10 %", perforated(10, 0.1)},
          {"perforated, 98 %", perforated(10, 0.98)},
          {"20 slits, 2 %, turned", slits(20, 0.02), turned(1)},
          {"perforated, 10 %, turned, a thousandth as large", perforated(10, 0.1), turned(1e-3)}};
}

// The room with that wall, after a motion, and its light.
struct Lit {
  Scene scene;
  PatchMesh mesh;
  Field radiosity;
  std::vector<Sensor> sensors;
  std::vector<double> exact;  // irradiance of each sensor
};

// The radiosity has a step at the wall, so the patches have constant radiosity here (GatherOptions::slopes).
Lit lit_by(const Case& c) {
  Lit lit;
  lit.scene = with_box(empty_scene({grey(0), grey(0)}), Point(-2, -1, 0), Point(2, 1, 2), true);
  for (const Quad& part : c.wall.parts) lit.scene = with_quad(std::move(lit.scene), part, 1);
  lit.scene = moved(std::move(lit.scene), c.motion);
  const double scale = c.motion.linear().col(0).norm();
  lit.mesh = tessellate(lit.scene, kept_sides(lit.scene, Sides::front), 0.25 * scale);
  lit.radiosity = Field::Zero(lit.mesh.size(), 1);
  for (PatchIndex i = 0; i < lit.mesh.size(); ++i) {
    const double x = (c.motion.inverse() * lit.mesh.centroid[i]).x();
    lit.radiosity(i, 0) = lit.mesh.material[i] == 0 && x < 0 ? 1 : 0;
  }
  for (const auto& [point, normal] : sensors_before_wall()) {
    double sum = 0;
    for (const Quad& opening : c.wall.openings) sum += point_to_polygon(point, normal, opening);
    lit.exact.push_back(sum);
    lit.sensors.push_back({c.motion * point, (c.motion.linear() * normal).normalized()});
  }
  return lit;
}

TEST(GatherIrradiance, ThroughNarrowOpeningsIsTheirFormFactor) {
  for (const Case& c : cases()) {
    const Lit lit = lit_by(c);
    const Occluder occluder(lit.scene, Occluder::Blockers::all);
    const GatheredIrradiance found =
        gather_irradiance(lit.mesh, lit.radiosity, occluder, lit.sensors, {.seed = 3, .slopes = false});
    for (std::size_t k = 0; k < lit.sensors.size(); ++k) {
      const double E = found.irradiance(static_cast<Eigen::Index>(k), 0);
      // One of 24 sensors would exceed three standard errors in one of fifteen runs. The seed is fixed.
      EXPECT_NEAR(E, lit.exact[k], 3 * found.errors.rays(static_cast<Eigen::Index>(k), 0)) << c.name << ' ' << k;
      EXPECT_NEAR(E, lit.exact[k], 0.05 * lit.exact[k]) << c.name << ' ' << k;
    }
  }
}

// One in ten thousand rays gets through, so every second sensor sees nothing by its first rays. It then gets thirty
// times as many rays, of which about ten get through.
TEST(GatherIrradiance, ThatSeesNothingAtFirstTakesMoreRays) {
  for (const Case& c :
       {Case{"holes", perforated(10, 1e-4)}, {"holes, turned, in mm", perforated(10, 1e-4), turned(1e3)}}) {
    const Lit lit = lit_by(c);
    const Occluder occluder(lit.scene, Occluder::Blockers::all);
    double sum = 0, variance = 0, count = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const GatheredIrradiance found =
          gather_irradiance(lit.mesh, lit.radiosity, occluder, lit.sensors, {.seed = seed, .slopes = false});
      for (std::size_t k = 0; k < lit.sensors.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        EXPECT_GT(found.irradiance(row, 0), 0) << c.name << ", seed " << seed << ", sensor " << k;
        sum += found.irradiance(row, 0) / lit.exact[k];
        variance += std::pow(found.errors.rays(row, 0) / lit.exact[k], 2);
        ++count;
      }
    }
    // About a hundred rays in all get through.
    EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(variance) / count) << c.name;
  }
}

// Over many seeds the errors have no common sign and the stated size. For n errors, their mean over the standard error
// is 0 +- 1 / sqrt(n), and the root mean square is 1 +- 1 / sqrt(2 n).
TEST(GatherIrradiance, ThroughNarrowOpeningsErrsAsItStates) {
  for (const Case& c : cases()) {
    const Lit lit = lit_by(c);
    const Occluder occluder(lit.scene, Occluder::Blockers::all);
    double sum = 0, errors = 0, variances = 0;
    constexpr std::uint64_t seeds = 10;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const GatherOptions options{.wanted_error = 0.05, .seed = seed, .slopes = false};
      const GatheredIrradiance found = gather_irradiance(lit.mesh, lit.radiosity, occluder, lit.sensors, options);
      for (std::size_t k = 0; k < lit.sensors.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const double relative = found.irradiance(row, 0) / lit.exact[k] - 1;
        sum += relative * lit.exact[k] / found.errors.rays(row, 0);
        errors += relative * relative;
        variances += std::pow(found.errors.rays(row, 0) / lit.exact[k], 2);
      }
    }
    const double n = seeds * static_cast<double>(lit.sensors.size());
    EXPECT_LT(std::abs(sum / n), 3 / std::sqrt(n)) << c.name;
    EXPECT_GT(std::sqrt(errors / variances), 0.7) << c.name;
    EXPECT_LT(std::sqrt(errors / variances), 1.3) << c.name;
  }
}

}  // namespace
}  // namespace patchlight::openings_test
