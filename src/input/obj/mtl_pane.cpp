#include "input/obj/mtl_pane.h"

#include "base/rounded.h"
#include "input/stated_panes.h"

namespace patchlight {
namespace {

// Refraction, with ray tracing or without.
bool is_of_glass(int illumination) {
  return illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9;
}

std::string shown(const Spectrum& filter) {
  return "Tf " + rounded(filter[0]) + " " + rounded(filter[1]) + " " + rounded(filter[2]);
}

MtlPane pane_with(const MtlTransparency& stated, const Spectrum& transmittance, std::string statement) {
  return {transmittance, plausible_index(stated.index.value_or(usual_index)), std::move(statement)};
}

// What goes through by d or Tr, coloured by Tf: one of 0 is a default that would make the material opaque.
MtlPane filtered(const MtlTransparency& stated, double share, const std::string& statement) {
  const bool is_coloured = stated.filter && (*stated.filter > 0).any() && (*stated.filter != 1).any();
  if (!is_coloured) return pane_with(stated, Spectrum::Constant(3, share), statement);
  return pane_with(stated, share * *stated.filter, statement + " and " + shown(*stated.filter));
}

}  // namespace

std::optional<MtlPane> mtl_pane(const MtlTransparency& stated) {
  if (is_contradictory(stated)) return std::nullopt;
  if (stated.dissolve) {
    const double d = *stated.dissolve;
    return d >= 0 && d < 1 ? std::optional(filtered(stated, 1 - d, "d " + rounded(d))) : std::nullopt;
  }
  if (stated.transparency) {
    const double tr = *stated.transparency;
    return tr > 0 && tr <= 1 ? std::optional(filtered(stated, tr, "Tr " + rounded(tr))) : std::nullopt;
  }
  if (!is_of_glass(stated.illumination) || !stated.filter) return std::nullopt;
  if (!(*stated.filter > 0).any() || (*stated.filter >= 1).all()) return std::nullopt;
  return pane_with(stated, *stated.filter, shown(*stated.filter) + " and illum " + std::to_string(stated.illumination));
}

bool is_contradictory(const MtlTransparency& stated) {
  if (!stated.dissolve || !stated.transparency) return false;
  return (*stated.dissolve >= 1 && *stated.transparency > 0) || (*stated.dissolve <= 0 && *stated.transparency <= 0);
}

}  // namespace patchlight
