#include "accuracy/interest.h"

#include "patchlight/base/error.h"

#include "accuracy/spaces.h"
#include "base/near_match.h"
#include "base/vectors.h"
#include "scene/room_body.h"

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
  for (const NamedRoom& room : scene.rooms) known.insert(room.name);
  return known;
}

// "a, b, c and 12 more, which patchlight check --all lists"
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t few = 20;
  std::string list;
  for (std::size_t k = 0; k < std::min(few, names.size()); ++k) list += (k == 0 ? "" : ", ") + names[k];
  if (names.size() <= few) return list;
  return list + " and " + std::to_string(names.size() - few) + " more, which patchlight check --all lists";
}

// A material, object, group or room, or one side of it.
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

// Of the rooms of this name, per patch whether it faces into one.
std::vector<bool> facing_into(const Scene& scene, const PatchMesh& mesh, const std::string& name) {
  std::vector<bool> faces(mesh.size(), false);
  for (const NamedRoom& room : scene.rooms) {
    if (room.name != name) continue;
    const RoomBody body(room.faces);
    for (PatchIndex i = 0; i < mesh.size(); ++i)
      faces[i] = faces[i] || body.holds(mesh.centroid[i] + body.step() * mesh.normal[i]);
  }
  return faces;
}

bool is_of(const Scene& scene, const PatchMesh& mesh, PatchIndex i, const Interest& interest) {
  const std::uint32_t group = scene.polygons[mesh.polygon[i]].group;
  return scene.materials[mesh.material[i]].name == interest.name ||
         (group < scene.groups.size() && scene.groups[group] == interest.name);
}

// 1 for each patch of what is named, on whichever side of it. A side alone means that of everything.
Eigen::VectorXd meant_by(const Scene& scene, const PatchMesh& mesh, const Interest& interest) {
  if (interest.name.empty()) return Eigen::VectorXd::Ones(mesh.size());
  const std::vector<bool> into_room = facing_into(scene, mesh, interest.name);
  Eigen::VectorXd meant(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) meant[i] = is_of(scene, mesh, i, interest) || into_room[i];
  return meant;
}

// By daylight there is so much more light outside that an error relative to all of it says nothing of the rooms.
Eigen::VectorXd interest_by_default(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& enclosed) {
  for (PatchIndex i = 0; i < enclosed.size(); ++i) {
    if (enclosed[i] == 1 && (scene.materials[mesh.material[i]].reflectance > 0).any()) return enclosed;
  }
  return Eigen::VectorXd::Ones(mesh.size());
}

}  // namespace

Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names,
                            const Eigen::VectorXd& enclosed) {
  if (names.empty()) return interest_by_default(scene, mesh, enclosed);
  const std::vector<Interest> interests = interests_named(scene, names);
  const bool sides =
      std::any_of(interests.begin(), interests.end(), [](const Interest& i) { return i.is_inside.has_value(); });
  const Eigen::VectorXd within = sides ? inside_shells(scene, mesh, Dividing::all) : Eigen::VectorXd();
  Eigen::VectorXd interest = Eigen::VectorXd::Zero(mesh.size());
  for (const Interest& one : interests) {
    const Eigen::VectorXd meant = meant_by(scene, mesh, one);
    const bool by_shells = enclosed.size() == 0 || (sides && total(meant.cwiseProduct(within)) > 0);
    const Eigen::VectorXd& inner = by_shells ? within : enclosed;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (meant[i] == 1 && (!one.is_inside || *one.is_inside == (inner[i] == 1))) interest[i] = 1;
    }
  }
  return interest;
}

void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest) {
  if ((interest.array() == 1).all()) return;
  const Field even = interest.array().replicate(1, problem.exitance.cols());
  if ((highest(problem.scattering.reflect(even)) > 0).any()) return;
  throw InputError(scene.file, "the surfaces of accuracy.interest reflect no light, of which the accuracy is measured");
}

void require_names(const Scene& scene, const std::vector<std::string>& names) {
  const std::set<std::string> known = names_in(scene);
  for (const std::string& name : names) {
    if (name == inside || name == outside || known.contains(interest_named(name, known).name)) continue;
    const std::vector<std::string> all(known.begin(), known.end());
    const std::string hint = suggestion(name, all);
    std::string message = "no material, object, group or room is called '" + name + "'";
    message += hint;
    message += hint.empty() ? "; expected one of " + first_of(all) : " Expected a name";
    message += ", or one with .inside or .outside";
    throw InputError(scene.file, message);
  }
}

}  // namespace patchlight
