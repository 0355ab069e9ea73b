#include "light/texture.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <tuple>
#include <vector>

namespace patchlight::texture_test {
namespace {

using Places = std::vector<Eigen::Vector2d>;

// Sums of a few thousand numbers of at most 1, over areas of a hundredth.
constexpr double rounding = 1e-11;

Texture coloured(std::uint32_t width, std::uint32_t height) {
  Texture texture{width, height, {}};
  // Numbers of [0, 1) without a pattern.
  std::uint32_t state = 1;
  const auto next = [&state] {
    state = state * 1664525U + 1013904223U;
    return static_cast<float>(state >> 8U) * 0x1p-24F;
  };
  for (std::uint32_t k = 0; k < width * height; ++k) texture.texels.push_back({next(), next(), next()});
  return texture;
}

TexturedReflectance textured(Texture texture, Wrap wrap = Wrap::repeat) {
  return {
      std::make_shared<const Texture>(std::move(texture)), {rgb(1, 0, 0), rgb(0, 1, 0), rgb(0, 0, 1)}, {wrap, wrap}};
}

Places rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

// The part of a polygon with normal . x <= limit: Sutherland and Hodgman 1974.
Places clipped(const Places& polygon, const Eigen::Vector2d& normal, double limit) {
  Places part;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d& a = polygon[k];
    const Eigen::Vector2d& b = polygon[(k + 1) % polygon.size()];
    const double above_a = normal.dot(a) - limit;
    const double above_b = normal.dot(b) - limit;
    if (above_a <= 0) part.push_back(a);
    if ((above_a < 0 && above_b > 0) || (above_a > 0 && above_b < 0))
      part.push_back(a + (b - a) * (above_a / (above_a - above_b)));
  }
  return part;
}

double area_of(const Places& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d& a = polygon[k];
    const Eigen::Vector2d& b = polygon[(k + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

// Brute force: a convex polygon is cut at every line of texels.
Rgb mean_by_clipping(const TexturedReflectance& surface, const Places& polygon) {
  const Texture& texture = *surface.texture;
  Rgb sum{};
  for (int row = -3 * static_cast<int>(texture.height); row < 4 * static_cast<int>(texture.height); ++row) {
    const Places strip =
        clipped(clipped(polygon, {0, -1}, -row / double(texture.height)), {0, 1}, (row + 1) / double(texture.height));
    if (strip.size() < 3) continue;
    for (int column = -3 * static_cast<int>(texture.width); column < 4 * static_cast<int>(texture.width); ++column) {
      const Places part = clipped(clipped(strip, {-1, 0}, -column / double(texture.width)), {1, 0},
                                  (column + 1) / double(texture.width));
      if (part.size() < 3) continue;
      const Spectrum here =
          reflectance_at(surface, {(column + 0.5) / double(texture.width), (row + 0.5) / double(texture.height)});
      for (int k = 0; k < 3; ++k) sum[static_cast<std::size_t>(k)] += area_of(part) / area_of(polygon) * here[k];
    }
  }
  return sum;
}

void expect_same(const Rgb& found, const Rgb& expected, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], tolerance) << "channel " << k;
}

class AMeanOver : public testing::TestWithParam<std::tuple<Wrap, double>> {
 protected:
  // A rotated quadrilateral that reaches beyond the edges of the texture.
  static Places turned_quadrilateral() {
    const double angle = std::get<1>(GetParam()) * std::numbers::pi / 180;
    Places places;
    for (const Eigen::Vector2d& at : Places{{-0.7, -0.4}, {0.9, -0.6}, {1.1, 0.8}, {-0.5, 0.5}})
      places.emplace_back(0.4 + std::cos(angle) * at.x() - std::sin(angle) * at.y(),
                          0.3 + std::sin(angle) * at.x() + std::cos(angle) * at.y());
    return places;
  }
};

TEST_P(AMeanOver, APolygonIsThatOfItsPartsInTexels) {
  const TexturedReflectance surface = textured(coloured(7, 5), std::get<0>(GetParam()));
  const Places places = turned_quadrilateral();
  expect_same(TextureMeans(surface).over(places), mean_by_clipping(surface, places), rounding);
}

TEST_P(AMeanOver, APolygonDoesNotDependOnTheSenseOfItsCorners) {
  const TextureMeans means(textured(coloured(7, 5), std::get<0>(GetParam())));
  Places places = turned_quadrilateral();
  const Rgb one = means.over(places);
  std::reverse(places.begin(), places.end());
  expect_same(means.over(places), one, rounding);
}

// Additivity: the mean over a polygon is the area-weighted mean over its two parts.
TEST_P(AMeanOver, APolygonIsThatOfItsTriangles) {
  const TextureMeans means(textured(coloured(64, 33), std::get<0>(GetParam())));
  const Places places = turned_quadrilateral();
  const Places one = {places[0], places[1], places[2]};
  const Places other = {places[0], places[2], places[3]};
  const double share = area_of(one) / area_of(places);
  Rgb sum{};
  for (std::size_t k = 0; k < 3; ++k) sum[k] = share * means.over(one)[k] + (1 - share) * means.over(other)[k];
  expect_same(means.over(places), sum, rounding);
}

INSTANTIATE_TEST_SUITE_P(Texture, AMeanOver,
                         testing::Combine(testing::Values(Wrap::repeat, Wrap::mirror, Wrap::clamp),
                                          testing::Values(0.0, 33.0, 90.0, 180.0, 251.0)));

TEST(Texture, HasItsMeanOverWholePicturesWhereverTheyBegin) {
  const Texture texture = coloured(16, 9);
  const TextureMeans means(textured(texture));
  for (const double shift : {0.0, 0.37, -5.25, 1000.5})
    expect_same(means.over(rectangle(shift, -shift, shift + 1, 2 - shift)), mean_colour(texture), 1e-9);
}

TEST(Texture, OfTwoHalvesHasTheColourOfEach) {
  // Left red, right white.
  const TextureMeans means(textured({2, 1, {{1, 0, 0}, {1, 1, 1}}}));
  expect_same(means.over(rectangle(0.1, 0.2, 0.5, 0.9)), {1, 0, 0}, rounding);
  expect_same(means.over(rectangle(0.5, 0.2, 0.75, 0.3)), {1, 1, 1}, rounding);
  expect_same(means.over(rectangle(0.25, 0, 0.75, 1)), {1, 0.5, 0.5}, rounding);
}

TEST(Texture, BeyondItsEdgesIsRepeatedMirroredOrGoesOn) {
  const Texture halves{2, 1, {{1, 0, 0}, {1, 1, 1}}};
  const Places right_of_it = rectangle(1, 0, 1.5, 1);
  expect_same(TextureMeans(textured(halves, Wrap::repeat)).over(right_of_it), {1, 0, 0}, rounding);
  expect_same(TextureMeans(textured(halves, Wrap::mirror)).over(right_of_it), {1, 1, 1}, rounding);
  expect_same(TextureMeans(textured(halves, Wrap::clamp)).over(rectangle(7, -3, 9, 5)), {1, 1, 1}, rounding);
  expect_same(TextureMeans(textured(halves, Wrap::clamp)).over(rectangle(-7, -3, -2, 5)), {1, 0, 0}, rounding);
}

TEST(Texture, OverNoAreaIsThatOfItsPlaceAndOverVeryManyTexelsThatOfThePicture) {
  const Texture texture = coloured(8, 8);
  const TextureMeans means(textured(texture));
  const auto& texel = texture.texels[3 * 8 + 2];
  expect_same(means.over(Places(3, Eigen::Vector2d(2.5 / 8, 3.5 / 8))), {texel[0], texel[1], texel[2]}, 0);
  expect_same(means.over(rectangle(0, 0, 1e9, 1e9)), mean_colour(texture), 0);
}

TEST(Texture, SaysHowFarItsTexelsDiffer) {
  const TexturedReflectance halves = textured({2, 1, {{0.5F, 0.25F, 0.75F}, {0.5F, 0.75F, 0.75F}}});
  const TextureRange range = range_of(halves);
  EXPECT_EQ(range.highest_reflectance, 0.75);
  EXPECT_FALSE(range.grey);
  EXPECT_NEAR(range.deviation, 0.5, rounding);  // 0.5 +- 0.25 in green
}

}  // namespace
}  // namespace patchlight::texture_test
