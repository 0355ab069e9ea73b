#include "archive/stop_files.h"

#include "patchlight/base/error.h"

#include "archive/file_names.h"
#include "archive/npy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace patchlight {
namespace {

// In place of patches.
constexpr std::int32_t in_the_open = -1;
constexpr std::int32_t at_back = -2;
constexpr std::int32_t no_polygon_there = -1;

std::filesystem::path in_half(const std::filesystem::path& folder, const char* name, std::size_t half) {
  return folder / (std::string(name) + "_" + std::to_string(half) + ".npy");
}

std::filesystem::path file_of(const std::filesystem::path& folder, std::size_t which, std::size_t half) {
  return in_half(folder, file_name::of_stops.at(which), half);
}

template <class Number, class All, class Value>
void write_each(const std::filesystem::path& file, const All& all, const Value& value) {
  std::vector<Number> numbers;
  numbers.reserve(all.size());
  for (const auto& one : all) numbers.push_back(value(one));
  write_npy_numbers(file, std::span<const Number>(numbers));
}

std::int32_t column_of(const SpecularStop& stop) {
  if (stop.patch == SpecularStop::in_the_open) return in_the_open;
  return stop.patch == SpecularStop::at_back ? at_back : static_cast<std::int32_t>(stop.patch);
}

PatchIndex patch_of(std::int32_t column) {
  if (column == in_the_open) return SpecularStop::in_the_open;
  return column == at_back ? SpecularStop::at_back : static_cast<PatchIndex>(column);
}

[[noreturn]] void refuse_stops(const std::filesystem::path& file, const std::string& found,
                               const std::string& expected) {
  throw InputError(file.string(),
                   "found " + found + "; expected " + expected + "\nhint: compute the form factors again");
}

// A ray is in one row alone.
void require_whole_rays(const std::filesystem::path& file, const RayRows& rows) {
  for (std::size_t i = 0; i + 1 < rows.first_stop.size(); ++i) {
    if (rows.first_stop[i] == rows.first_stop[i + 1]) continue;
    const RayStep last = rows.stops[rows.first_stop[i + 1] - 1].step();
    if (last != RayStep::ends && last != RayStep::kept)
      refuse_stops(file, "a row whose last ray does not end", "rays that end in their row");
  }
}

// A polygon is named wherever it counts.
bool is_polygon(const SpecularStop& stop, std::size_t polygons) {
  return stop.step() == RayStep::ends || stop.polygon < polygons;
}

}  // namespace

void write_stops(const std::filesystem::path& folder, std::size_t half, const RayRows& rows) {
  const std::vector<std::int64_t> begins(rows.first_stop.begin(), rows.first_stop.end());
  write_npy_numbers(file_of(folder, 0, half), std::span<const std::int64_t>(begins));
  write_each<std::int32_t>(file_of(folder, 1, half), rows.stops, column_of);
  write_each<float>(file_of(folder, 2, half), rows.stops, [](const SpecularStop& s) { return s.form_factor; });
  write_each<std::int32_t>(file_of(folder, 3, half), rows.stops, [](const SpecularStop& s) {
    return s.step() == RayStep::ends ? no_polygon_there : static_cast<std::int32_t>(s.polygon);
  });
  write_each<std::int32_t>(file_of(folder, 4, half), rows.stops,
                           [](const SpecularStop& s) { return std::bit_cast<std::int32_t>(s.bits); });
}

void write_kinds(const std::filesystem::path& file, const RayExchange& exchange) {
  std::vector<double> numbers;
  for (const auto& [front, back] : exchange.specular_kinds) numbers.insert(numbers.end(), {front, back});
  write_npy_numbers(file, std::span<const double>(numbers));
}

void write_classes(const std::filesystem::path& folder, const RowsByClass& by_class) {
  for (std::size_t half = 0; half < 2; ++half) {
    const std::vector<ClassEntry>& entries = by_class.halves.at(half);
    const auto file = [&](std::size_t which) { return in_half(folder, file_name::of_classes.at(which), half); };
    const auto number = [](std::uint32_t value) { return static_cast<std::int32_t>(value); };
    write_each<std::int32_t>(file(0), entries, [&](const ClassEntry& e) { return number(e.from); });
    write_each<std::int32_t>(file(1), entries, [&](const ClassEntry& e) { return number(e.to); });
    write_each<std::int32_t>(file(2), entries, [&](const ClassEntry& e) { return number(e.way_class); });
    write_each<float>(file(3), entries, [](const ClassEntry& e) { return e.form_factor; });
  }
}

void read_stops(const std::filesystem::path& folder, std::size_t half, const NumbersOf& there, RayRows& rows) {
  const auto begins = read_npy_numbers<std::int64_t>(file_of(folder, 0, half), there.patches + 1);
  if (begins.front() != 0 || !std::is_sorted(begins.begin(), begins.end()))
    refuse_stops(file_of(folder, 0, half), "rows that begin before those above them",
                 "0 first, then no number below the one before");
  rows.first_stop.assign(begins.begin(), begins.end());
  const std::size_t count = rows.first_stop.back();
  const auto columns = read_npy_numbers<std::int32_t>(file_of(folder, 1, half), count);
  const auto factors = read_npy_numbers<float>(file_of(folder, 2, half), count);
  const auto polygons = read_npy_numbers<std::int32_t>(file_of(folder, 3, half), count);
  const auto bits = read_npy_numbers<std::int32_t>(file_of(folder, 4, half), count);
  rows.stops.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (columns[k] < at_back || columns[k] >= static_cast<std::int64_t>(there.patches))
      refuse_stops(file_of(folder, 1, half), "column " + std::to_string(columns[k]),
                   "one of " + std::to_string(there.patches) + " patches, from 0, or -1 or -2");
    if (!(factors[k] >= 0 && factors[k] <= 1))
      refuse_stops(file_of(folder, 2, half), "a form factor of " + std::to_string(factors[k]), "numbers from 0 to 1");
    SpecularStop stop{patch_of(columns[k]), factors[k], static_cast<PolygonIndex>(polygons[k]),
                      std::bit_cast<std::uint32_t>(bits[k])};
    if (static_cast<std::uint32_t>(stop.step()) >= ray_steps)
      refuse_stops(file_of(folder, 4, half), "step " + std::to_string(stop.bits & 7U), "one from 0 to 5");
    if (!is_polygon(stop, there.polygons))
      refuse_stops(file_of(folder, 3, half), "polygon " + std::to_string(polygons[k]),
                   "one of " + std::to_string(there.polygons) + " polygons, from 0");
    rows.stops.push_back(stop);
  }
  require_whole_rays(file_of(folder, 4, half), rows);
}

std::vector<std::array<double, 2>> read_kinds(const std::filesystem::path& file) {
  const std::size_t count = npy_count(file);
  const auto numbers = read_npy_numbers<double>(file, count);
  const bool are_kinds = count > 0 && count % 2 == 0 &&
                         std::all_of(numbers.begin(), numbers.end(), [](double kind) { return std::isfinite(kind); });
  if (!are_kinds) refuse_stops(file, "what is no pair of numbers for each polygon", "two numbers for each");
  std::vector<std::array<double, 2>> kinds;
  for (std::size_t k = 0; k < count; k += 2) kinds.push_back({numbers[k], numbers[k + 1]});
  return kinds;
}

std::map<std::string, std::string> meaning_of_stop_files() {
  const std::array<const char*, 5> meaning = {
      "where the stops of each row begin; one more at the end",
      "the patch that is met at a stop; -1: the ray has left the model, -2: it meets a side without patches",
      "what the ray counts at a stop if nothing was lost before and all is held there; unit 1",
      "the clear face or mirror of a stop, or from which the ray starts; -1: none",
      "step of a stop + 8 if at a back + 16 times the cosine of the angle there in units of 2^-28; step 0: sent, 1: "
      "crossed, 2: through, 3: mirrored, 4: kept, 5: ends"};
  std::map<std::string, std::string> all;
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t which = 0; which < meaning.size(); ++which)
      all[file_of({}, which, half).string()] = meaning.at(which);
  const std::array<const char*, 4> of_entry = {"the rows of entries by specular ways", "the columns of these entries",
                                               "the classes of their ways, as listed in classes",
                                               "their form factors, in the mean of all bands; unit 1"};
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t which = 0; which < of_entry.size(); ++which)
      all[in_half({}, file_name::of_classes.at(which), half).string()] = of_entry.at(which);
  all[file_name::specular_kinds] =
      "per polygon, front and back: 0 if no ray goes on from there, 1 from a mirror, else 1 and the index of "
      "refraction of a clear face, -1 where it reflects nothing";
  return all;
}

}  // namespace patchlight
