#!/usr/bin/python3
"""Bytes of one answer as a stream, as Draco's mesh, and of its window as a LERC GeoTIFF.

    streams.py TALUS FOLDER        TALUS: the program; FOLDER: where databases are kept; models in TALUS_DEM_DIR

For each model and tolerance: vertices and triangles of the bounded answer, its quantum, and its bytes and bits a triangle; LERC with ZSTD, tiles of 256², MAX_Z_ERROR the tolerance, over the same window; Draco's sequential coding
of the same mesh with its columns, rows and height quanta as they are, quantised so finely that none is lost, at its
strongest level (needs draco_encoder: Debian package draco); meshoptimizer's codecs of it behind zstd (needs meshopt, built
beside the benches where the library is: Debian package libmeshoptimizer-dev); and what Dick et al. need for it by their layout,
k + 2 bits a triangle and 32 bits every sixteen, k bits holding the range of quanta.

With a third argument, tolerances: these instead of 5 and 20. With a fourth: models whose names contain it.
"""
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy
from osgeo import gdal

gdal.UseExceptions()
MODELS = ["srtm3_S36E149.tif", "taiwan_z13/taiwan.vrt", "kenya_central_z11.tif", "bigtujunga_30m_utm11.tif",
          "srtm3_N46E008.tif", "gabilan.bil", "tirol5m_avaPfa.tif"]
SIDE = 2049  # of the window amid a model, at most


def run(*words):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout


def window_of(path):
    dataset = gdal.Open(str(path))
    cols, rows = dataset.RasterXSize, dataset.RasterYSize
    west, north = max(0, (cols - SIDE) // 2), max(0, (rows - SIDE) // 2)
    east, south = min(cols, west + SIDE), min(rows, north + SIDE)
    t = dataset.GetGeoTransform()
    x = sorted((t[0] + (west + 0.5) * t[1], t[0] + (east - 0.5) * t[1]))
    y = sorted((t[3] + (north + 0.5) * t[5], t[3] + (south - 0.5) * t[5]))
    return (west, north, east - west, south - north), f"--bbox={x[0]!r},{y[0]!r},{x[1]!r},{y[1]!r}", t


def read_ply(path):
    data = Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in head.split(b"\n") if line.startswith(b"element")]
    points = numpy.frombuffer(body, "<f8", 3 * counts[0]).reshape(-1, 3)
    faces = numpy.frombuffer(body, numpy.dtype([("n", "u1"), ("v", "<i4", 3)]), counts[1], 24 * counts[0])["v"]
    return points, faces


def whole_ply(file, points, faces, transform, quantum):
    """The mesh in cells and quanta: whole numbers, so that fitting quantisation loses nothing. Returns its bits."""
    whole = numpy.empty_like(points)
    whole[:, 0] = numpy.rint((points[:, 0] - transform[0]) / transform[1] - 0.5)
    whole[:, 1] = numpy.rint((points[:, 1] - transform[3]) / transform[5] - 0.5)
    whole[:, 2] = numpy.rint(points[:, 2] / quantum)
    whole -= whole.min(axis=0)
    with open(file, "wb") as out:
        out.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                  b"property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
                  % (len(points), len(faces)))
        out.write(whole.astype("<f4").tobytes())
        rows = numpy.empty(len(faces), numpy.dtype([("n", "u1"), ("v", "<i4", 3)]))
        rows["n"], rows["v"] = 3, faces
        out.write(rows.tobytes())
    return [max(1, math.ceil(math.log2(top + 1))) for top in (whole.max(), whole[:, 2].max())]


def peers_of(folder, points, faces, transform, quantum, meshopt):
    """Bytes of the same mesh by name."""
    ply = folder / "mesh.ply"
    bits, height_bits = whole_ply(ply, points, faces, transform, quantum)
    sizes = {}
    if shutil.which("draco_encoder"):
        for name, level in (("Draco 0", 0), ("Draco 10", 10)):
            run("draco_encoder", "-i", ply, "-o", folder / "mesh.drc", "-qp", bits, "-cl", level)
            sizes[name] = (folder / "mesh.drc").stat().st_size
    if meshopt.exists() and bits <= 16:
        sizes["meshopt"] = int(run(meshopt, ply).split()[1])
    sizes["Dick"] = ((len(faces) + 2) * (height_bits + 2) + 7) // 8 + (len(faces) + 15) // 16 * 4
    return sizes


def main():
    talus, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    models = Path(os.environ.get("TALUS_DEM_DIR", "../shared/dem"))
    tolerances = [float(t) for t in sys.argv[3].split(",")] if len(sys.argv) > 3 else [5, 20]
    meshopt = talus.parent.parent / "bench" / "peers" / "meshopt"
    print("model tolerance quantum vertices triangles | bytes (bits) | LERC, against | "
          "peers on the same mesh: bytes (bits), against")
    for name in MODELS:
        if len(sys.argv) > 4 and sys.argv[4] not in name:
            continue
        if not (models / name).exists():
            print(f"{name}: not there")
            continue
        database = folder / (Path(name).stem + ".talus")
        if not database.exists():
            run(talus, "ingest", models / name, database)
        window, bbox, transform = window_of(models / name)
        for tolerance in tolerances:
            rqt, ply = folder / "answer.rqt", folder / "answer.ply"
            said = json.loads(run(talus, "query", database, bbox, "--tolerance", tolerance, "--heights", "bounded",
                                  "-o", rqt, "-o", ply, "--json"))
            ours = rqt.stat().st_size
            lerc = folder / "lerc.tif"
            gdal.Translate(str(lerc), str(models / name), srcWin=window,
                           creationOptions=["COMPRESS=LERC_ZSTD", f"MAX_Z_ERROR={tolerance}", "TILED=YES",
                                            "BLOCKXSIZE=256", "BLOCKYSIZE=256"])
            points, faces = read_ply(ply)
            peers = peers_of(folder, points, faces, transform, said["quantum"], meshopt)
            against = f"{ours / lerc.stat().st_size:.2f}"
            told = ", ".join(f"{peer} {size:,} ({8 * size / max(1, len(faces)):.2f}) {ours / size:.2f}"
                             for peer, size in peers.items())
            print(f"{Path(name).stem} {tolerance} {said['quantum']:g} {len(points):,} {len(faces):,} | "
                  f"{ours:,} ({8 * ours / max(1, len(faces)):.2f}) | "
                  f"{lerc.stat().st_size:,} {against} | {told}", flush=True)


if __name__ == "__main__":
    main()
