#include "archive/form_factor_files.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "archive/file_names.h"
#include "archive/json_values.h"
#include "archive/npy.h"
#include "archive/scene_file.h"
#include "archive/scene_hash.h"
#include "output/file/whole_file.h"
#include "output/mesh/write_mesh.h"
#include "output/report/report_json.h"
#include "pipeline/problem_of.h"
#include "plan/planned_scene.h"
#include "transport/closure.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

namespace patchlight {
namespace {

std::uint32_t group_of(const Scene& scene, const PatchMesh& mesh, PatchIndex i, GroupBy by) {
  return by == GroupBy::material ? mesh.material[i] : scene.polygons[mesh.polygon[i]].group;
}

std::string name_of(const Scene& scene, std::uint32_t group, GroupBy by) {
  return by == GroupBy::material ? scene.materials[group].name : group_name(scene, group);
}

}  // namespace

const char* name_of(GroupBy by) { return by == GroupBy::material ? "material" : "object"; }

GroupFactors group_factors(const Scene& scene, const FormFactors& form_factors, GroupBy by) {
  const PatchMesh& mesh = form_factors.mesh;
  const Exchange& exchange = form_factors.exchange;
  // Groups are numbered as they come up among the scene's, those without patches left out.
  std::map<std::uint32_t, std::uint32_t> number;
  for (PatchIndex i = 0; i < mesh.size(); ++i) number[group_of(scene, mesh, i, by)] = 0;
  GroupFactors groups;
  groups.by = by;
  for (auto& [group, place] : number) {
    place = static_cast<std::uint32_t>(groups.names.size());
    groups.names.push_back(name_of(scene, group, by));
  }

  const auto count = static_cast<std::uint32_t>(groups.names.size());
  groups.area = Eigen::VectorXd::Zero(count);
  std::vector<std::uint32_t> numbers(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    numbers[i] = number[group_of(scene, mesh, i, by)];
    groups.area[numbers[i]] += exchange.area[i];
  }
  groups.form_factor =
      groups.area.cwiseInverse().asDiagonal() * exchange_between_groups(exchange.exchange_areas, numbers, count);
  return groups;
}

void write_groups(const std::filesystem::path& file, const GroupFactors& groups) {
  std::ostringstream text;
  text << std::setprecision(9) << "from,area_m2";
  for (const std::string& name : groups.names) text << ',' << csv_cell(name);
  text << '\n';
  for (std::size_t from = 0; from < groups.names.size(); ++from) {
    const auto row = static_cast<Eigen::Index>(from);
    text << csv_cell(groups.names[from]) << ',' << groups.area[row];
    for (const double form_factor : groups.form_factor.row(row)) text << ',' << form_factor;
    text << '\n';
  }
  write_bytes(file, text.str());
}

namespace {

void report(const Observer& observer, PatchIndex row, PatchIndex rows) {
  if (observer && !observer({.stage = Stage::write, .fraction = static_cast<double>(row) / rows})) throw Canceled();
}

// A matrix over the patches: entry (i, j).
using Entry = std::function<double(PatchIndex i, PatchIndex j)>;

struct Matrix {
  PatchIndex size = 0;
  std::string meaning;
  Entry entry;
};

Matrix form_factors_of(const Exchange& exchange) {
  return {exchange.exchange_areas.size(), "form factors from patch (row) to patch (column)",
          [&exchange](PatchIndex i, PatchIndex j) {
            return static_cast<double>(exchange.exchange_areas.at(i, j)) / exchange.area[i];
          }};
}

Matrix sampling_errors_of(const Exchange& exchange) {
  return {exchange.exchange_areas.size(),
          "random draw of the sampling errors of form factors from patch (row) to patch (column)",
          [&exchange](PatchIndex i, PatchIndex j) { return exchange.half_differences.at(i, j) / exchange.area[i]; }};
}

void write_dense(const std::filesystem::path& file, const Matrix& matrix, const Observer& observer) {
  write_npy(file, matrix.size, matrix.size, [&](std::size_t row, std::span<float> values) {
    const auto i = static_cast<PatchIndex>(row);
    report(observer, i, matrix.size);
    for (PatchIndex j = 0; j < matrix.size; ++j) values[j] = static_cast<float>(matrix.entry(i, j));
  });
}

// Matrix Market coordinate format (Boisvert, Pozo and Remington 1996); indices count from 1.
void write_coordinates(const std::filesystem::path& file, const Matrix& matrix, const Observer& observer) {
  const PatchIndex size = matrix.size;
  std::uint64_t entries = 0;
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) entries += matrix.entry(i, j) != 0;
  }
  write_stream(file, [&](std::ostream& stream) {
    stream << "%%MatrixMarket matrix coordinate real general\n% " << matrix.meaning << '\n';
    stream << size << ' ' << size << ' ' << entries << '\n' << std::setprecision(9);
    for (PatchIndex i = 0; i < size && stream; ++i) {
      report(observer, i, size);
      for (PatchIndex j = 0; j < size; ++j) {
        const double entry = matrix.entry(i, j);
        if (entry != 0) stream << i + 1 << ' ' << j + 1 << ' ' << static_cast<float>(entry) << '\n';
      }
    }
  });
}

void write(const std::filesystem::path& file, const Matrix& matrix, MatrixFormat format, const Observer& observer) {
  (format == MatrixFormat::npy ? write_dense : write_coordinates)(file, matrix, observer);
}

// Closure that is still to come weighs by them.
bool stores_half_differences(const Exchange& exchange) {
  return exchange.half_differences.size() > 0 && exchange.closure.empty() &&
         weighs_by_errors(exchange.lost, exchange.half_differences.size());
}

Json files_part(const FormFactorResult& result) {
  Json part;
  part[result.format == MatrixFormat::npy ? file_name::dense : file_name::sparse] =
      "form factors F_ij from patch i (row) to patch j (column); unit 1";
  if (result.form_factors.exchange.half_differences.size() > 0) {
    part[result.format == MatrixFormat::npy ? file_name::dense_error : file_name::sparse_error] =
        "random draw of the sampling error of F_ij, before closure: half of the difference of two halves "
        "of its samples; unit 1";
  }
  if (stores_half_differences(result.form_factors.exchange)) {
    part[file_name::half_differences] =
        "the same of S_ij for each pair i < j, at j (j - 1) / 2 + i, in units of the root of both patches' areas: 0, "
        "or sign(k) 2^((|k| - 127) / 4)";
  }
  part[file_name::area] = "exposed area A_i of each patch; unit m^2. A_i F_ij = A_j F_ji";
  part[file_name::exitance] = "exitance of each patch by its material, a column per band; unit W/m^2";
  part[file_name::reflectance] = "diffuse reflectance of each patch, a column per band; unit 1";
  part[file_name::lost_share] = file_name::about_lost_share;
  part[file_name::raw_row_sum] = "sum_j F_ij before closure; unit 1";
  part[file_name::mesh] = "the patches, in the order of the rows; coordinates in m";
  part[file_name::scene] = "the model: polygons, materials, and which sides are simulated; coordinates in m";
  return part;
}

// The names of the short cuts that were not taken, as on the command line.
Json left_out(const ShortCuts& short_cuts) {
  Json names = Json::array();
  if (!short_cuts.hidden) names.push_back("hidden");
  if (!short_cuts.free) names.push_back("free");
  if (!short_cuts.far) names.push_back("far");
  return names;
}

Json counts_part(const AssemblyCounts& counts) {
  return {{"facing_pairs", counts.facing_pairs},
          {"near_pairs", counts.near_pairs},
          {"hidden_pairs", counts.hidden_pairs},
          {"free_pairs", counts.free_pairs},
          {"partly_occluded_pairs", counts.partial_pairs},
          {"blocked_pairs", counts.blocked_pairs},
          {"shadow_rays", counts.shadow_rays}};
}

std::string info_json(const FormFactorResult& result) {
  const auto& [request, plan, mesh, exchange, notes] = result.form_factors;
  Json json;
  json["kind"] = file_name::kind;
  json["version"] = version();
  json["command_line"] = result.command_line;
  json["geometry_sha256"] = geometry_hash(mesh);
  json["input"] = {
      {"file", result.scene.file}, {"sha256", result.scene.sha256}, {"metres_per_unit", result.scene.metres_per_unit}};
  json["patches"] = mesh.size();
  json["storage"] = name_of(Storage::tiles);
  json["matrix"] = result.format == MatrixFormat::npy ? "npy" : "mtx";
  json["closure"] = exchange.closure.empty() ? Json() : Json(exchange.closure);
  json["options"] = {{"max_edge_m", plan.max_edge},
                     {"sides", name_of(request.mesh.sides)},
                     {"contact_lines", request.mesh.contact_lines},
                     {"contact_line_count", number_of(plan.contacts)},
                     {"graded_edges", request.mesh.graded_edges},
                     {"samples", plan.assembly.samples},
                     {"estimator", name_of(plan.assembly.estimator)},
                     {"without", left_out(plan.assembly.short_cuts)},
                     {"seed", plan.assembly.seed},
                     {"lost_share_rays", exchange.lost.rays_per_patch}};
  json["counts"] = counts_part(exchange.counts);
  json["files"] = files_part(result);
  return json_text(json);
}

}  // namespace

bool is_earlier_form_factors(const std::filesystem::path& folder) {
  FolderResult result{file_name::info,
                      file_name::kind,
                      {file_name::dense,
                       file_name::sparse,
                       file_name::dense_error,
                       file_name::sparse_error,
                       file_name::half_differences,
                       "standard_error.npy",  // of earlier versions
                       "standard_error.mtx",
                       "entry_errors.npy",
                       file_name::area,
                       file_name::exitance,
                       file_name::reflectance,
                       file_name::lost_share,
                       file_name::raw_row_sum,
                       file_name::mesh,
                       file_name::scene,
                       file_name::info,
                       file_name::by_material,
                       file_name::by_object,
                       file_name::hit_distance,
                       file_name::directed,
                       file_name::lamps,
                       file_name::emitter_factors[0],
                       file_name::emitter_factors[1],
                       file_name::emitter_standard_error,
                       file_name::specular_kinds}};
  for (const std::span<const char* const> list :
       {std::span<const char* const>(file_name::of_half), std::span<const char* const>(file_name::of_stops),
        std::span<const char* const>(file_name::of_classes)}) {
    for (const std::string name : list) result.names.insert(result.names.end(), {name + "_0.npy", name + "_1.npy"});
  }
  using Iterator = std::filesystem::directory_iterator;
  return holds_result(folder, result) &&
         std::all_of(Iterator(folder), Iterator(), [](const auto& entry) { return entry.is_regular_file(); });
}

void write_matrix(const std::filesystem::path& file, const Exchange& exchange, MatrixFormat format,
                  const Observer& observer) {
  write(file, form_factors_of(exchange), format, observer);
}

void write_form_factors(const std::filesystem::path& folder, const FormFactorResult& result, const Observer& observer) {
  const Exchange& exchange = result.form_factors.exchange;
  write_whole_folder(folder, is_earlier_form_factors, [&](const std::filesystem::path& in) {
    const bool dense = result.format == MatrixFormat::npy;
    write_matrix(in / (dense ? file_name::dense : file_name::sparse), exchange, result.format, observer);
    if (exchange.half_differences.size() > 0) {
      write(in / (dense ? file_name::dense_error : file_name::sparse_error), sampling_errors_of(exchange),
            result.format, observer);
    }
    if (stores_half_differences(exchange))
      write_npy_numbers(in / file_name::half_differences, exchange.half_differences.codes());
    write_npy(in / file_name::area, exchange.area);
    write_materials(in, result.scene, result.form_factors.plan, result.form_factors.mesh, exchange.area);
    write_shares(in, exchange.lost);
    write_npy(in / file_name::raw_row_sum, exchange.raw_row_sum);
    write_mesh(in / file_name::mesh, result.scene,
               {result.form_factors.mesh, exchange.area, row_sums(exchange.exchange_areas).cwiseQuotient(exchange.area),
                exchange.raw_row_sum});
    for (const GroupFactors& groups : result.groups) {
      write_groups(in / (groups.by == GroupBy::material ? file_name::by_material : file_name::by_object), groups);
    }
    write_stored_scene(in / file_name::scene, result.scene, result.form_factors.plan.sides);
    write_bytes(in / file_name::info, info_json(result));
  });
}

void write_materials(const std::filesystem::path& folder, const Scene& scene, const Plan& plan, const PatchMesh& mesh,
                     const Eigen::VectorXd& exposed_area) {
  const RadiosityProblem problem =
      problem_of(scene, mesh, exposed_area, plan.sides.emit_from_back, reflections_of(plan));
  write_npy(folder / file_name::exitance, problem.exitance.matrix());
  write_npy(folder / file_name::reflectance, problem.scattering.reflectance.matrix());
}

void write_shares(const std::filesystem::path& folder, const LostShare& lost) {
  Eigen::MatrixXd shares(lost.escaped.size(), 4);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(lost.escaped.size());
  shares << lost.escaped, lost.at_backs, lost.covered, lost.overlaid.size() > 0 ? lost.overlaid : none;
  write_npy(folder / file_name::lost_share, shares);
}

void check_form_factors_writable(const std::filesystem::path& folder) {
  check_folder_writable(folder, is_earlier_form_factors);
}

}  // namespace patchlight
