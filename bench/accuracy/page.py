#!/usr/bin/python3
"""Measures what docs/accuracy.md says, and writes it there: tables between its marks, pictures beside it.

    page.py BUILD [PART...]     BUILD: build/release; parts: see PARTS at the end; without any: all

Between `<!-- measured: PART -->` and `<!-- end -->` everything is replaced; all other words are the author's. Real models are
found through TALUS_DEM_DIR; those that are not there are left out, and so is martini where there is no Node or npm to bring it.
"""
import json
import re
import statistics
import sys
import time
from pathlib import Path

import numpy
from osgeo import gdal

from measuring import KINDS, MARGIN, SIDE, Bench, Martini, models, run, share
from pictures import picture

PAPER = [("Interlaken, 25 m, mountains", "dhm25/dhm25_interlaken_lv95.bt", 64, 64),
         ("bigtujunga, 30 m, mountains", "bigtujunga_30m_utm11.tif", 64, 64), ("S36E149, 90 m, hills", "srtm3_S36E149.tif", 512, 512)]
PUBLISHED = [("Albis, 25 m, hills", [25921, 19773, 11636, 4664, 1789]),
             ("Matterhorn, 25 m, mountains", [25921, 22492, 17156, 10492, 6367])]
# ---- parts of the page -----------------------------------------------------------------------------------------


def row_of(cells):
    return "| " + " | ".join(cells) + " |"


def table(*columns):
    return [row_of(columns), "|---" * len(columns) + "|"]


def names_first(window):
    """Each tolerance of the tables, and the window's name beside the first."""
    return [(window.name if i == 0 else "", tolerance) for i, tolerance in enumerate(window.shown)]


def step_of(heights):
    """What all heights are multiples of, as far as floats tell."""
    for step, words in ((1, "whole metres"), (0.1, "decimetres"), (0.01, "centimetres")):
        if abs(heights / step - numpy.rint(heights / step)).max() * step < 1e-4:
            return words
    return "all digits"


def models_(bench, folder):
    """Where the windows lie, and what stands in them."""
    lines = table("window", "file", "first column, row", "EPSG", "samples stored as", "heights in it")
    places = [(w.name, w.file, w.col, w.row, SIDE) for w in bench.windows] + [(f"paper's table: {name}", *place, 160) for name, *place in PAPER]
    for name, file, col, row, cells in places:
        if not (models() / file).exists():
            continue
        dataset = gdal.Open(str(models() / file))
        band, crs = dataset.GetRasterBand(1), dataset.GetSpatialRef()
        heights = band.ReadAsArray(col, row, cells + 1, cells + 1).astype(float)
        lines.append(row_of([name, f"`{file}`", f"{col}, {row}", (crs and crs.GetAuthorityCode(None)) or "none",
                             f"{gdal.GetDataTypeName(band.DataType)}, {step_of(heights)}", f"{heights.min():.5g} to {heights.max():.5g} m"]))
    return lines


def windows(bench, folder):
    """Error against vertices, time and bytes, of databases, of kinds of errors that plain loops count, and of the peers."""
    over_vertices, over_time = [], []
    lines = table("window of 513²", "asked", "exact: vertices", "of samples", "95 % within", "RMS", "time", "bytes", "nested: vertices",
                  "midpoint: vertices", "true error", "perpendicular: vertices", "true error", "martini: vertices", "time", "true error")
    for window in bench.windows:
        found = {kind: bench.measured(window.cut, kind, window.timed) for kind in KINDS}
        counted = bench.counted(window.cut, sorted(window.timed, reverse=True))
        for kind in ("nested", "midpoint"):
            found[kind] = [{**row, "largest_error": row["true_error"]} for row in counted[kind]]
        if bench.martini:
            martini = Martini(bench, window.cut)
            found["martini"] = martini.measured(sorted(window.timed, reverse=True))
            martini.end()
        curve = lambda kind, cost: [(r[cost], r["largest_error"]) for r in found[kind] if r["largest_error"] > 0]
        over_vertices.append((window.name, "vertices", "largest true error, m", {kind: curve(kind, "vertices") for kind in found}))
        over_time.append((window.name, "ms", "largest true error, m",
                          {kind: [(1000 * s, e) for s, e in curve(kind, "warm_seconds")] for kind in (*KINDS, "martini") if kind in found}))
        at = {kind: {r["tolerance"]: r for r in rows} for kind, rows in found.items()}
        finest = at["exact"][window.shown[0]]["warm_seconds"]
        for name, tolerance in names_first(window):
            exact = at["exact"][tolerance]
            row = [name, f"{tolerance} m", f"{exact['vertices']:,}", f"{100 * exact['vertices'] / (SIDE + 1) ** 2:.2g} %",
                   f"{exact['percentile_95_error']:.2g} m", f"{exact['rms_error']:.2g} m", f"{exact['warm_seconds'] / finest:.2f}", f"{exact['bytes'] / 1000:,.1f} kB",
                   share(at["nested"][tolerance]["vertices"], exact["vertices"])]
            for kind in ("midpoint", "perpendicular"):
                row += [share(at[kind][tolerance]["vertices"], exact["vertices"]), f"{at[kind][tolerance]['largest_error']:.3g} m"]
            if "martini" in at:
                theirs = at["martini"][tolerance]
                row += [share(theirs["vertices"], exact["vertices"]), f"{theirs['warm_seconds'] / exact['warm_seconds']:.1f} x",
                        f"{theirs['largest_error']:.3g} m"]
            else:
                row += ["", "", ""]
            lines.append(row_of(row))
        print(f"{window.name}: answers", flush=True)
    legend = lambda kinds, martini: [(kind, kind) for kind in kinds] + ([("martini", martini)] if bench.martini else [])
    picture(folder / "vertices.svg", over_vertices, legend(["exact", "nested", "midpoint", "perpendicular"], "martini"))
    picture(folder / "time.svg", over_time, legend(KINDS, "martini, without reading the file"))
    return lines


def kinds(bench, folder):
    """What a kept error takes: the fewest vertices of each kind whose mesh really lies within it."""
    lines = table("window of 513²", "really within", "exact", "nested", "midpoint", "asked at", "perpendicular", "asked at",
                  "exact, 8-bit codes", "16-bit codes")
    for window in bench.windows:
        found = bench.counted(window.cut, sorted({*window.fine, *window.shown}))
        for name, tolerance in names_first(window):
            at = lambda kind: next(r for r in found[kind] if r["tolerance"] == tolerance)["vertices"]

            def least(kind):
                kept = [r for r in found[kind] if r["true_error"] <= tolerance]
                if not kept:
                    return f"not at {window.fine[0]:g} m", ""
                best = min(kept, key=lambda r: r["vertices"])
                return share(best["vertices"], at("exact")), f"{best['tolerance']:g} m"

            lines.append(row_of([name, f"{tolerance} m", f"{at('exact'):,}", share(at("nested"), at("exact")), *least("midpoint"),
                                 *least("perpendicular"), share(at("exact8"), at("exact")),
                                 f"{100 * at('exact16') / at('exact') - 100:+.2f} %"]))
        print(f"{window.name}: kinds", flush=True)
    return lines


def paper(bench, folder):
    """[P98], Table 1: its metric, its rule."""
    lines = ["| 161 × 161 samples | 0 m | 1 m | 2 m | 5 m | 10 m |", "|---|---|---|---|---|---|"]
    show = lambda counts: " | ".join(f"{c:,} ({100 * c / 25921:.0f} %)" for c in counts)
    lines += [f"| {name}, published | {show(counts)} |" for name, counts in PUBLISHED]
    for name, file, col, row in PAPER:
        if not (models() / file).exists():
            continue
        found = bench.counted(models() / file, [0, 1, 2, 5, 10], 160, col, row)["paper"]
        lines.append(f"| {name}, here | {show([r['vertices'] for r in found])} |")
        lines.append("| the same, true vertical error | " + " | ".join(f"{r['true_error']:.3g} m" for r in found) + " |")
    return lines


def overviews(cut, scratch):
    """GDAL's averaged overviews: bytes, and the largest distance of a sample from them, interpolated bilinearly."""
    heights = gdal.Open(str(cut)).ReadAsArray().astype(float)
    predictor = 2 if heights.dtype.kind == "i" else 3
    rows = []
    for factor in (2, 4, 8, 16):
        size = {"width": max(1, heights.shape[1] // factor), "height": max(1, heights.shape[0] // factor)}
        small, large = scratch / "small.tif", scratch / "large.tif"
        gdal.Translate(str(small), str(cut), resampleAlg="average", outputType=gdal.GDT_Float32, **size,
                       creationOptions=["COMPRESS=ZSTD", f"PREDICTOR={predictor}", "TILED=YES"])
        gdal.Translate(str(large), str(small), resampleAlg="bilinear", width=heights.shape[1], height=heights.shape[0])
        there = gdal.Open(str(large)).ReadAsArray().astype(float)
        rows.append((small.stat().st_size, float(numpy.abs(heights - there).max())))
    return rows


def bytes_(bench, folder):
    """Streams of each mode of heights beside LERC at the same bound, and overviews."""
    modes = {"exact": [], "bounded": [], "fitted": [], "finely fitted": ["--quantum"], "dense": []}
    lines = table("window of 513²", "asked", *(f"{mode}: {what}" for mode in modes for what in ("vertices", "kB")), "LERC_ZSTD, kB")
    panels = []
    for window in bench.windows:
        curves = {**{mode: [] for mode in modes}, "LERC": []}
        names = {tolerance: name for name, tolerance in names_first(window)}
        for tolerance in window.timed:
            row = [names.get(tolerance, ""), f"{tolerance:g} m"]
            for mode, quantum in modes.items():
                words = ["--heights", mode.split()[-1], *quantum, *([tolerance / 20] if quantum else [])]
                made = bench.answer(bench.database(window.cut), "--tolerance", tolerance, *words)
                curves[mode].append((made["bytes"], tolerance))
                exact = made["vertices"] if mode == "exact" else exact
                row += [f"{made['vertices']:,}" if mode == "exact" else share(made["vertices"], exact), f"{made['bytes'] / 1000:,.1f}"]
            lerc = bench.scratch / "lerc.tif"
            gdal.Translate(str(lerc), str(window.cut), creationOptions=["COMPRESS=LERC_ZSTD", f"MAX_Z_ERROR={tolerance}", "TILED=YES"])
            curves["LERC"].append((lerc.stat().st_size, tolerance))
            if tolerance in names:
                lines.append(row_of([*row, f"{lerc.stat().st_size / 1000:,.1f}"]))
        del curves["finely fitted"]  # for triangles, not for bytes
        curves["overviews"] = overviews(window.cut, bench.scratch)
        panels.append((window.name, "bytes", "largest error, m", curves))
        print(f"{window.name}: bytes", flush=True)
    picture(folder / "bytes.svg", panels,
            [("exact", "exact heights"), ("bounded", "bounded"), ("fitted", "fitted"), ("dense", "dense"), ("LERC", "LERC_ZSTD"),
             ("overviews", "GDAL overviews at 1/2 to 1/16, whose error nobody states")])
    return lines


def borders(bench, folder):
    """A rectangle amid a larger raster: what its border takes, on the lattice and beside it."""
    cells = SIDE - 32
    lines = table("480 x 480 cells of", "asked", "on the lattice", "elsewhere: constrain", "for the border alone", "constrain, `--snap 16`", "cover", "clip")
    for window in bench.windows:
        database = bench.database(window.wide)
        origin_x, dx, _, origin_y, _, dy = gdal.Open(str(window.wide)).GetGeoTransform()

        def bbox(col, row):
            xs, ys = [origin_x + (c + 0.5) * dx for c in (col, col + cells)], [origin_y + (r + 0.5) * dy for r in (row, row + cells)]
            return f"--bbox={min(xs)!r},{min(ys)!r},{max(xs)!r},{max(ys)!r}"

        for name, tolerance in names_first(window):
            ask = lambda place, *words: json.loads(run(bench.talus, "query", database, "--tolerance", tolerance, place, *words, "--json"))
            there, elsewhere = bbox(MARGIN, MARGIN), bbox(MARGIN + 5, MARGIN + 7)
            constrained = ask(elsewhere)
            meshes = [ask(elsewhere, *words) for words in (["--snap", 16], ["--border", "cover"], ["--border", "clip"])]
            lines.append(row_of([name, f"{tolerance} m", f"{ask(there)['vertices']:,}", f"{constrained['vertices']:,}",
                                 f"{constrained['border_vertices']:,}", *(f"{m['vertices']:,}" for m in meshes)]))
    return lines


def chains(bench, folder):
    """A coarse answer first, then what it lacks of the next, and so on: bytes together, against the last answer at once."""
    lines = table("window of 513²", "heights", "first", "then", "then", "together", "at once", "more")
    steps = {"S36E149, 90 m, hills": (50, 20, 5), "bigtujunga, 30 m, canyons": (50, 20, 5), "gabilan, 1 m, lidar": (1, 0.5, 0.1)}
    for window in bench.windows:
        if window.name not in steps:
            continue
        coarse, middle, fine = steps[window.name]
        for words, name in (([], "exact"), (["--heights", "bounded", "--quantum", fine], f"bounded, `--quantum {fine}`")):
            ask = lambda *more: bench.answer(bench.database(window.cut), *more, *words)["bytes"]
            parts = [ask("--tolerance", coarse), ask("--from", coarse, "--tolerance", middle), ask("--from", middle, "--tolerance", fine)]
            at_once = ask("--tolerance", fine)
            kb = lambda n: f"{n / 1000:,.1f} kB"
            lines.append(row_of([window.name if not words else "", name, f"{coarse} m: {kb(parts[0])}", f"{middle} m: {kb(parts[1])}",
                                 f"{fine} m: {kb(parts[2])}", kb(sum(parts)), kb(at_once), share(sum(parts), at_once)]))
    return lines


# What somebody wants, the window that stands for what they have, and the words of a query.
CHOICES = [("tiles of mountains for a web map, zoom 12", "bigtujunga, 30 m, canyons", ["--tolerance", 20, "--heights", "fitted"]),
           ("the same, zoom 14", "bigtujunga, 30 m, canyons", ["--tolerance", 5, "--heights", "bounded"]),
           ("a simulator's terrain, few triangles", "Swiss Alps, 90 m", ["--tolerance", 10, "--heights", "fitted"]),
           ("an overview that increments go on from", "Swiss Alps, 90 m", ["--tolerance", 50]),
           ("sheets of a lidar survey, few bytes", "gabilan, 1 m, lidar", ["--tolerance", 0.05, "--heights", "bounded"]),
           ("the same for contours and CAD, no terraces", "gabilan, 1 m, lidar", ["--tolerance", 0.05]),
           ("a survey without a loss", "gabilan, 1 m, lidar", ["--tolerance", 0]),
           ("nearly every sample in few bytes", "S36E149, 90 m, hills", ["--tolerance", 1, "--heights", "dense"]),
           ("slopes and runoff", "S36E149, 90 m, hills", ["--tolerance", 1])]


def choices(bench, folder):
    """What the page recommends, asked for."""
    lines = table("wanted", "window", "`talus query` with", "vertices", "of samples", "as a stream", "heights are multiples of", "at most off", "level steps (source)", "time of exact")
    for wanted, name, words in CHOICES:
        window = next((w for w in bench.windows if w.name == name), None)
        if window is None:
            continue
        database, surface = bench.database(window.cut), bench.scratch / "choice.tif"
        made = bench.answer(database, *words)
        bench.answer(database, *words)  # into memory
        seconds = lambda words: statistics.median(json.loads(run(bench.talus, "query", database, *words, "--json"))["seconds"] for _ in range(9))
        ratio = seconds(words) / seconds(words[:2])
        run(bench.talus, "query", database, *words, "-o", surface)
        there, truth = (gdal.Open(str(file)).ReadAsArray().astype(float) for file in (surface, window.cut))
        level = lambda heights: f"{100 * (abs(numpy.diff(heights, axis=1)) < 1e-6).mean():.0f} %"
        lines.append(row_of([wanted, name, f"`{' '.join(map(str, words))}`", f"{made['vertices']:,}", f"{100 * made['vertices'] / (SIDE + 1) ** 2:.2g} %",
                             f"{made['bytes'] / 1000:,.1f} kB", f"{made['quantum']:g} m" if made["quantum"] else "the source's", f"{abs(there - truth).max():.3g} m",
                             f"{level(there)} ({level(truth)})", f"{ratio:.1f}"]))
    return lines


PARTS = {"choices": choices, "models": models_, "windows": windows, "kinds": kinds, "paper": paper, "bytes": bytes_,
         "chains": chains, "borders": borders}


def main():
    build, wanted = Path(sys.argv[1]).resolve(), sys.argv[2:] or list(PARTS)
    unknown = [part for part in wanted if part not in PARTS]
    if unknown:
        sys.exit(f"page: no part {unknown[0]}: there are {' '.join(PARTS)}")
    page = Path("docs/accuracy.md")
    folder = page.parent / "accuracy"
    folder.mkdir(exist_ok=True)
    bench = Bench(build)
    for part in wanted:
        begun = time.monotonic()
        lines = PARTS[part](bench, folder)
        text, mark = page.read_text(), f"<!-- measured: {part} -->"
        if mark not in text:
            sys.exit(f"page: {page} has no mark {mark}")
        page.write_text(re.sub(re.escape(mark) + r".*?<!-- end -->", lambda _: mark + "\n" + "\n".join(lines) + "\n<!-- end -->", text, flags=re.S))
        print(f"{part}: written, {time.monotonic() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main()
