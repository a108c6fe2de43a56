#!/usr/bin/env python3
"""Holds read_v2.py against the program: read_v2_test.py TALUS SCRATCH

Rasters of every coding of heights, with and without voids, go through the program; the second reader must find every
sample bit for bit, and for regions and tolerances the very triangles of the program's answer. Exits with 77, after
saying why, where a library is missing.
"""

import math
import random
import struct
import subprocess
import sys
from pathlib import Path

import read_v2

VOID = -32768


def mountains(cols, rows, seed):
    draw = random.Random(seed)
    waves = [(draw.uniform(0.02, 0.5), draw.uniform(0.02, 0.5), draw.uniform(0, 6), 200 / k) for k in range(1, 7)]
    return [[sum(h * math.sin(a * c + b * r + w) for a, b, w, h in waves) + 800 + draw.uniform(-3, 3) for c in range(cols)]
            for r in range(rows)]


def with_voids(rows, seed):
    draw = random.Random(seed)
    for _ in range(4):
        c0, r0, radius = draw.randrange(len(rows[0])), draw.randrange(len(rows)), draw.uniform(2, 25)
        for r, row in enumerate(rows):
            for c in range(len(row)):
                if math.hypot(c - c0, r - r0) < radius or draw.random() < 0.002:
                    row[c] = VOID
    return rows


def each(rows, change):
    return [[h if h == VOID else change(h) for h in row] for row in rows]


def special(rows):
    """Values that a decimal cannot restore: zeros of both signs, thirds, the smallest and the largest."""
    draw = random.Random(5)
    return [[draw.choice((0.0, -0.0, h / 3, -h, 2.0**-149, -(2.0**-140), 1e6)) for h in row] for row in rows]


# name: ENVI's number of the sample type, struct's letter, rows
def rasters():
    yield "int16", 2, "h", each(mountains(150, 140, 1), round)
    yield "int16_voids", 2, "h", with_voids(each(mountains(150, 140, 2), round), 2)
    yield "int16_three_bands", 2, "h", with_voids(each(mountains(1100, 18, 3), round), 3)
    yield "int16_small", 2, "h", each(mountains(5, 9, 4), round)
    yield "int16_line", 2, "h", each(mountains(40, 1, 5), round)
    yield "float32_decimetres", 4, "f", with_voids(each(mountains(140, 60, 6), lambda h: round(h, 1)), 6)
    yield "float32_millimetres", 4, "f", each(mountains(70, 131, 7), lambda h: round(h, 3))
    yield "float32_any", 4, "f", mountains(140, 50, 8)
    yield "float32_special", 4, "f", special(mountains(60, 50, 9))
    yield "float64_centimetres", 5, "d", each(mountains(140, 50, 10), lambda h: round(h, 2))
    yield "float64_pages_of_decimals", 5, "d", [[h if c < 100 else round(h, 2) for c, h in enumerate(row)]
                                                for row in mountains(260, 40, 11)]
    yield "float64_any", 5, "d", with_voids(mountains(140, 50, 12), 12)


def write(path, number, letter, rows):
    path.write_bytes(b"".join(struct.pack("<%d%s" % (len(row), letter), *row) for row in rows))
    path.with_suffix(".hdr").write_text(
        "ENVI\nsamples = %d\nlines = %d\nbands = 1\ndata type = %d\ninterleave = bsq\nbyte order = 0\n"
        "header offset = 0\ndata ignore value = %d\n" % (len(rows[0]), len(rows), number, VOID))


def talus(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("%s: exit %d: %s" % (arguments, done.returncode, done.stderr))


def read_ply(path, mapping):
    head, rest = path.read_bytes().split(b"end_header\n", 1)
    count = {line.split()[1]: int(line.split()[2]) for line in head.split(b"\n") if line.startswith(b"element")}
    points = list(struct.iter_unpack("<ddd", rest[: 24 * count[b"vertex"]]))
    places = [(round((x - mapping["x0"]) / mapping["dx"]), round((y - mapping["y0"]) / mapping["dy"])) for x, y, _ in points]
    faces = [frozenset(places[i] for i in face[1:]) for face in struct.iter_unpack("<Biii", rest[24 * count[b"vertex"] :])]
    if len(faces) != count[b"face"] or len(set(faces)) != len(faces):
        sys.exit("%s: a triangle twice, or the file is cut short" % path)
    return set(faces), {p: z for p, (_, _, z) in zip(places, points)}


def bits(height):
    return struct.pack("<d", height)


def check(program, folder, name, number, letter, rows):
    raster, file, answer = folder / (name + ".bin"), folder / (name + ".talus"), folder / (name + ".ply")
    write(raster, number, letter, rows)
    talus(program, "ingest", "--overwrite", raster, file)
    database = read_v2.Database(file)

    samples, cols = database.samples(), len(rows[0])
    for i, (value,) in enumerate(struct.iter_unpack("<" + letter, raster.read_bytes())):
        place = i % cols, i // cols
        found = samples.get(place)
        if (found is None) != (value == VOID) or (found is not None and bits(found) != bits(value)):
            sys.exit("%s: sample %s is %s, the raster has %s" % (name, place, found, value))

    draw = random.Random(name)
    mapping, last = database.manifest["mapping"], (cols - 1, len(rows) - 1)
    triangles = 0
    for attempt in range(5):
        region = [0, 0, *last]
        if attempt > 1 and min(last) > 0:
            region = [v for pair in zip(*(sorted(draw.sample(range(n + 1), 2)) for n in last)) for v in pair]
        tolerance = (0.0, 5.0)[attempt] if attempt < 2 else draw.choice((0.1, 0.5, 1.0, 7.5, 40.0))
        arguments = [program, "query", file, "--tolerance", tolerance, "-o", answer]
        if region != [0, 0, *last]:
            x = sorted(mapping["x0"] + region[i] * mapping["dx"] for i in (0, 2))
            y = sorted(mapping["y0"] + region[i] * mapping["dy"] for i in (1, 3))
            arguments.append("--bbox=%r,%r,%r,%r" % (x[0], y[0], x[1], y[1]))
        talus(*arguments)
        theirs, ours = read_ply(answer, mapping), database.mesh(region, tolerance)
        if theirs[0] != ours[0]:
            sys.exit("%s: region %s at %g m: %d triangles are the program's only, %d the reader's only"
                     % (name, region, tolerance, len(theirs[0] - ours[0]), len(ours[0] - theirs[0])))
        if {p: bits(z) for p, z in theirs[1].items()} != {p: bits(z) for p, z in ours[1].items()}:
            sys.exit("%s: region %s at %g m: other heights" % (name, region, tolerance))
        triangles += len(ours[0])
    codings = sorted({page.coding for page in database.pages.values()})
    print("%-26s %6d samples, %6d triangles in 5 answers, codings %s, exact %s"
          % (name, len(samples), triangles, codings, database.exact))
    return codings


def main():
    program, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    seen = set()
    try:
        for raster in rasters():
            seen.update(check(program, folder, *raster))
    except read_v2.Missing as missing:
        print("skipped:", missing)
        sys.exit(77)
    print("codings seen:", sorted(seen))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main()
