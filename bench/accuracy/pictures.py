"""Curves over two logarithmic axes as SVG, some panels to a picture."""
import math
from pathlib import Path

WIDTH, HEIGHT, ACROSS = 300, 210, 3
COLOURS = {"exact": "#1b6ca8", "nested": "#2e8b57", "midpoint": "#c0392b", "perpendicular": "#8e44ad", "martini": "#d35400",
           "bounded": "#2e8b57", "fitted": "#16a3b8", "dense": "#e08e0b", "LERC": "#c0392b", "overviews": "#888888", "exact8": "#7f8c8d"}
DASHED = {"LERC", "overviews", "martini", "exact8"}  # peers, and what Talus does not store


def ticks(low, high):
    """1, 2, 5 in every decade, or 1 alone where there are many."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    marks = [m * 10.0**d for d in range(first, last + 1) for m in (1, 2, 5) if low <= m * 10.0**d <= high]
    return marks if len(marks) <= 9 else [t for t in marks if f"{t:e}"[0] == "1"]


def short(value):
    for limit, unit in ((1e6, "M"), (1e3, "k")):
        if value >= limit:
            return f"{value / limit:g}{unit}"
    return f"{value:g}"


def panel(left, top, title, x_title, y_title, curves):
    """curves: name → points, both coordinates above 0."""
    xs = [x for points in curves.values() for x, _ in points]
    ys = [y for points in curves.values() for _, y in points]
    x0, x1, y0, y1 = min(xs) / 1.1, max(xs) * 1.1, min(ys) / 1.2, max(ys) * 1.2

    def at(x, y):
        return left + WIDTH * math.log(x / x0) / math.log(x1 / x0), top + HEIGHT - HEIGHT * math.log(y / y0) / math.log(y1 / y0)

    out = [f'<text x="{left}" y="{top - 9}" font-size="13" font-weight="bold">{title}</text>']
    for t in ticks(x0, x1):
        x, y = at(t, y0)
        out.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{x:.1f}" y2="{top}" stroke="#e4e4e4"/>'
                   f'<text x="{x:.1f}" y="{y + 15:.1f}" font-size="11" text-anchor="middle">{short(t)}</text>')
    for t in ticks(y0, y1):
        x, y = at(x0, t)
        out.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{left + WIDTH}" y2="{y:.1f}" stroke="#e4e4e4"/>'
                   f'<text x="{x - 5:.1f}" y="{y + 4:.1f}" font-size="11" text-anchor="end">{short(t)}</text>')
    middle = top + HEIGHT / 2
    out.append(f'<rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#444"/>'
               f'<text x="{left + WIDTH / 2}" y="{top + HEIGHT + 31}" font-size="12" text-anchor="middle">{x_title}</text>'
               f'<text x="{left - 42}" y="{middle}" font-size="12" text-anchor="middle" transform="rotate(-90 {left - 42} {middle})">{y_title}</text>')
    for name, points in curves.items():
        if not points:
            continue
        places = [at(*p) for p in points]
        dash = ' stroke-dasharray="5 3"' if name in DASHED else ""
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        out.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[name]}" stroke-width="1.7"{dash}/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="{COLOURS[name]}"/>' for x, y in places]
    return "\n".join(out)


def picture(file, panels, legend):
    """panels: (title, x title, y title, curves); legend: (name, words)."""
    out, x = [], 62
    for name, words in legend:
        dash = ' stroke-dasharray="5 3"' if name in DASHED else ""
        out.append(f'<line x1="{x}" y1="22" x2="{x + 24}" y2="22" stroke="{COLOURS[name]}" stroke-width="3"{dash}/>'
                   f'<text x="{x + 30}" y="26" font-size="13">{words}</text>')
        x += 52 + 7 * len(words)
    for i, one in enumerate(panels):
        out.append(panel(62 + i % ACROSS * (WIDTH + 80), 62 + i // ACROSS * (HEIGHT + 78), *one))
    rows, across = (len(panels) + ACROSS - 1) // ACROSS, min(ACROSS, len(panels))
    Path(file).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{max(x, across * (WIDTH + 80) + 30)}" height="{62 + rows * (HEIGHT + 78)}" '
        f'font-family="sans-serif"><rect width="100%" height="100%" fill="white"/>\n' + "\n".join(out) + "\n</svg>\n")
