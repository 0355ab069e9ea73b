"""Color differences between solutions: CIEDE2000 from radiances in linear RGB or in XYZ."""
import math

# Luminance 179 cd/m^2 for a radiance of 1, IEC 61966-2-1.
XYZ_OF_RGB = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]


def xyz_of(arrays):
    if "xyz" in arrays:
        return arrays["xyz"]
    return [tuple(179 * sum(m * v for m, v in zip(row, rgb)) for row in XYZ_OF_RGB) for rgb in arrays["radiance"]]


def lab(xyz, white):
    f = [t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29 for t in
         (max(value, 0) / of_white for value, of_white in zip(xyz, white))]
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def difference(one, other):
    """CIEDE2000: Sharma, Wu and Dalal 2005, eqs. 2 to 22."""
    (L1, a1, b1), (L2, a2, b2) = one, other
    fraction = lambda c: math.sqrt(c**7 / (c**7 + 25.0**7))
    stretch = 1 + 0.5 * (1 - fraction((math.hypot(a1, b1) + math.hypot(a2, b2)) / 2))
    C1, C2 = math.hypot(stretch * a1, b1), math.hypot(stretch * a2, b2)
    h1, h2 = (math.degrees(math.atan2(b, stretch * a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    turn = (h2 - h1 + 180) % 360 - 180 if C1 * C2 else 0
    h = h1 + h2 if C1 * C2 == 0 else (h1 + turn / 2) % 360
    L, C = (L1 + L2) / 2, (C1 + C2) / 2
    cosine = lambda degrees: math.cos(math.radians(degrees))
    T = 1 - 0.17 * cosine(h - 30) + 0.24 * cosine(2 * h) + 0.32 * cosine(3 * h + 6) - 0.2 * cosine(4 * h - 63)
    dl = (L2 - L1) / (1 + 0.015 * (L - 50) ** 2 / math.sqrt(20 + (L - 50) ** 2))
    dc = (C2 - C1) / (1 + 0.045 * C)
    dh = 2 * math.sqrt(C1 * C2) * math.sin(math.radians(turn / 2)) / (1 + 0.015 * C * T)
    R = -2 * fraction(C) * math.sin(math.radians(60 * math.exp(-(((h - 275) / 25) ** 2))))
    return math.sqrt(max(dl * dl + dc * dc + dh * dh + R * dc * dh, 0))
