#include "archive/ray_row_files.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "archive/file_names.h"
#include "archive/npy.h"
#include "archive/scene_file.h"
#include "archive/scene_hash.h"
#include "files/sha256.h"
#include "optics/surface_optics.h"
#include "output/file/whole_file.h"
#include "output/mesh/write_mesh.h"
#include "output/report/report_json.h"
#include "plan/planned_scene.h"
#include "transport/ray_transport.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// To be raised when rows are found in another way, so that blocks of before are not taken.
constexpr std::uint32_t way_of_finding = 2;

std::string bytes_of_faces(const Scene& scene) {
  std::string bytes;
  const SurfaceOptics specular(scene, Reflections::followed);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Vector normal = front_normal(scene, p);
    for (const Side side : {Side::front, Side::back}) append_bytes(bytes, specular.nonspecular_fraction(p, side));
    append_bytes(bytes, specular.transmittance(p, normal));
    for (const Vector& direction : {normal, Vector(-normal)}) append_bytes(bytes, specular.reflectance(p, direction));
    append_bytes(bytes, scene.polygons[p].corners.size());
    for (const Point& corner : corner_points(scene, p)) {
      for (const double coordinate : corner) append_bytes(bytes, coordinate);
    }
  }
  return bytes;
}

std::string bytes_of_effects(const EffectOptions& effects) {
  std::string bytes;
  for (const auto* list : {&effects.force, &effects.skip}) {
    append_bytes(bytes, list->size());
    for (const Effect effect : *list) append_bytes(bytes, static_cast<std::int32_t>(effect));
  }
  return bytes;
}

std::string bytes_of(const RayOptions& options, std::span<const float> bright_densities) {
  std::string bytes;
  append_bytes(bytes, way_of_finding);
  append_bytes(bytes, options.rays);
  append_bytes(bytes, options.toward_bright);
  append_bytes(bytes, options.seed);
  for (const std::uint8_t doublings : options.doublings) append_bytes(bytes, doublings);
  for (const float density : bright_densities) append_bytes(bytes, density);
  return bytes;
}

std::string name_begin(const std::string& key) { return "rows_" + key + "_"; }

// 32 bits of a SHA-256 of a block.
std::int32_t digest(const std::string& key, std::size_t block, std::span<const std::int32_t> words) {
  std::string bytes;
  append_bytes(bytes, block);
  bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  const std::array parts{key, std::move(bytes)};
  return static_cast<std::int32_t>(std::stoul(sha256(parts).substr(0, 8), nullptr, 16));
}

}  // namespace

std::string row_key(const RowScene& of, const PatchMesh& mesh, const RayOptions& options,
                    std::span<const float> bright_densities) {
  const std::array parts{std::string(version()), geometry_hash(mesh), bytes_of_faces(of.scene),
                         bytes_of_effects(of.effects), bytes_of(options, bright_densities)};
  return sha256(parts).substr(0, 16);
}

RowBlocks row_blocks_in(const std::filesystem::path& folder, const std::string& key) {
  const auto file = [folder, key](std::size_t block) {
    return folder / (name_begin(key) + std::to_string(block) + ".npy");
  };
  const auto read = [file, key](std::size_t block) -> std::optional<std::vector<std::int32_t>> {
    try {
      if (!std::filesystem::exists(file(block))) return std::nullopt;
      const auto stored = read_npy_numbers<std::int32_t>(file(block), npy_count(file(block)));
      if (stored.empty()) return std::nullopt;
      std::vector<std::int32_t> words(stored.begin(), stored.end() - 1);
      if (stored.back() != digest(key, block, words)) return std::nullopt;
      return words;
    } catch (const InputError&) {
      return std::nullopt;
    } catch (const std::filesystem::filesystem_error&) {
      return std::nullopt;
    }
  };
  const auto keep = [folder, file, key](std::size_t block, std::span<const std::int32_t> words) {
    // A run that shares the folder may have removed it, when nothing was in it.
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::vector<std::int32_t> stored(words.begin(), words.end());
    stored.push_back(digest(key, block, words));
    write_npy_numbers(file(block), std::span<const std::int32_t>(stored));
  };
  return {read, keep};
}

void remove_row_blocks(const std::filesystem::path& folder, std::span<const std::string> keys) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    for (const std::string& key : keys) {
      if (name.starts_with(name_begin(key))) files.push_back(entry->path());
    }
  }
  for (const std::filesystem::path& file : files) std::filesystem::remove(file, error);
}

namespace {

// The files of rays that are specular on their way, in a folder of rows of rays.
// docs/reference/outputs/form-factor-folder.md describes them.

// The surfaces that stops may name.
struct NumbersOf {
  std::size_t patches = 0;
  std::size_t polygons = 0;
};

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
  for (const auto& one : all) numbers.push_back(static_cast<Number>(value(one)));
  write_npy_numbers(file, std::span<const Number>(numbers));
}

template <class Number, class All>
void write_as(const std::filesystem::path& file, const All& all) {
  write_each<Number>(file, all, [](const auto& one) { return one; });
}

std::int32_t column_of(const SpecularStop& stop) {
  if (stop.patch == SpecularStop::in_the_open) return in_the_open;
  return stop.patch == SpecularStop::at_back ? at_back : static_cast<std::int32_t>(stop.patch);
}

PatchIndex patch_of(std::int32_t column) {
  if (column == in_the_open) return SpecularStop::in_the_open;
  return column == at_back ? SpecularStop::at_back : static_cast<PatchIndex>(column);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& found, const std::string& expected) {
  throw InputError(file.string(),
                   "found " + found + "; expected " + expected + "\nhint: compute the form factors again");
}

// A ray is in one row alone.
void require_whole_rays(const std::filesystem::path& file, const RayRows& rows) {
  for (std::size_t i = 0; i + 1 < rows.first_stop.size(); ++i) {
    if (rows.first_stop[i] == rows.first_stop[i + 1]) continue;
    const RayStep last = rows.stops[rows.first_stop[i + 1] - 1].step();
    if (last != RayStep::ends && last != RayStep::kept)
      refuse(file, "a row whose last ray does not end", "rays that end in their row");
  }
}

// A polygon is named wherever it counts.
bool is_polygon(const SpecularStop& stop, std::size_t polygons) {
  return stop.step() == RayStep::ends || stop.polygon < polygons;
}

// Writes those of one half. Throws OutputError.
void write_stops(const std::filesystem::path& folder, std::size_t half, const RayRows& rows) {
  write_as<std::int64_t>(file_of(folder, 0, half), rows.first_stop);
  write_each<std::int32_t>(file_of(folder, 1, half), rows.stops, column_of);
  write_each<float>(file_of(folder, 2, half), rows.stops, [](const SpecularStop& s) { return s.form_factor; });
  write_each<std::int32_t>(file_of(folder, 3, half), rows.stops, [](const SpecularStop& s) {
    return s.step() == RayStep::ends ? no_polygon_there : static_cast<std::int32_t>(s.polygon);
  });
  write_each<std::int32_t>(file_of(folder, 4, half), rows.stops,
                           [](const SpecularStop& s) { return std::bit_cast<std::int32_t>(s.bits); });
}

// Writes RayExchange::specular_kinds. Throws OutputError.
void write_kinds(const std::filesystem::path& file, const RayExchange& exchange) {
  std::vector<double> numbers;
  for (const auto& [front, back] : exchange.specular_kinds) numbers.insert(numbers.end(), {front, back});
  write_npy_numbers(file, std::span<const double>(numbers));
}

// Writes the form factors by each class of ways. Throws OutputError.
void write_classes(const std::filesystem::path& folder, const RowsByClass& by_class) {
  for (std::size_t half = 0; half < 2; ++half) {
    const std::vector<ClassEntry>& entries = by_class.halves.at(half);
    const auto file = [&](std::size_t which) { return in_half(folder, file_name::of_classes.at(which), half); };
    write_each<std::int32_t>(file(0), entries, [](const ClassEntry& e) { return e.from; });
    write_each<std::int32_t>(file(1), entries, [](const ClassEntry& e) { return e.to; });
    write_each<std::int32_t>(file(2), entries, [](const ClassEntry& e) { return e.way_class; });
    write_each<float>(file(3), entries, [](const ClassEntry& e) { return e.form_factor; });
  }
}

// Reads those of one half into rows. Throws InputError when they cannot be.
void read_stops(const std::filesystem::path& folder, std::size_t half, const NumbersOf& there, RayRows& rows) {
  const auto begins = read_npy_numbers<std::int64_t>(file_of(folder, 0, half), there.patches + 1);
  if (begins.front() != 0 || !std::is_sorted(begins.begin(), begins.end()))
    refuse(file_of(folder, 0, half), "rows that begin before those above them",
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
      refuse(file_of(folder, 1, half), "column " + std::to_string(columns[k]),
             "one of " + std::to_string(there.patches) + " patches, from 0, or -1 or -2");
    if (!(factors[k] >= 0 && factors[k] <= 1))
      refuse(file_of(folder, 2, half), "a form factor of " + std::to_string(factors[k]), "numbers from 0 to 1");
    SpecularStop stop{patch_of(columns[k]), factors[k], static_cast<PolygonIndex>(polygons[k]),
                      std::bit_cast<std::uint32_t>(bits[k])};
    if (static_cast<std::uint32_t>(stop.step()) >= ray_steps)
      refuse(file_of(folder, 4, half), "step " + std::to_string(stop.bits & 7U), "one from 0 to 5");
    if (!is_polygon(stop, there.polygons))
      refuse(file_of(folder, 3, half), "polygon " + std::to_string(polygons[k]),
             "one of " + std::to_string(there.polygons) + " polygons, from 0");
    rows.stops.push_back(stop);
  }
  require_whole_rays(file_of(folder, 4, half), rows);
}

// Throws InputError.
std::vector<std::array<double, 2>> read_kinds(const std::filesystem::path& file) {
  const std::size_t count = npy_count(file);
  const auto numbers = read_npy_numbers<double>(file, count);
  const bool are_kinds = count > 0 && count % 2 == 0 &&
                         std::all_of(numbers.begin(), numbers.end(), [](double kind) { return std::isfinite(kind); });
  if (!are_kinds) refuse(file, "what is no pair of numbers for each polygon", "two numbers for each");
  std::vector<std::array<double, 2>> kinds;
  for (std::size_t k = 0; k < count; k += 2) kinds.push_back({numbers[k], numbers[k + 1]});
  return kinds;
}

using Json = nlohmann::ordered_json;

std::filesystem::path file_of_half(const std::filesystem::path& folder, std::size_t which, std::size_t half) {
  return in_half(folder, file_name::of_half.at(which), half);
}

void write_half(const std::filesystem::path& folder, std::size_t half, const RayRows& rows) {
  const auto file = [&](std::size_t which) { return file_of_half(folder, which, half); };
  write_as<std::int64_t>(file(0), rows.first_hit);
  write_as<std::int32_t>(file(1), rows.hits);
  write_as<double>(file(2), rows.hit_weight);
  write_as<std::int64_t>(file(3), rows.first_entry);
  write_each<std::int32_t>(file(4), rows.entries, [](const RayEntry& e) { return e.patch; });
  write_each<float>(file(5), rows.entries, [](const RayEntry& e) { return e.form_factor; });
  if (!rows.first_stop.empty()) write_stops(folder, half, rows);
}

void write_lamps(const std::filesystem::path& folder, const RayExchange& exchange) {
  std::vector<std::int64_t> ranges;
  for (const auto& [begin, end] : exchange.emitters) ranges.insert(ranges.end(), {begin, end});
  write_as<std::int64_t>(folder / file_name::lamps, ranges);
  const auto write = [&](const char* name, const EmitterValues& values) {
    const std::span<const float> all(values.data(), static_cast<std::size_t>(values.size()));
    write_npy_numbers(folder / name, all);
  };
  const EmitterFactors& factors = exchange.emitter_factors;
  for (std::size_t half = 0; half < 2; ++half) write(file_name::emitter_factors.at(half), factors.halves.at(half));
  write(file_name::emitter_standard_error, factors.standard_error);
}

// Describes files of which there is one for each half of the rays.
template <std::size_t n>
void describe(Json& part, const std::array<const char*, n>& names, const std::array<const char*, n>& meaning) {
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t which = 0; which < n; ++which) part[in_half({}, names[which], half).string()] = meaning[which];
}

void describe_stops(Json& part) {
  describe(part, file_name::of_stops,
           {"where the stops of each row begin; one more at the end",
            "the patch that is met at a stop; -1: the ray has left the model, -2: it meets a side without patches",
            "form factor of the ray at a stop, without losses before it and without specular light there; unit 1",
            "the clear face or mirror of a stop, or from which the ray starts; -1: none",
            "step of a stop + 8 if at a back + 16 times the cosine of the angle there in units of 2^-28; step 0: sent, "
            "1: crossed, 2: through, 3: mirrored, 4: kept, 5: ends"});
  describe(part, file_name::of_classes,
           {"the rows of entries by specular ways", "the columns of these entries",
            "the classes of their ways, as listed in classes", "their form factors, averaged over all bands; unit 1"});
  part[file_name::specular_kinds] =
      "per polygon, front and back: 0 if no ray goes on from there, 1 from a mirror, else 1 and the index of "
      "refraction of a clear face, -1 where it reflects nothing";
}

Json files_of_rows(bool is_specular) {
  Json part;
  describe(part, file_name::of_half,
           {"where the hits of each row begin in hits; one more at the end",
            "the patches that rays of each row have met: column j, once for each ray",
            "per row the form factor of each of its hits; unit 1",
            "where the entries of each row begin; one more at the end", "the columns of entries",
            "form factors found by rays towards bright patches; unit 1"});
  if (is_specular) describe_stops(part);
  part[file_name::lamps] = "first patch of each lamp that is apart from the rows, and the one after its last";
  for (const char* name : file_name::emitter_factors)
    part[name] = "form factors to these lamps as wholes, row by row, a column for each; unit 1";
  part[file_name::emitter_standard_error] = "standard error of the mean of both";
  part[file_name::hit_distance] = "harmonic mean of the lengths of each patch's rays; unit m";
  part[file_name::directed] = "per patch 1 when it was bright, so that rays were sent towards it on purpose";
  part[file_name::area] = "exposed area A_i of each patch; unit m^2";
  part[file_name::exitance] = "exitance of each patch by its material, a column per band; unit W/m^2";
  part[file_name::reflectance] = "diffuse reflectance of each patch, a column per band; unit 1";
  part[file_name::lost_share] = file_name::about_lost_share;
  part[file_name::mesh] = "the patches, in the order of the rows; coordinates in m";
  part[file_name::scene] = "the model: polygons, materials, and which sides are simulated; coordinates in m";
  return part;
}

std::string info_of_rows(const Scene& scene, const RayFormFactors& found, const RowsByClass& by_class,
                         const std::string& command_line) {
  const LostShare& lost = found.exchange.rows.lost;
  Json json;
  json["kind"] = file_name::kind;
  json["version"] = version();
  json["command_line"] = command_line;
  json["geometry_sha256"] = geometry_hash(found.mesh);
  json["input"] = {{"file", scene.file}, {"sha256", scene.sha256}, {"metres_per_unit", scene.metres_per_unit}};
  json["patches"] = found.mesh.size();
  json["storage"] = name_of(Storage::rays);
  json["options"] = {{"max_edge_m", found.plan.max_edge},
                     {"sides", name_of(found.request.mesh.sides)},
                     {"contact_lines", found.request.mesh.contact_lines},
                     {"contact_line_count", number_of(found.plan.contacts)},
                     {"graded_edges", found.request.mesh.graded_edges},
                     {"rays", found.plan.assembly.rays},
                     {"seed", found.plan.assembly.seed},
                     {"lost_share_rays", lost.rays_per_patch}};
  const bool is_specular = !found.exchange.specular_kinds.empty();
  json["specular"] = is_specular;
  if (is_specular) {
    json["classes"] = Json::array();
    for (const WayClass& way_class : by_class.classes) json["classes"].push_back(name_of(way_class, scene));
  }
  json["counts"] = {{"rays", found.exchange.rows.rays}, {"shadow_rays", found.exchange.rows.shadow_rays}};
  json["files"] = files_of_rows(is_specular);
  return json_text(json);
}

// The first entry of each row. A negative number in the file becomes a very large number here.
std::vector<std::uint64_t> read_begins(const std::filesystem::path& file, std::size_t rows) {
  auto begins = read_npy_as<std::vector<std::uint64_t>, std::int64_t>(file, rows + 1);
  const bool rises = begins.front() == 0 && std::is_sorted(begins.begin(), begins.end());
  if (!rises || std::bit_cast<std::int64_t>(begins.back()) < 0)
    refuse(file, "rows that begin before those above them", "0 first, then no number below the one before");
  return begins;
}

LargeArray<PatchIndex> read_columns(const std::filesystem::path& file, std::size_t count, std::size_t patches) {
  // A negative number in the file becomes a very large number here.
  const auto is_patch = [&](std::int32_t j) { return static_cast<std::uint32_t>(j) < patches; };
  return read_npy_as<LargeArray<PatchIndex>, std::int32_t>(file, count, [&](std::span<const std::int32_t> piece) {
    const auto other = std::find_if_not(piece.begin(), piece.end(), is_patch);
    if (other != piece.end())
      refuse(file, "column " + std::to_string(*other), "one of " + std::to_string(patches) + " patches, from 0");
  });
}

RayRows read_half(const std::filesystem::path& folder, std::size_t half, std::size_t patches) {
  const auto file = [&](std::size_t which) { return file_of_half(folder, which, half); };
  RayRows rows;
  rows.first_hit = read_begins(file(0), patches);
  rows.hits = read_columns(file(1), rows.first_hit.back(), patches);
  rows.hit_weight = read_npy_as<std::vector<double>, double>(file(2), patches);
  rows.first_entry = read_begins(file(3), patches);
  const LargeArray<PatchIndex> columns = read_columns(file(4), rows.first_entry.back(), patches);
  rows.entries.reserve(columns.size());
  read_npy_pieces<float>(file(5), columns.size(), [&](std::span<const float> piece) {
    for (const float entry : piece) {
      if (!(entry >= 0)) refuse(file(5), "a form factor of " + std::to_string(entry), "numbers from 0 on");
      rows.entries.push_back({columns[rows.entries.size()], entry});
    }
  });
  return rows;
}

double row_sum(const RayRows& rows, std::size_t i) {
  double sum = static_cast<double>(rows.first_hit[i + 1] - rows.first_hit[i]) * rows.hit_weight[i];
  for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
    sum += static_cast<double>(rows.entries[k].form_factor);
  return sum;
}

// Every row that has entries sums up to what its patch sees.
void require_sums(const std::filesystem::path& file, const RayRows& rows, const Eigen::VectorXd& wanted) {
  for (std::size_t i = 0; i < rows.hit_weight.size(); ++i) {
    const std::uint64_t hits = rows.first_hit[i + 1] - rows.first_hit[i];
    const double sum = row_sum(rows, i);
    const bool is_empty = hits == 0 && rows.first_entry[i] == rows.first_entry[i + 1];
    const double expected = wanted[static_cast<Eigen::Index>(i)];
    const bool is_weighed = rows.hit_weight[i] >= -rounding_of_entries;
    if (is_weighed && (is_empty || std::abs(sum - expected) <= rounding_of_entries)) continue;
    std::ostringstream found, right;
    found << "form factors that sum to " << sum << " in row " << i + 1;
    right << expected << ", as lost_share.npy states";
    refuse(file, found.str(), right.str());
  }
}

EmitterValues read_lamp_values(const std::filesystem::path& file, std::size_t patches, std::size_t lamps) {
  // A form factor is a mean of shares of the hemisphere.
  const LargeArray<float> stored = read_npy_numbers<float>(file, patches * lamps);
  const auto is_factor = [](float value) { return value >= 0 && value <= 1.001F; };
  const auto other = std::find_if_not(stored.begin(), stored.end(), is_factor);
  if (other != stored.end()) refuse(file, "a form factor of " + std::to_string(*other), "numbers from 0 to 1");
  return Eigen::Map<const EmitterValues>(stored.data(), static_cast<Eigen::Index>(patches),
                                         static_cast<Eigen::Index>(lamps));
}

bool is_side(const PatchMesh& mesh, const PatchRange& patches) {
  const PatchRange side = mesh.patches_on(mesh.polygon[patches.begin], mesh.side[patches.begin]);
  return side.begin == patches.begin && side.end == patches.end;
}

std::vector<PatchRange> read_lamps(const std::filesystem::path& file, const PatchMesh& mesh) {
  const std::size_t count = npy_count(file);
  if (count % 2 != 0 || count > 2000) refuse(file, std::to_string(count) + " numbers", "two for each lamp");
  const LargeArray<std::int64_t> stored = read_npy_numbers<std::int64_t>(file, count);
  std::vector<PatchRange> lamps;
  for (std::size_t k = 0; k < count; k += 2) {
    const std::int64_t begin = stored[k], end = stored[k + 1];
    const bool is_range = begin >= 0 && begin < end && end <= static_cast<std::int64_t>(mesh.size());
    if (!is_range || !is_side(mesh, {static_cast<PatchIndex>(begin), static_cast<PatchIndex>(end)}))
      refuse(file, "patches " + std::to_string(begin) + " to " + std::to_string(end), "all patches of a side");
    lamps.push_back({static_cast<PatchIndex>(begin), static_cast<PatchIndex>(end)});
  }
  return lamps;
}

}  // namespace

void write_ray_rows(const std::filesystem::path& folder, const Scene& scene, const RayFormFactors& found,
                    const std::string& command_line, const Observer& observer) {
  const auto tell = [&](double fraction) {
    if (observer && !observer({.stage = Stage::write, .fraction = fraction})) throw Canceled();
  };
  const TracedRows& rows = found.exchange.rows;
  const RowsByClass by_class = rows_by_class(rows, scene, SurfaceOptics(scene, reflections_of(found.plan)));
  write_whole_folder(folder, is_earlier_form_factors, [&](const std::filesystem::path& in) {
    for (std::size_t half = 0; half < 2; ++half) {
      tell(0.4 * static_cast<double>(half));
      write_half(in, half, rows.halves.at(half));
    }
    tell(0.8);
    write_lamps(in, found.exchange);
    if (!found.exchange.specular_kinds.empty()) {
      write_kinds(in / file_name::specular_kinds, found.exchange);
      write_classes(in, by_class);
    }
    write_as<float>(in / file_name::hit_distance, rows.distance);
    write_npy(in / file_name::directed, std::span<const std::uint8_t>(rows.directed));
    write_npy(in / file_name::area, rows.area);
    write_materials(in, scene, found.plan, found.mesh, rows.area);
    write_shares(in, rows.lost);
    tell(0.9);
    write_mesh(in / file_name::mesh, scene, {found.mesh, found.area, found.row_sum, {}});
    tell(1);
    write_stored_scene(in / file_name::scene, scene, found.plan.sides);
    write_bytes(in / file_name::info, info_of_rows(scene, found, by_class, command_line));
  });
}

RayExchange read_ray_rows(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh) {
  require_same_geometry(folder, info, mesh);
  const std::size_t patches = mesh.size();
  RayExchange exchange;
  TracedRows& rows = exchange.rows;
  const StoredShares shares = read_shares(folder, info);
  rows.area = shares.area;
  rows.lost = shares.lost;
  const Eigen::VectorXd wanted = expected_row_sum(rows.lost);
  auto kinds = info.is_specular ? read_kinds(folder / file_name::specular_kinds) : std::vector<std::array<double, 2>>();
  for (std::size_t half = 0; half < 2; ++half) {
    RayRows& of_half = rows.halves.at(half);
    of_half = read_half(folder, half, patches);
    if (info.is_specular) {
      read_stops(folder, half, {patches, kinds.size()}, of_half);
    } else {
      require_sums(file_of_half(folder, 2, half), of_half, wanted);
    }
  }
  rows.distance = read_npy_as<std::vector<float>, float>(folder / file_name::hit_distance, patches);
  const auto is_length = [](float metres) { return std::isfinite(metres) && metres >= 0; };
  if (!std::all_of(rows.distance.begin(), rows.distance.end(), is_length))
    refuse(folder / file_name::hit_distance, "a length that is below 0 or no number", "meters, not below 0");
  rows.directed = read_npy_bytes(folder / file_name::directed, patches);
  rows.rays = rows.halves[0].hits.size() + rows.halves[1].hits.size();
  exchange.emitters = read_lamps(folder / file_name::lamps, mesh);
  EmitterFactors& factors = exchange.emitter_factors;
  for (std::size_t half = 0; half < 2; ++half)
    factors.halves.at(half) =
        read_lamp_values(folder / file_name::emitter_factors.at(half), patches, exchange.emitters.size());
  factors.standard_error =
      read_lamp_values(folder / file_name::emitter_standard_error, patches, exchange.emitters.size());
  exchange.specular_kinds = std::move(kinds);
  return exchange;
}

}  // namespace patchlight
