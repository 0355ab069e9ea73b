#include "patchlight/base/error.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/radiance/radiance_material.h"
#include "input/radiance/radiance_programs.h"
#include "input/radiance/radiance_text.h"
#include "input/read_model.h"
#include "input/round_shapes.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

Point point_at(const RadiancePrimitive& primitive, std::size_t k) {
  return {primitive.numbers[k], primitive.numbers[k + 1], primitive.numbers[k + 2]};
}

FacetedShape turned_inside_out(FacetedShape shape) {
  for (std::vector<std::uint32_t>& face : shape.faces) std::reverse(face.begin(), face.end());
  return shape;
}

FacetedShape outline_of(const RadiancePrimitive& primitive) {
  FacetedShape shape;
  for (std::size_t k = 0; k < primitive.numbers.size(); k += 3) shape.points.push_back(point_at(primitive, k));
  shape.faces.emplace_back(shape.points.size());
  std::iota(shape.faces[0].begin(), shape.faces[0].end(), 0U);
  return shape;
}

// A cone, or a cylinder with one radius for both ends.
FacetedShape cone_of(const RadiancePrimitive& primitive) {
  const double first = primitive.numbers[6];
  return faceted_cone(point_at(primitive, 0), point_at(primitive, 3), first,
                      primitive.numbers.size() > 7 ? primitive.numbers[7] : first);
}

FacetedShape ring_of(const RadiancePrimitive& primitive) {
  const auto [inner, outer] = std::minmax(primitive.numbers[6], primitive.numbers[7]);
  return faceted_ring(point_at(primitive, 0), point_at(primitive, 3), inner, outer);
}

void require_arguments(const RadiancePrimitive& primitive, const std::string& where) {
  const std::size_t found = primitive.numbers.size();
  const std::string start = primitive.kind + " " + primitive.name + " has " + std::to_string(found) + " numbers; ";
  if (primitive.kind == "polygon") {
    if (found >= 9 && found % 3 == 0) return;
    throw InputError(where, start + "expected three for each of its corners, nine at least");
  }
  const bool is_sphere = primitive.kind == "sphere" || primitive.kind == "bubble";
  const bool is_cylinder = primitive.kind == "cylinder" || primitive.kind == "tube";
  const std::size_t expected = is_sphere ? 4 : is_cylinder ? 7 : 8;
  if (found != expected) throw InputError(where, start + "expected " + std::to_string(expected));
  const double least = *std::min_element(primitive.numbers.begin() + (is_sphere ? 3 : 6), primitive.numbers.end());
  if (least < 0)
    throw InputError(where, primitive.kind + " " + primitive.name + " has a negative radius; expected 0 or more");
}

// True for surfaces with geometry of their own.
bool is_radiance_surface(const std::string& kind) {
  constexpr std::array surfaces = {"polygon", "sphere", "bubble", "cylinder", "tube", "cone", "cup", "ring"};
  return std::find(surfaces.begin(), surfaces.end(), kind) != surfaces.end();
}

// True for surfaces that are replaced by facets.
bool is_round(const std::string& kind) { return is_radiance_surface(kind) && kind != "polygon"; }

// The faces of such a surface, in units of the file; a polygon has one. Throws InputError at `where` for a wrong number
// of arguments, or for a length or radius that is not positive.
FacetedShape radiance_surface(const RadiancePrimitive& primitive, const std::string& where) {
  require_arguments(primitive, where);
  const std::string& kind = primitive.kind;
  if (kind == "polygon") return outline_of(primitive);
  FacetedShape shape;
  if (kind == "sphere" || kind == "bubble") {
    if (primitive.numbers[3] > 0) shape = faceted_sphere(point_at(primitive, 0), primitive.numbers[3]);
  } else {
    shape = kind == "ring" ? ring_of(primitive) : cone_of(primitive);
  }
  if (shape.faces.empty())
    throw InputError(where, kind + " " + primitive.name +
                                " has no area; expected radii above 0 and two places, or a "
                                "direction, that are not one");
  const bool is_inside_out = kind == "bubble" || kind == "tube" || kind == "cup";
  return is_inside_out ? turned_inside_out(std::move(shape)) : shape;
}

// Light from infinity, from the disk of a Radiance source on the sphere of directions.
struct FarSource {
  std::string name;
  Vector direction;          // unit, toward the source
  double degrees = 0;        // angular diameter
  Spectrum radiance{};       // W/(m^2 sr)
  bool has_pattern = false;  // the radiance varies
};

constexpr double most_degrees_of_a_sun = 5;

// A hemisphere around the vertical, or the full sphere.
bool is_sky(const FarSource& source) {
  const bool is_half = source.degrees >= 179.9 && std::abs(source.direction.z()) > 0.999;
  return !source.has_pattern && (is_half || source.degrees >= 359);
}

// E = L pi sin^2(a / 2) normal to a disk of angular diameter a: 6.7967e-5 sr for the sun's 0.533 degrees.
Sun far_sun(const FarSource& source) {
  const double radius = source.degrees * std::numbers::pi / 360;
  return {source.direction, source.radiance * std::numbers::pi * std::pow(std::sin(radius), 2)};
}

Sky with_half(Sky sky, const FarSource& source) {
  const bool is_all = source.degrees >= 359;
  if (is_all || source.direction.z() > 0) sky.zenith_radiance = source.radiance;
  if (is_all || source.direction.z() < 0) sky.ground_radiance = source.radiance;
  return sky;
}

// Reads a source primitive, rotated by `turn`, without its radiance. Throws InputError at `where` without four numbers,
// a direction or an angle.
FarSource far_source(const RadiancePrimitive& primitive, const Eigen::Matrix3d& turn, const std::string& where) {
  if (primitive.numbers.size() != 4)
    throw InputError(where, "source " + primitive.name + " has " + std::to_string(primitive.numbers.size()) +
                                " numbers; expected a direction and an angle in degrees, 4");
  const Vector direction = turn * Vector(primitive.numbers[0], primitive.numbers[1], primitive.numbers[2]);
  const double degrees = primitive.numbers[3];
  if (!(direction.stableNorm() > 0) || !std::isfinite(direction.stableNorm()) || !(degrees > 0 && degrees <= 360))
    throw InputError(where, "source " + primitive.name + " has no direction, or no angle above 0 up to 360 degrees");
  return {primitive.name, direction.stableNormalized(), degrees};
}

// Adds supported sources: the first disk up to 5 degrees becomes the sun, uniform hemispheres become a uniform sky and
// the ground. Notes list the others, with advice for skies.
Scene with_far_sources(Scene scene, const std::vector<FarSource>& sources) {
  LeftOut left_out;
  for (const FarSource& source : sources) {
    const std::string name = "source " + source.name;
    if (source.degrees <= most_degrees_of_a_sun && !source.has_pattern && !scene.sun) {
      scene.sun = far_sun(source);
      scene.diagnostics.push_back(
          {DiagnosticCode::simplified_light, name + " of " + rounded(source.degrees) + " degrees is the sun"});
    } else if (is_sky(source)) {
      scene.sky =
          with_half(scene.sky.value_or(Sky{.zenith_radiance = rgb(0, 0, 0), .ground_radiance = rgb(0, 0, 0)}), source);
    } else if (source.degrees > most_degrees_of_a_sun) {
      left_out.lose(
          "sources of light that varies, or that are no half sphere, are left out: --sky gives a sky, e.g. --sky "
          "overcast:10000lx",
          name + " of " + rounded(source.degrees) + " degrees");
    } else {
      left_out.lose("sources are left out beside a sun, or with a pattern", name);
    }
  }
  return left_out.on(std::move(scene));
}

namespace fs = std::filesystem;

// The placement of objects below an !xform.
struct Frame {
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  std::string modifier;  // replaces the modifiers of surfaces; empty: none
  std::string prefix;
  bool turns_fronts = false;
  std::uint32_t line = 0;  // line in the main file; 0 in the main file itself
};

// If both frames name a modifier, the outer one wins: it is applied last.
Frame inside(const Frame& outer, const RadianceXform& xform, const Eigen::Affine3d& copy, std::uint32_t line) {
  return {outer.placement * copy, outer.modifier.empty() ? xform.modifier : outer.modifier,
          xform.name.empty() ? outer.prefix : outer.prefix + xform.name + ".", outer.turns_fronts != xform.turns_fronts,
          outer.line == 0 ? line : outer.line};
}

class RadianceReader {
 public:
  RadianceReader(double metres_per_unit, fs::path confine, RadianceModifiers known)
      : confine_(std::move(confine)), modifiers_(std::move(known)) {
    scene_.metres_per_unit = metres_per_unit;
    top_.placement.linear() *= metres_per_unit;
  }

  FileModel model(const fs::path& file) && {
    scene_.file = file.string();
    scene_.up = Vector::UnitZ();
    scene_.up_stated = true;
    read(file, top_, file.string());
    scene_.sha256 = sha256(digests_);
    scene_ = with_far_sources(std::move(scene_), sources_);
    scene_ = left_out_.on(std::move(scene_));
    return {with_used_materials(std::move(scene_)), std::move(modifiers_)};
  }

 private:
  // Reads a file once, even if several files name it.
  const std::string& text_of(const fs::path& file, const std::string& where) {
    const auto [found, is_new] = texts_.try_emplace(file.lexically_normal().string());
    if (is_new) {
      found->second = read_text(file, where, file.string());
      if (!digests_.empty()) scene_.inputs.push_back(file);
      digests_.push_back(sha256({&found->second, 1}));
    }
    return found->second;
  }

  // Looks beside the file that names it, then in the current folder.
  fs::path found_file(const std::string& name, const fs::path& named_by, const std::string& where) const {
    const fs::path beside = named_by.parent_path() / name;
    for (const fs::path& candidate : {beside, fs::path(name)}) {
      require_within(confine_, candidate, where);
      std::error_code error;
      if (fs::is_regular_file(candidate, error)) return candidate;
    }
    throw InputError(where,
                     "names the file " + name +
                         ", which is neither beside it nor in the current folder\nhint: put it there, or take it out");
  }

  void read(const fs::path& file, const Frame& frame, const std::string& where) {
    std::error_code error;
    const fs::path place = fs::weakly_canonical(file, error);
    if (std::find(open_.begin(), open_.end(), place) != open_.end())
      throw InputError(where, "names " + file.string() + ", which names this file again; a file cannot hold itself");
    if (open_.size() == reading_limits::nesting) throw InputError(where, "files name each other more than 64 deep");
    if (++files_ > reading_limits::files) throw InputError(where, "more than 200,000 files are named, counting copies");
    open_.push_back(place);
    RadianceText text(text_of(file, where), file.string());
    while (text.has_more()) {
      const RadiancePrimitive primitive = text.next();
      const std::string here = at_line(file, primitive.line);
      if (primitive.kind == "!") {
        run(primitive, file, frame);
      } else if (primitive.kind == "instance" || primitive.kind == "mesh") {
        add_instance(primitive, file, frame);
      } else if (primitive.kind == "source") {
        add_source(primitive, frame, here);
      } else if (is_radiance_surface(primitive.kind)) {
        add_surface(primitive, frame, here, primitive.line);
      } else {
        modifiers_.define(primitive, here);
      }
    }
    open_.pop_back();
  }

  std::vector<std::vector<std::string>> lines_of(const std::string& name, const fs::path& named_by,
                                                 const std::string& where) {
    std::vector<std::vector<std::string>> lines;
    for (const TextLine& line : logical_lines(text_of(found_file(name, named_by, where), where))) {
      std::vector<std::string> all;
      for (const std::string_view word : words_before_comment(line.text)) all.emplace_back(word);
      lines.push_back(std::move(all));
    }
    return lines;
  }

  // A line with programs: genbox and xform are emulated; no program is run.
  void run(const RadiancePrimitive& command, const fs::path& file, const Frame& frame) {
    const std::string where = at_line(file, command.line);
    const std::vector<std::vector<std::string>> stages = piped_commands(command.words[0]);
    const auto is_known = [&](const std::vector<std::string>& words) {
      return words[0] == "xform" || (words[0] == "genbox" && &words == &stages[0]);
    };
    if (stages.empty() || !std::all_of(stages.begin(), stages.end(), is_known)) return lose_program(command, where);
    add_piped(stages, file, frame, command.line);
  }

  void lose_program(const RadiancePrimitive& command, const std::string& where) {
    const std::string text(trimmed(command.words[0]));
    if (text.starts_with("gensky") || text.starts_with("gendaylit"))
      return left_out_.lose(
          "programs that write skies are not run; --sky and --sun give one, e.g. --sky overcast:10000lx",
          where + " !" + text.substr(0, text.find(' ')));
    left_out_.lose(
        "programs other than !genbox and !xform are not run, and their surfaces are left out; replace the lines with "
        "their output",
        where + " !" + text.substr(0, 60));
  }

  // The last program transforms the surfaces of those before it.
  void add_piped(std::span<const std::vector<std::string>> stages, const fs::path& file, const Frame& frame,
                 std::uint32_t line) {
    const std::string where = at_line(file, line);
    const std::span words = std::span(stages.back()).subspan(1);
    if (stages.back()[0] == "genbox") {
      for (const RadiancePrimitive& surface : radiance_genbox(words, where)) add_surface(surface, frame, where, line);
      return;
    }
    const RadianceXform xform = xform_of(words, file, where);
    const bool is_first = stages.size() == 1;
    if (is_first && xform.files.empty()) throw InputError(where, "xform without a file; expected the name of one");
    if (!is_first && !xform.files.empty())
      throw InputError(where, "xform names " + xform.files[0] + " and reads a pipe; expected one of them");
    for (const Eigen::Affine3d& copy : xform.copies) {
      if (++copies_ > reading_limits::copies)
        throw InputError(where, "more than 1,000,000 copies are made; expected smaller arrays");
      const Frame below = inside(frame, xform, copy, line);
      if (!is_first) add_piped(stages.first(stages.size() - 1), file, below, line);
      for (const std::string& name : xform.files) read(found_file(name, file, where), below, where);
    }
  }

  RadianceXform xform_of(std::span<const std::string> words, const fs::path& file, const std::string& where) {
    return radiance_xform(words, where, [&](const std::string& name) { return lines_of(name, file, where); });
  }

  // Octrees and meshes have binary formats; a scene file may replace them.
  void add_instance(const RadiancePrimitive& primitive, const fs::path& file, const Frame& frame) {
    const std::string where = at_line(file, primitive.line);
    if (primitive.words.empty()) throw InputError(where, primitive.kind + " " + primitive.name + " names no file");
    if (fs::path(primitive.words[0]).extension() != ".rad") {
      left_out_.lose("left out, of the kind " + primitive.kind + ", whose octrees and meshes cannot be read",
                     frame.prefix + primitive.name);
      return;
    }
    RadianceXform xform = xform_of(std::span(primitive.words).subspan(1), file, where);
    xform.name = primitive.name;
    if (primitive.modifier != "void") xform.modifier = primitive.modifier;
    for (const Eigen::Affine3d& copy : xform.copies)
      read(found_file(primitive.words[0], file, where), inside(frame, xform, copy, primitive.line), where);
  }

  // The modifier of a surface; empty for void. \throws InputError if undefined.
  std::optional<std::size_t> modifier_of(const RadiancePrimitive& primitive, const Frame& frame,
                                         const std::string& where) const {
    const std::string& name = frame.modifier.empty() ? primitive.modifier : frame.modifier;
    if (name == "void") return std::nullopt;
    if (const auto found = modifiers_.place_of(name)) return found;
    throw InputError(where, "the material " + name + " of " + primitive.kind + " " + primitive.name +
                                " is not defined\nhint: name the file that defines it before this one, e.g. "
                                "'materials.mat room.rad'");
  }

  // Empty for modifiers that light passes unchanged.
  std::optional<MaterialIndex> material_of(std::size_t place) {
    const auto [known, is_new] = index_.emplace(place, std::nullopt);
    if (!is_new) return known->second;
    const RadianceModifier& modifier = modifiers_.at(modifiers_.material_below(place));
    if (modifier.kind == "mist" || modifier.kind == "antimatter") {
      left_out_.add("materials whose surfaces are left out, as they are mist or antimatter", modifier.name);
      return std::nullopt;
    }
    if (modifiers_.has_pattern(place)) left_out_.add("patterns and textures of materials, left out", modifier.name);
    std::optional<RadianceMaterial> material = radiance_material(modifier.kind, modifier.name, modifier.numbers);
    if (!material) {
      material = RadianceMaterial{{modifier.name, rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {}};
      left_out_.add("unsupported materials become matt with reflectance 0.5",
                    modifier.name + " (" + modifier.kind + ")");
    }
    if (!material->simplified.empty()) {
      const std::string sentence = "materials of the kind " + modifier.kind + ": " + material->simplified;
      if (material->loses_light)
        left_out_.lose(sentence, modifier.name);
      else
        left_out_.add(sentence, modifier.name);
    }
    if (modifiers_.varies_in_strength(place) && (material->material.exitance > 0).any()) {
      // Its flux is unknown: ies2rad scales the distribution of a luminaire by the numbers of its light.
      left_out_.lose(
          "lights below a pattern, e.g. by ies2rad, emit nothing: give IES files as [[luminaire]] of kind \"ies\" in a "
          "scene file",
          modifier.name);
      material->material.exitance.setZero();
    }
    known->second = static_cast<MaterialIndex>(scene_.materials.size());
    scene_.materials.push_back(std::move(material->material));
    return known->second;
  }

  void add_surface(const RadiancePrimitive& primitive, const Frame& frame, const std::string& where,
                   std::uint32_t line) {
    const FacetedShape shape = radiance_surface(primitive, where);
    const std::optional<std::size_t> modifier = modifier_of(primitive, frame, where);
    const std::optional<MaterialIndex> material = modifier ? material_of(*modifier) : std::nullopt;
    if (!modifier) left_out_.add("surfaces without a material (void), left out", frame.prefix + primitive.name);
    if (!material) return;
    if (scene_.polygons.size() + shape.faces.size() > reading_limits::polygons)
      throw InputError(where, "there are more than 10,000,000 faces, counting copies; expected smaller arrays");
    if (is_round(primitive.kind)) {
      left_out_.add("round surfaces have " + std::to_string(round_sides) +
                        " sides, moved outward so that areas are kept; of the kind " + primitive.kind,
                    frame.prefix + primitive.name);
    }
    // A reflected copy keeps its front.
    const bool is_mirrored = frame.placement.linear().determinant() < 0;
    const auto placed = [&](const Point& point) { return Point(frame.placement * point); };
    Polygon polygon{.corners = {},
                    .material = *material,
                    .group = groups_.index_of(frame.prefix + primitive.name, scene_.groups),
                    .line = frame.line == 0 ? line : frame.line};
    scene_ = with_shape(std::move(scene_), shape, placed, is_mirrored != frame.turns_fronts, std::move(polygon));
  }

  void add_source(const RadiancePrimitive& primitive, const Frame& frame, const std::string& where) {
    const std::optional<std::size_t> modifier = modifier_of(primitive, frame, where);
    if (!modifier) return;
    const RadianceModifier& light = modifiers_.at(modifiers_.material_below(*modifier));
    FarSource source = far_source(primitive, frame.placement.linear(), where);
    if (light.kind != "light" && light.kind != "glow" && light.kind != "illum") return;
    source.radiance = rgb(light.numbers[0], light.numbers[1], light.numbers[2]);
    source.has_pattern = modifiers_.varies_in_strength(*modifier);
    sources_.push_back(std::move(source));
  }

  fs::path confine_;
  RadianceModifiers modifiers_;
  Scene scene_;
  Frame top_;
  std::vector<fs::path> open_;                                 // open files, each named by the one before
  std::map<std::string, std::string> texts_;                   // of files
  std::vector<std::string> digests_;                           // digests of the files, in reading order
  std::map<std::size_t, std::optional<MaterialIndex>> index_;  // of the used modifiers
  GroupIndex groups_;
  std::vector<FarSource> sources_;
  LeftOut left_out_;
  std::size_t files_ = 0;
  std::size_t copies_ = 0;  // of !xform
};

}  // namespace

FileModel read_radiance(const fs::path& file, double metres_per_unit, const fs::path& confine,
                        RadianceModifiers known) {
  return RadianceReader(metres_per_unit, confine, std::move(known)).model(file);
}

}  // namespace patchlight
