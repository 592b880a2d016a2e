"""Draw the sign conventions, one picture per sign: `python scripts/draw_signs.py` writes docs/img/signs/*.svg.

Side views look to port (nose left, x to the right); the drawings use two colours that read on light and dark pages.
"""

from __future__ import annotations

from math import cos, hypot, radians, sin
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "img" / "signs"
LINE, MARK, FAINT = "#6b7785", "#d1495b", "#9aa5b1"
WIDTH, HEIGHT = 320, 180


def arrow(x1: float, y1: float, x2: float, y2: float, colour: str = MARK) -> str:
    """A straight arrow."""
    length = hypot(x2 - x1, y2 - y1)
    ux, uy = (x2 - x1) / length, (y2 - y1) / length
    return line(x1, y1, x2 - 7 * ux, y2 - 7 * uy, colour) + head(x2, y2, ux, uy, colour)


def head(x: float, y: float, ux: float, uy: float, colour: str) -> str:
    """A filled arrow head that points along (ux, uy)."""
    left = f"{x - 10 * ux - 5 * uy:.1f},{y - 10 * uy + 5 * ux:.1f}"
    right = f"{x - 10 * ux + 5 * uy:.1f},{y - 10 * uy - 5 * ux:.1f}"
    return f'<polygon points="{x:.1f},{y:.1f} {left} {right}" fill="{colour}"/>'


def line(x1: float, y1: float, x2: float, y2: float, colour: str = LINE, dash: str = "") -> str:
    """A straight line."""
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return (
        f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" stroke-width="2"{dashed}/>'
    )


def arc(cx: float, cy: float, r: float, start: float, end: float) -> str:
    """A circular arrow from one angle to another, degrees from x towards the bottom of the page."""
    sign = 1.0 if end > start else -1.0
    stop = end - sign * 8.0
    x1, y1, x2, y2 = (f(radians(a)) * r + c for a in (start, stop) for f, c in ((cos, cx), (sin, cy)))
    sweep = 1 if sign > 0 else 0
    x, y = cx + r * cos(radians(end)), cy + r * sin(radians(end))
    ux, uy = -sign * sin(radians(end - sign * 5)), sign * cos(radians(end - sign * 5))
    path = f'<path d="M{x1:.1f},{y1:.1f} A{r},{r} 0 0 {sweep} {x2:.1f},{y2:.1f}" fill="none" stroke="{MARK}"'
    return f'{path} stroke-width="2"/>' + head(x, y, ux, uy, MARK)


def text(x: float, y: float, words: str, colour: str = MARK, anchor: str = "middle") -> str:
    """A label."""
    return (
        f'<text x="{x}" y="{y}" fill="{colour}" font-family="sans-serif" font-size="15" '
        f'text-anchor="{anchor}">{words}</text>'
    )


def section(colour: str = LINE, turn: float = 0.0, drop: float = 0.0, flap: float = 0.0, dash: str = "") -> str:
    """A wing section of chord 200, nose left, turned about its flexural axis; the flap is the last quarter."""
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    style = f'fill="none" stroke="{colour}" stroke-width="2"{dashed}'
    body = f'<path d="M210,83 C140,70 62,70 60,90 C62,108 140,104 210,97" {style}/>'
    tail = f'<path d="M210,83 L260,91 L210,97 Z" transform="rotate({flap} 210 90)" {style}/>'
    return f'<g transform="rotate({turn} 140 90) translate(0 {drop})">{body}{tail}</g>'


def axis() -> str:
    """The flexural axis."""
    return f'<circle cx="140" cy="90" r="4" fill="{LINE}"/>'


def planform(left: bool = True) -> str:
    """A swept wing from above, nose up the page."""
    right = "160,30 290,105 290,135 160,100"
    mirrored = "160,30 30,105 30,135 160,100"
    shapes = [right, mirrored] if left else [right]
    return "".join(f'<polygon points="{p}" fill="none" stroke="{LINE}" stroke-width="2"/>' for p in shapes)


DRAWINGS = {
    "plunge": section(FAINT, drop=-18, dash="5 4") + section(drop=18) + arrow(140, 72, 140, 108) + text(158, 98, "h"),
    "pitch": section(FAINT, dash="5 4") + section(turn=12) + axis() + arc(140, 90, 95, 180, 207) + text(38, 60, "θ"),
    "lift": section() + axis() + arrow(140, 82, 140, 20) + text(158, 34, "L"),
    "moment": section() + axis() + arc(140, 90, 42, 150, 330) + text(192, 52, "M"),
    "flap": section(FAINT, dash="5 4") + section(flap=22) + arc(210, 90, 66, 0, 24) + text(292, 106, "δ"),
    "gust": section() + "".join(arrow(x, 168, x, 122) for x in (80, 140, 200, 260)) + text(292, 150, "w_g"),
    "angle_of_attack": line(20, 90, 300, 90, FAINT, "5 4")
    + section(turn=12)
    + axis()
    + arrow(12, 120, 52, 120, LINE)
    + text(44, 142, "air, V", LINE)
    + arc(140, 90, 118, 180, 192)
    + text(24, 66, "α"),
    "sweep": planform() + line(160, 47, 290, 47, FAINT, "5 4") + line(160, 47, 290, 112, FAINT, "5 4")
    + arc(160, 47, 100, 0, 26.5) + text(276, 78, "Λ") + arrow(160, 120, 160, 165, LINE) + text(174, 160, "x", LINE),
    "roll": f'<g transform="rotate(-14 160 90)">{line(40, 90, 280, 90)}{line(160, 72, 160, 90)}</g>'
    + line(40, 90, 280, 90, FAINT, "5 4") + arc(160, 90, 128, 0, -14) + text(302, 66, "roll")
    + text(238, 128, "starboard", LINE) + text(82, 148, "port", LINE) + text(160, 172, "seen from behind", FAINT),
    "washout": section(FAINT, dash="5 4") + section(turn=-10) + axis() + text(110, 60, "root", FAINT)
    + text(110, 132, "tip", LINE) + arc(140, 90, 95, 180, 155) + text(36, 150, "washout"),
}  # fmt: skip


def drawing(name: str) -> str:
    """The SVG of one sign."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
        f'aria-label="{name.replace("_", " ")}, positive as drawn">{DRAWINGS[name]}</svg>\n'
    )


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in DRAWINGS:
        (FOLDER / f"{name}.svg").write_text(drawing(name), encoding="utf-8")
    print(f"wrote {len(DRAWINGS)} drawings to {FOLDER}")
