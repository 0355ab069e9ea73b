#include "light/spectra.h"

#include "light/colour_tables.h"
#include "light/photometry.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

constexpr double knot_width = 5;  // nm, of Knots

double middle_of(Eigen::Index cell) { return shortest_wavelength + 0.5 + static_cast<double>(cell); }

// lm/W at the peak of V(lambda): the definition of the candela, rounded as in CIE S 010.
constexpr double peak_efficacy = 683;

template <std::size_t size>
SampledSpectrum at_even_steps(std::string name, const std::array<double, size>& values) {
  const double step = (longest_wavelength - shortest_wavelength) / static_cast<double>(size - 1);
  SampledSpectrum spectrum{std::move(name), {}, {values.begin(), values.end()}};
  for (std::size_t k = 0; k < size; ++k)
    spectrum.wavelengths.push_back(shortest_wavelength + step * static_cast<double>(k));
  return spectrum;
}

// One value for each cell.
template <typename Value>
std::shared_ptr<const SampledSpectrum> of_formula(std::string name, const Value& value) {
  SampledSpectrum spectrum{std::move(name), {}, {}};
  for (double wavelength = shortest_wavelength; wavelength <= longest_wavelength; wavelength += 1) {
    spectrum.wavelengths.push_back(wavelength);
    spectrum.values.push_back(value(wavelength));
  }
  return std::make_shared<const SampledSpectrum>(std::move(spectrum));
}

// Planck's law relative to 560 nm, for c_2 / T in nm.
double relative_planck(double wavelength, double second) {
  constexpr double reference = 560;
  return std::pow(reference / wavelength, 5) * std::expm1(second / reference) / std::expm1(second / wavelength);
}

Cells knots_in_cells(const Knots& knots) { return in_cells(at_even_steps({}, knots), Beyond::end); }

// By polynomials through four knots: CIE 15:2004, 7.2.1.
Cells observer_knots_in_cells(const Knots& knots) {
  Cells cells;
  for (Eigen::Index cell = 0; cell < number_of_cells; ++cell) {
    const double place = (middle_of(cell) - shortest_wavelength) / knot_width;
    const auto first =
        static_cast<std::size_t>(std::clamp(std::floor(place) - 1, 0.0, static_cast<double>(knots.size() - 4)));
    const double t = place - static_cast<double>(first);
    cells[cell] = -knots[first] * (t - 1) * (t - 2) * (t - 3) / 6 + knots[first + 1] * t * (t - 2) * (t - 3) / 2 -
                  knots[first + 2] * t * (t - 1) * (t - 3) / 2 + knots[first + 3] * t * (t - 1) * (t - 2) / 6;
  }
  return cells;
}

// The primaries of Rec. 709 with the white of D65.
Eigen::Matrix3d matrix_of_primaries() {
  const Eigen::Matrix<double, 3, 2> xy{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
  Eigen::Matrix3d primaries;  // X, Y, Z of each where Y = 1
  for (Eigen::Index k = 0; k < 3; ++k)
    primaries.col(k) = Eigen::Vector3d(xy(k, 0), xy(k, 1), 1 - xy(k, 0) - xy(k, 1)) / xy(k, 1);
  const Eigen::Vector3d white = xyz_of_cells(in_cells(*illuminant_d65_spectrum(), Beyond::zero));
  return primaries * (primaries.inverse() * (white / white.y())).asDiagonal();
}

}  // namespace

Cells in_cells(const SampledSpectrum& spectrum, Beyond beyond) {
  assert(!spectrum.wavelengths.empty() && spectrum.wavelengths.size() == spectrum.values.size());
  const std::vector<double>& at = spectrum.wavelengths;
  Cells cells;
  std::size_t above = 0;
  for (Eigen::Index k = 0; k < number_of_cells; ++k) {
    const double wavelength = middle_of(k);
    while (above < at.size() && at[above] < wavelength) ++above;
    const bool is_outside = above == at.size() || (above == 0 && at[0] > wavelength);
    if (is_outside) {
      cells[k] = beyond == Beyond::zero ? 0 : spectrum.values[above == 0 ? 0 : above - 1];
    } else if (at[above] == wavelength) {
      cells[k] = spectrum.values[above];
    } else {
      const double share = (wavelength - at[above - 1]) / (at[above] - at[above - 1]);
      cells[k] = (1 - share) * spectrum.values[above - 1] + share * spectrum.values[above];
    }
  }
  return cells;
}

const Eigen::Array<double, 3, number_of_cells>& observer_in_cells() {
  static const Eigen::Array<double, 3, number_of_cells> observer = [] {
    Eigen::Array<double, 3, number_of_cells> rows;
    rows.row(0) = observer_knots_in_cells(observer_x).transpose();
    rows.row(1) = observer_knots_in_cells(observer_y).transpose();
    rows.row(2) = observer_knots_in_cells(observer_z).transpose();
    return rows;
  }();
  return observer;
}

std::shared_ptr<const SampledSpectrum> illuminant_d65_spectrum() {
  return std::make_shared<const SampledSpectrum>(at_even_steps("D65", illuminant_d65));
}

std::shared_ptr<const SampledSpectrum> illuminant_a_spectrum() {
  constexpr double second = 1.435e7 / 2848;  // nm
  return of_formula("A", [](double wavelength) { return 100 * relative_planck(wavelength, second); });
}

std::shared_ptr<const SampledSpectrum> planckian_spectrum(double kelvin) {
  constexpr double second = 1.438776877e7;  // h c / k, nm K
  return of_formula("black body", [kelvin](double wavelength) { return relative_planck(wavelength, second / kelvin); });
}

std::shared_ptr<const SampledSpectrum> daylight_spectrum(double kelvin) {
  assert(kelvin >= coolest_daylight && kelvin <= hottest_daylight);
  // CIE 15:2004, eqs. 3.3 to 3.5.
  const double t = 1000 / kelvin;
  const double x = kelvin <= 7000 ? ((-4.6070 * t + 2.9678) * t + 0.09911) * t + 0.244063
                                  : ((-2.0064 * t + 1.9018) * t + 0.24748) * t + 0.237040;
  const double y = (-3 * x + 2.870) * x - 0.275;
  const double divisor = 0.0241 + 0.2562 * x - 0.7341 * y;
  const double m_1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / divisor;
  const double m_2 = (0.0300 - 31.4424 * x + 30.0717 * y) / divisor;
  TenNanometres values{};
  // The far ends of the hottest daylight are above 0 all the same.
  for (std::size_t k = 0; k < values.size(); ++k)
    values[k] = std::max(0.0, daylight_0[k] + m_1 * daylight_1[k] + m_2 * daylight_2[k]);
  return std::make_shared<const SampledSpectrum>(at_even_steps("daylight", values));
}

const std::array<Cells, 3>& reflectances_of_primaries() {
  static const std::array<Cells, 3> primaries = [] {
    const Cells red = knots_in_cells(reflectance_red);
    const Cells green = knots_in_cells(reflectance_green);
    return std::array<Cells, 3>{red, green, (1 - red - green).max(0.0)};
  }();
  return primaries;
}

Eigen::Vector3d xyz_per_watt(const Eigen::Vector3d& observer) { return peak_efficacy * observer; }

Eigen::Vector3d xyz_of_cells(const Cells& light) { return xyz_per_watt(observer_in_cells().matrix() * light.matrix()); }

double luminance_of_cells(const Cells& light) { return xyz_of_cells(light).y(); }

const Eigen::Matrix3d& xyz_from_rgb() {
  static const Eigen::Matrix3d matrix = matrix_of_primaries();
  return matrix;
}

const Eigen::Matrix3d& rgb_from_xyz() {
  static const Eigen::Matrix3d matrix = xyz_from_rgb().inverse();
  return matrix;
}

Spectrum rgb_of_reflectance(const SampledSpectrum& reflectance) {
  const Cells d65 = in_cells(*illuminant_d65_spectrum(), Beyond::zero);
  const Cells reflected = d65 * in_cells(reflectance, Beyond::end);
  const Eigen::Vector3d values = rgb_from_xyz() * xyz_of_cells(reflected) / luminance_of_cells(d65);
  return values.transpose().array();
}

Spectrum rgb_of_light(const SampledSpectrum& light) {
  const Eigen::Vector3d xyz = xyz_of_cells(in_cells(light, Beyond::zero));
  assert(xyz.y() > 0);
  const Spectrum values = (rgb_from_xyz() * xyz).cwiseMax(0).transpose().array();
  return luminous_efficacy / luminance(values) * values;
}

}  // namespace patchlight
