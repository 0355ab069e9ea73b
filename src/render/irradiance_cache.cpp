#include "render/irradiance_cache.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// Records serve at normals up to this angle from theirs, and up to this share of their radius before or behind their
// plane: a table's top has nothing to tell of its lower side, nor of the floor.
constexpr double widest_turn = 0.985;   // cosine of 10 degrees
constexpr double widest_offset = 0.15;  // 10 degrees over the radius of curved surfaces

// How fast radii may grow with the distance from a record.
constexpr double growth_of_radius = 0.4;

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Point& point, double cells_per_metre) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(point[axis] * cells_per_metre));
  return cell;
}

// Cells that share a key are looked at together, which costs time alone.
std::uint64_t key_of(const Cell& cell, int level) {
  std::uint64_t key = static_cast<std::uint64_t>(level) + 1024;
  for (const std::int64_t c : cell) {
    key = (key ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15U;
    key ^= key >> 29;
  }
  return key;
}

}  // namespace

double IrradianceCache::weight_of(const Reach& record, const Point& point, const Vector& normal) {
  const Vector way = point - record.point;
  const double square = way.squaredNorm();
  if (!(square < record.radius * record.radius)) return 0;
  const double cosine = normal.dot(record.normal);
  if (!(cosine > widest_turn)) return 0;
  if (std::abs(record.normal.dot(way)) > widest_offset * record.radius) return 0;
  const double turn = std::sqrt(std::max(0.0, 1 - cosine) / (1 - widest_turn));
  return 1 - std::max(std::sqrt(square) / record.radius, turn);
}

template <typename See>
void IrradianceCache::for_each_around(const Point& point, const Vector& normal, const See& see) const {
  for (const Level& level : levels_) {
    const auto cell = cells_.find(key_of(cell_of(point, level.cells_per_metre), level.log2_of_edge));
    if (cell == cells_.end()) continue;
    for (const std::uint32_t index : cell->second) {
      const double weight = weight_of(reaches_[index], point, normal);
      if (weight > 0) see(index, weight);
    }
  }
}

std::vector<IrradianceCache::Weighted> IrradianceCache::around(const Point& point, const Vector& normal) const {
  std::vector<Weighted> found;
  for_each_around(point, normal, [&](std::uint32_t index, double weight) { found.push_back({index, weight}); });
  return found;
}

IrradianceCache::IrradianceCache(Eigen::VectorXd luminous_weights) : luminous_weights_(std::move(luminous_weights)) {}

// Cells at least as wide as the ball of the record: it meets eight of them at most.
IrradianceCache::Level IrradianceCache::level_for(double radius) {
  const int log2_of_edge = static_cast<int>(std::ceil(std::log2(2 * radius)));
  const auto has_it = [&](const Level& level) { return level.log2_of_edge == log2_of_edge; };
  const auto known = std::find_if(levels_.begin(), levels_.end(), has_it);
  if (known != levels_.end()) return *known;
  levels_.push_back({log2_of_edge, std::ldexp(1.0, -log2_of_edge)});
  return levels_.back();
}

void IrradianceCache::add(const IrradianceRecord& record) {
  assert(record.irradiance.size() == luminous_weights_.size() && record.gradient.cols() == record.irradiance.size());
  const Level level = level_for(record.radius);
  const auto index = static_cast<std::uint32_t>(reaches_.size());
  reaches_.push_back({record.point, record.normal, record.radius, record.uncertainty});
  for (Eigen::Index band = 0; band < record.irradiance.size(); ++band) {
    values_.push_back(record.irradiance[band]);
    for (Eigen::Index axis = 0; axis < 3; ++axis) values_.push_back(record.gradient(axis, band));
  }
  const Vector reach = Vector::Constant(record.radius);
  const Cell lower = cell_of(record.point - reach, level.cells_per_metre);
  const Cell upper = cell_of(record.point + reach, level.cells_per_metre);
  for (std::int64_t x = lower[0]; x <= upper[0]; ++x)
    for (std::int64_t y = lower[1]; y <= upper[1]; ++y)
      for (std::int64_t z = lower[2]; z <= upper[2]; ++z)
        cells_[key_of({x, y, z}, level.log2_of_edge)].push_back(index);
}

void IrradianceCache::add_graded(const std::vector<IrradianceRecord>& records) {
  const std::size_t before = reaches_.size();
  for (const IrradianceRecord& record : records) add(record);
  // Cells keep records whose radius shrinks, which no longer serve there.
  for (std::size_t k = before; k < reaches_.size(); ++k) {
    Reach& record = reaches_[k];
    for (const Weighted& one : around(record.point, record.normal)) {
      Reach& other = reaches_[one.index];
      const double distance = (other.point - record.point).norm();
      other.radius = std::min(other.radius, record.radius + growth_of_radius * distance);
      record.radius = std::min(record.radius, other.radius + growth_of_radius * distance);
    }
  }
}

double IrradianceCache::weight_at(const Point& point, const Vector& normal) const {
  double sum = 0;
  for_each_around(point, normal, [&](std::uint32_t, double weight) { sum += weight; });
  return sum;
}

std::optional<CachedIrradiance> IrradianceCache::at(const Point& point, const Vector& normal) const {
  const Eigen::Index bands = luminous_weights_.size();
  CachedIrradiance found{Spectrum::Zero(bands), 0};
  double weights = 0, squares = 0, own = 0, first = 0, second = 0;
  for_each_around(point, normal, [&](std::uint32_t index, double weight) {
    // E_i + (x - x_i) . grad E_i
    const Reach& record = reaches_[index];
    const Vector way = point - record.point;
    const double* of_band = values_.data() + static_cast<std::size_t>(index) * static_cast<std::size_t>(4 * bands);
    double value = 0;
    for (Eigen::Index band = 0; band < bands; ++band, of_band += 4) {
      const double change = way.x() * of_band[1] + way.y() * of_band[2] + way.z() * of_band[3];
      const double predicted = std::max(0.0, of_band[0] + change);
      found.irradiance[band] += weight * predicted;
      value += predicted * luminous_weights_[band];
    }
    weights += weight;
    squares += weight * weight;
    own += weight * weight * record.uncertainty * record.uncertainty;
    first += weight * value;
    second += weight * value * value;
  });
  if (weights == 0) return std::nullopt;
  // By what records differ, with as many degrees of freedom as records of equal weight would have.
  const double mean = first / weights;
  const double scatter = std::max(0.0, second / weights - mean * mean);
  const double freedom = std::max(0.5, weights * weights / squares - 1);
  const double variance = own / (weights * weights) + scatter / freedom;
  found.irradiance /= weights;
  found.deviation = std::sqrt(variance);
  return found;
}

}  // namespace patchlight
