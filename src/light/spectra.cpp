#include "light/spectra.h"

#include "light/photometry.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Values from 380 to 780 nm by 5 nm, and by 10 nm.
using Knots = std::array<double, 81>;
using TenNanometers = std::array<double, 41>;

// Color matching functions of the CIE 1931 observer (2 degrees) and relative power of the CIE standard illuminant D65,
// from the tables of raysect (BSD-3, demos and optics, commit 5ed9a21b).
const Knots observer_x = {{0.001368, 0.002236, 0.004243, 0.00765,  0.01431,  0.02319,  0.04351,  0.07763,  0.13438,
                           0.21477,  0.2839,   0.3285,   0.34828,  0.34806,  0.3362,   0.3187,   0.2908,   0.2511,
                           0.19536,  0.1421,   0.09564,  0.05795,  0.03201,  0.0147,   0.0049,   0.0024,   0.0093,
                           0.0291,   0.06327,  0.1096,   0.1655,   0.22575,  0.2904,   0.3597,   0.43345,  0.51205,
                           0.5945,   0.6784,   0.7621,   0.8425,   0.9163,   0.9786,   1.0263,   1.0567,   1.0622,
                           1.0456,   1.0026,   0.9384,   0.85445,  0.7514,   0.6424,   0.5419,   0.4479,   0.3608,
                           0.2835,   0.2187,   0.1649,   0.1212,   0.0874,   0.0636,   0.04677,  0.0329,   0.0227,
                           0.01584,  0.011359, 0.008111, 0.00579,  0.004109, 0.002899, 0.002049, 0.00144,  0.001,
                           0.00069,  0.000476, 0.000332, 0.000235, 0.000166, 0.000117, 0.000083, 0.000059, 0.000042}};

const Knots observer_y = {{0.000039, 0.000064, 0.00012,  0.000217, 0.000396, 0.00064,  0.00121, 0.00218,  0.004,
                           0.0073,   0.0116,   0.01684,  0.023,    0.0298,   0.038,    0.048,   0.06,     0.0739,
                           0.09098,  0.1126,   0.13902,  0.1693,   0.20802,  0.2586,   0.323,   0.4073,   0.503,
                           0.6082,   0.71,     0.7932,   0.862,    0.91485,  0.954,    0.9803,  0.99495,  1,
                           0.995,    0.9786,   0.952,    0.9154,   0.87,     0.8163,   0.757,   0.6949,   0.631,
                           0.5668,   0.503,    0.4412,   0.381,    0.321,    0.265,    0.217,   0.175,    0.1382,
                           0.107,    0.0816,   0.061,    0.04458,  0.032,    0.0232,   0.017,   0.01192,  0.00821,
                           0.005723, 0.004102, 0.002929, 0.002091, 0.001484, 0.001047, 0.00074, 0.00052,  0.000361,
                           0.000249, 0.000172, 0.00012,  0.000085, 0.00006,  0.000042, 0.00003, 0.000021, 0.000015}};

const Knots observer_z = {
    {0.00645, 0.01055, 0.02005, 0.03621, 0.06785, 0.1102,  0.2074,  0.3713,  0.6456,  1.03905, 1.3856,  1.62296,
     1.74706, 1.7826,  1.77211, 1.7441,  1.6692,  1.5281,  1.28764, 1.0419,  0.81295, 0.6162,  0.46518, 0.3533,
     0.272,   0.2123,  0.1582,  0.1117,  0.07825, 0.05725, 0.04216, 0.02984, 0.0203,  0.0134,  0.00875, 0.00575,
     0.0039,  0.00275, 0.0021,  0.0018,  0.00165, 0.0014,  0.0011,  0.001,   0.0008,  0.0006,  0.00034, 0.00024,
     0.00019, 0.0001,  0.00005, 0.00003, 0.00002, 0.00001, 0,       0,       0,       0,       0,       0,
     0,       0,       0,       0,       0,       0,       0,       0,       0,       0,       0,       0,
     0,       0,       0,       0,       0,       0,       0,       0,       0}};

const Knots illuminant_d65 = {
    {49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204, 91.486,  92.4589, 93.4318, 90.057,  86.6823, 95.7736,
     104.865, 110.936, 117.008, 117.41,  117.812, 116.336, 114.861, 115.392, 115.923, 112.367, 108.811, 109.082,
     109.354, 108.578, 107.802, 106.296, 104.79,  106.239, 107.689, 106.047, 104.405, 104.225, 104.046, 102.023,
     100,     98.1671, 96.3342, 96.0611, 95.788,  92.2368, 88.6856, 89.3459, 90.0062, 89.8026, 89.5991, 88.6489,
     87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863,  80.0268, 80.1207, 80.2146, 81.2462, 82.2778, 80.281,
     78.2842, 74.0027, 69.7213, 70.6652, 71.6091, 72.979,  74.349,  67.9765, 61.604,  65.7448, 69.8856, 72.4863,
     75.087,  69.3398, 63.5927, 55.0054, 46.4182, 56.6118, 66.8054, 65.0941, 63.3828}};

// The mean of daylight, S_0, and its variations S_1 and S_2: CIE 15:2004, table T.2.
const TenNanometers daylight_0 = {{63.4,  65.8,  94.8,  104.8, 105.9, 96.8,  113.9, 125.6, 125.5, 121.3, 121.3,
                                   113.5, 113.1, 110.8, 106.5, 108.8, 105.3, 104.4, 100,   96,    95.1,  89.1,
                                   90.5,  90.3,  88.4,  84,    85.1,  81.9,  82.6,  84.9,  81.3,  71.9,  74.3,
                                   76.4,  63.3,  71.7,  77,    65.2,  47.7,  68.6,  65}};

const TenNanometers daylight_1 = {{38.5,  35,    43.4,  46.3,  43.9,  37.1,  36.7,  35.9, 32.6,  27.9, 24.3,
                                   20.1,  16.2,  13.2,  8.6,   6.1,   4.2,   1.9,   0,    -1.6,  -3.5, -3.5,
                                   -5.8,  -7.2,  -8.6,  -9.5,  -10.9, -10.7, -12,   -14,  -13.6, -12,  -13.3,
                                   -12.9, -10.6, -11.6, -12.2, -10.2, -7.8,  -11.2, -10.4}};

const TenNanometers daylight_2 = {{3,    1.2, -1.1, -0.5, -0.7, -1.2, -2.6, -2.9, -2.8, -2.6, -2.6, -1.8, -1.5, -1.3,
                                   -1.2, -1,  -0.5, -0.3, 0,    0.2,  0.5,  2.1,  3.2,  4.1,  4.7,  5.1,  6.7,  7.3,
                                   8.6,  9.8, 10.2, 8.3,  9.6,  8.5,  7,    7.6,  8,    6.7,  5.2,  7.4,  6.8}};

// Reflectances that under D65 have the colors red and green of 1 (Rec. 709): Mallett and Yuksel 2019. That of blue is
// the rest of 1.
const Knots reflectance_red = {
    {0.026670057265, 0.026668537675, 0.026662402067, 0.026647029228, 0.026611236842, 0.026533297825, 0.026381071457,
     0.02609312485,  0.0255731221,   0.024701121515, 0.023417275087, 0.021826631386, 0.020266995381, 0.019387127753,
     0.020167155643, 0.023947233243, 0.028878212288, 0.023273492068, 0.012323002474, 0.002326453401, 0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.03274916532,  0.107924166392, 0.214366915485, 0.340605927095,
     0.475222680628, 0.607983546499, 0.730039083193, 0.834150084188, 0.914963473006, 0.969254083695, 0.997109378108,
     1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,
     1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,
     1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,
     1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,
     1.00000,        1.00000,        1.00000,        1.00000}};

const Knots reflectance_green = {
    {0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.006906820183, 0.047736388605, 0.115843846621, 0.202512278197, 0.29869834792,
     0.401628554431, 0.50748518878,  0.612051907393, 0.711515978166, 0.802112427588, 0.879950040181, 0.941134538091,
     0.982104418944, 1.00000,        1.00000,        1.00000,        1.00000,        1.00000,        1.00000,
     1.00000,        0.997631725339, 0.977520116447, 0.926481002264, 0.843070369565, 0.736318367104, 0.615486670433,
     0.489730185407, 0.367231076865, 0.25509095325,  0.159098728529, 0.083487548805, 0.030745916305, 0.002890621892,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,        0.00000,
     0.00000,        0.00000,        0.00000,        0.00000}};

double middle_of(Eigen::Index cell) { return shortest_wavelength + 0.5 + static_cast<double>(cell); }

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

// Polynomials through four knots: CIE 15:2004, 7.2.1.
Cells observer_knots_in_cells(const Knots& knots) {
  Cells cells;
  for (Eigen::Index cell = 0; cell < number_of_cells; ++cell) {
    const double place = (middle_of(cell) - shortest_wavelength) / 5;
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
    rows << observer_knots_in_cells(observer_x).transpose(), observer_knots_in_cells(observer_y).transpose(),
        observer_knots_in_cells(observer_z).transpose();
    return rows;
  }();
  return observer;
}

std::shared_ptr<const SampledSpectrum> illuminant_d65_spectrum() {
  return std::make_shared<const SampledSpectrum>(at_even_steps("D65", illuminant_d65));
}

std::shared_ptr<const SampledSpectrum> illuminant_a_spectrum() {
  return of_formula("A", [](double wavelength) { return 100 * relative_planck(wavelength, 1.435e7 / 2848); });
}

std::shared_ptr<const SampledSpectrum> planckian_spectrum(double kelvin) {
  const double second = 1.438776877e7 / kelvin;  // h c / (k T), nm
  return of_formula("black body", [second](double wavelength) { return relative_planck(wavelength, second); });
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
  TenNanometers values{};
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

// 683 lm/W at the peak of V(lambda): the definition of the candela, rounded as in CIE S 010.
Eigen::Vector3d xyz_per_watt(const Eigen::Vector3d& observer) { return 683 * observer; }

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
