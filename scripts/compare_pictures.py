#!/usr/bin/env python3
"""Says how large the errors of a final picture are, as shares of its luminances, and how two pictures differ.

usage: scripts/compare_pictures.py PICTURE.exr [OTHER.exr]

Both are what patchlight render writes. As in --picture-error, an error counts relative to the luminance, or to a
twentieth of the luminance below which nine of ten pixels stay. Pixels whose middle shows no patch have no part.
"""
import math
import struct
import sys
import zlib


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def layers(file):
    """{name: values} of a scan line file of OpenEXR with ZIP compression and 32-bit channels."""
    with open(file, "rb") as stream:
        data = stream.read()
    if struct.unpack_from("<I", data)[0] != 20000630:
        raise SystemExit(f"error: {file}: is no OpenEXR file")
    at, attributes = 8, {}
    while data[at]:
        name, at = text(data, at)
        _, at = text(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    channels, k = [], 0
    while attributes["channels"][k]:
        name, k = text(attributes["channels"], k)
        channels.append((name, "I" if struct.unpack_from("<i", attributes["channels"], k)[0] == 0 else "f"))
        k += 16
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    found = {name: [] for name, _ in channels}
    for begin in range(0, height, 16):
        offset = struct.unpack_from("<Q", data, at + 1 + 8 * (begin // 16))[0]
        size = struct.unpack_from("<i", data, offset + 4)[0]
        lines = min(16, height - begin)
        block = plain(data[offset + 8:offset + 8 + size], lines * width * 4 * len(channels))
        place = 0
        for _ in range(lines):
            for name, kind in channels:
                found[name] += struct.unpack_from(f"<{width}{kind}", block, place)
                place += 4 * width
    return found


def plain(block, size):
    """Undoes ZIP, the differences of bytes, and their order by halves."""
    if len(block) == size:
        return block
    coded = bytearray(zlib.decompress(block))
    for k in range(1, len(coded)):
        coded[k] = (coded[k - 1] + coded[k] - 128) & 255
    out = bytearray(size)
    out[0::2], out[1::2] = coded[:(size + 1) // 2], coded[(size + 1) // 2:]
    return bytes(out)


def quantile(values, share):
    return sorted(values)[int(share * (len(values) - 1))]


def tell(name, values):
    rms = math.sqrt(sum(v * v for v in values) / len(values))
    print(f"{name}: rms {100 * rms:.2f} %, median {100 * quantile([abs(v) for v in values], .5):.2f} %, "
          f"nine of ten below {100 * quantile([abs(v) for v in values], .9):.2f} %, "
          f"above 1 %: {100 * sum(abs(v) > .01 for v in values) / len(values):.1f} % of the pixels")


def main():
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    first = layers(sys.argv[1])
    luminances = first["luminance.Y"]
    least = quantile([v for v in luminances if v > 0], .9) / 20
    shown = [k for k, patch in enumerate(first["patch.id"]) if patch != 0xffffffff]
    scale = [max(v, least) for v in luminances]
    tell("stated error", [first["error.Y"][k] / scale[k] for k in shown])
    if len(sys.argv) == 3:
        other = layers(sys.argv[2])["luminance.Y"]
        tell("difference", [(luminances[k] - other[k]) / scale[k] for k in shown])
        mean = sum(other[k] for k in shown) / len(shown)
        print(f"mean differs by {100 * (sum(luminances[k] for k in shown) / len(shown) / mean - 1):+.3f} %")


if __name__ == "__main__":
    main()
