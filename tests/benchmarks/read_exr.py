"""Reads the OpenEXR images that `patchlight render` writes, without other libraries."""
import struct
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
