#include "form_factor/pair_samples.h"

#include "base/sampling.h"
#include "base/target_clones.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace patchlight {

// At most 256 scrambles, and so many that the table stays below 150 MB.
SampleTable::SampleTable(std::uint32_t samples, std::uint64_t seed)
    : samples_(samples), scrambles_(std::clamp((1U << 22) / samples, 16U, 256U)), seed_(seed) {
  assert(samples > 0);
  table_.resize(std::size_t{scrambles_} * 4 * samples);
  for (std::uint32_t scramble = 0; scramble < scrambles_; ++scramble) {
    const auto points = scrambled_sobol(samples, hash({seed, scramble}));
    std::uint32_t* const rows = table_.data() + std::size_t{scramble} * 4 * samples;
    for (std::size_t k = 0; k < samples; ++k)
      for (std::size_t d = 0; d < 4; ++d) rows[d * samples + k] = static_cast<std::uint32_t>(points[k][d] * 0x1p32);
  }
}

SampleSet SampleTable::of_pair(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t replicate) const {
  const std::uint32_t key = hash(first_key ^ hash(second_key ^ hash(static_cast<std::uint32_t>(seed_))));
  const std::uint32_t scramble = (key % scrambles_ + replicate) % scrambles_;
  SampleSet set{table_.data() + std::size_t{scramble} * 4 * samples_, samples_, {}};
  std::uint32_t state = hash(key + replicate);
  for (std::uint32_t& shift : set.shift) shift = state = hash(state + 0x9e3779b9U);
  return set;
}

double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y) {
  // G = (n_x . d)(-n_y . d) / (pi |d|^4), d = y - x
  const Vector d = y - x;
  const double cosine_x = normal_x.dot(d);
  const double cosine_y = -normal_y.dot(d);
  const double squared = d.squaredNorm();
  if (!(cosine_x > 0 && cosine_y > 0)) return 0;
  return cosine_x * cosine_y / (std::numbers::pi * squared * squared);
}

namespace {

std::array<float, 3> narrow(const Vector& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// The corners moved toward the centroid until the border lies 5e-7 of the scene's extent inside, at most 1e-3 of the
// way. A ray in single precision that starts within about 3e-7 of a wall may pass it, where the patch ends at the foot
// of the wall (Occluder).
std::array<Point, 4> inner_corners(const PatchShape& shape, double scale) {
  const auto& [points, count] = shape.corners;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < static_cast<int>(count); ++k) {
    const Vector edge = points[(k + 1) % count] - points[k];
    if (edge.norm() > 0) nearest = std::min(nearest, edge.cross(shape.centroid - points[k]).norm() / edge.norm());
  }
  const double share = std::min(1e-3, 5e-7 / (scale * nearest));
  std::array<Point, 4> inner = points;
  for (Point& point : inner) point += share * (shape.centroid - point);
  return inner;
}

// Where samples lie on a patch: coordinates d and d + 1 of the set, for triangles made barycentric
// (square_to_triangle()).
template <std::size_t count>
PATCHLIGHT_INLINE std::array<std::array<float, count>, 2> place(bool is_triangle, const SampleSet& set, std::size_t d,
                                                                std::size_t first) {
  std::array<std::array<float, count>, 2> at;
  for (std::size_t c = 0; c < 2; ++c) {
    const std::uint32_t* const net = set.net + (d + c) * set.stride + first;
    for (std::size_t k = 0; k < count; ++k) at[c][k] = shifted(net[k], set.shift[d + c]);
  }
  if (!is_triangle) return at;
  for (std::size_t k = 0; k < count; ++k) {
    const float root = std::sqrt(at[0][k]);
    at[0][k] = root - root * at[1][k];
    at[1][k] = root * at[1][k];
  }
  return at;
}

// Loops over `count` lanes, which is known to the compiler, so that they become vector instructions.
template <std::size_t count>
PATCHLIGHT_INLINE void fill(PairSamples& samples, std::ptrdiff_t lane, const SampledPatch& from, const SampledPatch& to,
                            const SampleSet& set, std::size_t first, float factor) {
  const auto [u, v] = place<count>(from.is_triangle, set, 0, first);
  const auto [s, t] = place<count>(to.is_triangle, set, 2, first);
  std::array<std::array<float, count>, 3> x;
  std::array<std::array<float, count>, 3> toward;
  std::array<float, count> squared{};
  std::array<float, count> cosine{};
  std::array<float, count> other{};
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t k = 0; k < count; ++k) {
      x[d][k] = from.origin[d] + u[k] * from.along_u[d] + v[k] * (from.along_v[d] + u[k] * from.twist[d]);
      const float y = to.origin[d] + s[k] * to.along_u[d] + t[k] * (to.along_v[d] + s[k] * to.twist[d]);
      toward[d][k] = y - x[d][k];
      squared[k] += toward[d][k] * toward[d][k];
      cosine[k] += toward[d][k] * from.normal[d];
      other[k] -= toward[d][k] * to.normal[d];
    }
  }
  std::array<float, count> weight;
  for (std::size_t k = 0; k < count; ++k) {
    const float density = (from.density[0] + u[k] * from.density[1] + v[k] * from.density[2]) *
                          (to.density[0] + s[k] * to.density[1] + t[k] * to.density[2]);
    weight[k] = factor * density * std::max(0.0F, cosine[k]) * std::max(0.0F, other[k]) / (squared[k] * squared[k]);
  }
  ShadowPacket& rays = samples.rays;
  std::copy(x[0].begin(), x[0].end(), rays.from_x.begin() + lane);
  std::copy(x[1].begin(), x[1].end(), rays.from_y.begin() + lane);
  std::copy(x[2].begin(), x[2].end(), rays.from_z.begin() + lane);
  std::copy(toward[0].begin(), toward[0].end(), rays.toward_x.begin() + lane);
  std::copy(toward[1].begin(), toward[1].end(), rays.toward_y.begin() + lane);
  std::copy(toward[2].begin(), toward[2].end(), rays.toward_z.begin() + lane);
  std::copy(weight.begin(), weight.end(), samples.weight.begin() + lane);
  std::fill_n(rays.from_polygon.begin() + lane, count, from.polygon);
  std::fill_n(rays.to_polygon.begin() + lane, count, to.polygon);
}

}  // namespace

SampledPatch sampled_patch(const PatchShape& shape, PolygonIndex polygon, const TracingFrame& frame) {
  SampledPatch patch;
  const std::array<Point, 4> p = inner_corners(shape, frame.scale);
  patch.is_triangle = shape.corners.count == 3;
  const Vector along_u = p[1] - p[0];
  const Vector along_v = p[patch.is_triangle ? 2 : 3] - p[0];
  const Vector twist = patch.is_triangle ? Vector(Vector::Zero()) : Vector(p[2] - p[1] - p[3] + p[0]);
  patch.origin = narrow(frame.scale * (p[0] - frame.centre));
  patch.along_u = narrow(frame.scale * along_u);
  patch.along_v = narrow(frame.scale * along_v);
  patch.twist = narrow(frame.scale * twist);
  patch.normal = narrow(shape.normal);
  patch.density = {1, 0, 0};
  if (!patch.is_triangle) {
    // |dx/du x dx/dv| over the area, linear in u and v for a planar quadrilateral.
    const Vector jacobian(along_u.cross(along_v).dot(shape.normal), along_u.cross(twist).dot(shape.normal),
                          twist.cross(along_v).dot(shape.normal));
    patch.density = narrow(jacobian / (jacobian[0] + (jacobian[1] + jacobian[2]) / 2));
  }
  patch.polygon = polygon;
  return patch;
}

PATCHLIGHT_TARGET_CLONES
void add_samples(PairSamples& samples, int lane, int count, const SampledPatch& from, const SampledPatch& to,
                 const SampleSet& set, std::uint32_t first, double scale) {
  assert(lane + count <= static_cast<int>(ShadowPacket::size));
  const auto factor = static_cast<float>(scale * scale / std::numbers::pi);
  const std::ptrdiff_t at = lane;
  switch (count) {
    case 2:
      return fill<2>(samples, at, from, to, set, first, factor);
    case 4:
      return fill<4>(samples, at, from, to, set, first, factor);
    case 8:
      return fill<8>(samples, at, from, to, set, first, factor);
    default:
      return fill<16>(samples, at, from, to, set, first, factor);
  }
}

}  // namespace patchlight
