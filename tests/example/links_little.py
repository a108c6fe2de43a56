#!/usr/bin/python3
"""links_little.py PROGRAM MOST: fails if a program links more than MOST libraries, or GDAL or PROJ at all."""
import shutil
import subprocess
import sys

program, most = sys.argv[1], int(sys.argv[2])
if shutil.which("ldd") is None:
    sys.exit(77)
lines = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout.splitlines()
print("\n".join(lines))
forbidden = [line for line in lines if "libgdal" in line or "libproj" in line]
sanitized = any("libasan" in line or "libtsan" in line or "libubsan" in line for line in lines)
if forbidden:
    sys.exit(f"{program} links {forbidden[0].split()[0]}")
if len(lines) > most and not sanitized:
    sys.exit(f"{program} links {len(lines)} libraries, more than {most}")
