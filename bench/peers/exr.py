"""Reads OpenEXR pictures of scan lines: uncompressed or ZIP, halves or floats. Plain Python 3, no packages."""
import array
import itertools
import struct
import sys
import zlib

ROWS_PER_BLOCK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIPS, ZIP
HALF, FLOAT = 1, 2


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("latin-1"), end + 1


def header_of(data):
    """The attributes by name, as bytes, and where the table of blocks begins."""
    if data[:4] != b"\x76\x2f\x31\x01":
        raise ValueError("is not an OpenEXR picture")
    attributes, at = {}, 8
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def channels_of(attribute):
    """Names and types, in the order in which their values follow in a row."""
    out, at = [], 0
    while attribute[at]:
        name, at = text_at(attribute, at)
        out.append((name, struct.unpack_from("<i", attribute, at)[0]))
        at += 16
    return out


def unpacked(block, size):
    """A block as it was before ZIP: OpenEXR stores differences of bytes, all even ones before all odd ones."""
    if len(block) == size:
        return block
    sums = bytes(itertools.accumulate(zlib.decompress(block), lambda a, b: (a + b - 128) & 255))
    out = bytearray(size)
    out[0::2], out[1::2] = sums[:(size + 1) // 2], sums[(size + 1) // 2:]
    return bytes(out)


def values_of(row, kind):
    if kind == HALF:
        return array.array("f", struct.unpack(f"<{len(row) // 2}e", row))
    out = array.array("f", row)
    if sys.byteorder == "big":
        out.byteswap()
    return out


def read(path):
    """Width, height and an array of floats per channel, from the top row to the last."""
    data = path.read_bytes()
    try:
        attributes, at = header_of(data)
        channels = channels_of(attributes["channels"])
        x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
        width, height = x1 - x0 + 1, y1 - y0 + 1
        rows = ROWS_PER_BLOCK[attributes["compression"][0]]
        row_bytes = sum(width * (2 if kind == HALF else 4) for _, kind in channels)
        out = {name: array.array("f", bytes(4 * width * height)) for name, _ in channels}
        for offset in struct.unpack_from(f"<{-(-height // rows)}Q", data, at):
            first, size = struct.unpack_from("<ii", data, offset)
            count = min(rows, y1 + 1 - first)
            block = unpacked(data[offset + 8:offset + 8 + size], count * row_bytes)
            begin = 0
            for y in range(first - y0, first - y0 + count):
                for name, kind in channels:
                    end = begin + width * (2 if kind == HALF else 4)
                    out[name][y * width:(y + 1) * width] = values_of(block[begin:end], kind)
                    begin = end
    except (IndexError, KeyError, ValueError, struct.error, zlib.error) as error:
        raise ValueError(f"{path}: cannot be read as an OpenEXR picture: {error}") from None
    return width, height, out
