#!/usr/bin/env python3
"""A second reader of Talus databases, which follows docs/format/v3.md and shares no code with the program.

Only Python's standard library, and LMDB, xxHash and zstd through ctypes. Slow and plain: it is here to show that
the document says enough. read_v3_test.py holds it against the program.
"""

import bisect
import ctypes
import ctypes.util
import functools
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
    """The entries of the LMDB file, everything checked against its checksum."""

    NOSUBDIR, RDONLY, NOLOCK, NOTFOUND = 0x4000, 0x20000, 0x400000, -30798

    def __init__(self, path):
        self.mdb, self.xxh = library("lmdb"), library("xxhash")
        self.xxh.XXH3_64bits_withSeed.restype = ctypes.c_uint64
        self.xxh.XXH3_64bits_withSeed.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint64]
        env, self.txn = ctypes.c_void_p(), ctypes.c_void_p()
        self.ok(self.mdb.mdb_env_create(ctypes.byref(env)))
        self.ok(self.mdb.mdb_env_open(env, str(path).encode(), self.NOSUBDIR | self.RDONLY | self.NOLOCK, 0))
        self.ok(self.mdb.mdb_txn_begin(env, None, self.RDONLY, ctypes.byref(self.txn)))
        self.entries = ctypes.c_uint()
        self.ok(self.mdb.mdb_dbi_open(self.txn, None, 0, ctypes.byref(self.entries)))

    @staticmethod
    def ok(code):
        require(code == 0, "LMDB says %d" % code)

    def value(self, number, position):
        key = struct.pack(">BQ", number + 1, position)
        at = MdbVal(9, ctypes.cast(ctypes.c_char_p(key), ctypes.c_void_p))
        value = MdbVal()
        code = self.mdb.mdb_get(self.txn, self.entries, ctypes.byref(at), ctypes.byref(value))
        if code == self.NOTFOUND:
            return None
        self.ok(code)
        return ctypes.string_at(value.data, value.size)

    def checksum(self, number, position, generation, content):
        prefix = bytes([number & 0xFF]) + struct.pack(">Q", position) + struct.pack("<I", generation)
        seed = self.xxh.XXH3_64bits_withSeed(prefix, len(prefix), 0)
        return struct.pack(">Q", self.xxh.XXH3_64bits_withSeed(content, len(content), seed))

    def get(self, number, position):
        """(content, generation) of a page; None where there is none."""
        stored = self.from_tile(number, position) if number in (0, 1, 32, 33) else self.value(number, position)
        if not stored:
            return None
        require(len(stored) >= 12, "a value without its prefix")
        generation, content = struct.unpack_from("<I", stored, 8)[0], stored[12:]
        require(stored[:8] == self.checksum(number, position, generation, content), "checksum")
        return content, generation

    def from_tile(self, number, place):
        x, y = (sum((place >> 2 * bit + axis & 1) << bit for bit in range(32)) - 2**31 for axis in (0, 1))
        tile = position(x >> 3, y >> 3) if number == 0 else place
        value = self.value(0, tile)
        if value is None:
            return None
        require(len(value) >= 8 + 268, "a tile without its directory")
        directory = value[8 : 8 + 268]
        require(value[:8] == self.checksum(0, tile ^ (1 << 64) - 1, 0, directory), "checksum of a tile's directory")
        lengths = struct.unpack("<67I", directory)
        require(len(value) == 8 + 268 + sum(lengths), "length of a tile")
        part = {33: 0, 1: 1, 32: 66}.get(number)
        if part is None:
            x, y = x % 8, y % 8
            part = 2 + (7 - y if x == 0 else 7 + x if y == 0 else 15 + 7 * (y - 1) + x - 1)
        start = 8 + 268 + sum(lengths[:part])
        return value[start : start + lengths[part]]


def xxh3(content):
    xxh = library("xxhash")
    xxh.XXH3_64bits.restype, xxh.XXH3_64bits.argtypes = ctypes.c_uint64, [ctypes.c_char_p, ctypes.c_size_t]
    return xxh.XXH3_64bits(content, len(content))


def seal_is_whole(path):
    """The file's last 32 bytes fit all the others."""
    xxh = library("xxhash")

    class Hash128(ctypes.Structure):
        _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]

    xxh.XXH3_128bits.restype = Hash128
    xxh.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    with open(path, "rb") as file:
        content = file.read()
    sealed, seal = content[:-32], content[-32:]
    digest = xxh.XXH3_128bits(sealed, len(sealed))
    return seal == b"TALUSEND" + struct.pack("<Q", len(sealed)) + struct.pack(">QQ", digest.high, digest.low)


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


def is_centre(p):
    return bool(p[0] & spacing(p) and p[1] & spacing(p))


def is_side_midpoint(p):
    return not is_centre(p)


def children_of(p):
    """The vertices that have p as a parent."""
    s = spacing(p)
    if is_centre(p):
        return [(p[0] - s, p[1]), (p[0] + s, p[1]), (p[0], p[1] - s), (p[0], p[1] + s)]
    h = s // 2
    return [(p[0] + i * h, p[1] + j * h) for i in (-1, 1) for j in (-1, 1)] if h else []


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


def number_of_code(h, coding):
    """The number whose height code is h."""
    if coding <= 6:
        return round(h * 10 ** (coding if coding <= 3 else coding - 3))
    if coding == 7:
        return unrise(struct.unpack("<i", struct.pack("<f", h))[0], 32)
    return unrise(struct.unpack("<q", struct.pack("<d", h))[0], 64)


# ---- section 5.1: whole numbers as bits --------------------------------------------------------------------


ONE = 1 << 62


def power62(base, exponent):
    result = ONE
    while exponent:
        if exponent & 1:
            result = result * base >> 62
        base = base * base >> 62
        exponent >>= 1
    return result


def token_range(token):
    """First number of a token, and the bits below it."""
    if token < 16:
        return token, 0
    high = (token - 16) // 2 + 4
    return (2 + token % 2) << (high - 1), high - 1


ESCAPE = 136


def states_of(t):
    """How many of the 1024 states of distribution t each token has."""
    mean = (23170 if t % 2 else 16384) << (t // 2)
    narrow, wide = mean // 8 * 5, 2 * mean
    narrow, wide = ((m * ONE) // (m + (1 << 20)) for m in (narrow, wide))

    def at_least(v):
        q = power62(narrow, v)
        return (q << 62) // (ONE + q) * 2 // 10 * 9 + power62(wide, v) // 10

    counts = []
    for token in range(ESCAPE):
        first, bits = token_range(token)
        chance = max(at_least(first) - at_least(first + (1 << bits)), 0)
        count = ((chance >> 51) + 1) // 2
        counts.append(1 if count == 0 and chance > ONE >> 14 else count)
    largest = counts.index(max(counts))
    counts.append(1)
    while sum(counts) < 1024:
        counts[largest] += 1
    while sum(counts) > 1024:
        counts[counts.index(max(counts))] -= 1
    return counts


TABLES = {}


def table(t):
    """(token, bits to read, next state without them) of every state."""
    if t not in TABLES:
        counts, tokens, place = states_of(t), [None] * 1024, 0
        for token, count in enumerate(counts):
            for _ in range(count):
                tokens[place] = token
                place = (place + 643) % 1024
        TABLES[t], seen = [], list(counts)
        for token in tokens:
            x = seen[token]
            seen[token] += 1
            bits = 11 - x.bit_length()
            TABLES[t].append((token, bits, (x << bits) - 1024))
    return TABLES[t]


class Numbers:
    def __init__(self, content):
        require(len(content) >= 12, "a sequence without its head")
        used = [c for c in range(96) if content[c // 8] >> c % 8 & 1]
        at = 12 + len(used)
        require(len(content) >= at + 6, "a sequence without its head")
        self.table = dict.fromkeys(range(96), 0)
        self.table.update(zip(used, content[12:at]))
        require(all(t < 96 for t in self.table.values()), "distribution")
        head = int.from_bytes(content[at : at + 6], "little")
        self.states = [head >> 8 + 10 * k & 1023 for k in range(4)]
        self.bits, self.size = int.from_bytes(content[at + 6 :], "little"), 8 * len(content[at + 6 :])
        self.at, self.turn = head & 255, 0
        require(self.at < 8, "idle bits")

    def take(self, count):
        bits = self.bits >> self.at & (1 << count) - 1
        self.at += count
        return bits

    def get(self, context):
        token, bits, following = table(self.table[context])[self.states[self.turn]]
        if token == ESCAPE:
            number = self.take(self.take(6) + 1)
        else:
            first, low = token_range(token)
            number = first + self.take(low)
        self.states[self.turn] = following + self.take(bits)
        self.turn = (self.turn + 1) % 4
        return number

    def finish(self):
        require(self.at == self.size and self.states == [0] * 4, "bits missing or left over")


def unzigzag(z):
    return -(z + 1) // 2 if z & 1 else z // 2


VOIDS, COVERS, CHILDREN = 0, 17, 19  # first contexts


# ---- section 6: heights ------------------------------------------------------------------------------------


SIDE = 128  # of a page's square
CLASSES = 26


def bits_of(content):
    """The bits of a stream, as text of 0 and 1."""
    return bin(int.from_bytes(content + b"\1", "little"))[:2:-1]


def number_of(bits):
    """The number whose lowest bit comes first."""
    return int(bits[::-1], 2) if bits else 0


class HeightNumbers:
    """The numbers of a page's square: numbers[x + 128·y]."""

    def __init__(self, content, width, stored, above=None):
        """above: the corner numbers that are known by place, where the page does not have any."""
        self.w, self.stored, self.numbers = 8 * width, stored, [0] * SIDE**2
        self.streams(content, self.corners(content) if above is None else self.corners_above(content, above))
        for s in (4, 2, 1):
            self.spacing(s)
        require(self.high_at == len(self.high) - 1 and self.low_at == len(self.low), "bits left over in heights")
        require(len(self.flags) < self.flag_at + 8 and "1" not in self.flags[self.flag_at :], "flags left over")
        require(not self.apart, "numbers listed apart in another order")

    def wrap(self, v):
        half = 1 << self.w - 1
        return (v + half & 2 * half - 1) - half

    def corners(self, content):
        """Section 6.1; returns how many bytes they take."""
        at = 0
        for y in range(0, SIDE, 8):
            b = content[at]
            require(b <= self.w, "bits of corners")
            bits, at = bits_of(content[at + 1 : at + 1 + 2 * b]), at + 1 + 2 * b
            for k, x in enumerate(range(0, SIDE, 8)):
                before = (x - 8, y) if x else (0, y - 8) if y else None
                number = self.numbers[before[0] + SIDE * before[1]] if before else 0
                self.numbers[x + SIDE * y] = self.wrap(number + unzigzag(number_of(bits[k * b : k * b + b])))
        return at

    def corners_above(self, content, above):
        """The same where the page above has them."""
        packed = b""
        for y in range(0, SIDE, 8):
            for x in range(0, SIDE, 8):
                before = (x - 8, y) if x else (0, y - 8) if y else None
                number = self.numbers[before[0] + SIDE * before[1]] if before else 0
                number = self.numbers[x + SIDE * y] = self.wrap(above.get(x + SIDE * y, number))
                packed += (number % (1 << self.w)).to_bytes(self.w // 8, "little")
        check = xxh3(packed) % 2**32
        require(content[:4] == check.to_bytes(4, "little"), "corners of another page above")
        return 4

    def streams(self, content, at):
        """Section 6.3: what stands before the groups."""
        self.shift, least, apart, high, flags, flagged = struct.unpack_from("<BBHHHI", content, at)
        require(self.shift < self.w and least <= self.w - 16 and flagged >> CLASSES == 0, "head of heights")
        self.flagged = [flagged >> q & 1 for q in range(CLASSES)]
        self.low_bits = [least + (content[at + 12 + q // 2] >> 4 * (q % 2) & 15) for q in range(CLASSES)]
        at += 25
        self.apart = []
        for _ in range(apart):
            place, number = content[at : at + 2], content[at + 2 : at + 2 + self.w // 8]
            self.apart.append((int.from_bytes(place, "little"), int.from_bytes(number, "little")))
            at += 2 + self.w // 8
        self.all_flagged = flags == 65535
        flags = 0 if self.all_flagged else flags
        require(at + flags + high <= len(content), "streams of heights")
        self.flags, self.flag_at = bits_of(content[at : at + flags]), 0
        self.high, self.high_at = bits_of(content[at + flags : at + flags + high]).split("1"), 0  # zeros before each 1
        self.low, self.low_at = content[at + flags + high :], 0

    def spacing(self, s):
        """Section 6.2: both passes of a spacing."""
        m = SIDE // (2 * s)
        places = range(m)
        even = {(c, r): self.numbers[2 * c * s + SIDE * 2 * r * s] for r in places for c in places}
        self.rim(even, m)
        straight = self.bends(m, even, lambda c, r: (
            even[c - 1, r] + even[c + 1, r], even[c, r - 1] + even[c, r + 1]))
        for r in places:
            self.row(s, (2 * r + 1) * s, 2 * s, [
                self.predicted([(even[c + i, r + j], straight[c + i, r + j]) for j in (0, 1) for i in (0, 1)])
                for c in places])
        self.end_pass(s, True)

        centres = {(c, r): self.numbers[(2 * c + 1) * s + SIDE * (2 * r + 1) * s] for r in places for c in places}
        self.rim(centres, m)
        diagonal = self.bends(m, even, lambda c, r: (
            centres[c - 1, r - 1] + centres[c, r], centres[c, r - 1] + centres[c - 1, r]))
        of_centre = self.bends(m, centres, lambda c, r: (
            even[c, r] + even[c + 1, r + 1], even[c + 1, r] + even[c, r + 1]))
        for r in places:
            self.row(s, 2 * r * s, 2 * s, [
                self.predicted([(even[c, r], diagonal[c, r]), (even[c + 1, r], diagonal[c + 1, r]),
                                (centres[c, r - 1], of_centre[c, r - 1]), (centres[c, r], of_centre[c, r])])
                for c in places])
            self.row(0, (2 * r + 1) * s, 2 * s, [
                self.predicted([(even[c, r], diagonal[c, r]), (even[c, r + 1], diagonal[c, r + 1]),
                                (centres[c - 1, r], of_centre[c - 1, r]), (centres[c, r], of_centre[c, r])])
                for c in places])
        self.end_pass(s, False)

    def rim(self, grid, m):
        for r in range(m):
            grid[-1, r] = self.wrap(2 * grid[0, r] - grid[1, r])
            grid[m, r] = self.wrap(2 * grid[m - 1, r] - grid[m - 2, r])
        for c in range(-1, m + 1):
            grid[c, -1] = self.wrap(2 * grid[c, 0] - grid[c, 1])
            grid[c, m] = self.wrap(2 * grid[c, m - 1] - grid[c, m - 2])

    def bends(self, m, grid, pairs):
        """{place: (sum of its two bends, sum of their sizes)}, for the rim, too; pairs(c, r): the sums of its pairs."""
        found = {}
        for r in range(m):
            for c in range(m):
                a, b = (self.wrap(pair - 2 * grid[c, r]) for pair in pairs(c, r))
                found[c, r] = a + b, abs(a) + abs(b)
        for k in range(-1, m + 1):
            inside = min(max(k, 0), m - 1)
            found[-1, k], found[m, k] = found[0, inside], found[m - 1, inside]
            found[k, -1], found[k, m] = found[inside, 0], found[inside, m - 1]
        return found

    def predicted(self, near):
        """(prediction, bent) from four numbers with their bends."""
        (a, (sum_a, size_a)), (b, (sum_b, size_b)), (c, (sum_c, size_c)), (d, (sum_d, size_d)) = near
        correction = self.wrap(3 * (sum_a + sum_b + sum_c + sum_d)) >> 4
        number = self.wrap(a + (self.wrap(b + c + d - 3 * a - correction + 2) >> 2))
        return number, (size_a + size_b + size_c + size_d) % (1 << self.w)

    def row(self, x, y, step, predictions):
        """Section 6.3: the groups of a row."""
        largest, below = (1 << self.w) - 1, (1 << self.shift) - 1
        for first in range(0, len(predictions), 16):
            group = predictions[first : first + 16]
            places = [x + (first + k) * step + SIDE * y for k in range(16)]
            for place, (number, _) in zip(places, group):
                self.numbers[place] = number
            total = sum(min(min(bent + below, largest) >> self.shift, 255) for _, bent in group)
            high = total.bit_length() - 1
            self.group([p for p in places if self.stored[p]],
                       total if total < 2 else 1 + 2 * high + (total >> high - 1 & 1))

    def group(self, stored, of):
        if not stored:
            return
        if self.flagged[of]:
            if self.all_flagged:
                return
            self.flag_at += 1
            require(self.flag_at <= len(self.flags), "too few flags of heights")
            if self.flags[self.flag_at - 1] == "1":
                return
        n = self.low_bits[of]
        size = (n * len(stored) + 7) // 8
        require(self.low_at + size <= len(self.low), "too few low parts of heights")
        require(self.high_at + len(stored) < len(self.high), "too few high parts of heights")
        low = int.from_bytes(self.low[self.low_at : self.low_at + size], "little")
        self.low_at += size
        for place in stored:
            z = len(self.high[self.high_at]) << n | low & (1 << n) - 1
            low >>= n
            self.high_at += 1
            self.numbers[place] = self.wrap(self.numbers[place] + unzigzag(z))

    def end_pass(self, s, centres):
        while self.apart:
            y, x = divmod(self.apart[0][0], SIDE)
            if power(x | y) != s or bool(x & s and y & s) != centres:
                break
            place, number = self.apart.pop(0)
            self.numbers[place] = self.wrap(number)


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
        self.cols = max(min(e[2] // unit, x * side + side - 1) - self.col + 1, 0)
        self.rows = max(min(e[3] // unit, y * side + side - 1) - self.row + 1, 0)

    def points(self):
        """(index, grid point) of every sample."""
        for r in range(self.rows):
            for c in range(self.cols):
                yield r * self.cols + c, ((self.col + c) * self.unit, (self.row + r) * self.unit)

    def is_own(self, c, r):
        last = self.band == self.database.bands - 1
        return last or (self.col + c) % self.database.children != 0 or (self.row + r) % self.database.children != 0

    def decode(self, content):
        n = self.cols * self.rows
        version, coding, flags, form, cols, rows, width, base, heights, errors = struct.unpack_from("<6BHqII", content)
        require(version == 3 and coding <= 8 and flags <= 63 and form <= 5 and width in (2, 4, 8), "page header")
        require((cols, rows) == (self.cols, self.rows), "page size")
        require(form in (0, 1, 3) or coding == 0 and width <= 4, "form of errors")
        require(form < 4 or width == 2 and self.database.integer == (form == 4), "form of errors")
        require(bool(flags & 4) == (self.band > 0), "child entries")
        require(24 + heights + errors <= len(content), "parts of a page")
        require(not flags & 32 or self.band == 0, "corners of a page above")
        self.coding, self.form, self.width, self.slice = coding, form, width, self.slice_of_tile()
        require(bool(flags & 16) == (self.slice is not None), "a tile that is in a slice, and is not")
        self.errors, self.distances, self.heights = {}, {}, None
        self.offset = self.col % self.database.side, self.row % self.database.side

        heights, content = content[24 : 24 + heights], content[24 + heights :]
        errors, rest = content[:errors], content[errors:]
        numbers = Numbers(rest) if flags & 7 else None
        require(numbers or not rest, "bytes behind a page")
        self.valid = self.voids(numbers) if flags & 1 else [1] * n
        self.covers = self.all_covers(numbers, flags & 8) if flags & 2 else [15] * n
        self.below = self.children(numbers) if flags & 4 else []
        if self.slice:
            nothing = coding == form == 0 and width == 2 and heights == errors == b"" and not flags & 32
            require(nothing, "a page in a slice that has something itself")
            require(base % 2**64 == self.slice.digest, "another slice than the page's")
            self.from_slice()
        else:
            self.from_page(base, heights, errors, flags)
        if numbers:
            numbers.finish()
        return self

    def slice_of_tile(self):
        """Section 8.1: what a page has heights and errors from; None if it has its own."""
        if self.band > 1 or not self.database.keeps:
            return None
        children = self.database.children ** (1 - self.band)
        return self.database.slice(self.x // children, self.y // children)

    def from_page(self, base, heights, errors, flags):
        stored, places = [False] * SIDE**2, []
        for i, p in self.points():
            places.append(self.offset[0] + i % self.cols + SIDE * (self.offset[1] + i // self.cols))
            stored[places[i]] = bool(self.valid[i] or flags & 1 and self.covers[i])
        above = self.corners_above(base) if flags & 32 else None
        square = HeightNumbers(heights, self.width, stored, above).numbers
        self.numbers = [square[place] for place in places]
        self.heights = [height_code(signed(base + square[p]), self.coding) if stored[p] else 0.0 for p in places]
        self.all_errors(errors)

    def from_slice(self):
        """Section 8.1. A height that the slice does not have is None."""
        held, self.heights = self.slice.vertices, []
        for i, p in self.points():
            height, error, covers = held.get(p, (self.slice.posts.get(p), None, None))
            self.heights.append(height)
            if not self.is_own(i % self.cols, i // self.cols):
                continue
            self.errors[i] = error or 0
            if error is None:  # else it is above
                near = self.database.is_near_border(p)
                require(near == (p in held), "a slice without a vertex near the border, or with another")
            require(covers in (None, self.covers[i]), "other covers in a slice")
        if self.band == 1:
            self.check_parents_of_missing_pages()

    def check_parents_of_missing_pages(self):
        """Section 8.1: what a slice has of pages that are not stored."""
        x, y = self.x * self.database.children, self.y * self.database.children
        for p, (_, error, covers) in self.slice.vertices.items():
            page = p[0] // self.database.side - x + self.database.children * (p[1] // self.database.side - y)
            if spacing(p) >= self.database.children or self.below[page][0]:
                continue
            require(error is None and covers == 0, "a vertex of a missing page that is above, or covers something")
            needing = [self.slice.vertices[q] for q in children_of(p) if q in self.slice.vertices]
            require(any(e is None for _, e, _ in needing), "a vertex of a missing page that nothing needs")

    def corners_above(self, base):
        """{place in the square: height number} of the corners that the page above has, too."""
        parent, known = self.database.pages[1, self.x // 8, self.y // 8], {}
        for i, p in self.points():
            if p[0] % 8 or p[1] % 8 or not self.valid[i]:
                continue
            k = parent.index((p[0] // 8, p[1] // 8))
            if k is None or not parent.valid[k]:
                continue
            place = self.offset[0] + i % self.cols + SIDE * (self.offset[1] + i // self.cols)
            known[place] = number_of_code(parent.heights[k], self.coding) - base
        return known

    def all_errors(self, content):
        """Section 7.2."""
        side, last = self.database.side, self.band == self.database.bands - 1
        classes = [[] for _ in range(15 if last else 6)]
        for i, p in self.levels():
            s = self.spacing(p)
            if s >= side:
                classes[14].append((i, p))
            elif self.is_implied(i, p):
                self.distances[i] = self.distance(i, p)
            else:
                classes[2 * (s.bit_length() - 1) + is_centre(p)].append((i, p))
        bits, at = bits_of(content), 1
        require(bits, "no errors")
        modes = [15] * len(classes)
        if bits[0] == "1":
            modes = [number_of(bits[at + 5 * k : at + 5 * k + 5]) for k in range(len(classes))]
            at += 5 * len(classes)
        for mode, vertices in zip(modes, classes):
            low_bits, has_flags = mode % 16, mode >= 16
            require(mode == 15 or low_bits <= 14, "mode of a class")
            flags = "0" if mode == 15 else "1"
            flags = flags * len(vertices)
            if has_flags:
                flags, at = bits[at : at + len(vertices)], at + len(vertices)
                require(len(flags) == len(vertices), "too few flags of errors")
            for flag, (i, p) in zip(flags, vertices):
                number = 0
                if flag == "1":
                    zeros = bits.find("1", at, at + 24) - at
                    if zeros >= 0:
                        low = bits[at + zeros + 1 : at + zeros + 1 + low_bits]
                        number, at = zeros << low_bits | number_of(low), at + zeros + 1 + low_bits
                    else:
                        number, at = number_of(bits[at + 24 : at + 39]), at + 39
                    number += has_flags
                require(number < (32768 if self.form == 4 else 4002), "a number of an error")
                if self.form == 4:
                    self.distances[i] = (self.least_eighths(i, p) + number) % 32768 / 8
                else:
                    self.errors[i] = (self.least(i, p) + number) % 4002
        require(len(bits) - 8 < at <= len(bits) and "1" not in bits[at:], "bits of errors")

    def own_eighths(self, i, p):
        """The distance from the middle of the ends in a page of form 4 or 5, in eighths."""
        a, b = (self.index(q) for q in diamond(p)[0])
        counts = spacing(p) > 1 or is_centre(p)
        if counts and a is not None and b is not None and self.valid[i] and self.valid[a] and self.valid[b]:
            return min(4 * abs(sum(signed(self.numbers[q] - self.numbers[i], 16) for q in (a, b))), 32767)
        return 0

    def least_eighths(self, i, p):
        children = [q for q in map(self.index, children_of(p)) if q is not None]
        return max([self.own_eighths(i, p)] + [int(8 * self.distances[q]) for q in children])

    def error(self, i):
        """What it counts as, in metres; None where another page has it."""
        if i in self.distances:
            metres = self.database.metres(self.distances[i])
            return metres if self.database.integer else LADDER[bisect.bisect_left(LADDER, metres)]
        return self.database.counted(self.errors[i]) if i in self.errors else None

    def count(self, i):
        """What it counts as, in eighths of a height code or as a code; None where another page has it."""
        if i in self.errors:
            return self.database.counts[self.errors[i]]
        if i not in self.distances:
            return None
        if self.database.integer:
            return math.ceil(8 * self.distances[i])
        return bisect.bisect_left(LADDER, self.database.metres(self.distances[i]))

    # In units, and in the page: None where it is not.

    def index(self, p):
        c, r = p[0] - self.col, p[1] - self.row
        return r * self.cols + c if 0 <= c < self.cols and 0 <= r < self.rows else None

    def square(self, p, reach):
        """The rows of the square of ± reach around p, 1 for data; None if it leaves the page."""
        first, last = self.index((p[0] - reach, p[1] - reach)), self.index((p[0] + reach, p[1] + reach))
        if first is None or last is None:
            return None
        return [self.valid[k : k + 2 * reach + 1] for k in range(first, last + 1, self.cols)]

    def spacing(self, p):
        return spacing(p)

    def levels(self):
        """(index, unit) of own vertices: finest first, side midpoints before centres, row by row."""
        own = [(r * self.cols + c, (self.col + c, self.row + r)) for r in range(self.rows) for c in range(self.cols)
               if self.is_own(c, r)]
        key = lambda v: (min(spacing(v[1]), self.database.side),
                         spacing(v[1]) < self.database.side and is_centre(v[1]))
        return sorted(own, key=key)  # stable: row by row

    def voids(self, numbers):
        valid, kinds = [0] * (self.cols * self.rows), {}
        for r0 in range(0, self.rows, 8):
            for c0 in range(0, self.cols, 8):
                kind = numbers.get(VOIDS + kinds.get((c0 - 8, r0), 0) + 3 * kinds.get((c0, r0 - 8), 0))
                kinds[c0, r0] = kind
                for r in range(r0, min(r0 + 8, self.rows)):
                    for c in range(c0, min(c0 + 8, self.cols)):
                        w, n, nw = (valid[b * self.cols + a] if a >= 0 and b >= 0 else 1
                                    for a, b in ((c - 1, r), (c, r - 1), (c - 1, r - 1)))
                        bit = numbers.get(VOIDS + 9 + w + 2 * n + 4 * nw) ^ w if kind == 1 else kind == 0
                        valid[r * self.cols + c] = int(bit)
        return valid

    def all_covers(self, numbers, inner_follow):
        covers = [0] * (self.cols * self.rows)
        for i, p in self.levels():
            s = spacing(p)
            square = self.square(p, s)
            inside = square is not None
            data = sum(map(sum, square)) if inside else None
            if s >= self.database.side or data == (2 * s + 1) ** 2:
                guess = 15
            else:
                guess = 0 if data == 0 else sum(self.seems_data(p, k, covers) << k for k in range(4))
            change = 0 if inside and inner_follow else numbers.get(COVERS + (not inside))
            covers[i] = change ^ guess
            require(covers[i] <= 15, "covers")
        return covers

    def seems_data(self, p, k, covers):
        ends, apexes = diamond(p)
        apex, end = apexes[k // 2], ends[k % 2]
        if spacing(p) == 1 and not is_centre(p):
            there = [self.index(q) for q in (p, apex, end)]
            return all(i is None or self.valid[i] for i in there)
        split = (apex[0] + end[0]) // 2, (apex[1] + end[1]) // 2
        i = self.index(split)
        if i is None:
            return True
        return (covers[i] >> (0 if diamond(split)[1][0] == p else 2) & 3) != 0

    def children(self, numbers):
        def moved(f, context):
            bits = struct.unpack("<i", struct.pack("<f", f))[0] + unzigzag(numbers.get(context))
            return struct.unpack("<f", struct.pack("<i", signed(bits, 32)))[0]

        entries, last = [], (0, 0, 0.0, 0.0, 0)
        for _ in range(self.database.children**2):
            if numbers.get(CHILDREN) == 0:
                entries.append((0, 0, 0.0, 0.0, 0))
                continue
            last = (1, last[1] + unzigzag(numbers.get(CHILDREN + 1)), moved(last[2], CHILDREN + 2),
                    moved(last[3], CHILDREN + 3), (last[4] + unzigzag(numbers.get(CHILDREN + 4))) % 2**32)
            require(0 <= last[1] <= 4001, "child entry")
            entries.append(last)
        return entries

    # ---- section 7: errors that follow from heights

    def is_data(self, p):
        i = self.index(p)
        return i is not None and bool(self.valid[i])

    def is_implied(self, i, p):
        s, centre = spacing(p), is_centre(p)
        if s > (0, 1, 4, 4, 4, 4)[self.form]:
            return False
        if s == 1 and not centre:
            ends, apexes = diamond(p)
            return self.is_data(p) and all(map(self.is_data, ends)) and any(map(self.is_data, apexes))
        reach = {(1, True): 1, (2, False): 2, (2, True): 4, (4, False): 6, (4, True): 10}[s, centre]
        square = self.square(p, reach)
        return square is not None and all(map(all, square))

    def distance(self, i, p):
        """The largest over the diamond and what is below, in height codes."""
        (a, b), apexes = diamond(p)
        largest = max([self.distances[self.index(q)] for q in children_of(p)], default=0)
        h = self.heights
        if self.form == 1:
            return max(largest, rounded_up(h[i], h[self.index(a)], h[self.index(b)]))
        if spacing(p) == 1:
            return max(largest, abs(h[i] - (h[self.index(a)] + h[self.index(b)]) / 2))
        for apex in apexes:
            corners = [(q[0] - p[0], q[1] - p[1]) for q in (apex, a, b)]
            area, samples = samples_in(*corners)
            ha, hb, hc = (h[i + x + y * self.cols] for x, y in corners)
            for x, y, wa, wb, wc in samples:
                surface = (wa * ha + wb * hb + wc * hc) / area  # a power of two: exact
                largest = max(largest, abs(h[i + x + y * self.cols] - surface))
        return largest

    def least(self, i, p):
        """The least code that a vertex can have, by what is known so far."""
        if spacing(p) >= self.database.side:
            return 0
        metres, code = 0.0, 0
        a, b = (self.index(q) for q in diamond(p)[0])
        counts = self.form == 0 or spacing(p) > 1 or is_centre(p)
        if self.form == 5:
            metres = self.database.metres(self.own_eighths(i, p) / 8)
        elif counts and a is not None and b is not None and self.valid[i] and self.valid[a] and self.valid[b]:
            metres = self.database.metres(abs(self.heights[i] - (self.heights[a] / 2 + self.heights[b] / 2)))
        for q in map(self.index, children_of(p)):
            if q in self.distances:
                metres = max(metres, self.database.metres(self.distances[q]))
            elif q is not None:
                code = max(code, self.errors[q])
        return max(code, bisect.bisect_left(LADDER, metres))


def cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@functools.lru_cache(None)
def samples_in(a, b, c):
    """Twice a triangle's area, and (x, y, weights of the corners) of all samples in it."""
    area, samples = cross(a, b, c), []
    for y in range(min(a[1], b[1], c[1]), max(a[1], b[1], c[1]) + 1):
        for x in range(min(a[0], b[0], c[0]), max(a[0], b[0], c[0]) + 1):
            weights = [cross((x, y), b, c), cross(a, (x, y), c), cross(a, b, (x, y))]
            if all(w * area >= 0 for w in weights):
                samples.append((x, y, *weights))
    return area, samples


def rounded_up(h, a, b):
    true = abs(Fraction(h) - (Fraction(a) + Fraction(b)) / 2)
    middle = (a + b) / 2
    if true == 0:
        return 0.0
    found = abs(h - middle)
    sum_is_exact = Fraction(a + b) == Fraction(a) + Fraction(b) and Fraction(middle) * 2 == Fraction(a + b)
    if sum_is_exact and Fraction(found) == true:
        return found
    return math.nextafter(math.nextafter(found, math.inf), math.inf)


# ---- section 4.1: records ----------------------------------------------------------------------------------


RECORD = (("block_error", "256H"), ("block_holds", "256B"), ("has_data", "256B"), ("middle", "256f"), ("right", "256f"),
          ("down", "256f"), ("above", "256f"), ("below", "256f"), ("finest", "256h"), ("coarsest", "256h"),
          ("typical", "256d"), ("errors", "289H"), ("holds", "289B"), ("posts", "256d"), ("post_valid", "256B"),
          ("entry", "BHffI"), ("valid_samples", "Q"), ("lowest", "d"), ("highest", "d"), ("vertices_above", "25Q"))


def record(content):
    """{field: values} of a tile."""
    zstd = library("zstd")
    zstd.ZSTD_decompress.restype = ctypes.c_size_t
    zstd.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
    size = sum(struct.calcsize("<" + letters) for _, letters in RECORD)
    plain = ctypes.create_string_buffer(size + 1)
    require(content[:1] == b"\2", "version of a record")
    require(zstd.ZSTD_decompress(plain, size + 1, content[1:], len(content) - 1) == size, "size of a record")
    fields, at = {}, 0
    for name, letters in RECORD:
        letters = "<" + letters
        fields[name] = struct.unpack_from(letters, plain.raw, at)
        at += struct.calcsize(letters)
    return fields


# ---- section 4.2: slices -----------------------------------------------------------------------------------


TILE = 1024
NO_SLICE = 2**31 - 1


class Slice:
    """vertices[grid point]: (height code, what its error counts as, covers); the error is None if it is not above."""

    def __init__(self, database, x, y, content):
        self.database, self.corner, self.vertices, self.posts = database, (x * TILE, y * TILE), {}, {}
        self.digest = xxh3(content)
        require(len(content) >= 8, "a slice without its head")
        version, self.flags, self.coding, self.shift, self.above = struct.unpack_from("<4Bi", content)
        require(version == 3 and self.flags <= 7 and self.shift < 40, "head of a slice")
        require(self.coding <= (0 if database.integer else 8), "coding of a slice")
        if self.above == NO_SLICE:
            require(len(content) == 8 and not (self.flags or self.coding or self.shift), "a slice that holds nothing")
            return
        require(0 <= self.above < (NO_SLICE if database.integer else 4001), "threshold of a slice")
        require(not database.keeps or self.above == database.kept_code, "threshold of a tolerance")
        require(len(content) >= 20, "a slice without its head")
        self.base, size = struct.unpack_from("<qI", content, 8)
        require(20 + size <= len(content), "bits of a slice")
        self.bits, numbers = bits_of(content[20 : 20 + size]), Numbers(content[20 + size :])
        self.read_posts(numbers)
        self.read_vertices(numbers)
        not_above = {p for p in self.order if self.flags & 4 and self.bit(numbers)}
        errors, covers = self.read_errors(numbers, not_above), self.read_covers(numbers)
        numbers.finish()
        self.vertices = {p: (self.code(p), errors.get(p), covers[p]) for p in self.order}

    def is_in_tile(self, p):
        (x, y), (c0, r0, c1, r1) = self.corner, self.database.extent
        return (max(x, c0) <= p[0] <= min(x + TILE - 1, c1)) and (max(y, r0) <= p[1] <= min(y + TILE - 1, r1))

    def code(self, p):
        return height_code(signed(self.base + self.numbers[p]), self.coding)

    @staticmethod
    def bit(numbers):
        bit = numbers.get(91)
        require(bit <= 1, "neither above nor not above")
        return bit

    @staticmethod
    def checked(number):
        require(abs(number) <= NO_SLICE, "height of a slice")
        return number

    def read_posts(self, numbers):
        x, y = self.corner
        found = {}
        for r in range(y, y + TILE, 64):
            for c in range(x, x + TILE, 64):
                before = found.get((c - 64, r), found.get((c, r - 64), 0))
                found[c, r] = self.checked(before + unzigzag(numbers.get(0)))
        self.numbers = {p: n for p, n in found.items() if self.is_in_tile(p)}  # of all known vertices
        self.posts = {p: self.code(p) for p in self.numbers}

    def read_vertices(self, numbers):
        self.order, count = [], 0
        for s in (32, 16, 8, 4, 2, 1):
            for p in self.level(s, True) + self.level(s, False):
                if not all(q in self.numbers or not self.is_in_tile(q) for q in diamond(p)[1]):
                    continue
                count += 1
                require(count <= len(self.bits), "too few bits of a slice")
                if self.bits[count - 1] == "1":
                    predicted, kind = self.predicted(p)
                    context = 1 + 5 * (2 * (s.bit_length() - 1) + is_side_midpoint(p)) + kind
                    self.numbers[p] = self.checked(predicted + unzigzag(numbers.get(context)))
                    self.order.append(p)
        require(len(self.bits) == (count + 7) // 8 * 8 and "1" not in self.bits[count:], "bits left over in a slice")

    def level(self, s, centres):
        """The points of the tile and the extent with a spacing, row by row: the centres, or the side midpoints."""
        (x, y), (c0, r0, c1, r1) = self.corner, self.database.extent
        points = []
        for r in range(y + s * centres, y + TILE, s * (1 + centres)):
            if r0 <= r <= r1:
                first = x if r & s and not centres else x + s  # every second column
                points += [(c, r) for c in range(first, x + TILE, 2 * s) if c0 <= c <= c1]
        return points

    def predicted(self, p):
        """(prediction, class)"""
        ends, parents = ([self.numbers.get(q) for q in side] for side in diamond(p))
        if None not in ends + parents:
            (a, b), (c, d) = ends, parents
            bend = abs(a + b - c - d) + abs(a - b)
            return 5 * (a + b) + 3 * (c + d) + 8 >> 4, min((bend >> self.shift).bit_length(), 4)
        if None not in ends:
            return sum(ends) >> 1, 4
        known = [n for n in ends + parents[::-1] if n is not None]
        return known[0] if known else 0, 4

    def read_errors(self, numbers, not_above):
        errors, may_be_less, counts = {}, self.flags & 2, self.database.counts
        for p in reversed(self.order):
            if p in not_above:
                continue
            least, source = self.least(p, errors)
            level = min(spacing(p).bit_length() - 1, 3)
            m = numbers.get(61 + 3 * (2 * level + is_side_midpoint(p)) + source)
            m = unzigzag(m) if may_be_less else m
            if not self.database.integer:
                error = least + m
            else:
                k = numbers.get(85 + level)
                if m == 0 and not may_be_less:
                    error = least + k
                else:
                    code = bisect.bisect_left(counts, least) + m
                    require(0 <= code <= 4001, "error of a slice")
                    error = counts[code] - k
            require(self.above < error < (NO_SLICE if self.database.integer else 4001), "error of a slice")
            errors[p] = error
        return errors

    def least(self, p, errors):
        """(least error, source)"""
        least, source = self.above + 1, 0
        a, b = diamond(p)[0]
        if a in self.numbers and b in self.numbers:
            d = self.own_error(p, a, b)
            if d > least:
                least, source = d, 1
        for q in children_of(p):
            if errors.get(q, -1) >= least:
                least, source = errors[q], 2
        return min(least, NO_SLICE - 1), source

    def own_error(self, p, a, b):
        if self.database.integer:
            return 4 * abs(2 * self.numbers[p] - self.numbers[a] - self.numbers[b])
        metres = self.database.metres(abs(self.code(p) - (self.code(a) / 2 + self.code(b) / 2)))
        return bisect.bisect_left(LADDER, metres) if math.isfinite(metres) else 4001

    def read_covers(self, numbers):
        covers = {}
        for p in self.order:
            if self.flags & 1:
                number = numbers.get(90 if any(covers.get(q, 15) != 15 for q in diamond(p)[1]) else 89)
                require(number <= 15, "covers of a slice")
                covers[p] = number ^ 15
            else:
                covers[p] = 15
        return covers


# ---- section 2, and the questions ------------------------------------------------------------------------


class Database:
    def __init__(self, path):
        self.tables = Tables(path)
        found = self.tables.get(-1, 0)
        require(found is not None, "no header")
        m = self.manifest = json.loads(found[0])
        require(m["talus"] == 3, "another version")
        layout, step = m["layout"], m["step"]
        finest, self.lossy = m["errors"].get("finest_tolerance", 0.0), m["errors"]["lossy_bound"]
        self.integer = step["integer"] and finest == 0
        self.keeps = finest > self.lossy  # section 8.1
        self.kept_above = max(finest - self.lossy, 0.0)
        self.kept_code = bisect.bisect_right(LADDER, self.kept_above) - 1
        self.children, self.side, self.bands = 2 ** layout["band_levels"], layout["page_side"], layout["bands"]
        self.extent = m["extent"]
        require(m["errors"]["kind"] == "exact", "errors of another kind")
        require(m["errors"]["metric"] in ("vertical", "perpendicular"), "errors of another metric")
        self.root = 1
        while self.root <= max(abs(v) for v in self.extent):
            self.root *= 2
        require(self.side * self.children ** (self.bands - 1) >= self.root, "number of bands")
        require(self.bands == 3 or self.bands > 3 and self.side * self.children ** (self.bands - 2) < self.root,
                "number of bands")
        scale, per_unit = abs(step["scale"]), m["vertical"]["metres_per_unit"]
        whole = math.floor(1 / scale + 0.5)
        fraction = scale < 1 and abs(scale * whole - 1) < 3e-16
        self.factor = (1 if fraction else scale) * per_unit
        self.divisor = step["divisor"] * (whole if fraction else 1)
        self.pages, self.slices = {}, {}
        generations = [m["generation"]] + m["top_generations"]
        require(not self.keeps or not any(generations), "an update of a database that keeps a tolerance")

    def page(self, band, x, y, generation):
        if (band, x, y) not in self.pages:
            found = self.tables.get(band, position(x, y))
            require(found is not None, "page %d/%d of band %d is missing" % (x, y, band))
            require(found[1] == generation, "page %d/%d of band %d is stale" % (x, y, band))
            require(not self.keeps or generation == 0, "an updated page of a database that keeps a tolerance")
            self.pages[band, x, y] = Page(self, band, x, y).decode(found[0])
        return self.pages[band, x, y]

    def height(self, code):
        step = self.manifest["step"]
        scaled = code * step["scale"] / step["divisor"]
        return scaled if step["offset"] == 0 else scaled + step["offset"]

    def metres(self, distance):
        return distance * self.factor / self.divisor

    def eighths(self, code):
        """Section 7: how many eighths of a height code a code counts as; infinite where it counts as its own metres."""
        metres = LADDER[code]
        if code in (0, 4001):
            return metres
        k = math.ceil(metres * self.divisor / self.factor * 8)  # or one beside it
        if k > 2**31:
            return math.inf
        while self.metres((k - 1) / 8) >= metres:
            k -= 1
        while self.metres(k / 8) < metres:
            k += 1
        return k if k < 2**31 - 1 else math.inf

    @functools.cached_property
    def counts(self):
        """What each error code counts as: eighths, or itself."""
        return [self.eighths(code) if self.integer else code for code in range(4002)]

    def counted(self, code):
        """Section 7: what an error code counts as, in metres."""
        own = not self.integer or code == 0 or math.isinf(self.counts[code])
        return LADDER[code] if own else self.metres(self.counts[code] / 8)

    def walk(self, region, wanted):
        """The pages that overlap a region, from the top; wanted(band, x, y, largest error) says which."""

        def overlaps(band, x, y):
            cells = self.side * self.children**band
            return (x * cells <= region[2] and (x + 1) * cells > region[0] and
                    y * cells <= region[3] and (y + 1) * cells > region[1])

        def visit(band, x, y, generation):
            page = self.page(band, x, y, generation)
            yield page
            for k, (stored, largest, _, _, written) in enumerate(page.below):
                j, i = divmod(k, self.children)
                child = band - 1, x * self.children + i, y * self.children + j
                if stored and overlaps(*child) and wanted(*child, self.counted(largest)):
                    yield from visit(*child, written)

        top = self.bands - 1
        for (x, y), generation in zip(self.tops(), self.manifest["top_generations"], strict=True):
            if overlaps(top, x, y):
                yield from visit(top, x, y, generation)

    def tops(self):
        """Section 2: the pages of the last band, in the order of their keys."""
        cells = self.side * self.children ** (self.bands - 1)
        c0, r0, c1, r1 = (v // cells for v in self.extent)
        return sorted(((x, y) for y in range(r0, r1 + 1) for x in range(c0, c1 + 1)), key=lambda p: position(*p))

    def record(self, x, y):
        """Section 4.1: of the tile whose page of band 1 is (x, y); None where there is none."""
        found = self.tables.get(32, position(x, y))
        return found and record(found[0])

    def slice(self, x, y):
        """Section 4.2: of the tile whose page of band 1 is (x, y); None where there is none."""
        if (x, y) not in self.slices:
            self.slices[x, y] = self.read_slice(x, y)
        return self.slices[x, y]

    def read_slice(self, x, y):
        found, page = self.tables.get(33, position(x, y)), self.tables.get(1, position(x, y))
        if page is None or self.keeps and not page[0][2] & 16:  # section 8.1: the tile is whole
            return require(found is None, "a slice where none should be")
        require(found is not None, "slice %d/%d is missing" % (x, y))
        require(found[1] == page[1], "slice %d/%d is stale" % (x, y))
        return Slice(self, x, y, found[0])

    def samples(self):
        """Section 8: {grid point: height} of all samples that are data, but those whose heights nobody has."""
        found = {}
        for page in self.walk(self.extent, lambda *_: True):
            if page.band == 0:
                known = ((p, page.heights[i]) for i, p in page.points() if page.valid[i])
                found.update((p, self.height(code)) for p, code in known if code is not None)
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

    def is_near_border(self, p):
        """Section 8.1."""
        s, (c0, r0, c1, r1) = spacing(p), self.extent
        reach = s * (3 if p[0] & s and p[1] & s else 2)
        return p[0] - reach < c0 or p[0] + reach > c1 or p[1] - reach < r0 or p[1] + reach > r1

    def kept_height(self, p):
        """Section 8.1: the code of a selected vertex."""
        band = min((spacing(p).bit_length() - 1) // (self.children.bit_length() - 1), self.bands - 1)
        unit = self.children**band
        key = band, p[0] // unit // self.side, p[1] // unit // self.side
        page = self.pages.get(key)
        if page is None:  # generation 0: such databases are never updated
            if self.tables.get(band, position(*key[1:])) is None:
                return 0.0
            if band == 0:  # which may have the corners
                self.page(1, key[1] // self.children, key[2] // self.children, 0)
            page = self.page(*key, 0)
        i = page.index((p[0] // unit, p[1] // unit))
        error = LADDER[page.errors[i]] if i in page.errors else page.error(i)
        if not self.keeps or error > LADDER[self.kept_code] or self.is_near_border(p):
            require(page.heights[i] is not None, "a kept vertex without a height")
            return page.heights[i]
        a, b = diamond(p)[0]
        return self.kept_height(a) / 2 + self.kept_height(b) / 2

    def mesh(self, region, tolerance):
        """Section 9: {triangle: as a set of grid points}, {grid point: height}."""
        tolerance = max(tolerance - self.lossy, self.kept_above)
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
                    selected[p] = self.height(self.kept_height(p)), page.covers[i]

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
