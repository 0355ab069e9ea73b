#include "lighting/sky_divisions.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::array<std::size_t, 7> tregenza_rows = {30, 30, 24, 24, 18, 12, 6};

}  // namespace

SkyDivisions::SkyDivisions(int factor, const Vector& up, const Vector& north)
    : factor_(factor), up_(up), north_(north), east_(north.cross(up)), first_of_row_{1} {
  assert(factor > 0);
  for (const std::size_t count : tregenza_rows)
    for (int k = 0; k < factor; ++k)
      first_of_row_.push_back(first_of_row_.back() + count * static_cast<std::size_t>(factor));
}

// Rows have one height, and the cap around the zenith half of it.
double SkyDivisions::sine_at_foot(std::size_t row) const {
  const double height = pi / 2 / (7 * factor_ + 0.5);
  return std::sin(static_cast<double>(row) * height);
}

SkyDivisions::Place SkyDivisions::place_of(std::size_t division) const {
  const auto next = std::upper_bound(first_of_row_.begin(), first_of_row_.end(), division);
  const auto row = static_cast<std::size_t>(next - first_of_row_.begin()) - 1;
  return {row, division - first_of_row_[row]};
}

std::size_t SkyDivisions::at(const Vector& direction) const {
  const double sine = direction.dot(up_);
  if (sine < 0) return 0;
  const double height = pi / 2 / (7 * factor_ + 0.5);
  const auto row = static_cast<std::size_t>(std::asin(std::min(1.0, sine)) / height);
  if (row + 1 >= first_of_row_.size()) return first_of_row_.back();
  // The first division of a row has its middle in the north.
  const double azimuth = std::atan2(direction.dot(east_), direction.dot(north_)) / (2 * pi);
  const auto count = static_cast<double>(count_in(row));
  const double place = std::floor(azimuth * count + 0.5);
  return first_of_row_[row] + static_cast<std::size_t>(place < 0 ? place + count : place) % count_in(row);
}

double SkyDivisions::solid_angle(std::size_t division) const {
  if (division == 0) return 2 * pi;
  const std::size_t row = place_of(division).row;
  if (row + 1 >= first_of_row_.size()) return 2 * pi * (1 - sine_at_foot(row));
  return 2 * pi * (sine_at_foot(row + 1) - sine_at_foot(row)) / static_cast<double>(count_in(row));
}

std::vector<Vector> SkyDivisions::directions(std::size_t division, int across) const {
  assert(division > 0);
  const auto [row, in_row] = place_of(division);
  const bool is_cap = row + 1 >= first_of_row_.size();
  const double low = sine_at_foot(row);
  const double high = is_cap ? 1 : sine_at_foot(row + 1);
  const double width = is_cap ? 2 * pi : 2 * pi / static_cast<double>(count_in(row));
  std::vector<Vector> all;
  for (int k = 0; k < across; ++k) {
    // Equal steps of the sine cut a zone into equal solid angles.
    const double sine = low + (high - low) * (k + 0.5) / across;
    const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
    for (int m = 0; m < across; ++m) {
      const double azimuth = width * (static_cast<double>(in_row) - 0.5 + (m + 0.5) / across);
      all.push_back(sine * up_ + cosine * (std::cos(azimuth) * north_ + std::sin(azimuth) * east_));
    }
  }
  return all;
}

}  // namespace patchlight
