#include "accuracy/interest.h"

#include "patchlight/base/error.h"

#include "accuracy/spaces.h"
#include "base/vectors.h"

#include <algorithm>
#include <optional>
#include <set>

namespace patchlight {
namespace {

constexpr const char* inside = ".inside";
constexpr const char* outside = ".outside";

std::set<std::string> names_in(const Scene& scene) {
  std::set<std::string> known(scene.groups.begin(), scene.groups.end());
  for (const Material& material : scene.materials) known.insert(material.name);
  return known;
}

// A material, object or group, or one side of it.
struct Interest {
  std::string name;
  std::optional<bool> is_inside = {};  // nothing: both sides
};

// What is called "room.inside" itself is meant before the inside of "room".
Interest interest_named(const std::string& name, const std::set<std::string>& known) {
  if (known.contains(name)) return {name};
  for (const std::string side : {inside, outside}) {
    if (name.ends_with(side)) return {name.substr(0, name.size() - side.size()), side == inside};
  }
  return {name};
}

std::vector<Interest> interests_named(const Scene& scene, const std::vector<std::string>& names) {
  const std::set<std::string> known = names_in(scene);
  std::vector<Interest> interests;
  for (const std::string& name : names) interests.push_back(interest_named(name, known));
  return interests;
}

bool is_of(const Scene& scene, const PatchMesh& mesh, PatchIndex i, const Interest& interest) {
  const std::uint32_t group = scene.polygons[mesh.polygon[i]].group;
  return scene.materials[mesh.material[i]].name == interest.name ||
         (group < scene.groups.size() && scene.groups[group] == interest.name);
}

}  // namespace

Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names) {
  if (names.empty()) return Eigen::VectorXd::Ones(mesh.size());
  const std::vector<Interest> interests = interests_named(scene, names);
  const bool sides =
      std::any_of(interests.begin(), interests.end(), [](const Interest& i) { return i.is_inside.has_value(); });
  const Eigen::VectorXd within = sides ? inside_shells(scene, mesh, Dividing::all) : Eigen::VectorXd();
  Eigen::VectorXd interest(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const auto counts = [&](const Interest& one) {
      return is_of(scene, mesh, i, one) && (!one.is_inside || *one.is_inside == (within[i] == 1));
    };
    interest[i] = std::any_of(interests.begin(), interests.end(), counts) ? 1 : 0;
  }
  return interest;
}

void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest) {
  if ((interest.array() == 1).all()) return;
  const Field even = interest.array().replicate(1, problem.exitance.cols());
  if ((highest(problem.scattering.reflect(even)) > 0).any()) return;
  throw InputError(scene.file,
                   "found nothing that reflects light among what is of interest; expected a material, object or group "
                   "with a reflectance above 0, as an accuracy is that of reflected light");
}

void require_names(const Scene& scene, const std::vector<std::string>& names) {
  const std::set<std::string> known = names_in(scene);
  for (const std::string& name : names) {
    if (known.contains(interest_named(name, known).name)) continue;
    std::string all;
    for (const std::string& other : known) all += (all.empty() ? "" : ", ") + other;
    throw InputError(scene.file, "found no material, object or group '" + name +
                                     "' to be interested in; expected one of " + all +
                                     ", or one of these with .inside or .outside");
  }
}

}  // namespace patchlight
