#include "patchlight/output/write_points.h"

#include "output/write_bytes.h"

#include <cassert>
#include <iomanip>
#include <sstream>

namespace patchlight {
namespace {

constexpr std::size_t input_columns = 6;  // x y z nx ny nz

std::string header(Eigen::Index bands) {
  std::string names = "x,y,z,nx,ny,nz";
  if (bands == 3) return names + ",E_r,E_g,E_b\n";
  for (Eigen::Index band = 1; band <= bands; ++band) names += ",E_" + std::to_string(band);
  return names + "\n";
}

// The first six words of a line, whether separated by blanks or commas, each followed by a comma.
std::string input_cells(std::string line) {
  for (char& c : line) {
    if (c == ',' || c == ';') c = ' ';
  }
  std::istringstream words(line);
  std::string cells, word;
  for (std::size_t column = 0; column < input_columns; ++column) {
    word.clear();
    words >> word;
    cells += word + ",";
  }
  return cells;
}

}  // namespace

void write_points(const std::filesystem::path& file, const std::vector<std::string>& lines,
                  const FieldView& irradiance) {
  assert(static_cast<Eigen::Index>(lines.size()) == irradiance.rows());
  std::ostringstream text;
  text << header(irradiance.cols()) << std::setprecision(9);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    text << input_cells(lines[k]);
    for (Eigen::Index band = 0; band < irradiance.cols(); ++band) {
      text << (band > 0 ? "," : "") << irradiance(static_cast<Eigen::Index>(k), band);
    }
    text << "\n";
  }
  write_bytes(file, text.str());
}

}  // namespace patchlight
