#include "patchlight/base/error.h"

#include "archive/file_names.h"
#include "archive/form_factor_files.h"
#include "archive/json_values.h"
#include "archive/npy.h"
#include "archive/scene_hash.h"
#include "base/parallel.h"
#include "files/reason.h"
#include "transport/closure.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

namespace patchlight {
namespace {

struct Range {
  double low = 0;
  double high = 0;
};

// The largest possible row sums of sampled form factors. An exchange area is below the mean of both patch areas: it is
// the fraction of rays from either patch that arrive, or a form factor below 1 from the smaller patch. Sampled by area,
// it has no bound: points at the distance r have weights up to 1 / (2 pi r^2).
// Consider patches of size h that share an edge. The chance of a weight above K / h^2 is below K^-1.5 / 15. So with N
// patches and n samples of each pair, the chance of a row above L is N n^-0.5 L^-1.5. That is 1e-6 for N = 1e5, n = 4
// and L = 1e7.
Eigen::ArrayXd most_row_sums(const FormFactorInfo& info, const PatchMesh& mesh, const Eigen::VectorXd& exposed) {
  const Eigen::Map<const Eigen::ArrayXd> area(mesh.area.data(), exposed.size());
  const Eigen::ArrayXd bounded = (static_cast<double>(area.size()) * area + area.sum()) / 2 / exposed.array();
  return (1 + rounding_of_entries) * bounded + (info.estimator == Estimator::area ? 1e7 : 0);
}

void require_raw_row_sums(const std::filesystem::path& file, const Eigen::VectorXd& sums, const Eigen::ArrayXd& most) {
  for (Eigen::Index i = 0; i < sums.size(); ++i) {
    if (sums[i] >= 0 && sums[i] <= most[i]) continue;
    std::ostringstream text;
    text << "found form factors that sum to " << sums[i] << " in row " << i + 1 << " before closure; expected 0 to "
         << most[i] << "\nhint: compute the form factors again";
    throw InputError(file.string(), text.str());
  }
}

// Each entry was scaled by the smaller factor of its two rows: a row keeps at least the smallest factor of all, also
// one that was not cut itself, and a cut row sum is still above 1.
Range range_of_cut_row(double raw, double largest) {
  return {raw / std::max(1.0, largest) * (1 - rounding_of_entries), raw * (1 + rounding_of_entries)};
}

// Where sum_j F_ij of a row must lie. As computed it is the stored sum, but for rounding. Closure makes it 1 in a
// closed scene; in an open one it moves it towards the measured share, by a sum that is weighed against the entries'
// errors.
Range row_sum_range(const FormFactorInfo& info, const Exchange& exchange, Eigen::Index i, double largest) {
  constexpr double most_overshoot = 0.2;
  const double raw = exchange.raw_row_sum[i];
  if (!is_closed(info)) return {raw - rounding_of_entries * (1 + raw), raw + rounding_of_entries * (1 + raw)};
  if (info.closure.starts_with(cut_row_sums)) return range_of_cut_row(raw, largest);
  if (exchange.lost.closed()) return {raw > 0 ? 1 - rounding_of_entries : 0, 1 + rounding_of_entries};
  const double seen = 1 - exchange.lost.escaped[i] - exchange.lost.at_backs[i];
  return {std::min(raw, seen) - most_overshoot, std::max(raw, seen) + most_overshoot};
}

// Stored form factors have the row sums that were stored with them, or those that closure makes of them.
// Throws InputError that names the file and the first row where it is not so.
void require_row_sums(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh,
                      const Exchange& exchange) {
  require_raw_row_sums(folder / file_name::raw_row_sum, exchange.raw_row_sum, most_row_sums(info, mesh, exchange.area));
  const Eigen::VectorXd sums = row_sums(exchange.exchange_areas).cwiseQuotient(exchange.area);
  const double largest = sums.size() > 0 ? exchange.raw_row_sum.maxCoeff() : 0;
  for (Eigen::Index i = 0; i < sums.size(); ++i) {
    const Range range = row_sum_range(info, exchange, i, largest);
    if (sums[i] >= range.low && sums[i] <= range.high) continue;
    std::ostringstream text;
    text << "found form factors that sum to " << sums[i] << " in row " << i + 1 << "; expected " << range.low << " to "
         << range.high << "\nhint: compute the form factors again";
    throw InputError((folder / file_name::dense).string(), text.str());
  }
}

// Rows that are read at once, and columns that one thread takes of them: a pair is then set and compared with its
// mirror image by one thread, or after all rows before.
constexpr PatchIndex rows_at_once = 64;

Sides sides_of(const std::string& name) {
  for (const Sides sides : {Sides::automatic, Sides::front, Sides::both}) {
    if (name == name_of(sides)) return sides;
  }
  throw InputError("sides", "found '" + name + "'; expected auto, front or both");
}

Storage storage_of(const std::string& name) {
  for (const Storage storage : {Storage::tiles, Storage::rays}) {
    if (name == name_of(storage)) return storage;
  }
  throw InputError("storage", "found '" + name + "'; expected tiles or rays");
}

Estimator estimator_of(const std::string& name) {
  for (const Estimator estimator :
       {Estimator::automatic, Estimator::area, Estimator::point_polygon, Estimator::hemisphere, Estimator::contour}) {
    if (name == name_of(estimator)) return estimator;
  }
  throw InputError("estimator", "found '" + name + "'; expected auto, area, point-polygon, hemisphere or contour");
}

// The part that is common to both kinds of form factors.
FormFactorInfo info_of_any(const nlohmann::json& json) {
  FormFactorInfo info;
  info.geometry_sha256 = json.at("geometry_sha256").get<std::string>();
  info.model = json.at("input").at("file").get<std::string>();
  info.metres_per_unit = json.at("input").value("metres_per_unit", 1.0);
  info.patches = json.at("patches").get<PatchIndex>();
  // Folders of earlier versions do not have this.
  info.storage = storage_of(json.value("storage", name_of(Storage::tiles)));
  const nlohmann::json& options = json.at("options");
  info.max_edge = options.at("max_edge_m").get<double>();
  info.sides = sides_of(options.at("sides").get<std::string>());
  // Nor this: their patches follow the outlines of faces alone.
  info.contact_lines = options.value("contact_lines", false);
  if (options.contains("contact_line_count"))
    info.contact_line_count = options.at("contact_line_count").get<std::size_t>();
  info.graded_edges = options.value("graded_edges", false);
  info.seed = options.at("seed").get<std::uint64_t>();
  info.lost_share_rays = options.at("lost_share_rays").get<int>();
  if (!(info.max_edge > 0 && std::isfinite(info.max_edge) && info.lost_share_rays >= 1))
    throw std::out_of_range("an option has a value that it cannot have");
  return info;
}

FormFactorInfo info_of(const nlohmann::json& json) {
  FormFactorInfo info = info_of_any(json);
  const nlohmann::json& options = json.at("options");
  if (info.storage == Storage::rays) {
    info.rays = options.at("rays").get<int>();
    // In folders of earlier versions what goes on is in the form factors.
    info.is_specular = json.value("specular", false);
    if (info.rays < 1) throw std::out_of_range("an option has a value that it cannot have");
    return info;
  }
  if (!json.at("closure").is_null()) info.closure = json.at("closure").get<std::string>();
  info.samples = options.at("samples").get<int>();
  const std::string matrix = json.at("matrix").get<std::string>();
  info.format = matrix == "npy" ? MatrixFormat::npy : MatrixFormat::matrix_market;
  if (info.samples < 1 || (matrix != "npy" && matrix != "mtx"))
    throw std::out_of_range("an option has a value that it cannot have");
  const nlohmann::json& counts = json.at("counts");
  info.counts.facing_pairs = counts.at("facing_pairs").get<std::uint64_t>();
  info.counts.near_pairs = counts.at("near_pairs").get<std::uint64_t>();
  info.counts.hidden_pairs = counts.at("hidden_pairs").get<std::uint64_t>();
  info.counts.free_pairs = counts.at("free_pairs").get<std::uint64_t>();
  info.counts.partial_pairs = counts.at("partly_occluded_pairs").get<std::uint64_t>();
  info.counts.blocked_pairs = counts.at("blocked_pairs").get<std::uint64_t>();
  info.counts.shadow_rays = counts.at("shadow_rays").get<std::uint64_t>();
  // Folders of earlier versions do not have this.
  info.estimator = estimator_of(options.value("estimator", name_of(Estimator::automatic)));
  return info;
}

void require_positive(const std::filesystem::path& file, const Eigen::VectorXd& values) {
  if (values.allFinite() && (values.array() > 0).all()) return;
  throw InputError(file.string(), "found an area that is not above 0; compute the form factors again");
}

void require_shares(const std::filesystem::path& file, const Eigen::MatrixXd& values) {
  if (values.allFinite() && (values.array() >= 0).all() && (values.array() <= 1).all()) return;
  throw InputError(file.string(), "found a share outside 0 to 1; compute the form factors again");
}

// Can this be an entry of F? `exchange_area` is A_i F_ij and `other` A_j F_ji, in m^2.
bool is_plausible(double form_factor, double exchange_area, double other) {
  const double most_difference =
      rounding_of_entries * std::max(exchange_area, other) + static_cast<double>(std::numeric_limits<float>::min());
  return std::isfinite(form_factor) && form_factor >= 0 && std::abs(exchange_area - other) <= most_difference;
}

// Some rows of F, and what turns them into exchange areas.
struct Rows {
  PatchIndex begin;
  PatchIndex count;
  std::vector<double> F;
  const Eigen::VectorXd& area;

  double form_factor(PatchIndex r, PatchIndex j) const { return F[r * static_cast<std::size_t>(area.size()) + j]; }
};

// Sets S_ij = A_i F_ij for these rows and the columns [begin, end) on or right of the diagonal, and compares those left
// of it with their mirror images. Returns false when an entry cannot be.
bool take(const Rows& rows, PatchRange columns, ExchangeAreas& S) {
  bool plausible = true;
  for (PatchIndex r = 0; r < rows.count; ++r) {
    const PatchIndex i = rows.begin + r;
    for (PatchIndex j = columns.begin; j < columns.end; ++j) {
      const double form_factor = rows.form_factor(r, j);
      const double exchange_area = rows.area[i] * form_factor;
      const bool is_mirrored = j < i;
      const double other = is_mirrored ? static_cast<double>(S.at(j, i)) : exchange_area;
      plausible &= is_plausible(form_factor, exchange_area, other);
      if (!is_mirrored) S.set(i, j, narrow_toward_zero(exchange_area));
    }
  }
  return plausible;
}

// Names the first entry that cannot be.
[[noreturn]] void refuse(const std::filesystem::path& file, const Rows& rows, const ExchangeAreas& S) {
  for (PatchIndex r = 0; r < rows.count; ++r) {
    for (PatchIndex j = 0; j < S.size(); ++j) {
      const PatchIndex i = rows.begin + r;
      const double form_factor = rows.form_factor(r, j);
      const double exchange_area = rows.area[i] * form_factor;
      const double other = j < i ? static_cast<double>(S.at(j, i)) : exchange_area;
      if (is_plausible(form_factor, exchange_area, other)) continue;
      std::ostringstream text;
      text << "found a form factor " << form_factor << " and with it A_i F_ij = " << exchange_area
           << " where A_j F_ji = " << other
           << "; expected equal numbers, finite and not negative\nhint: compute the form factors again";
      throw InputError(file.string(), text.str());
    }
  }
  throw InputError(file.string(), "found a form factor that cannot be; compute the form factors again");
}

// S_ij = A_i F_ij from the rows of F.
ExchangeAreas read_exchange_areas(const std::filesystem::path& file, const Eigen::VectorXd& area) {
  const auto size = static_cast<PatchIndex>(area.size());
  NpyReader reader(file);
  if (reader.rows() != size || reader.columns() != size) {
    throw InputError(file.string(),
                     "found " + std::to_string(reader.rows()) + " x " + std::to_string(reader.columns()) +
                         " values; expected one row and one column for each of " + std::to_string(size) + " patches");
  }
  ExchangeAreas S(size);
  std::vector<std::uint8_t> plausible((size + rows_at_once - 1) / rows_at_once);
  for (PatchIndex begin = 0; begin < size; begin += rows_at_once) {
    const PatchIndex count = std::min(rows_at_once, size - begin);
    const Rows rows{begin, count, reader.next_rows(count), area};
    parallel_for(plausible.size(), [&](std::size_t part) {
      const PatchIndex first = static_cast<PatchIndex>(part) * rows_at_once;
      plausible[part] = take(rows, {first, std::min(first + rows_at_once, size)}, S);
    });
    if (!std::all_of(plausible.begin(), plausible.end(), [](std::uint8_t good) { return good != 0; })) {
      refuse(file, rows, S);
    }
  }
  return S;
}

// The stored differences; empty if there are none.
HalfDifferences read_half_differences(const std::filesystem::path& file, const PatchMesh& mesh) {
  if (!std::filesystem::exists(file)) return {};
  const std::size_t size = mesh.size();
  return {mesh.area, read_npy_numbers<std::int8_t>(file, size * (size - 1) / 2)};
}

}  // namespace

FormFactorInfo read_form_factor_info(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / file_name::info;
  require_regular_file(file);
  std::ifstream stream(file);
  if (!stream) {
    throw InputError(folder.string(), std::string("there is no ") + file_name::info +
                                          " in it; expected a folder that patchlight form-factors has written");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(stream);
    if (json.at("kind") != file_name::kind) throw InputError("kind", "found " + json.at("kind").dump());
    return info_of(json);
  } catch (const std::exception& error) {
    throw InputError(file.string(), "is not as patchlight form-factors writes it (" + reason_of(error) +
                                        "); compute the form factors again");
  }
}

void require_same_geometry(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh) {
  const std::string wanted = geometry_hash(mesh);
  if (info.geometry_sha256 == wanted && info.patches == mesh.size()) return;
  std::ostringstream text;
  text << "found form factors of " << info.patches << " patches with geometry " << info.geometry_sha256.substr(0, 12)
       << ", made from " << info.model << " with edges up to " << info.max_edge
       << " m and mesh.sides=" << name_of(info.sides) << "; expected those of " << mesh.size()
       << " patches with geometry " << wanted.substr(0, 12)
       << (info.patches == mesh.size() ? ": as many patches, but they lie elsewhere" : "")
       << "\nhint: give the same model, lamps, read.metres_per_unit and mesh.sides, without mesh.max_edge and "
          "mesh.patches"
          "\nhint: or compute them again: patchlight form-factors MODEL -o "
       << folder.string();
  throw InputError(folder.string(), text.str());
}

StoredShares read_shares(const std::filesystem::path& folder, const FormFactorInfo& info) {
  const std::size_t size = info.patches;
  Eigen::VectorXd area = read_npy(folder / file_name::area, size, 1);
  require_positive(folder / file_name::area, area);
  const Eigen::MatrixXd lost = read_npy(folder / file_name::lost_share, size, 4);
  require_shares(folder / file_name::lost_share, lost);
  return {std::move(area), {lost.col(0), lost.col(1), lost.col(2), info.lost_share_rays, {}, {}, lost.col(3)}};
}

bool is_closed(const FormFactorInfo& info) { return !info.closure.empty() && !info.closure.starts_with("none"); }

Exchange read_exchange(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh) {
  require_same_geometry(folder, info, mesh);
  if (info.format != MatrixFormat::npy) {
    throw InputError(folder.string(),
                     "found F.mtx; expected F.npy\nhint: compute the form factors again with --matrix npy");
  }
  const std::size_t size = info.patches;
  auto [area, lost] = read_shares(folder, info);
  Eigen::VectorXd raw_row_sum = read_npy(folder / file_name::raw_row_sum, size, 1);
  ExchangeAreas S = read_exchange_areas(folder / file_name::dense, area);
  Exchange exchange{std::move(S),    std::move(area), std::move(raw_row_sum),
                    std::move(lost), info.counts,     read_half_differences(folder / file_name::half_differences, mesh),
                    info.closure};
  require_row_sums(folder, info, mesh, exchange);
  return exchange;
}

}  // namespace patchlight
