#!/usr/bin/python3
"""Makes a raster GDAL reads (EHdr: .bil, .hdr, .prj) of the Jacksboro fault model that Debian's package
python-matplotlib-data carries as a NumPy archive. Standard library only.

jacksboro.py [--from ARCHIVE] OUT.bil
"""
import ast
import os
import struct
import sys
import zipfile
from pathlib import Path

ARCHIVE = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz"

WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
    'UNIT["degree",0.0174532925199433],AXIS["Longitude",EAST],AXIS["Latitude",NORTH],AUTHORITY["EPSG","4326"]]\n'
)


def npy(data):
    """The header and the raw bytes of an array in NumPy's format 1.0."""
    if data[:8] != b"\x93NUMPY\x01\x00":
        raise ValueError("not a NumPy array of format 1.0")
    (length,) = struct.unpack_from("<H", data, 8)
    header = ast.literal_eval(data[10 : 10 + length].decode("latin-1"))
    if header["fortran_order"]:
        raise ValueError("stored by columns")
    return header, data[10 + length :]


def number(data):
    header, raw = npy(data)
    if header["descr"] != "<f8" or header["shape"] != ():
        raise ValueError(f"one double expected, not {header}")
    return struct.unpack("<d", raw)[0]


def convert(archive, out):
    with zipfile.ZipFile(archive) as members:
        header, heights = npy(members.read("elevation.npy"))
        west, north, dx, dy = (number(members.read(f"{key}.npy")) for key in ("xmin", "ymin", "dx", "dy"))
        south = number(members.read("ymax.npy"))
    rows, cols = header["shape"]
    if header["descr"] != "<i2" or len(heights) != 2 * rows * cols:
        raise ValueError(f"{archive}: int16 heights expected, not {header}")
    # In this file ymin is the northern edge; edges are those of pixels, and EHdr wants the centre of the first.
    if not south < north or abs((north - south) / dy - rows) > 1e-6:
        raise ValueError(f"{archive}: ymin {north} is not {rows} rows of {dy} north of ymax {south}")
    lines = {
        "BYTEORDER": "I", "LAYOUT": "BIL", "NROWS": rows, "NCOLS": cols, "NBANDS": 1, "NBITS": 16,
        "PIXELTYPE": "SIGNEDINT", "ULXMAP": repr(west + dx / 2), "ULYMAP": repr(north - dy / 2),
        "XDIM": repr(dx), "YDIM": repr(dy),
    }
    out.parent.mkdir(parents=True, exist_ok=True)
    write(out.with_suffix(".hdr"), "".join(f"{key:<10}{value}\n" for key, value in lines.items()).encode())
    write(out.with_suffix(".prj"), WGS84.encode())
    write(out, heights)


def write(path, data):
    """Beside, then renamed: whoever looks sees all of the file or nothing."""
    beside = path.with_name(f"{path.name}.{os.getpid()}")
    beside.write_bytes(data)
    beside.replace(path)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    source = ARCHIVE
    if arguments[:1] == ["--from"] and len(arguments) > 1:
        source, arguments = arguments[1], arguments[2:]
    if len(arguments) != 1 or not arguments[0].endswith(".bil"):
        sys.exit(__doc__)
    try:
        convert(source, Path(arguments[0]))
    except (OSError, KeyError, ValueError, struct.error, zipfile.BadZipFile) as failure:
        sys.exit(f"jacksboro.py: {failure}")
