#pragma once

#include "patchlight/form_factors.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// What makes patches a group.
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

}  // namespace patchlight
