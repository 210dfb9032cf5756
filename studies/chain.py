"""Write docs/chain.svg: the chain of rigid bodies, and one joint in detail.

python studies/chain.py
"""

from __future__ import annotations

import math
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"

INK, BODY, EDGE, SHEAR, FLEXURE, GREY = (
    "#1f2937", "#e7ebf1", "#5b6677", "#1d6fb8", "#b4471f", "#8a94a3",
)  # fmt: skip
WIDTH, HEIGHT = 900, 640

Point = tuple[float, float]


class Drawing:
    """Collects the elements of an SVG; y points down, angles are clockwise from the vertical."""

    def __init__(self) -> None:
        self.parts: list[str] = []

    def add(self, element: str) -> None:
        """Add one element."""
        self.parts.append(element)

    def line(
        self,
        a: Point,
        b: Point,
        color: str = INK,
        width: float = 1.4,
        *,
        dash: str = "",
        head: str = "",
    ) -> None:
        """Draw a line, with an arrow head ("end" or "both") if wanted."""
        extra = f' stroke-dasharray="{dash}"' if dash else ""
        if head:
            extra += f' marker-end="url(#head-{color[1:]})"'
        if head == "both":
            extra += f' marker-start="url(#head-{color[1:]})"'
        self.add(
            f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" '
            f'stroke="{color}" stroke-width="{width}"{extra}/>'
        )

    def path(self, points: list[Point], color: str, width: float = 1.4, head: bool = False) -> None:
        """Draw a polyline."""
        extra = f' marker-end="url(#head-{color[1:]})"' if head else ""
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add(
            f'<polyline points="{text}" fill="none" stroke="{color}" stroke-width="{width}" '
            f'stroke-linejoin="round" stroke-linecap="round"{extra}/>'
        )

    def text(
        self, at: Point, words: str, color: str = INK, anchor: str = "middle", size: float = 16
    ) -> None:
        """Write a label; `_` makes a subscript of the letters up to a blank, `*..*` italics."""
        out, italic = [], False
        for piece in words.split("*"):
            style = ' font-style="italic"' if italic else ""
            if italic and "_" in piece:
                name, below = piece.split("_")
                out.append(
                    f"<tspan{style}>{name}</tspan>"
                    f'<tspan dy="4" font-size="{0.7 * size:.0f}"{style}>{below}</tspan>'
                    '<tspan dy="-4">&#8203;</tspan>'
                )
            elif piece:
                out.append(f"<tspan{style}>{piece}</tspan>")
            italic = not italic
        self.add(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{color}" text-anchor="{anchor}" '
            f'font-size="{size}">{"".join(out)}</text>'
        )

    def dot(self, at: Point, color: str = INK, radius: float = 3) -> None:
        """Draw a filled circle."""
        self.add(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}" fill="{color}"/>')

    def body(self, base: Point, angle: float, length: float, half: float) -> Point:
        """Draw a rigid body from its base up; return its top."""
        top = along(base, angle, length)
        corners = [
            across(base, angle, -half),
            across(base, angle, half),
            across(top, angle, half),
            across(top, angle, -half),
        ]
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
        self.add(f'<polygon points="{text}" fill="{BODY}" stroke="{EDGE}" stroke-width="1.3"/>')
        return top

    def arc(self, center: Point, radius: float, begin: float, end: float, color: str) -> None:
        """Draw an arc with an arrow head, from one angle to another."""
        count = 24
        points = [
            along(center, begin + (end - begin) * i / count, radius) for i in range(count + 1)
        ]
        self.path(points, color, head=True)

    def zigzag(self, a: Point, b: Point, color: str, teeth: int = 4, size: float = 5) -> None:
        """Draw a spring between two points."""
        length = math.dist(a, b)
        tx, ty = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        points = [a]
        for i in range(2 * teeth):
            share = (i + 0.5) / (2 * teeth)
            side = size if i % 2 == 0 else -size
            points.append(
                (a[0] + share * length * tx - side * ty, a[1] + share * length * ty + side * tx)
            )
        self.path([*points, b], color, 1.6)

    def spiral(self, center: Point, radius: float, angle: float, color: str) -> None:
        """Draw a rotational spring."""
        turns, count = 2.0, 60
        self.path(
            [
                along(center, angle + 2 * math.pi * turns * i / count, radius * i / count)
                for i in range(count + 1)
            ],
            color,
            1.6,
        )

    def write(self, path: Path) -> None:
        """Write the file."""
        heads = "".join(
            f'<marker id="head-{color[1:]}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" '
            f'markerHeight="7" orient="auto-start-reverse"><path d="M0,1 L10,5 L0,9 z" '
            f'fill="{color}"/></marker>'
            for color in (INK, SHEAR, FLEXURE, GREY)
        )
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}" font-family="Georgia, \'Times New Roman\', serif" '
            'role="img">\n<title>Chain of rigid bodies and springs; one joint in detail</title>\n'
            f'<defs>{heads}</defs>\n<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n'
            + "\n".join(self.parts)
            + "\n</svg>\n",
            encoding="utf-8",
        )


def along(base: Point, angle: float, length: float) -> Point:
    """Return the point at a length along the axis e = (sin, cos) of a body."""
    return base[0] + length * math.sin(angle), base[1] - length * math.cos(angle)


def across(base: Point, angle: float, length: float) -> Point:
    """Return the point at a length along the normal t = (cos, -sin) of a body."""
    return base[0] + length * math.cos(angle), base[1] + length * math.sin(angle)


def ground(d: Drawing, x: float, y: float, half: float) -> None:
    """Draw the ground."""
    d.line((x - half, y), (x + half, y), INK, 2)
    for i in range(int(2 * half / 12) + 1):
        d.line((x - half + 12 * i, y), (x - half + 12 * i - 9, y + 9), GREY, 1)


def chain(d: Drawing) -> None:
    """Draw three bodies, displaced, with loads."""
    x0, y0, length, half = 110.0, 540.0, 140.0, 15.0
    angles = [math.radians(a) for a in (9, 20, 27)]
    slips = [40.0, 40.0, 40.0]
    ground(d, x0 + 15, y0, 75)
    d.line((x0, y0), (x0, y0 - 3 * length - 50), GREY, 1, dash="5 4")

    top: Point = (x0, y0)
    below = 0.0
    labels = []
    for i, (angle, slip) in enumerate(zip(angles, slips, strict=True), start=1):
        lifted = along(top, below, 7)
        base = across(lifted, below, slip)
        d.line(across(lifted, below, -20), across(lifted, below, slip + 20), EDGE, 1.2)
        d.zigzag(lifted, base, SHEAR)
        new_top = d.body(base, angle, length, half)
        d.spiral(base, 12, angle, FLEXURE)
        d.dot(base, INK, 2.5)
        d.dot(lifted, INK, 2.5)
        middle = along(base, angle, length / 2)
        d.dot(middle, EDGE, 3)
        labels.append((i, base, angle, below, middle, lifted))
        top, below = new_top, angle
    for i, base, angle, _, middle, lifted in labels:
        d.text((middle[0] + 8, middle[1] + 5), f"*m_{i}*", INK, "start", 15)
        d.text(across(base, angle, -44 if i > 1 else -62), f"*u_{i}*", SHEAR, "middle", 17)
        d.text((base[0] + 30, base[1] + (20 if i > 1 else -9)), f"*φ_{i}*", FLEXURE, "start", 17)
        d.dot(lifted, INK, 2.5)
        # Absolute rotation, from the vertical.
        d.line(base, along(base, 0, 100), GREY, 1, dash="3 3")
        d.arc(base, 88, 0, angle - 0.02, GREY)
        at = along(base, angle / 2, 101)
        d.text((at[0] + (-2 if i == 3 else -8), at[1] - 2), f"*θ_{i}*", INK, "middle", 15)
        # Length, on the right.
        a, b = across(base, angle, half + 42), across(along(base, angle, length), angle, half + 42)
        d.line(a, b, GREY, 1, head="both")
        m = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        d.text(across((m[0], m[1] + 5), angle, 13), f"*l_{i}*", INK, "middle", 15)

    d.line((top[0] - 4, top[1]), (top[0] + 56, top[1]), INK, 2.2, head="end")
    d.text((top[0] + 67, top[1] + 6), "*F*", INK, "middle", 19)
    d.line((top[0], top[1] - 76), (top[0], top[1] - 4), INK, 2.2, head="end")
    d.text((top[0] + 15, top[1] - 58), "*P*", INK, "middle", 19)
    d.line((x0, top[1] - 24), (top[0] - 2, top[1] - 24), GREY, 1, head="both")
    d.text(((x0 + top[0]) / 2, top[1] - 32), "displacement of the top", INK, "middle", 14)

    d.line((36, 600), (86, 600), INK, 1.4, head="end")
    d.line((36, 600), (36, 550), INK, 1.4, head="end")
    d.text((95, 605), "*x*", INK, "middle", 16)
    d.text((36, 543), "*y*", INK, "middle", 16)
    d.line((150, 590), (225, 590), INK, 1.4, head="end")
    d.text((236, 595), "ground acceleration", INK, "start", 14)


def joint(d: Drawing) -> None:
    """Draw joint i in detail."""
    below, angle = math.radians(12), math.radians(36)
    start: Point = (590.0, 550.0)
    half, slip = 27.0, 104.0
    d.text((680, 52), "Joint *i*", INK, "middle", 19)
    top = d.body(start, below, 170, half)
    d.text(along((start[0] + 42, start[1]), below, 70), "body *i* − 1", INK, "start", 15)
    lifted = along(top, below, 14)
    base = across(lifted, below, slip)
    d.line(across(lifted, below, -46), across(lifted, below, slip + 62), EDGE, 1.4)
    d.body(base, angle, 200, half)
    side = across(along(base, angle, 110), angle, half + 12)
    d.text((side[0], side[1] + 8), "body *i*", INK, "start", 15)
    d.zigzag(lifted, base, SHEAR, 5, 8)
    d.spiral(base, 22, angle, FLEXURE)
    d.dot(base)
    d.dot(lifted)
    d.text((lifted[0] - 24, lifted[1] - 12), "*T_i−1*", INK, "middle", 16)
    d.text((base[0] + 6, base[1] + 44), "*b_i*", INK, "middle", 16)

    # Slip.
    a, b = along(lifted, below, 92), along(base, below, 92)
    d.line(along(lifted, below, 8), along(lifted, below, 98), GREY, 1, dash="3 3")
    d.line(a, b, SHEAR, 1.6, head="end")
    d.text((a[0] - 12, a[1] - 2), "slip *u_i*", SHEAR, "end", 16)
    d.text((a[0] - 12, a[1] + 19), "shear *V_i*", SHEAR, "end", 16)

    # Rotation.
    d.line(along(base, below, 26), along(base, below, 236), GREY, 1, dash="4 4")
    d.arc(base, 222, below, angle - 0.012, FLEXURE)
    at = along(base, below, 246)
    d.text((at[0] - 6, at[1] - 18), "rotation *φ_i* = *θ_i* − *θ_i−1*", FLEXURE, "middle", 16)
    d.text((at[0] - 6, at[1] + 3), "moment *M_i*", FLEXURE, "middle", 16)

    # Directions of the body below.
    corner = (480.0, 520.0)
    e, n = along(corner, below, 56), across(corner, below, 56)
    d.line(corner, e, INK, 1.5, head="end")
    d.line(corner, n, INK, 1.5, head="end")
    d.text((e[0] + 2, e[1] - 9), "*e_i−1*", INK, "middle", 16)
    d.text((n[0] + 4, n[1] + 22), "*t_i−1*", INK, "middle", 16)


def main() -> None:
    """Draw and write."""
    d = Drawing()
    chain(d)
    d.line((445, 60), (445, 600), "#d5dae2", 1)
    joint(d)
    d.write(DOCS / "chain.svg")


if __name__ == "__main__":
    main()
