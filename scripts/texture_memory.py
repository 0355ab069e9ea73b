#!/usr/bin/env python3
"""Prints what a picture of 8192 x 8192 pixels on a floor costs: seconds and the most memory of the tool.

Usage: texture_memory.py TOOL [PIXELS]
"""

import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import time
import zlib


def write_png(file, size):
    """A pattern of stripes and fields, as a floor of planks has them, with some noise."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packer = zlib.compressobj(6)
    rows = b""
    for y in range(size):
        shade = 60 + (y * 7919 >> 5) % 90
        row = bytearray(b"\0")
        for block in range(size // 64):
            tone = shade + (block * 31 + y // 512 * 17) % 50
            row += bytes((tone, tone * 3 // 4, tone // 2)) * 32 + bytes((tone + 9, tone, tone // 2)) * 32
        rows += packer.compress(bytes(row))
    rows += packer.flush()
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def main():
    tool = pathlib.Path(sys.argv[1]).resolve()
    size = int(sys.argv[2]) if len(sys.argv) > 2 else 8192
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_png(folder / "floor.png", size)
        (folder / "room.mtl").write_text("newmtl floor\nKd 1 1 1\nmap_Kd floor.png\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n")
        (folder / "room.obj").write_text(
            "mtllib room.mtl\nv 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 3 0\nv 4 3 0\nv 4 3 4\nv 0 3 4\n"
            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl floor\nf 4/1 3/2 2/3 1/4\nusemtl lamp\nf 5 6 7 8\n"
        )
        begin = time.monotonic()
        subprocess.run(
            [tool, "solve", "room.obj", "--patches", "2000", "-o", "room.vtp"], cwd=folder, check=True, stdout=subprocess.DEVNULL
        )
        seconds = time.monotonic() - begin
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"{size} x {size} pixels: {seconds:.1f} s, {used.ru_utime + used.ru_stime:.1f} CPU s, "
        f"at most {used.ru_maxrss / 1024:.0f} MB in one process"
    )


if __name__ == "__main__":
    main()
