#include "render/irradiance_cache.h"

#include <algorithm>
#include <array>
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

Cell cell_of(const Point& point, int level) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(std::ldexp(point[axis], -level)));
  return cell;
}

// Cells that share a key are looked at together, which costs time alone.
std::uint64_t key_of(const Cell& cell, int level) {
  std::uint64_t key = static_cast<std::uint64_t>(level + 1024);
  for (const std::int64_t c : cell) {
    key = (key ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15U;
    key ^= key >> 29;
  }
  return key;
}

double weight_of(const IrradianceRecord& record, const Point& point, const Vector& normal) {
  const Vector way = point - record.point;
  const double square = way.squaredNorm();
  if (!(square < record.radius * record.radius)) return 0;
  const double cosine = normal.dot(record.normal);
  if (!(cosine > widest_turn)) return 0;
  if (std::abs(record.normal.dot(way)) > widest_offset * record.radius) return 0;
  const double turn = std::sqrt(std::max(0.0, 1 - cosine) / (1 - widest_turn));
  return 1 - std::max(std::sqrt(square) / record.radius, turn);
}

}  // namespace

IrradianceCache::IrradianceCache(Eigen::VectorXd luminous_weights) : luminous_weights_(std::move(luminous_weights)) {}

void IrradianceCache::add(const IrradianceRecord& record) {
  // Cells at least as wide as the ball of the record: it meets eight of them at most.
  const int level = static_cast<int>(std::ceil(std::log2(2 * record.radius)));
  if (std::find(levels_.begin(), levels_.end(), level) == levels_.end()) levels_.push_back(level);
  const auto index = static_cast<std::uint32_t>(records_.size());
  records_.push_back(record);
  const Vector reach = Vector::Constant(record.radius);
  const Cell lower = cell_of(record.point - reach, level);
  const Cell upper = cell_of(record.point + reach, level);
  for (std::int64_t x = lower[0]; x <= upper[0]; ++x)
    for (std::int64_t y = lower[1]; y <= upper[1]; ++y)
      for (std::int64_t z = lower[2]; z <= upper[2]; ++z) cells_[key_of({x, y, z}, level)].push_back(index);
}

void IrradianceCache::add_graded(const std::vector<IrradianceRecord>& records) {
  const std::size_t before = records_.size();
  for (const IrradianceRecord& record : records) add(record);
  // Cells keep records whose radius shrinks, which no longer serve there.
  for (std::size_t k = before; k < records_.size(); ++k) {
    IrradianceRecord& record = records_[k];
    for (const Weighted& one : around(record.point, record.normal)) {
      IrradianceRecord& other = records_[one.index];
      const double distance = (other.point - record.point).norm();
      other.radius = std::min(other.radius, record.radius + growth_of_radius * distance);
      record.radius = std::min(record.radius, other.radius + growth_of_radius * distance);
    }
  }
}

std::vector<IrradianceCache::Weighted> IrradianceCache::around(const Point& point, const Vector& normal) const {
  std::vector<Weighted> found;
  for (const int level : levels_) {
    const auto cell = cells_.find(key_of(cell_of(point, level), level));
    if (cell == cells_.end()) continue;
    for (const std::uint32_t index : cell->second) {
      const double weight = weight_of(records_[index], point, normal);
      if (weight > 0) found.push_back({index, weight});
    }
  }
  return found;
}

double IrradianceCache::weight_at(const Point& point, const Vector& normal) const {
  double sum = 0;
  for (const Weighted& one : around(point, normal)) sum += one.weight;
  return sum;
}

std::optional<CachedIrradiance> IrradianceCache::at(const Point& point, const Vector& normal) const {
  const std::vector<Weighted> records = around(point, normal);
  if (records.empty()) return std::nullopt;
  const Eigen::Index bands = luminous_weights_.size();
  Spectrum sum = Spectrum::Zero(bands);
  double weights = 0, squares = 0, own = 0, first = 0, second = 0;
  for (const auto& [index, weight] : records) {
    // E_i + (x - x_i) . grad E_i
    const IrradianceRecord& record = records_[index];
    const Vector way = point - record.point;
    const Field& slope = record.gradient;
    Spectrum predicted = record.irradiance;
    predicted += way.x() * slope.row(0) + way.y() * slope.row(1) + way.z() * slope.row(2);
    predicted = predicted.max(0.0);
    sum += weight * predicted;
    const double value = (predicted.matrix() * luminous_weights_).value();
    weights += weight;
    squares += weight * weight;
    own += weight * weight * record.uncertainty * record.uncertainty;
    first += weight * value;
    second += weight * value * value;
  }
  // By what records differ, with as many degrees of freedom as records of equal weight would have.
  const double mean = first / weights;
  const double scatter = std::max(0.0, second / weights - mean * mean);
  const double freedom = std::max(0.5, weights * weights / squares - 1);
  const double variance = own / (weights * weights) + scatter / freedom;
  return CachedIrradiance{sum / weights, std::sqrt(variance)};
}

}  // namespace patchlight
