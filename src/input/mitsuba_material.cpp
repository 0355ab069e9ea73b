#include "input/mitsuba_material.h"

#include "patchlight/base/error.h"

#include "input/mitsuba_spectrum.h"
#include "input/reading_limits.h"
#include "input/stated_mirrors.h"
#include "input/stated_panes.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// What is put around another BSDF and changes no diffuse light.
constexpr std::array wrappers = {"twosided", "bumpmap", "bump",         "normalmap", "mask",
                                 "opacity",  "coating", "roughcoating", "blendbsdf", "mixturebsdf"};
// The properties that may say what a surface reflects, the first one counts.
constexpr std::array colours = {"reflectance", "diffusereflectance", "basecolor", "specularreflectance"};
constexpr std::array glass_kinds = {"dielectric", "thindielectric", "roughdielectric"};
constexpr std::array conductors = {"conductor", "roughconductor"};

template <std::size_t N>
bool is_one_of(const std::array<const char*, N>& kinds, const std::string& kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

// Index of refraction, a number or the name of what has it.
double index_in(const MitsubaFile& file, const pugi::xml_node& bsdf, const std::string& name, double otherwise) {
  static const std::map<std::string, double> known = {
      {"vacuum", 1},     {"air", 1.000277}, {"ice", 1.31},           {"water", 1.333},        {"bk7", 1.5046},
      {"quartz", 1.458}, {"pyrex", 1.470},  {"acrylic glass", 1.49}, {"polypropylene", 1.49}, {"diamond", 2.419}};
  const pugi::xml_node property = file.property(bsdf, name);
  if (!property) return otherwise;
  const std::string stated = file.text(property, "value");
  const auto found = known.find(stated);
  if (found != known.end()) return found->second;
  const std::optional<double> number = finite_number(stated);
  if (number && *number > 0) return *number;
  throw InputError(file.place(property),
                   "found '" + stated + "' where an index of refraction is expected, e.g. 1.5 or bk7");
}

// Fresnel's equations square to a conductor: ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
Spectrum fresnel(const Spectrum& eta, const Spectrum& k) {
  return ((eta - 1).square() + k.square()) / ((eta + 1).square() + k.square());
}

class MaterialReader {
 public:
  MaterialReader(const MitsubaFile& file, const std::string& name) : file_(file) {
    read_.material = {name, rgb(0, 0, 0), rgb(0, 0, 0)};
  }

  MitsubaMaterial of(const pugi::xml_node& bsdf, int depth) && {
    add(bsdf, depth);
    return std::move(read_);
  }

 private:
  void simplify(const std::string& what) { read_.simplified.push_back(what); }

  void add(const pugi::xml_node& bsdf, int depth) {
    const std::string kind = file_.text(bsdf, "type");
    if (!bsdf) {
      simplify("surfaces without a BSDF have the reflectance 0.5");
      read_.material.reflectance = rgb(0.5, 0.5, 0.5);
    } else if (is_one_of(wrappers, kind)) {
      if (static_cast<std::size_t>(depth) == reading_limits::nesting)
        throw InputError(file_.place(bsdf), "BSDFs are nested more than 64 deep");
      if (kind != "twosided") simplify(kind + " is left out, what it is put around counts");
      add(file_.nested(bsdf, "bsdf"), depth + 1);
    } else if (is_one_of(glass_kinds, kind)) {
      add_glass(bsdf, kind);
    } else if (is_one_of(conductors, kind)) {
      add_conductor(bsdf, kind);
    } else if (kind == "difftrans") {
      read_.material.diffuse_transmittance = colour(bsdf, "transmittance").value_or(rgb(0.5, 0.5, 0.5));
    } else if (kind == "null") {
      read_.is_nothing = true;
      simplify("null is nothing: such surfaces are left out");
    } else {
      add_matt(bsdf, kind);
    }
  }

  std::optional<Spectrum> colour(const pugi::xml_node& bsdf, const std::string& name) {
    const pugi::xml_node property = file_.property(bsdf, name);
    const std::optional<MitsubaColour> found = mitsuba_colour(file_, property);
    if (!found) return std::nullopt;
    if (!found->simplified.empty()) simplify(found->simplified);
    return found->value;
  }

  void add_matt(const pugi::xml_node& bsdf, const std::string& kind) {
    std::optional<Spectrum> found;
    for (const char* const name : colours) {
      if (!found) found = colour(bsdf, name);
    }
    const bool is_matt = kind == "diffuse" || kind == "lambertian";
    if (!is_matt) simplify(kind + (found ? " becomes matt" : " has no reflectance that is known, 0.5 is taken"));
    read_.material.reflectance = found.value_or(rgb(0.5, 0.5, 0.5)).min(1).max(0);
  }

  // A pane of that index which absorbs nothing, or colours the light.
  void add_glass(const pugi::xml_node& bsdf, const std::string& kind) {
    const double inside = index_in(file_, bsdf, "intior", 1.5046);
    const double outside = index_in(file_, bsdf, "extior", 1.000277);
    const double index = plausible_index(std::max(inside / outside, outside / inside));
    const Spectrum share = colour(bsdf, "speculartransmittance").value_or(rgb(1, 1, 1)) * highest_transmittance(index);
    if (kind == "dielectric") simplify("dielectric surfaces are thin clear panes, which do not bend light");
    if (kind == "roughdielectric") simplify("roughdielectric lets light straight through, without scattering it");
    read_.material = as_pane(std::move(read_.material), share, index, kind);
  }

  // Reflectance square to the surface; by name where there are no optical constants.
  Spectrum metal_reflectance(const pugi::xml_node& bsdf) {
    static const std::map<std::string, Spectrum> known = {{"none", rgb(1, 1, 1)},        {"Ag", rgb(0.97, 0.96, 0.92)},
                                                          {"Al", rgb(0.91, 0.92, 0.92)}, {"Au", rgb(1, 0.77, 0.34)},
                                                          {"Cu", rgb(0.95, 0.64, 0.54)}, {"Cr", rgb(0.55, 0.56, 0.55)},
                                                          {"Ni", rgb(0.66, 0.61, 0.53)}};
    const std::optional<Spectrum> eta = colour(bsdf, "eta");
    const std::optional<Spectrum> k = colour(bsdf, "k");
    if (eta && k) return fresnel(*eta / index_in(file_, bsdf, "exteta", 1), *k / index_in(file_, bsdf, "exteta", 1));
    const auto found = known.find(file_.word(bsdf, "material", "Cu"));
    if (found != known.end()) return found->second;
    simplify("a metal that is not known by name reflects 0.9");
    return rgb(0.9, 0.9, 0.9);
  }

  void add_conductor(const pugi::xml_node& bsdf, const std::string& kind) {
    const Spectrum reflected =
        (colour(bsdf, "specularreflectance").value_or(rgb(1, 1, 1)) * metal_reflectance(bsdf)).min(1).max(0);
    if (kind == "conductor") {
      read_.material.reflectance = reflected;
      read_.material = as_mirror(std::move(read_.material), reflected, rgb(0, 0, 0), kind);
      return;
    }
    simplify(kind + " becomes matt");
    read_.material.reflectance = reflected;
  }

  const MitsubaFile& file_;
  MitsubaMaterial read_;
};

}  // namespace

MitsubaMaterial mitsuba_material(const MitsubaFile& file, const pugi::xml_node& bsdf, const std::string& name) {
  return MaterialReader(file, name).of(bsdf, 0);
}

}  // namespace patchlight
