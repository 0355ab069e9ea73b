#include "accuracy/spaces.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "base/vectors.h"
#include "base/words.h"
#include "form_factor/patch_shape.h"
#include "scene/room_body.h"
#include "scene/solids.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// Walks from each place.
constexpr std::uint32_t usual_walks = 16;

std::vector<Ray> onward(const std::vector<FacingPlace>& places, std::uint32_t walks, std::uint32_t key) {
  const auto samples = scrambled_sobol(walks, key);
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vector direction = cosine_direction(places[k].normal, samples[k][0], samples[k][1]);
    rays.push_back({places[k].point, direction, places[k].polygon});
  }
  return rays;
}

// A space that is much lower than its faces are wide is a gap, not a room, e.g. below a building that does not touch
// the ground: most rays end nearer than a hundredth of the size of the face.
bool is_gap(std::span<const std::optional<Hit>> hits, double face_area) {
  const double limit = 0.01 * std::sqrt(face_area);
  const auto count = std::count_if(hits.begin(), hits.end(),
                                   [&](const std::optional<Hit>& hit) { return hit && hit->distance < limit; });
  return 2 * static_cast<std::size_t>(count) > hits.size();
}

// True when fewer than half of the random walks from the place with this key leave the scene within four reflections.
// False in a gap in front of a face of this area, m^2.
bool is_enclosed(const Scene& scene, const Occluder& faces, const FacingPlace& from, std::size_t key, double face_area,
                 std::uint32_t walks) {
  std::vector<FacingPlace> places(walks, from);
  for (std::uint32_t k = 0; k < 4; ++k) {
    const auto hits = faces.first_hits(onward(places, walks, hash({stream::enclosure, key, k})));
    if (k == 0 && is_gap(hits, face_area)) return false;
    std::vector<FacingPlace> next;
    for (const std::optional<Hit>& hit : hits) {
      if (!hit) continue;
      const Vector front = front_normal(scene, hit->polygon);
      next.push_back({hit->point, hit->side == Side::front ? front : Vector(-front), hit->polygon});
    }
    places = std::move(next);
    if (2 * places.size() <= walks) return false;
  }
  return true;
}

}  // namespace

Eigen::VectorXd enclosed_patches(const Scene& scene, const Occluder& faces, const PatchMesh& mesh) {
  // In a very large mesh, fewer walks reduce the confidence only for patches at a space's border.
  const std::uint32_t walks = mesh.size() > 50000 ? 4 : usual_walks;
  std::vector<double> face_area;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) face_area.push_back(polygon_area(scene, p));
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  Eigen::VectorXd enclosed(mesh.size());
  parallel_for(mesh.size(), [&](std::size_t k) {
    const auto patch = static_cast<PatchIndex>(k);
    const PolygonIndex polygon = mesh.polygon[patch];
    const FacingPlace place{mesh.centroid[patch], mesh.normal[patch], polygon};
    enclosed[patch] = is_enclosed(scene, faces, place, keys[patch], face_area[polygon], walks) ? 1 : 0;
  });
  return enclosed;
}

std::vector<std::uint8_t> enclosed_places(const Scene& scene, const Occluder& faces,
                                          std::span<const FacingPlace> places) {
  std::vector<std::uint8_t> enclosed(places.size(), 0);
  parallel_for(places.size(),
               [&](std::size_t k) { enclosed[k] = is_enclosed(scene, faces, places[k], k, 0, usual_walks) ? 1 : 0; });
  return enclosed;
}

namespace {

bool divides(const Scene& scene, const Solid& solid, Dividing by) {
  const bool opaque =
      std::any_of(solid.polygons.begin(), solid.polygons.end(), [&](PolygonIndex p) { return !is_opening(scene, p); });
  return opaque && (solid.has_opening || by == Dividing::all);
}

// A shell, and the sides of its own polygons.
struct Shell {
  const Solid& solid;
  std::vector<std::uint8_t> inner;  // at 2 * polygon + side: 0 not of the shell, 1 faces its inside, 2 its outside

  bool is_inside(const PatchMesh& mesh, PatchIndex i) const;
};

Shell shell_of(const Scene& scene, const Shells& shells, const Solid& solid) {
  std::vector<std::uint8_t> inner(2 * scene.polygons.size(), 0);
  for (const PolygonIndex p : solid.polygons) {
    const auto side = static_cast<std::size_t>(inner_side(solid, shells, p));
    inner[2 * std::size_t{p} + side] = 1;
    inner[2 * p + 1 - side] = 2;
  }
  return {solid, std::move(inner)};
}

bool Shell::is_inside(const PatchMesh& mesh, PatchIndex i) const {
  const std::uint8_t own = inner[2 * std::size_t{mesh.polygon[i]} + static_cast<std::size_t>(mesh.side[i])];
  if (own != 0) return own == 1;
  return holds(solid, mesh.centroid[i] + tolerance_of_coordinates * solid.box.diagonal().norm() * mesh.normal[i]);
}

}  // namespace

Eigen::VectorXd inside_patches(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh,
                               const Eigen::VectorXd& enclosed) {
  return enclosed.size() > 0 ? enclosed : inside_shells(scene, sides, mesh, Dividing::with_openings);
}

Eigen::VectorXd inside_shells(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh, Dividing by) {
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(scene, sides);
  std::vector<Shell> dividing;
  for (const Solid& solid : geometry->solids) {
    if (divides(scene, solid, by)) dividing.push_back(shell_of(scene, geometry->shells, solid));
  }
  Eigen::VectorXd inside = Eigen::VectorXd::Zero(mesh.size());
  if (dividing.empty()) return inside;
  parallel_for(mesh.size(), [&](std::size_t k) {
    const auto i = static_cast<PatchIndex>(k);
    const auto holds_it = [&](const Shell& shell) { return shell.is_inside(mesh, i); };
    if (std::any_of(dividing.begin(), dividing.end(), holds_it)) inside[i] = 1;
  });
  return inside;
}

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
  return first_few(names, few) + (names.size() > few ? ", which patchlight check --all lists" : "");
}

// A material, object, group or room, or one side of it.
struct Interest {
  std::string name;
  std::optional<bool> is_inside = {};  // nothing: both sides
};

// A part called "room.inside" itself comes before the inside of "room".
Interest interest_named(const std::string& name, const std::set<std::string>& known) {
  if (known.contains(name)) return {name};
  for (const std::string side : {inside, outside}) {
    if (name.ends_with(side)) return {name.substr(0, name.size() - side.size()), side == inside};
  }
  return {name};
}

// Per patch: whether it faces into a room of this name.
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

// 1 for each patch of the named parts, on either side. A side without a name means that side of all parts.
Eigen::VectorXd meant_by(const Scene& scene, const PatchMesh& mesh, const Interest& interest) {
  if (interest.name.empty()) return Eigen::VectorXd::Ones(mesh.size());
  const std::vector<bool> into_room = facing_into(scene, mesh, interest.name);
  Eigen::VectorXd meant(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) meant[i] = is_of(scene, mesh, i, interest) || into_room[i];
  return meant;
}

// By daylight there is much more light outside, so an error relative to all of it would hide the errors in the rooms.
Eigen::VectorXd interest_by_default(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& enclosed) {
  for (PatchIndex i = 0; i < enclosed.size(); ++i) {
    if (enclosed[i] == 1 && (scene.materials[mesh.material[i]].reflectance > 0).any()) return enclosed;
  }
  return Eigen::VectorXd::Ones(mesh.size());
}

}  // namespace

Eigen::VectorXd interest_of(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh,
                            const std::vector<std::string>& names, const Eigen::VectorXd& enclosed) {
  if (names.empty()) return interest_by_default(scene, mesh, enclosed);
  const std::set<std::string> known = names_in(scene);
  std::vector<Interest> interests;
  for (const std::string& name : names) interests.push_back(interest_named(name, known));
  const bool by_side =
      std::any_of(interests.begin(), interests.end(), [](const Interest& i) { return i.is_inside.has_value(); });
  const Eigen::VectorXd within = by_side ? inside_shells(scene, sides, mesh, Dividing::all) : Eigen::VectorXd();
  Eigen::VectorXd interest = Eigen::VectorXd::Zero(mesh.size());
  for (const Interest& one : interests) {
    const Eigen::VectorXd meant = meant_by(scene, mesh, one);
    const bool by_shells = enclosed.size() == 0 || (by_side && total(meant.cwiseProduct(within)) > 0);
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
  throw InputError(scene.file,
                   "the surfaces of accuracy.interest reflect no light; the accuracy is that of reflected light");
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
