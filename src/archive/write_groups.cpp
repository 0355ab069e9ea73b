#include "archive/group_factors.h"
#include "output/file/write_bytes.h"
#include "output/report/csv_cell.h"
#include "transport/merged.h"

#include <cstdint>
#include <iomanip>
#include <sstream>

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
  constexpr std::uint32_t none = ~std::uint32_t{0};
  // Groups are numbered as they come up among the scene's, those without patches left out.
  std::vector<std::uint32_t> number;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const std::uint32_t group = group_of(scene, mesh, i, by);
    if (group >= number.size()) number.resize(group + 1, none);
    number[group] = 0;
  }
  GroupFactors groups;
  groups.by = by;
  for (std::uint32_t group = 0; group < number.size(); ++group) {
    if (number[group] == none) continue;
    number[group] = static_cast<std::uint32_t>(groups.names.size());
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

}  // namespace patchlight
