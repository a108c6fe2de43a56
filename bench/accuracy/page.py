#!/usr/bin/python3
"""Measures what docs/accuracy.md says, and writes it there: tables between its marks, pictures beside it.

    page.py BUILD [PAGE]     BUILD: build/release; PAGE: docs/accuracy.md. Models: TALUS_DEM_DIR

Between `<!-- measured: NAME -->` and `<!-- end -->` everything is replaced; all other words are the author's.
"""
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy
from osgeo import gdal

gdal.UseExceptions()
# Name, file, first column and row of a window of 513² samples without voids.
WINDOWS = [("S36E149, hills", "srtm3_S36E149.tif", 88, 88), ("Kenya, one mountain", "kenya_central_z11.tif", 3712, 2944),
           ("Taiwan, mountains", "taiwan_z13/taiwan.vrt", 5000, 10000), ("Swiss Alps", "swiss_germany_3s/swiss_germany.vrt", None, None),
           ("bigtujunga, 30 m", "bigtujunga_30m_utm11.tif", 64, 64), ("gabilan, 10 m", "gabilan.bil", 128, 128)]
SIDE = 512
LADDER = [0.5, 0.7, 1, 1.4, 2, 2.8, 4, 5, 6.3, 8, 10, 14, 20, 28, 40, 50]
PAPER = [("Interlaken, 25 m, mountains", "dhm25/dhm25_interlaken_lv95.bt", 64, 64),
         ("gabilan, 10 m, hills", "gabilan.bil", 256, 256), ("S36E149, 90 m, hills", "srtm3_S36E149.tif", 512, 512)]
PUBLISHED = [("Albis, 25 m, hills", [25921, 19773, 11636, 4664, 1789]),
             ("Matterhorn, 25 m, mountains", [25921, 22492, 17156, 10492, 6367])]
# For bytes: whole models, at most 2049² samples.
MODELS = [("S36E149", "srtm3_S36E149.tif"), ("N46E008", "srtm3_N46E008.tif"), ("bigtujunga", "bigtujunga_30m_utm11.tif"),
          ("gabilan", "gabilan.bil")]
COLOURS = {"exact": "#1b6ca8", "nested": "#2e8b57", "midpoint": "#c0392b", "perpendicular": "#8e44ad", "exact8": "#888888",
           "bounded": "#2e8b57", "dense": "#e08e0b", "LERC": "#c0392b", "overviews": "#888888"}


def run(*words):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout


def models():
    return Path(os.environ.get("TALUS_DEM_DIR", "../shared/dem"))


def without_voids(file):
    """The roughest window of SIDE + 1 samples, at multiples of 64, in which all is data."""
    band = gdal.Open(str(file)).GetRasterBand(1)
    heights, void = band.ReadAsArray(), band.GetNoDataValue()
    best = None
    for row in range(0, heights.shape[0] - SIDE, 64):
        for col in range(0, heights.shape[1] - SIDE, 64):
            part = heights[row:row + SIDE + 1, col:col + SIDE + 1]
            if void is not None and (part == void).any():
                continue
            range_ = float(part.max()) - float(part.min())
            if best is None or range_ > best[0]:
                best = (range_, col, row)
    return best[1:]


def kinds_of(build, file, col, row, side, tolerances):
    """Of each kind: rows of tolerance, vertices, triangles, true_error."""
    lines = run(build / "bench/accuracy/error_kinds", file, col, row, side, *tolerances).splitlines()
    found = {}
    for line in map(json.loads, lines):
        found.setdefault(line["kind"], []).append(line)
    return found


# ---- pictures ----------------------------------------------------------------------------------------------


def ticks(low, high):
    """1, 2, 5 in every decade."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    return [t for d in range(first, last + 1) for t in (10.0**d, 2 * 10.0**d, 5 * 10.0**d) if low <= t <= high]


def short(value):
    for limit, unit in ((1e6, "M"), (1e3, "k")):
        if value >= limit:
            return f"{value / limit:g}{unit}"
    return f"{value:g}"


def panel(left, top, width, height, title, x_title, y_title, curves):
    """One picture of curves over two logarithmic axes. curves: name → points."""
    xs = [x for points in curves.values() for x, _ in points]
    ys = [y for points in curves.values() for _, y in points]
    x0, x1, y0, y1 = min(xs) / 1.1, max(xs) * 1.1, min(ys) / 1.2, max(ys) * 1.2
    at = lambda x, y: (left + width * math.log(x / x0) / math.log(x1 / x0), top + height - height * math.log(y / y0) / math.log(y1 / y0))
    out = [f'<text x="{left}" y="{top - 9}" font-size="13" font-weight="bold">{title}</text>']
    for axis, (low, high) in (("x", (x0, x1)), ("y", (y0, y1))):
        marks = ticks(low, high)
        if len(marks) > 9:
            marks = [t for t in marks if f"{t:e}"[0] == "1"]
        for t in marks:
            px, py = at(t, y0) if axis == "x" else at(x0, t)
            end = f'x2="{px:.1f}" y2="{top}"' if axis == "x" else f'x2="{left + width}" y2="{py:.1f}"'
            out.append(f'<line x1="{px:.1f}" y1="{py:.1f}" {end} stroke="#e4e4e4"/>')
            out.append(f'<text x="{px:.1f}" y="{py + 15:.1f}" font-size="11" text-anchor="middle">{short(t)}</text>' if axis == "x"
                       else f'<text x="{px - 5:.1f}" y="{py + 4:.1f}" font-size="11" text-anchor="end">{short(t)}</text>')
    out.append(f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#444"/>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 31}" font-size="12" text-anchor="middle">{x_title}</text>')
    middle = top + height / 2
    out.append(f'<text x="{left - 42}" y="{middle}" font-size="12" text-anchor="middle" '
               f'transform="rotate(-90 {left - 42} {middle})">{y_title}</text>')
    for name, points in curves.items():
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in (at(*p) for p in points))
        out.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[name]}" stroke-width="1.8"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.3" fill="{COLOURS[name]}"/>' for x, y in (at(*p) for p in points)]
    return "\n".join(out)


def picture(file, panels, legend):
    """panels: title, x title, y title, curves; three in a row."""
    width, height = 300, 210
    out = []
    for i, (title, x_title, y_title, curves) in enumerate(panels):
        out.append(panel(62 + (i % 3) * (width + 80), 62 + (i // 3) * (height + 78), width, height, title, x_title, y_title, curves))
    x = 62
    for name, words in legend:
        out.append(f'<line x1="{x}" y1="22" x2="{x + 24}" y2="22" stroke="{COLOURS[name]}" stroke-width="3"/>'
                   f'<text x="{x + 30}" y="26" font-size="13">{words}</text>')
        x += 50 + 7.2 * len(words)
    rows = (len(panels) + 2) // 3
    whole = f'<svg xmlns="http://www.w3.org/2000/svg" width="{min(3, len(panels)) * (width + 80) + 30}" height="{62 + rows * (height + 78)}" ' \
            f'font-family="sans-serif"><rect width="100%" height="100%" fill="white"/>\n'
    Path(file).write_text(whole + "\n".join(out) + "\n</svg>\n")


# ---- what is measured ----------------------------------------------------------------------------------------


def least_for(rows, true_error):
    """The fewest vertices with which a kind really keeps an error, among those measured; none if it never did."""
    kept = [r for r in rows if r["true_error"] <= true_error]
    return min(kept, key=lambda r: r["vertices"]) if kept else None


def error_kinds(build, folder):
    table = ["| window of 513² | asked | exact | nested | perpendicular | midpoint | true error | exact, 8-bit codes | midpoint, to keep it |",
             "|---|---|---|---|---|---|---|---|---|"]
    panels = []
    for name, file, col, row in WINDOWS:
        path = models() / file
        if not path.exists():
            continue
        if col is None:
            col, row = without_voids(path)
        found = kinds_of(build, path, col, row, SIDE, LADDER)
        at = lambda kind, tolerance: next(r for r in found[kind] if r["tolerance"] == tolerance)
        for tolerance in (1, 5, 20):
            exact = at("exact", tolerance)
            share = lambda r: f"{100 * r['vertices'] / exact['vertices'] - 100:+.0f} %"
            kept = least_for(found["midpoint"], tolerance)
            table.append(
                f"| {name if tolerance == 1 else ''} | {tolerance} m | {exact['vertices']:,} | {share(at('nested', tolerance))} | "
                f"{share(at('perpendicular', tolerance))}, {at('perpendicular', tolerance)['true_error']:.3g} m | "
                f"{share(at('midpoint', tolerance))} | {at('midpoint', tolerance)['true_error']:.3g} m | "
                f"{share(at('exact8', tolerance))} | {share(kept) + ' at ' + format(kept['tolerance'], 'g') + ' m' if kept else 'not below ' + format(LADDER[0], 'g') + ' m'} |")
            assert at("exact16", tolerance)["vertices"] >= exact["vertices"]
        curves = {kind: [(r["vertices"], r["true_error"]) for r in found[kind] if r["true_error"] > 0]
                  for kind in ("exact", "nested", "midpoint", "perpendicular")}
        panels.append((name, "vertices", "largest true error, m", curves))
        worst = max(at("exact16", t)["vertices"] / at("exact", t)["vertices"] for t in LADDER)
        print(f"{name}: column {col}, row {row}; 16-bit codes cost at most {100 * worst - 100:.3f} %", flush=True)
    picture(folder / "error-kinds.svg", panels, [("exact", "exact"), ("nested", "nested"), ("midpoint", "midpoint"),
                                                 ("perpendicular", "perpendicular")])
    return table


def paper_table(build):
    table = ["| 161 × 161 samples | 0 m | 1 m | 2 m | 5 m | 10 m |", "|---|---|---|---|---|---|"]
    show = lambda counts: " | ".join(f"{c:,} ({100 * c / 25921:.0f} %)" for c in counts)
    table += [f"| {name}, published | {show(counts)} |" for name, counts in PUBLISHED]
    for name, file, col, row in PAPER:
        path = models() / file
        if path.exists():
            found = kinds_of(build, path, col, row, 160, [0, 1, 2, 5, 10])
            table.append(f"| {name}, here | {show([r['vertices'] for r in found['paper']])} |")
            table.append(f"| the same, true error m | {' | '.join(format(r['true_error'], '.3g') for r in found['paper'])} |")
    return table


def overviews(file, scratch):
    """GDAL's averaged overviews: bytes, and the largest distance of a sample from them, interpolated bilinearly."""
    band = gdal.Open(str(file)).GetRasterBand(1)
    heights, void = band.ReadAsArray().astype(float), band.GetNoDataValue()
    rows = []
    for factor in (2, 4, 8, 16):
        size = dict(width=max(1, heights.shape[1] // factor), height=max(1, heights.shape[0] // factor))
        small, large = scratch / "small.tif", scratch / "large.tif"
        gdal.Translate(str(small), str(file), resampleAlg="average", **size,
                       creationOptions=["COMPRESS=ZSTD", "PREDICTOR=2" if band.DataType == gdal.GDT_Int16 else "PREDICTOR=3", "TILED=YES"])
        gdal.Translate(str(large), str(small), resampleAlg="bilinear", width=heights.shape[1], height=heights.shape[0],
                       outputType=gdal.GDT_Float32)
        there = gdal.Open(str(large)).ReadAsArray().astype(float)
        both = (heights != void) & (there != void) if void is not None else numpy.ones(heights.shape, bool)
        rows.append((small.stat().st_size, float(numpy.abs(heights - there)[both].max())))
    return rows


def heights_of_streams(build, folder, scratch):
    table = ["| model | asked | exact kB | bounded | dense | LERC |", "|---|---|---|---|---|---|"]
    panels = []
    talus = build / "app/talus"
    for name, file in MODELS:
        path = models() / file
        if not path.exists():
            continue
        database = scratch / (path.stem + ".talus")
        if not database.exists():
            run(talus, "ingest", path, database)
        curves = {kind: [] for kind in ("exact", "bounded", "dense", "LERC")}
        for tolerance in (1, 2, 5, 10, 20):
            for kind in ("exact", "bounded", "dense"):
                run(talus, "query", database, "--tolerance", tolerance, "--heights", kind, "-o", scratch / "a.rqt")
                curves[kind].append(((scratch / "a.rqt").stat().st_size, tolerance))
            gdal.Translate(str(scratch / "lerc.tif"), str(path),
                           creationOptions=["COMPRESS=LERC_ZSTD", f"MAX_Z_ERROR={tolerance}", "TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256"])
            curves["LERC"].append(((scratch / "lerc.tif").stat().st_size, tolerance))
            table.append(f"| {name if tolerance == 1 else ''} | {tolerance} m | "
                         + " | ".join(f"{curves[kind][-1][0] / 1000:,.1f}" for kind in curves) + " |")
        curves["overviews"] = overviews(path, scratch)
        panels.append((name, "bytes", "largest error, m", curves))
        print(f"{name}: bytes", flush=True)
    picture(folder / "bytes.svg", panels, [("exact", "exact heights"), ("bounded", "bounded"), ("dense", "dense"), ("LERC", "LERC_ZSTD"),
                                           ("overviews", "GDAL overviews, whose error nobody states")])
    return table


def main():
    build, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2] if len(sys.argv) > 2 else "docs/accuracy.md")
    folder, scratch = page.parent / "accuracy", build / "kept" / "accuracy"
    folder.mkdir(parents=True, exist_ok=True)
    scratch.mkdir(parents=True, exist_ok=True)
    measured = {"kinds": error_kinds(build, folder), "paper": paper_table(build), "heights": heights_of_streams(build, folder, scratch)}
    text = page.read_text()
    for name, lines in measured.items():
        mark = f"<!-- measured: {name} -->"
        if mark not in text:
            sys.exit(f"{page} has no mark {mark}")
        text = re.sub(re.escape(mark) + r".*?<!-- end -->", lambda _: mark + "\n" + "\n".join(lines) + "\n<!-- end -->", text, flags=re.S)
    page.write_text(text)


if __name__ == "__main__":
    main()
