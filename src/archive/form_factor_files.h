#pragma once

#include "patchlight/form_factors.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The property that the patches of a group share.
enum class GroupBy { material, object };

/// "material" or "object".
const char* name_of(GroupBy by);

/// Form factors between groups of patches: F_GH = sum S_ij / A_G over the patches i of G and j of H, the share of what
/// leaves G, all of it equally bright, that arrives at H.
struct GroupFactors {
  GroupBy by = GroupBy::material;
  std::vector<std::string> names;  ///< of the groups that have patches
  Eigen::VectorXd area;            ///< m^2, exposed
  Eigen::MatrixXd form_factor;     ///< rows: from, columns: to
};

/// The form factors between the groups of a scene, each the mean over the area of the group it is from.
GroupFactors group_factors(const Scene& scene, const FormFactors& form_factors, GroupBy by);

/// Writes a CSV: a header with the names of the groups, then per group its name, its area in m^2 and its form factors
/// to all groups. \throws OutputError.
void write_groups(const std::filesystem::path& file, const GroupFactors& groups);

/// How a matrix is stored.
enum class MatrixFormat {
  npy,           ///< numpy's .npy: dense, 32-bit floats
  matrix_market  ///< Matrix Market .mtx: coordinates of the nonzero entries
};

/// The input of write_form_factors().
struct FormFactorResult {
  const Scene& scene;
  const FormFactors& form_factors;
  std::vector<GroupFactors> groups;  ///< the tables to write, if any
  std::string command_line;          ///< for the record
  MatrixFormat format = MatrixFormat::npy;
};

/// Writes the matrix F_ij = S_ij / A_i alone, rows and columns in the order of the patches. \throws OutputError,
/// Canceled.
void write_matrix(const std::filesystem::path& file, const Exchange& exchange, MatrixFormat format,
                  const Observer& observer = {});

/// Writes a folder, whole or not at all: F.npy or F.mtx, area.npy, lost_share.npy, raw_row_sum.npy, mesh.vtp,
/// scene.json, info.json, sampling_error.npy or .mtx where Exchange::half_differences were kept, and the tables
/// by_material.csv and by_object.csv if there are any. docs/reference/outputs/form-factor-folder.md describes them.
/// \throws OutputError, Canceled.
void write_form_factors(const std::filesystem::path& folder, const FormFactorResult& result,
                        const Observer& observer = {});

/// Fails early: \throws OutputError when write_form_factors could not write here.
void check_form_factors_writable(const std::filesystem::path& folder);

/// Stored entries were rounded to float, 6e-8 each: sums and differences of them are off by less than this.
inline constexpr double rounding_of_entries = 1e-5;

/// How stored form factors were made.
struct FormFactorInfo {
  std::string geometry_sha256;  ///< of the patches
  std::string model;            ///< the model's file
  double metres_per_unit = 1;   ///< of the model
  PatchIndex patches = 0;
  MatrixFormat format = MatrixFormat::npy;
  Storage storage = Storage::tiles;  ///< or rays: then neither a matrix nor samples, estimator and counts of it
  int rays = 0;                      ///< AssemblyOptions::rays
  bool is_specular = false;          ///< rays go on from clear faces or mirrors: there are stops
  std::string closure;               ///< the method that closed them; empty if none did
  double max_edge = 0;               ///< meters
  Sides sides = Sides::automatic;
  bool contact_lines = true;                      ///< MeshOptions::contact_lines
  std::optional<std::size_t> contact_line_count;  ///< how many were followed; open where it was not stored
  bool graded_edges = false;                      ///< MeshOptions::graded_edges
  int samples = 8;
  std::uint64_t seed = 1;
  int lost_share_rays = 256;
  Estimator estimator = Estimator::automatic;
  AssemblyCounts counts;
};

/// True when closure changed what was computed.
bool is_closed(const FormFactorInfo& info);

/// Reads info.json of such a folder. \throws InputError.
FormFactorInfo read_form_factor_info(const std::filesystem::path& folder);

/// True for a folder with the files of form factors and no others, which may be replaced.
bool is_earlier_form_factors(const std::filesystem::path& folder);

/// \throws InputError, with a way out, when the form factors are those of other patches.
void require_same_geometry(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh);

/// Writes exitance.npy and reflectance.npy: those of the patches as the scene has them, a column per band.
void write_materials(const std::filesystem::path& folder, const Scene& scene, const Plan& plan, const PatchMesh& mesh,
                     const Eigen::VectorXd& exposed_area);

/// Writes lost_share.npy.
void write_shares(const std::filesystem::path& folder, const LostShare& lost);

/// The stored areas and lost shares of the patches.
struct StoredShares {
  Eigen::VectorXd area;  ///< exposed, m^2
  LostShare lost;
};

/// \throws InputError where areas are not positive, or shares none.
StoredShares read_shares(const std::filesystem::path& folder, const FormFactorInfo& info);

/// Reads the form factors of this mesh. \throws InputError when they belong to another one, or are none.
Exchange read_exchange(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh);

}  // namespace patchlight
