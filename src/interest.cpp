#include "interest.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <set>

namespace patchlight {
namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names) {
  if (names.empty()) return Eigen::VectorXd::Ones(mesh.size());
  Eigen::VectorXd interest(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const std::uint32_t group = scene.polygons[mesh.polygon[i]].group;
    const bool of_interest = has(names, scene.materials[mesh.material[i]].name) ||
                             (group < scene.groups.size() && has(names, scene.groups[group]));
    interest[i] = of_interest ? 1 : 0;
  }
  return interest;
}

void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest) {
  if ((interest.array() == 1).all()) return;
  const double highest = (problem.reflectance.colwise() * interest.array()).maxCoeff();
  if (highest > 0) return;
  throw InputError(scene.file,
                   "found nothing that reflects light among what is of interest; expected a material, object or group "
                   "with a reflectance above 0, as an accuracy is that of reflected light");
}

void require_names(const Scene& scene, const std::vector<std::string>& names) {
  std::set<std::string> known(scene.groups.begin(), scene.groups.end());
  for (const Material& material : scene.materials) known.insert(material.name);
  for (const std::string& name : names) {
    if (known.contains(name)) continue;
    std::string all;
    for (const std::string& other : known) all += (all.empty() ? "" : ", ") + other;
    throw InputError(scene.file,
                     "found no material, object or group '" + name + "' to be interested in; expected one of " + all);
  }
}

}  // namespace patchlight
