#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/material_settings.h"
#include "input/tables/read_tables.h"
#include "input/text.h"
#include "input/toml/toml_tables.h"
#include "light/spectra.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

bool is_name_of_light(const TomlValue& value) {
  return value.kind == TomlValue::Kind::text && (value.text == "D65" || value.text == "A");
}

bool names_file(const TomlValue& value) {
  return value.kind == TomlValue::Kind::text && !value.text.empty() && !is_name_of_light(value);
}

// A missing file is reported at the line that names it, a fault in the file at its own line.
SampledSpectrum read_named(const TomlValue& value, const TomlFrame& frame) {
  const std::filesystem::path file = named_file(value, frame);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    refuse(value, "the name of a file of wavelengths and values: there is no file " + file.string());
  return read_spectrum(file);
}

std::shared_ptr<const SampledSpectrum> shared(SampledSpectrum spectrum) {
  return std::make_shared<const SampledSpectrum>(std::move(spectrum));
}

std::shared_ptr<const SampledSpectrum> with_light(std::shared_ptr<const SampledSpectrum> spectrum,
                                                  const TomlValue& value) {
  if (luminance_of_cells(in_cells(*spectrum, Beyond::zero)) > 0) return spectrum;
  refuse(value, "a spectrum with light between 380 and 780 nm");
}

std::shared_ptr<const SampledSpectrum> daylight_of(const TomlValue& value) {
  return daylight_spectrum(
      within(value, coolest_daylight, hottest_daylight, "the color temperature of daylight, 4000 to 25000 K"));
}

std::shared_ptr<const SampledSpectrum> of_temperature(const TomlValue& table) {
  allow_keys(table, {"kelvin", "daylight"});
  const std::string key = one_of(table, {"kelvin", "daylight"});
  const TomlValue& value = *find(table, key);
  if (key == "daylight") return daylight_of(value);
  return planckian_spectrum(within(value, 500, 1e5, "the temperature of a black body, 500 to 100000 K"));
}

std::vector<double> edges_of(const TomlValue& value) {
  const std::string expected = "two or more increasing wavelengths from 380 to 780 nm";
  if (value.kind != TomlValue::Kind::list || value.items.size() < 2) refuse(value, expected);
  std::vector<double> edges = numbers(value, value.items.size(), expected);
  const bool grow = std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) == edges.end();
  if (!grow || edges.front() < shortest_wavelength || edges.back() > longest_wavelength) refuse(value, expected);
  return edges;
}

void add_file(std::vector<std::filesystem::path>& files, const TomlValue* value, const TomlFrame& frame) {
  if (value != nullptr && names_file(*value)) files.push_back(named_file(*value, frame));
}

}  // namespace

bool is_by_wavelength(const TomlValue& value) {
  return value.kind == TomlValue::Kind::text || value.kind == TomlValue::Kind::table;
}

std::shared_ptr<const SampledSpectrum> sampled_share(const TomlValue& value, const TomlFrame& frame) {
  if (!names_file(value)) refuse(value, "a number, [R, G, B], or a file of wavelengths and values, e.g. \"paint.csv\"");
  SampledSpectrum spectrum = read_named(value, frame);
  const auto above = std::find_if(spectrum.values.begin(), spectrum.values.end(), [](double v) { return v > 1; });
  if (above == spectrum.values.end()) return shared(std::move(spectrum));
  const double wavelength = spectrum.wavelengths[static_cast<std::size_t>(above - spectrum.values.begin())];
  throw InputError(value.where, value.name + ": found " + shortest(*above) + " at " + shortest(wavelength) + " nm in " +
                                    spectrum.name + "; expected 0 to 1 at every wavelength: divide percents by 100");
}

std::shared_ptr<const SampledSpectrum> sampled_exitance(const TomlValue& value, const TomlFrame& frame) {
  if (!names_file(value))
    refuse(value,
           "a number, [R, G, B], or a file of wavelengths and values per nm; for a light of known strength give "
           "the spectrum separately, e.g. spectrum = {kelvin = 2700}");
  return with_light(shared(read_named(value, frame)), value);
}

std::shared_ptr<const SampledSpectrum> light_spectrum(const TomlValue& value, const TomlFrame& frame) {
  if (value.kind == TomlValue::Kind::table) return with_light(of_temperature(value), value);
  if (is_name_of_light(value)) return value.text == "A" ? illuminant_a_spectrum() : illuminant_d65_spectrum();
  if (!names_file(value))
    refuse(value, "a file of wavelengths and values, 'D65', 'A', {kelvin = 2700} or {daylight = 5500}");
  return with_light(shared(read_named(value, frame)), value);
}

std::shared_ptr<const SampledSpectrum> daylight_of_temperature(const TomlValue& table) {
  const TomlValue* const value = find(table, "color_temperature");
  return value ? daylight_of(*value) : nullptr;
}

std::optional<BandsAsked> bands_asked(const TomlValue& root) {
  const TomlValue* const table = find(root, "spectra");
  if (!table) return std::nullopt;
  allow_keys(*table, {"bands", "edges_nm", "color_error"});
  BandsAsked asked;
  const TomlValue* const edges = find(*table, "edges_nm");
  const TomlValue* const bands = find(*table, "bands");
  if (edges && bands) one_of(*table, {"bands", "edges_nm"});
  if (edges) asked.edges_nm = edges_of(*edges);
  if (const TomlValue* const error = find(*table, "color_error")) asked.color_error = positive(*error);
  if (!bands) return asked;
  if (bands->kind == TomlValue::Kind::number) {
    const std::string expected = "a whole number of bands from 1 to 400, 'rgb' or 'auto'";
    if (!is_number_of_bands(bands->number)) refuse(*bands, expected);
    asked.edges_nm = equal_edges(static_cast<Eigen::Index>(bands->number));
  } else {
    asked.rgb = choice<bool>(*bands, {{"rgb", true}, {"auto", false}});
  }
  return asked;
}

std::vector<std::filesystem::path> spectrum_files(const TomlValue& root, const TomlFrame& frame) {
  std::vector<std::filesystem::path> files;
  for (const TomlValue& table : tables(find(root, "material"))) {
    for (const auto& [key, quantity] : named_quantities)
      if (quantity != MaterialSetting::Quantity::index) add_file(files, find(table, key), frame);
  }
  for (const TomlValue& table : tables(find(root, "luminaire"))) add_file(files, find(table, "spectrum"), frame);
  return files;
}

}  // namespace patchlight
