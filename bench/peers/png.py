"""Reads and writes PNG pictures of 8 bits per channel, not interlaced. Plain Python 3, no packages."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {0: 1, 2: 3, 6: 4}  # by colour type: grey, RGB, RGBA
COLOUR_TYPE = {count: kind for kind, count in CHANNELS.items()}


def chunks(data):
    at = len(SIGNATURE)
    while at < len(data):
        size = struct.unpack_from(">I", data, at)[0]
        yield data[at + 4:at + 8], data[at + 8:at + 8 + size]
        at += 12 + size


def predicted(kind, left, up, corner):
    """What filter `kind` adds to a byte."""
    if kind == 4:  # Paeth: whichever of the three is nearest to left + up - corner
        to_left, to_up, to_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
        return left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
    return (0, left, up, (left + up) // 2)[kind]


def read(path):
    """Width, height, channels and the bytes of all rows from the top."""
    data = path.read_bytes()
    parts = list(chunks(data))
    width, height, bits, colour, _, _, interlaced = struct.unpack(">2I5B", parts[0][1])
    if data[:8] != SIGNATURE or bits != 8 or colour not in CHANNELS or interlaced:
        raise ValueError(f"{path}: is not a plain PNG of 8 bits")
    channels = CHANNELS[colour]
    raw = zlib.decompress(b"".join(body for kind, body in parts if kind == b"IDAT"))
    stride, above, out = width * channels, bytearray(width * channels), bytearray()
    for y in range(height):
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        kind = raw[y * (stride + 1)]
        for x in range(stride):
            left, corner = (row[x - channels], above[x - channels]) if x >= channels else (0, 0)
            row[x] = (row[x] + predicted(kind, left, above[x], corner)) & 255
        out += row
        above = row
    return width, height, channels, bytes(out)


def encoded(width, height, channels, pixels):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    rows = b"".join(b"\0" + pixels[y * width * channels:(y + 1) * width * channels] for y in range(height))
    head = struct.pack(">2I5B", width, height, 8, COLOUR_TYPE[channels], 0, 0, 0)
    return SIGNATURE + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
