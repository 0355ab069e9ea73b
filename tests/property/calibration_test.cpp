// The differences of halves have the size of the true errors of sampled exchange areas.
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::calibration_test {
namespace {

using namespace test;

// A room with rows of boxes, in which many pairs are partly hidden from each other.
Scene cluttered_room() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (int k = 0; k < 6; ++k) {
    const Point corner(0.4 + 0.6 * k, 0.5 + 0.3 * (k % 3), 0.2);
    scene = with_box(std::move(scene), corner, corner + Vector(0.3, 1.1, 1.3), false);
  }
  return scene;
}

// Compares pairs with a reference of 25 times the samples, over several seeds.
class Calibration : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Scene scene = cluttered_room();
    const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.4);
    const Occluder occluder(scene);
    shapes = patch_shapes(mesh);
    for (std::uint64_t seed = 1; seed <= 8; ++seed)
      assemblies.push_back(assemble_exchange_areas(mesh, occluder, {8, seed, true}));
    reference.push_back(assemble_exchange_areas(mesh, occluder, {200, 77, true}));
    another.push_back(assemble_exchange_areas(mesh, occluder, {32, 78}));
  }
  static void TearDownTestSuite() {
    assemblies.clear();
    reference.clear();
    another.clear();
  }

  static double error(const Assembly& assembly, PatchIndex i, PatchIndex j) {
    return static_cast<double>(assembly.exchange_areas.at(i, j)) -
           static_cast<double>(reference[0].exchange_areas.at(i, j));
  }
  // The variance of error(), as both are independent.
  static double variance(const Assembly& assembly, PatchIndex i, PatchIndex j) {
    const double of_reference = reference[0].half_differences.at(i, j);
    const double difference = assembly.half_differences.at(i, j);
    return difference * difference + of_reference * of_reference;
  }
  // By other rays, so that the choice of pairs does not depend on their errors.
  static double visible_share(PatchIndex i, PatchIndex j) {
    const double U = unoccluded_exchange_area(shapes[i], shapes[j]);
    return U > 0 ? static_cast<double>(another[0].exchange_areas.at(i, j)) / U : 0;
  }
  static void for_pairs(const std::function<void(PatchIndex i, PatchIndex j)>& use) {
    for (PatchIndex j = 0; j < shapes.size(); ++j)
      for (PatchIndex i = 0; i < j; ++i) use(i, j);
  }
  static inline std::vector<PatchShape> shapes;
  static inline std::vector<Assembly> assemblies;
  static inline std::vector<Assembly> reference;
  static inline std::vector<Assembly> another;
};

// The mean square of differences is no less than that of errors: the second half of the samples fills the gaps of the
// first. It is no more than twice as large: this bound is measured, not derived. Both hold, too, for pairs that are
// nearly hidden or nearly visible, most of which have rays that agree. Pairs are independent, so the sum of e^2 - D^2
// over the pairs has the variance sum (e^2 - D^2)^2: four standard errors.
TEST_F(Calibration, SquaresOfDifferencesAreThoseOfErrorsOrALittleMore) {
  const std::vector<std::pair<double, double>> ranges{{0, 2}, {0, 0.1}, {0.1, 0.9}, {0.9, 2}};
  for (const auto& [lowest, highest] : ranges) {
    double errors = 0;
    double differences = 0;
    double square = 0;
    for_pairs([&, lowest = lowest, highest = highest](PatchIndex i, PatchIndex j) {
      const double share = visible_share(i, j);
      if (share < lowest || share >= highest) return;
      double of_errors = 0;
      double of_differences = 0;
      for (const Assembly& assembly : assemblies) {
        of_errors += std::pow(error(assembly, i, j), 2);
        of_differences += variance(assembly, i, j);
      }
      errors += of_errors;
      differences += of_differences;
      square += std::pow(of_errors - of_differences, 2);
    });
    const double standard_error = std::sqrt(square) / differences;
    EXPECT_LT(errors / differences, 1 + 4 * standard_error) << lowest << " to " << highest;
    EXPECT_GT(errors / differences, 0.5 - 4 * standard_error) << lowest << " to " << highest;
    EXPECT_LT(standard_error, 0.1) << "an interval that is always large is none";
  }
}

// Neither errors nor differences have a common sign: over all pairs they cancel in the sum as independent ones do. The
// unit is m^2, of the exchange in the whole room.
TEST_F(Calibration, ErrorsAndDifferencesCancelInTheSum) {
  for (const Assembly& assembly : assemblies) {
    double errors = 0;
    double differences = 0;
    double variances = 0;
    double squares = 0;
    for_pairs([&](PatchIndex i, PatchIndex j) {
      const double difference = assembly.half_differences.at(i, j);
      errors += error(assembly, i, j);
      variances += variance(assembly, i, j);
      differences += difference;
      squares += difference * difference;
    });
    EXPECT_LT(std::abs(errors), 3 * std::sqrt(variances));
    EXPECT_LT(std::abs(differences), 3 * std::sqrt(squares));
  }
}

}  // namespace
}  // namespace patchlight::calibration_test
