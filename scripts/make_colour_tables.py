#!/usr/bin/env python3
"""Prints the tables of src/light/spectra.cpp: the CIE 1931 observer, illuminant D65, the components of daylight, and the
reflectances of the red and green primaries of Rec. 709; that of blue is the rest up to 1.

usage: scripts/make_colour_tables.py FOLDER

FOLDER has cie1931_2deg_xyz.csv and cie_d65.csv: wavelength in nm, values, by 5 nm. Needs numpy.

The reflectances of primaries are those of Mallett and Yuksel 2019, "Spectral primary decomposition for rendering with
sRGB reflectance" (Eurographics Symposium on Rendering). They are the smoothest triple of spectra in [0, 1] that sum to 1 and have the
colors red, green and blue under D65. The sum of the squared differences from knot to knot is least. They are computed here, by OSQP's method (Stellato et al. 2020, algorithm 1) and its polishing."""
import pathlib
import sys

import numpy as np

# CIE 15:2004, table T.2: 380 to 780 nm by 10 nm.
S = """63.4 38.5 3 65.8 35 1.2 94.8 43.4 -1.1 104.8 46.3 -.5 105.9 43.9 -.7 96.8 37.1 -1.2 113.9 36.7 -2.6 125.6 35.9 -2.9
125.5 32.6 -2.8 121.3 27.9 -2.6 121.3 24.3 -2.6 113.5 20.1 -1.8 113.1 16.2 -1.5 110.8 13.2 -1.3 106.5 8.6 -1.2 108.8 6.1
-1 105.3 4.2 -.5 104.4 1.9 -.3 100 0 0 96 -1.6 .2 95.1 -3.5 .5 89.1 -3.5 2.1 90.5 -5.8 3.2 90.3 -7.2 4.1 88.4 -8.6 4.7
84 -9.5 5.1 85.1 -10.9 6.7 81.9 -10.7 7.3 82.6 -12 8.6 84.9 -14 9.8 81.3 -13.6 10.2 71.9 -12 8.3 74.3 -13.3 9.6 76.4
-12.9 8.5 63.3 -10.6 7 71.7 -11.6 7.6 77 -12.2 8 65.2 -10.2 6.7 47.7 -7.8 5.2 68.6 -11.2 7.4 65 -10.4 6.8"""

KNOTS = np.arange(380, 785, 5)
CELLS = np.arange(380.5, 780)  # the middles of each nm


def table(file):
    rows = [line.split(",") for line in file.read_text().splitlines()[1:] if line]
    values = np.array(rows, dtype=float)
    return values[(values[:, 0] >= 380) & (values[:, 0] <= 780)]


def interpolation():
    """The matrix from values at the knots to values in the cells."""
    matrix = np.zeros((CELLS.size, KNOTS.size))
    left = ((CELLS - 380) // 5).astype(int)
    share = (CELLS - KNOTS[left]) / 5
    matrix[np.arange(CELLS.size), left] = 1 - share
    matrix[np.arange(CELLS.size), left + 1] = share
    return matrix


def observer_in_cells(values):
    """Interpolation by polynomials through four knots, CIE 15:2004, 7.2.1."""
    cells = np.zeros(CELLS.size)
    for cell, wavelength in enumerate(CELLS):
        first = min(max(int((wavelength - 380) // 5) - 1, 0), KNOTS.size - 4)
        t = (wavelength - KNOTS[first]) / 5
        for k in range(4):
            others = [j for j in range(4) if j != k]
            cells[cell] += values[first + k] * np.prod([(t - j) / (k - j) for j in others])
    return cells


def rgb_from_xyz(white):
    """Rec. 709 primaries, with this white."""
    xy = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    primaries = np.array([[x / y, 1, (1 - x - y) / y] for x, y in xy]).T
    return np.linalg.inv(primaries * np.linalg.solve(primaries, white))


def smoothest(H, A, low, high):
    """The x that makes x'Hx / 2 least, with low <= A x <= high."""
    n, m = H.shape[0], A.shape[0]
    is_equal = high - low < 1e-12
    x, z, y = np.zeros(n), np.zeros(m), np.zeros(m)
    rho = np.where(is_equal, 1e3, 1.0)
    sigma = 1e-6
    inverse = np.linalg.inv(H + sigma * np.eye(n) + A.T @ (rho[:, None] * A))
    for _ in range(20000):
        x = inverse @ (sigma * x + A.T @ (rho * z - y))
        Ax = A @ x
        z = np.clip(Ax + y / rho, low, high)
        y = y + rho * (Ax - z)
    # Polishing: active constraints hold exactly.
    for _ in range(50):
        at_low, at_high = (y < -1e-9) | is_equal, (y > 1e-9) & ~is_equal
        active = at_low | at_high
        K = A[active]
        right = np.where(at_low, low, high)[active]
        system = np.block([[H, K.T], [K, np.zeros((K.shape[0],) * 2)]])
        solution = np.linalg.lstsq(system, np.r_[np.zeros(n), right], rcond=None)[0]
        x = solution[:n]
        y = np.zeros(m)
        y[active] = solution[n:]
        Ax = A @ x
        y[(Ax < low - 1e-10) & ~active] = -1
        y[(Ax > high + 1e-10) & ~active] = 1
        wrong = np.zeros(m, dtype=bool)
        wrong[active] = ((y > 1e-9) & at_low & ~is_equal | (y < -1e-9) & at_high)[active]
        y[wrong] = 0
        if not wrong.any() and (Ax > low - 1e-9).all() and (Ax < high + 1e-9).all():
            return x
    raise SystemExit("no solution was found")


def primaries(observer, d65):
    into = interpolation()
    weights = np.array([observer_in_cells(values) for values in observer.T]) * (into @ d65)  # X, Y, Z of each cell
    weights /= weights[1].sum()
    rgb = rgb_from_xyz(weights.sum(1)) @ weights @ into  # red, green, blue of each knot
    n = KNOTS.size
    D = np.diff(np.eye(n), axis=0)
    T = D.T @ D
    # The third is 1 less the two others.
    H = np.block([[2 * T, T], [T, 2 * T]])
    I, O = np.eye(n), np.zeros((n, n))
    A = np.vstack([np.hstack([rgb, np.zeros((3, n))]), np.hstack([np.zeros((3, n)), rgb]), np.hstack([I, O]),
                   np.hstack([O, I]), np.hstack([I, I])])
    low = np.r_[1, 0, 0, 0, 1, 0, np.zeros(3 * n)]
    high = np.r_[1, 0, 0, 0, 1, 0, np.ones(3 * n)]
    x = np.clip(smoothest(H, A, low, high), 0, 1)
    red, green = x[:n], x[n:]
    return red, green, np.clip(1 - red - green, 0, 1)


def numbers(values, digits):
    lines, line = [], "   "
    for value in values:
        text = np.format_float_positional(round(float(value), digits), trim="-") + ","
        if len(line) + len(text) >= 119:
            lines.append(line)
            line = "   "
        line += " " + text
    return "\n".join(lines + [line.rstrip(",")])


def array(comment, name, values, digits):
    kind = "Knots" if len(values) == KNOTS.size else "TenNanometres"
    return f"// {comment}\nconst {kind} {name} = {{{{\n{numbers(values, digits)}}}}};\n\n"


def main():
    folder = pathlib.Path(sys.argv[1])
    observer = table(folder / "cie1931_2deg_xyz.csv")[:, 1:]
    d65 = table(folder / "cie_d65.csv")[:, 1]
    text = ""
    origin = "from the tables of raysect (BSD-3, demos and optics, commit 5ed9a21b)."
    for k, letter in enumerate("xyz"):
        text += array(f"CIE 1931 2 degree observer, {letter}; {origin}", f"observer_{letter}", observer[:, k], 9)
    text += array(f"CIE standard illuminant D65; {origin}", "illuminant_d65", d65, 6)
    components = np.array(S.split(), dtype=float).reshape(-1, 3)
    for k in range(3):
        text += array("CIE 15:2004, table T.2.", f"daylight_{k}", components[:, k], 2)
    for name, values in zip(("red", "green"), primaries(observer, d65)):
        text += array("Mallett and Yuksel 2019, computed for D65.", f"reflectance_{name}", values, 12)
    print(text, end="")


main()
