"""Reads what patchlight writes as .vtp, with the standard library alone: VTK XML PolyData, appended raw, LZ4."""
import array
import struct
import xml.etree.ElementTree as ElementTree

CODES = {"Float32": "f", "Float64": "d", "Int32": "i", "Int64": "q", "UInt8": "B", "Int8": "b", "UInt64": "Q"}


def lz4_block(data, size):
    """The bytes of a block of LZ4: literals, then matches in the bytes before."""
    out, k = bytearray(), 0

    def length(nibble):
        nonlocal k
        total = nibble
        while nibble == 15:
            total += data[k]
            k += 1
            if data[k - 1] != 255:
                break
        return total

    while len(out) < size:
        token = data[k]
        k += 1
        literals = length(token >> 4)
        out += data[k:k + literals]
        k += literals
        if len(out) >= size:
            break
        offset = struct.unpack_from("<H", data, k)[0]
        k += 2
        match = length(token & 15) + 4
        if offset >= match:
            out += out[len(out) - offset:len(out) - offset + match]
        else:
            for _ in range(match):
                out.append(out[-offset])
    return bytes(out)


def block_bytes(data, start):
    """The bytes of an appended array: the number of blocks, their sizes, then the blocks."""
    count, size, last = struct.unpack_from("<3Q", data, start)
    packed = struct.unpack_from(f"<{count}Q", data, start + 24)
    at, out = start + 24 + 8 * count, b""
    for k, length in enumerate(packed):
        full = last if k + 1 == count and last else size
        out += lz4_block(data[at:at + length], full)
        at += length
    return out


def read_vtp(file):
    """Points as triples, and the faces' corners and arrays as {name: list of tuples}."""
    with open(file, "rb") as stream:
        content = stream.read()
    mark = content.index(b"<AppendedData")
    start = content.index(b"_", mark) + 1
    head = ElementTree.fromstring(content[:mark] + b"</VTKFile>")

    def values(node):
        numbers = array.array(CODES[node.get("type")], block_bytes(content, start + int(node.get("offset"))))
        width = int(node.get("NumberOfComponents") or 1)
        return [tuple(numbers[k:k + width]) for k in range(0, len(numbers), width)]

    piece = head.find(".//Piece")
    points = values(piece.find("Points/DataArray"))
    polygons = {node.get("Name"): values(node) for node in piece.findall("Polys/DataArray")}
    corners, begin = [], 0
    for (end,) in polygons["offsets"]:
        corners.append([polygons["connectivity"][k][0] for k in range(begin, end)])
        begin = end
    cells = {node.get("Name"): values(node) for node in piece.findall("CellData/DataArray")}
    return points, corners, cells
