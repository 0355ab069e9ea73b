#include "patchlight/base/error.h"

#include "input/material_settings.h"
#include "input/round_shapes.h"
#include "input/text.h"
#include "input/toml/toml_tables.h"
#include "light/photometry.h"
#include "light/spectra.h"

namespace patchlight {
namespace {

using Quantity = MaterialSetting::Quantity;
using Matrix = Eigen::Matrix3d;

Vector axis_of(const TomlValue& value) {
  if (value.kind == TomlValue::Kind::list) return direction(value);
  return choice<Vector>(value, {{"x", Vector::UnitX()}, {"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
}

Matrix rotation_of(const TomlValue& table) {
  allow_keys(table, {"axis", "degrees"});
  const Vector axis = axis_of(required(table, "axis", "an axis 'x', 'y', 'z' or [x, y, z]"));
  return turned_about(axis, number(required(table, "degrees", "an angle, counter-clockwise seen from the axis' tip")));
}

// One rotation, or several in order of application.
Matrix rotations_of(const TomlValue& value) {
  if (value.kind != TomlValue::Kind::list) return rotation_of(value);
  Matrix all = Matrix::Identity();
  for (const TomlValue& item : value.items) all = rotation_of(item) * all;
  return all;
}

Matrix scale_of(const TomlValue& value) {
  if (value.kind == TomlValue::Kind::number) return positive(value) * Matrix::Identity();
  const Vector factors = vector(value);
  if (factors.cwiseAbs().minCoeff() == 0) refuse(value, "a factor above 0, or three that are not 0");
  return factors.asDiagonal();
}

// Rotates the vertical axis of the model to that of the scene: a quarter turn around x, or the identity.
Matrix upturned(const Vector& from, const Vector& to) {
  if (from == to) return Matrix::Identity();
  return turned_about(Vector::UnitX(), from == Vector::UnitY() ? 90 : -90);
}

Eigen::Affine3d matrix_of(const TomlValue& value, double metres_per_unit) {
  const std::string expected = "three rows of four numbers, or four of which the last is [0, 0, 0, 1]";
  const bool is_list = value.kind == TomlValue::Kind::list;
  if (!is_list || (value.items.size() != 3 && value.items.size() != 4)) refuse(value, expected);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t row = 0; row < value.items.size(); ++row) {
    const std::vector<double> entries = numbers(value.items[row], 4, expected);
    matrix.row(static_cast<Eigen::Index>(row)) = Eigen::Map<const Eigen::RowVector4d>(entries.data());
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) refuse(value.items[3], "the last row [0, 0, 0, 1]");
  if (matrix.topLeftCorner<3, 3>().determinant() == 0) refuse(value, "a matrix that can be inverted");
  matrix.topRightCorner<3, 1>() *= metres_per_unit;
  return Eigen::Affine3d(matrix);
}

// Vertical axis, then either the matrix, or scale, rotation and translation.
std::optional<Eigen::Affine3d> placement_of(const TomlValue& table, const TomlFrame& frame) {
  const TomlValue* const scale = find(table, "scale");
  const TomlValue* const rotate = find(table, "rotate");
  const TomlValue* const translate = find(table, "translate");
  const TomlValue* const matrix = find(table, "matrix");
  const TomlValue* const up = find(table, "up");
  if (matrix && (scale || rotate || translate)) {
    throw InputError(matrix->where, "model.matrix and model.scale, rotate or translate exclude each other");
  }
  if (!scale && !rotate && !translate && !matrix && !up) return std::nullopt;
  Eigen::Affine3d placement = matrix ? matrix_of(*matrix, frame.metres_per_unit) : Eigen::Affine3d::Identity();
  if (rotate) placement.linear() = rotations_of(*rotate);
  if (scale) placement.linear() *= scale_of(*scale);
  if (translate) placement.translation() = frame.metres_per_unit * vector(*translate);
  if (up) placement.linear() *= upturned(upright(*up), frame.up);
  return placement;
}

std::vector<std::string> patterns(const TomlValue& value) {
  return texts(value, "a name of objects, groups or materials, a pattern with * and ?, or a list of such");
}

ModelEntry model_of(const TomlValue& table, const TomlFrame& frame) {
  allow_keys(table, {"file", "unit", "up", "scale", "rotate", "translate", "matrix", "only", "leave_out"});
  ModelEntry model;
  const TomlValue& file = required(table, "file", "the name of a model file");
  model.file = named_file(file, frame);
  model.where = file.where;
  if (const TomlValue* const unit = find(table, "unit")) model.metres_per_unit = unit_length(*unit);
  model.placement = placement_of(table, frame);
  if (const TomlValue* const only = find(table, "only")) model.choice.only = patterns(*only);
  if (const TomlValue* const rest = find(table, "leave_out")) model.choice.leave_out = patterns(*rest);
  return model;
}

// Sets the value of a material key, in linear RGB and by wavelength.
MaterialSetting with_value(MaterialSetting setting, const TomlValue& value, const TomlFrame& frame) {
  if (setting.quantity == Quantity::light_spectrum) {
    setting.sampled = light_spectrum(value, frame);
    setting.value = rgb_of_light(*setting.sampled);
  } else if (setting.quantity == Quantity::index || !is_by_wavelength(value)) {
    setting.value = spectrum(value);
  } else if (is_share(setting.quantity)) {
    setting.sampled = sampled_share(value, frame);
    setting.value = rgb_of_reflectance(*setting.sampled).max(0.0).min(1.0);
  } else {
    setting.sampled = sampled_exitance(value, frame);
    const double luminance = luminance_of_cells(in_cells(*setting.sampled, Beyond::zero));
    setting.value = luminance / luminous_efficacy * rgb_of_light(*setting.sampled);
  }
  return setting;
}

std::vector<MaterialSetting> settings_of_table(const TomlValue& table, const TomlFrame& frame) {
  allow_keys(table, {"name", "of", "reflectance", "specular_reflectance", "transmittance", "diffuse_transmittance",
                     "index", "exitance", "radiance", "spectrum"});
  const TomlValue* const of = find(table, "of");
  const TomlValue& name =
      of && !find(table, "name") ? *of : required(table, "name", "the name of materials, or a pattern with * and ?");
  const std::string material = &name == of ? "*" : text(name);
  std::vector<MaterialSetting> settings;
  for (const auto& [key, quantity] : named_quantities) {
    const TomlValue* const value = find(table, key);
    if (value == nullptr) continue;
    settings.push_back(with_value({material, quantity, {}, name.where, of ? text(*of) : std::string()}, *value, frame));
    if (is_share(quantity) && (settings.back().value > 1).any()) refuse(*value, "0 to 1 in every band");
    if (quantity == Quantity::index && !is_index(settings.back().value)) refuse(*value, expected_index);
  }
  if (find(table, "exitance") && find(table, "radiance")) one_of(table, {"exitance", "radiance"});
  for (const char* const key : {"exitance", "radiance"}) {
    const TomlValue* const light = find(table, key);
    if (light && is_by_wavelength(*light) && find(table, "spectrum")) one_of(table, {key, "spectrum"});
  }
  if (settings.empty()) throw InputError(table.where, "this material changes nothing; expected a reflectance or more");
  return settings;
}

}  // namespace

std::filesystem::path named_file(const TomlValue& value, const TomlFrame& frame) {
  std::filesystem::path file = path(value, frame.file);
  require_within(frame.confine, file, value.where);
  return file;
}

std::vector<ModelEntry> models_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<ModelEntry> models;
  for (const TomlValue& table : tables(find(root, "model"))) models.push_back(model_of(table, frame));
  if (models.empty()) {
    throw InputError(root.where, "names no model; expected at least one table [[model]] with file = \"ROOM.obj\"");
  }
  return models;
}

std::vector<MaterialSetting> settings_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<MaterialSetting> settings;
  for (const TomlValue& table : tables(find(root, "material"))) {
    for (MaterialSetting& setting : settings_of_table(table, frame)) settings.push_back(std::move(setting));
  }
  return settings;
}

}  // namespace patchlight
