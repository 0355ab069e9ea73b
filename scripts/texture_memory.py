#!/usr/bin/env python3
"""Prints what a picture of 8192 x 8192 pixels on a floor costs: seconds and the most memory of the tool.

Usage: texture_memory.py TOOL [PIXELS] [--kind rgb|alpha|16|hdr]

alpha: a PNG with a fourth channel; 16: a PNG of 16 bits per channel; hdr: a Radiance HDR, half as high.
"""

import argparse
import pathlib
import resource
import struct
import subprocess
import tempfile
import time
import zlib


def tones(y, blocks):
    """The two tones of each block of 64 pixels in row y: stripes and fields, as a floor of planks has them, with some noise."""
    shade = 60 + (y * 7919 >> 5) % 90
    for block in range(blocks):
        tone = shade + (block * 31 + y // 512 * 17) % 50
        yield tone, tone + 9


def png_pixel(kind, red, tone, y):
    channels = (red, tone * 3 // 4 if red == tone else tone, tone // 2)
    if kind == "alpha":
        channels += (0 if y // 64 % 4 == 0 else 255,)
    return b"".join(bytes((value, value) if kind == "16" else (value,)) for value in channels)


def write_png(file, size, kind):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packer = zlib.compressobj(6)
    rows = b""
    for y in range(size):
        row = bytearray(b"\0")
        for one, other in tones(y, size // 64):
            row += png_pixel(kind, one, one, y) * 32 + png_pixel(kind, other, one, y) * 32
        rows += packer.compress(bytes(row))
    rows += packer.flush()
    header = struct.pack(">IIBBBBB", size, size, 16 if kind == "16" else 8, 6 if kind == "alpha" else 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def write_hdr(file, size):
    """Pixels without runs; 128 as the exponent makes a mantissa of 128 a half."""
    with file.open("wb") as out:
        out.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (size // 2, size))
        for y in range(size // 2):
            row = b""
            for one, other in tones(y, size // 64):
                row += bytes((one, one * 3 // 4, one // 2, 128)) * 32 + bytes((other, one, one // 2, 128)) * 32
            out.write(row)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("pixels", type=int, nargs="?", default=8192)
    parser.add_argument("--kind", choices=("rgb", "alpha", "16", "hdr"), default="rgb")
    options = parser.parse_args()
    size = options.pixels
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        picture = "floor.hdr" if options.kind == "hdr" else "floor.png"
        if options.kind == "hdr":
            write_hdr(folder / picture, size)
        else:
            write_png(folder / picture, size, options.kind)
        (folder / "room.mtl").write_text(f"newmtl floor\nKd 1 1 1\nmap_Kd {picture}\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n")
        (folder / "room.obj").write_text(
            "mtllib room.mtl\nv 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 3 0\nv 4 3 0\nv 4 3 4\nv 0 3 4\n"
            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl floor\nf 4/1 3/2 2/3 1/4\nusemtl lamp\nf 5 6 7 8\n"
        )
        begin = time.monotonic()
        subprocess.run(
            [options.tool.resolve(), "solve", "room.obj", "--patches", "2000", "-o", "room.vtp"],
            cwd=folder,
            check=True,
            stdout=subprocess.DEVNULL,
        )
        seconds = time.monotonic() - begin
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(
        f"{size} x {size // 2 if options.kind == 'hdr' else size} pixels ({options.kind}): {seconds:.1f} s, "
        f"{used.ru_utime + used.ru_stime:.1f} CPU s, at most {used.ru_maxrss / 1024:.0f} MB in one process"
    )


if __name__ == "__main__":
    main()
