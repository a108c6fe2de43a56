#!/usr/bin/env python3
"""A second reader of Talus databases, which follows docs/format/v1.md and shares no code with the program.

Only Python's standard library, and LMDB, zstd and xxHash through ctypes. Slow and plain: it is here to show that the
document says enough. read_v1_test.py holds it against the program.
"""

import ctypes
import ctypes.util
import json
import math
import struct
from fractions import Fraction


class Missing(Exception):
    """A library that this reader needs is not there."""


class Damage(Exception):
    """Something the format does not allow."""


def require(condition, what):
    if not condition:
        raise Damage(what)


def library(name):
    found = ctypes.util.find_library(name)
    if found is None:
        raise Missing("no lib" + name)
    return ctypes.CDLL(found)


# ---- section 1: the file ---------------------------------------------------------------------------------


class MdbVal(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("data", ctypes.c_void_p)]


class Tables:
    """The named tables of the LMDB file, every value checked against its checksum."""

    NOSUBDIR, RDONLY, NOLOCK, NOTFOUND = 0x4000, 0x20000, 0x400000, -30798

    def __init__(self, path):
        self.mdb, self.xxh = library("lmdb"), library("xxhash")
        self.xxh.XXH3_64bits_withSeed.restype = ctypes.c_uint64
        self.xxh.XXH3_64bits_withSeed.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint64]
        env, self.txn = ctypes.c_void_p(), ctypes.c_void_p()
        self.ok(self.mdb.mdb_env_create(ctypes.byref(env)))
        self.ok(self.mdb.mdb_env_set_maxdbs(env, 33))
        self.ok(self.mdb.mdb_env_open(env, str(path).encode(), self.NOSUBDIR | self.RDONLY | self.NOLOCK, 0))
        self.ok(self.mdb.mdb_txn_begin(env, None, self.RDONLY, ctypes.byref(self.txn)))
        self.opened = {}

    @staticmethod
    def ok(code):
        require(code == 0, "LMDB says %d" % code)

    def table(self, number):
        if number not in self.opened:
            name = b"header" if number == -1 else b"band/%02d" % number
            dbi = ctypes.c_uint()
            code = self.mdb.mdb_dbi_open(self.txn, name, 0, ctypes.byref(dbi))
            if code != self.NOTFOUND:
                self.ok(code)
            self.opened[number] = dbi if code == 0 else None
        return self.opened[number]

    def get(self, number, position):
        dbi = self.table(number)
        if dbi is None:
            return None
        raw = struct.pack(">Q", position)
        key = MdbVal(8, ctypes.cast(ctypes.c_char_p(raw), ctypes.c_void_p))
        value = MdbVal()
        code = self.mdb.mdb_get(self.txn, dbi, ctypes.byref(key), ctypes.byref(value))
        if code == self.NOTFOUND:
            return None
        self.ok(code)
        stored = ctypes.string_at(value.data, value.size)
        require(len(stored) >= 8, "a value without its checksum")
        content = stored[8:]
        prefix = bytes([number & 0xFF]) + raw
        seed = self.xxh.XXH3_64bits_withSeed(prefix, len(prefix), 0)
        require(struct.unpack(">Q", stored[:8])[0] == self.xxh.XXH3_64bits_withSeed(content, len(content), seed), "checksum")
        return content


# ---- section 3: vertices ---------------------------------------------------------------------------------


def power(v):
    return 1 << 30 if v == 0 else v & -v


def spacing(p):
    return power(p[0] | p[1])


def diamond(p):
    """(ends, apexes)"""
    (col, row), s = p, spacing(p)
    if col & s and row & s:
        nw, ne, sw, se = (col - s, row - s), (col + s, row - s), (col - s, row + s), (col + s, row + s)
        even = (nw[0] // (2 * s) + nw[1] // (2 * s)) % 2 == 0
        return ((nw, se), (ne, sw)) if even else ((ne, sw), (nw, se))
    across, along = ((col, row - s), (col, row + s)), ((col - s, row), (col + s, row))
    return (along, across) if col & s else (across, along)


# ---- section 7: errors -----------------------------------------------------------------------------------


def ladder():
    rungs = [25 * n / 10**7 for n in range(41)]
    for d in range(11):
        for i in range(1, 361):
            whole = 25 * (40 + i)
            rungs.append(whole / 10 ** (7 - d) if d < 7 else float(whole * 10 ** (d - 7)))
    return rungs + [math.inf]


LADDER = ladder()


# ---- sections 4 to 6: pages ------------------------------------------------------------------------------


def signed(v, bits=64):
    v &= (1 << bits) - 1
    return v - (1 << bits) if v >> (bits - 1) else v


def unrise(v, bits):
    return v ^ ((1 << (bits - 1)) - 1) if v < 0 else v


def to_float(v):
    return struct.unpack("<f", struct.pack("<f", v))[0]


def height_code(k, coding):
    if coding == 0:
        return float(k)
    if coding <= 3:
        return k / 10**coding
    if coding <= 6:
        return to_float(k / 10 ** (coding - 3))
    if coding == 7:
        return struct.unpack("<f", struct.pack("<i", unrise(signed(k, 32), 32)))[0]
    return struct.unpack("<d", struct.pack("<q", unrise(k, 64)))[0]


def position(x, y):
    """The key of a page: its coordinates, signs flipped, bits interleaved."""
    x, y = (x & 0xFFFFFFFF) ^ 1 << 31, (y & 0xFFFFFFFF) ^ 1 << 31
    return sum((x >> k & 1) << 2 * k | (y >> k & 1) << 2 * k + 1 for k in range(32))


class Page:
    def __init__(self, database, band, x, y):
        self.database, self.band, self.x, self.y = database, band, x, y
        unit, side, e = database.children**band, database.side, database.extent
        self.unit = unit
        self.col = max(-(-e[0] // unit), x * side)
        self.row = max(-(-e[1] // unit), y * side)
        self.cols = min(e[2] // unit, x * side + side - 1) - self.col + 1
        self.rows = min(e[3] // unit, y * side + side - 1) - self.row + 1

    def points(self):
        """(index, grid point) of every sample."""
        for r in range(self.rows):
            for c in range(self.cols):
                yield r * self.cols + c, ((self.col + c) * self.unit, (self.row + r) * self.unit)

    def is_own(self, c, r):
        last = self.band == self.database.bands - 1
        return last or (self.col + c) % self.database.children != 0 or (self.row + r) % self.database.children != 0

    def neighbours(self, c, r):
        """Of an implied midpoint: the indices of its two neighbours; else nothing."""
        i = r * self.cols + c
        col_odd, row_odd = (self.col + c) % 2, (self.row + r) % 2
        if not self.implied or col_odd == row_odd:
            return None
        if col_odd:
            return (i - 1, i + 1) if 0 < c < self.cols - 1 else None
        return (i - self.cols, i + self.cols) if 0 < r < self.rows - 1 else None

    def decode(self, content):
        n = self.cols * self.rows
        version, coding, flags, width, cols, rows = struct.unpack_from("<BBBBHH", content)
        require(version == 1 and coding <= 8 and flags <= 15 and width in (1, 2, 4, 8), "page header")
        require((cols, rows) == (self.cols, self.rows), "page size")
        self.coding = coding
        self.implied = bool(flags & 4)
        at = 8

        def section(size):
            nonlocal at
            (word,) = struct.unpack_from("<I", content, at)
            m = word & 0x7FFFFFFF
            raw = content[at + 4 : at + 4 + m]
            require(len(raw) == m, "section longer than the page")
            at += 4 + m
            if not word >> 31:
                raw = self.database.unpack(raw, size)
            require(len(raw) == size, "length of a section")
            return raw

        self.valid, self.covers = b"\x01" * n, b"\x0f" * n
        if flags & 1:
            bits = section((n + 7) // 8)
            self.valid = bytes(bits[i // 8] >> i % 8 & 1 for i in range(n))
        if flags & 2:
            self.covers = section(n)
        planes = [section(n) for _ in range(width)]
        residuals = [int.from_bytes(z, "little") for z in zip(*planes)]
        self.heights = [height_code(k, coding) for k in self.numbers(residuals)]

        stored = [r * self.cols + c for r in range(self.rows) for c in range(self.cols)
                  if self.is_own(c, r) and self.neighbours(c, r) is None]
        low, high = section(len(stored)), section(len(stored))
        self.errors = {i: LADDER[l | h << 8] for i, l, h in zip(stored, low, high)}
        self.below = []
        if flags & 8:
            self.below = [struct.unpack_from("<BHff", entry) for entry in
                          struct.iter_unpack("11s", section(11 * self.database.children**2)) for entry in entry]
        require(at == len(content), "bytes behind the last section")
        return self

    def error(self, i):
        """In metres; None where another page has it."""
        if i in self.errors:
            return self.errors[i]
        r, c = divmod(i, self.cols)
        if not self.is_own(c, r):
            return None
        a, b = (self.heights[j] for j in self.neighbours(c, r))
        return self.database.midpoint_error(self.heights[i], a, b)

    def numbers(self, residuals):
        """Section 6: undoes the prediction."""
        side, cols, rows = self.database.side, self.cols, self.rows
        u, v = self.col % side, self.row % side
        numbers = [0] * (cols * rows)
        residuals = iter(residuals)

        def has(p):
            return 0 <= p[0] < cols and 0 <= p[1] < rows

        def at(p):
            return numbers[p[1] * cols + p[0]]

        def pair(p, q):
            there = [at(o) for o in (p, q) if has(o)]
            return (sum(there) // len(there) if there else 0), len(there)

        def put(p, predicted):
            z = next(residuals)
            numbers[p[1] * cols + p[0]] = signed(predicted + (-(z + 1) // 2 if z & 1 else z // 2))

        def centre(c, r, s):
            (a, na), (b, nb) = pair((c - s, r - s), (c + s, r + s)), pair((c + s, r - s), (c - s, r + s))
            if na == nb:
                return (a + b) // 2  # of nothing and nothing: 0
            return a if na > nb else b

        def middle(ends, apexes):
            (along, n), (across, m) = pair(*ends), pair(*apexes)
            if n == 2 and m == 2:
                return along + (signed(across - along) >> 2)
            return along if n >= m else across

        if u == 0 and v == 0:
            put((0, 0), 0)
        s = side // 2
        while s >= 1:
            for r in range((s - v) % (2 * s), rows, 2 * s):
                for c in range((s - u) % (2 * s), cols, 2 * s):
                    put((c, r), centre(c, r, s))
            for r in range(-v % s, rows, s):
                odd = (r + v) % (2 * s) == s
                for c in range((-u if odd else s - u) % (2 * s), cols, 2 * s):
                    up, along = ((c, r - s), (c, r + s)), ((c - s, r), (c + s, r))
                    put((c, r), middle(up, along) if odd else middle(along, up))
            s //= 2
        require(next(residuals, None) is None, "residuals left over")
        return numbers


# ---- section 2, and the questions ------------------------------------------------------------------------


class Database:
    def __init__(self, path):
        self.tables, self.zstd = Tables(path), library("zstd")
        self.zstd.ZSTD_decompress.restype = ctypes.c_size_t
        self.zstd.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
        text = self.tables.get(-1, 0)
        require(text is not None, "no header")
        m = self.manifest = json.loads(text)
        require(m["talus"] == 1, "another version")
        layout, step = m["layout"], m["step"]
        self.children, self.side, self.bands = 2 ** layout["band_levels"], layout["page_side"], layout["bands"]
        self.extent = m["extent"]
        self.exact = m["errors"]["exact_arithmetic"]
        self.root = 1
        while self.root <= max(abs(v) for v in self.extent):
            self.root *= 2
        require(self.side * self.children ** (self.bands - 1) >= self.root, "number of bands")
        require(self.bands == 1 or self.side * self.children ** (self.bands - 2) < self.root, "number of bands")
        scale, per_unit = abs(step["scale"]), m["vertical"]["metres_per_unit"]
        whole = math.floor(1 / scale + 0.5)
        fraction = scale < 1 and abs(scale * whole - 1) < 1e-14
        self.factor = (1 if fraction else scale) * per_unit
        self.divisor = step["divisor"] * (whole if fraction else 1)
        self.pages = {}

    def unpack(self, frame, size):
        out = ctypes.create_string_buffer(max(size, 1))
        require(self.zstd.ZSTD_decompress(out, size, frame, len(frame)) == size, "a section does not unpack")
        return out.raw[:size]

    def page(self, band, x, y):
        if (band, x, y) not in self.pages:
            content = self.tables.get(band, position(x, y))
            require(content is not None, "page %d/%d of band %d is missing" % (x, y, band))
            self.pages[band, x, y] = Page(self, band, x, y).decode(content)
        return self.pages[band, x, y]

    def height(self, code):
        step = self.manifest["step"]
        scaled = code * step["scale"] / step["divisor"]
        return scaled if step["offset"] == 0 else scaled + step["offset"]

    def midpoint_error(self, h, a, b):
        metres = abs(h - (a + b) / 2) * self.factor / self.divisor
        if self.exact:
            return metres
        return 0.0 if Fraction(a) + Fraction(b) == 2 * Fraction(h) else metres + 4e-9

    def walk(self, region, wanted):
        """The pages that overlap a region, from the top; wanted(band, x, y, largest error) says which."""
        def overlaps(band, x, y):
            cells = self.side * self.children**band
            return (x * cells <= region[2] and (x + 1) * cells > region[0] and
                    y * cells <= region[3] and (y + 1) * cells > region[1])

        def visit(band, x, y):
            page = self.page(band, x, y)
            yield page
            for k, (stored, largest, _, _) in enumerate(page.below):
                j, i = divmod(k, self.children)
                child = band - 1, x * self.children + i, y * self.children + j
                if stored and overlaps(*child) and wanted(*child, LADDER[largest]):
                    yield from visit(*child)

        top = self.bands - 1
        cells = self.side * self.children**top
        for y in range(self.extent[1] // cells, self.extent[3] // cells + 1):
            for x in range(self.extent[0] // cells, self.extent[2] // cells + 1):
                if overlaps(top, x, y):
                    yield from visit(top, x, y)

    def samples(self):
        """Section 8: {grid point: height} of all samples that are data."""
        found = {}
        for page in self.walk(self.extent, lambda *_: True):
            if page.band == 0:
                found.update((p, self.height(page.heights[i])) for i, p in page.points() if page.valid[i])
        return found

    def border(self, region):
        """Section 9: vertices the border needs, those beyond the region included."""
        c0, r0, c1, r1 = region
        needed = {(c, r) for c in (c0, c1) for r in (r0, r1)}

        def cut(fixed, first, last, place):
            p = first
            while p < last:
                length = min(power(fixed), power(p), 16)
                while p + length > last:
                    length //= 2
                for end in (place(p), place(p + length)):
                    if end[0] // length % 2 != end[1] // length % 2:
                        needed.add(end)
                p += length

        for row in (r0, r1):
            cut(row, c0, c1, lambda v: (v, row))
        for col in (c0, c1):
            cut(col, r0, r1, lambda v: (col, v))
        waiting = list(needed)
        while waiting:
            p = waiting.pop()
            if spacing(p) < self.root:
                new = set(diamond(p)[1]) - needed
                needed |= new
                waiting += new
        return needed

    def mesh(self, region, tolerance):
        """Section 9: {triangle: as a set of grid points}, {grid point: height}."""
        c0, r0, c1, r1 = region

        def inside(p):
            return c0 <= p[0] <= c1 and r0 <= p[1] <= r1

        forced = {p for p in self.border(region) if inside(p)}
        pages = set()
        for p in forced:
            band = min((spacing(p).bit_length() - 1) // (self.children.bit_length() - 1), self.bands - 1)
            for b in range(band, self.bands):
                cells = self.side * self.children**b
                pages.add((b, p[0] // cells, p[1] // cells))

        selected = {}  # grid point: (height, covers)
        for page in self.walk(region, lambda b, x, y, largest: largest > tolerance or (b, x, y) in pages):
            for i, p in page.points():
                error = page.error(i) if inside(p) else None
                if error is not None and (error > tolerance or p in forced):
                    selected[p] = self.height(page.heights[i]), page.covers[i]

        triangles, heights = set(), {}
        for p, (_, covers) in selected.items():
            if spacing(p) >= self.root:
                continue
            ends, apexes = diamond(p)
            finest = spacing(p) == 1 and (p[0] + p[1]) % 2 == 1
            for k in range(4):
                apex, end = apexes[k // 2], ends[k % 2]
                split = (apex[0] + end[0]) // 2, (apex[1] + end[1]) // 2
                if covers >> k & 1 and inside(apex) and inside(end) and (finest or split not in selected):
                    triangles.add(frozenset((p, apex, end)))
                    heights.update((q, selected[q][0]) for q in (p, apex, end))
        return triangles, heights


if __name__ == "__main__":
    import sys

    database = Database(sys.argv[1])
    print(json.dumps(database.manifest, indent=1))
    found = database.samples()
    print(len(found), "samples,", min(found.values()), "to", max(found.values()))
