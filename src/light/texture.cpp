#include "light/texture.h"

#include "base/tolerances.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// The texel at a whole number of texels from the picture's edge.
std::size_t wrapped(double place, std::uint32_t count, Wrap wrap) {
  const double n = count;
  const double whole = std::floor(place);
  if (wrap == Wrap::clamp) return static_cast<std::size_t>(std::clamp(whole, 0.0, n - 1));
  if (wrap == Wrap::repeat) return static_cast<std::size_t>(std::min(whole - n * std::floor(whole / n), n - 1));
  const double turned = whole - 2 * n * std::floor(whole / (2 * n));
  return static_cast<std::size_t>(std::clamp(turned < n ? turned : 2 * n - 1 - turned, 0.0, n - 1));
}

Rgb colour_of(const std::array<float, 3>& texel) { return {texel[0], texel[1], texel[2]}; }

// At a place in texels.
Rgb colour_at(const TexturedReflectance& textured, double x, double y) {
  const Texture& texture = *textured.texture;
  const std::size_t column = wrapped(x, texture.width, textured.wrap[0]);
  const std::size_t row = wrapped(y, texture.height, textured.wrap[1]);
  return colour_of(texture.texels[row * texture.width + column]);
}

Rgb sum_of(const Rgb& a, const Rgb& b, double times) {
  return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]};
}

// Twice the area, positive where the corners run from u to v.
double twice_the_area(std::span<const Eigen::Vector2d> corners) {
  double sum = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d a = corners[k] - corners[0];
    const Eigen::Vector2d b = corners[(k + 1) % corners.size()] - corners[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

double length_around(std::span<const Eigen::Vector2d> corners) {
  double length = 0;
  for (std::size_t k = 0; k < corners.size(); ++k)
    length += (corners[(k + 1) % corners.size()] - corners[k]).lpNorm<1>();
  return length;
}

}  // namespace

Spectrum reflectance_of(const TexturedReflectance& textured, const Rgb& colour) {
  return colour[0] * textured.of_primaries[0] + colour[1] * textured.of_primaries[1] +
         colour[2] * textured.of_primaries[2];
}

Spectrum reflectance_at(const TexturedReflectance& textured, const Eigen::Vector2d& place) {
  const Texture& texture = *textured.texture;
  return reflectance_of(textured, colour_at(textured, place.x() * texture.width, place.y() * texture.height));
}

Rgb mean_colour(const Texture& texture) {
  Rgb sum{};
  for (const auto& texel : texture.texels) sum = sum_of(sum, colour_of(texel), 1);
  const auto count = static_cast<double>(texture.texels.size());
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

bool reflects_more_than_all(const TexturedReflectance& textured) {
  const auto is_more = [&](const std::array<float, 3>& texel) {
    return (reflectance_of(textured, colour_of(texel)) > 1 + tolerance_of_coordinates).any();
  };
  const auto& texels = textured.texture->texels;
  // The highest red, green and blue together reflect no less than any texel, and mostly that is little enough.
  std::array<float, 3> highest{};
  for (const auto& texel : texels)
    for (std::size_t k = 0; k < 3; ++k) highest[k] = std::max(highest[k], texel[k]);
  return is_more(highest) && std::any_of(texels.begin(), texels.end(), is_more);
}

TextureRange range_of(const TexturedReflectance& textured) {
  const Spectrum mean = reflectance_of(textured, mean_colour(*textured.texture));
  TextureRange range;
  Spectrum squares = Spectrum::Zero(mean.size());
  for (const auto& texel : textured.texture->texels) {
    const Spectrum here = reflectance_of(textured, colour_of(texel));
    range.highest_reflectance = std::max(range.highest_reflectance, here.maxCoeff());
    range.grey = range.grey && (here == here[0]).all();
    squares += (here - mean).square();
  }
  squares /= static_cast<double>(textured.texture->texels.size());
  for (Eigen::Index band = 0; band < mean.size(); ++band)
    if (mean[band] > 0) range.deviation = std::max(range.deviation, std::sqrt(squares[band]) / mean[band]);
  return range;
}

TextureMeans::TextureMeans(const TexturedReflectance& textured)
    : textured_(textured), mean_(mean_colour(*textured.texture)) {
  const Texture& texture = *textured.texture;
  sums_.reserve(std::size_t{texture.height} * (texture.width + 1));
  for (std::size_t row = 0; row < texture.height; ++row) {
    sums_.push_back({});
    for (std::size_t column = 0; column < texture.width; ++column)
      sums_.push_back(sum_of(sums_.back(), colour_of(texture.texels[row * texture.width + column]), 1));
  }
}

// The integral of the color along a row, from its edge to x texels.
Rgb TextureMeans::sum_to(double x, std::size_t row) const {
  const Texture& texture = *textured_.texture;
  const double width = texture.width;
  const Rgb* sums = &sums_[row * (texture.width + 1)];
  const Rgb& whole = sums[texture.width];
  const auto within = [&](double at) {
    const auto column = std::min(static_cast<std::size_t>(std::max(at, 0.0)), std::size_t{texture.width} - 1);
    const Rgb texel = colour_of(texture.texels[row * texture.width + column]);
    return sum_of(sums[column], texel, at - static_cast<double>(column));
  };
  // Beyond the edges the first and the last texel go on.
  if (textured_.wrap[0] == Wrap::clamp) return within(x);
  if (textured_.wrap[0] == Wrap::repeat) {
    const double times = std::floor(x / width);
    return sum_of(within(x - times * width), whole, times);
  }
  const double times = std::floor(x / (2 * width));
  const double rest = x - times * 2 * width;
  if (rest < width) return sum_of(within(rest), whole, 2 * times);
  return sum_of(sum_of({}, whole, 2 * times + 2), within(2 * width - rest), -1);
}

// The integral over y, from one end of an edge to the other, of that of the color along x from `base`. Between lines
// of texels the latter is linear in x, so its value in the middle is exact.
Rgb TextureMeans::outline_integral(const Eigen::Vector2d& begin, const Eigen::Vector2d& to, double base) const {
  Rgb sum{};
  const Eigen::Vector2d step = to - begin;
  if (step.y() == 0) return sum;
  Eigen::Vector2d next_line;  // whole numbers of texels
  for (int axis = 0; axis < 2; ++axis)
    next_line[axis] = step[axis] > 0 ? std::floor(begin[axis]) + 1 : std::ceil(begin[axis]) - 1;
  for (double at = 0; at < 1;) {
    double next = 1;
    Eigen::Vector2d crossing(2, 2);
    for (int axis = 0; axis < 2; ++axis) {
      if (step[axis] != 0) crossing[axis] = (next_line[axis] - begin[axis]) / step[axis];
      next = std::min(next, crossing[axis]);
    }
    const Eigen::Vector2d middle = begin + 0.5 * (at + next) * step;
    const std::size_t row = wrapped(middle.y(), textured_.texture->height, textured_.wrap[1]);
    const double height = (next - at) * step.y();
    sum = sum_of(sum, sum_to(middle.x(), row), height);
    sum = sum_of(sum, sum_to(base, row), -height);
    for (int axis = 0; axis < 2; ++axis)
      if (crossing[axis] <= next) next_line[axis] += step[axis] > 0 ? 1 : -1;
    at = next;
  }
  return sum;
}

// Green's theorem: over a polygon, the integral of f dx dy is that of F dy around it, dF/dx = f.
Rgb TextureMeans::over(std::span<const Eigen::Vector2d> corners) const {
  const Texture& texture = *textured_.texture;
  std::vector<Eigen::Vector2d> in_texels;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : corners) {
    in_texels.emplace_back(corner.x() * texture.width, corner.y() * texture.height);
    middle += in_texels.back() / static_cast<double>(corners.size());
  }
  const double around = length_around(in_texels);
  if (!(around <= 1e6) || !(middle.lpNorm<1>() <= 1e12)) return mean_;
  const double area = twice_the_area(in_texels) / 2;
  if (std::abs(area) <= tolerance_of_arithmetic * around * around || around < tolerance_of_coordinates)
    return colour_at(textured_, middle.x(), middle.y());
  double base = in_texels[0].x();
  for (const Eigen::Vector2d& corner : in_texels) base = std::min(base, std::floor(corner.x()));
  Rgb integral{};
  for (std::size_t k = 0; k < in_texels.size(); ++k)
    integral = sum_of(integral, outline_integral(in_texels[k], in_texels[(k + 1) % in_texels.size()], base), 1);
  // Rounding may lead beyond what texels can have.
  for (double& value : integral) value = std::clamp(value / area, 0.0, 1.0);
  return integral;
}

}  // namespace patchlight
