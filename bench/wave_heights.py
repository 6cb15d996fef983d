# A height map of waves of 4 to 256 cycles, the finer the fainter, as a PNG of 16 bits.
#
#   python3 bench/wave_heights.py OUT.png SIZE
import math
import struct
import sys
import zlib

path, size = sys.argv[1], int(sys.argv[2])
cycles = [4 << k for k in range(7)]
along = [[math.sin(2 * math.pi * c * (i + 0.5) / size) for i in range(size)] for c in cycles]
rows = bytearray()
for j in range(size):
    factors = [0.2 * 0.5**k * along[k][(j + size // 4 // c) % size] for k, c in enumerate(cycles)]
    rows.append(0)
    heights = [0.5] * size
    for factor, wave in zip(factors, along):
        heights = [h + factor * w for h, w in zip(heights, wave)]
    for h in heights:
        rows += struct.pack(">H", int(min(max(h, 0.0), 1.0) * 65535 + 0.5))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


with open(path, "wb") as file:
    file.write(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 16, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(bytes(rows), 1))
        + chunk(b"IEND", b"")
    )
