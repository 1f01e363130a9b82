#!/usr/bin/env python3
"""Writes the 60 programs of this folder: twelve parts in the styles of five post-processors.

The styles are those of programs that Fanuc users, Mach3, LinuxCNC, Fusion 360 and FreeCAD write:
their headers, tool changes, numbers, order of words and ends. No program of others is copied.

Usage: make_programs.py    (writes into the folder where it is)
"""
import math
import pathlib

FOLDER = pathlib.Path(__file__).parent


class Fanuc:
    """Line numbers, a point in every number, one motion code a line, G28 by way of a relative Z."""

    name = "fanuc"

    def __init__(self, number, title):
        self.lines, self.n, self.title = ["%", f"O{1000 + number} ({title.upper()})"], 5, title
        self.modal = None
        self.put("G21")
        self.put("G0 G17 G40 G49 G80 G90")

    def put(self, text):
        self.n += 5
        self.lines.append(f"N{self.n} {text}")

    @staticmethod
    def value(v):
        text = f"{v:.3f}".rstrip("0")
        return "0." if text in ("-0.", "0.") else text

    def words(self, **values):
        return " ".join(f"{k}{self.value(v)}" for k, v in values.items() if v is not None)

    def tool(self, number, diameter, speed, x, y):
        self.modal = None
        self.put(f"( TOOL {number} DIA. {self.value(diameter)} )")
        self.put(f"T{number} M6")
        self.put(f"G0 G90 G54 {self.words(X=x, Y=y)} A0. S{speed} M3".replace(" A0.", ""))
        self.put(f"G43 H{number} Z25.")
        self.put("M8")

    def end_tool(self):
        self.put("M9")
        self.put("M5")
        self.put("G91 G28 Z0.")

    def end(self):
        self.put("G28 X0. Y0.")
        self.put("G90")
        self.put("M30")
        self.lines.append("%")

    def move(self, code, feed=None, **values):
        text = "" if code == self.modal else code + " "
        self.modal = code
        self.put(text + self.words(**values) + (f" F{self.value(feed)}" if feed else ""))

    def cycle(self, code, first, rest, feed, **values):
        self.modal = None
        self.put(f"G98 {code} {self.words(X=first[0], Y=first[1], **values)} F{self.value(feed)}")
        for x, y in rest:
            self.put(self.words(X=x, Y=y))
        self.put("G80")

    def side(self, code, number, x, y, feed):
        self.modal = "G1"
        self.put(f"G1 {code} D{number} {self.words(X=x, Y=y)} F{self.value(feed)}")

    def text(self):
        return "\n".join(self.lines) + "\n"


class Mach(Fanuc):
    """No line numbers, all decimals, M6 before T, G64, comments of the part."""

    name = "mach"

    def __init__(self, number, title):
        self.lines, self.modal = [f"({title})", "(Mach3 metric, part " + str(number) + ")"], None
        for line in ("G90", "G21", "G64", "G40 G49 G80", "G54"):
            self.put(line)

    def put(self, text):
        self.lines.append(text)

    @staticmethod
    def value(v):
        return f"{v:.4f}"

    def tool(self, number, diameter, speed, x, y):
        self.modal = None
        self.put(f"M6 T{number} (end mill {diameter:g} mm)")
        self.put(f"G43 H{number}")
        self.put(f"S{speed} M03")
        self.put("M07")
        self.put(f"G00 {self.words(Z=25)}")
        self.put(f"G00 {self.words(X=x, Y=y)}")

    def end_tool(self):
        self.put(f"G0 {self.words(Z=25)}")
        self.put("M05 M09")

    def end(self):
        self.put("G49")
        self.put("G0 X0.0000 Y0.0000")
        self.put("M30")

    def move(self, code, feed=None, **values):
        code = code[0] + "0" + code[1:]
        self.put(f"{code} {self.words(**values)}" + (f" F{feed:.1f}" if feed else ""))

    def side(self, code, number, x, y, feed):
        self.put(f"{code} D{number}")
        self.move("G1", feed, X=x, Y=y)


class LinuxCnc(Mach):
    """Parameters for depth and feed, G64 P Q, lower case, messages, M2."""

    name = "linuxcnc"

    def __init__(self, number, title):
        self.lines, self.modal = ["%", f"; {title}"], None
        self.put("(MSG, part %d)" % number)
        self.put("#<clearance> = 25.000")
        self.put("#<plunge> = 120 ; mm/min")
        self.put("g21 g17 g90 g40 g49 g80 g94 g91.1")
        self.put("g64 p0.005 q0.005")
        self.put("g54")

    @staticmethod
    def value(v):
        return f"{v:.4f}".rstrip("0").rstrip(".")

    def words(self, **values):
        return super().words(**values).lower()

    def tool(self, number, diameter, speed, x, y):
        self.put(f"t{number} m6 (tool {number}: {diameter:g} mm)")
        self.put(f"g43 h{number}")
        self.put(f"s{speed} m3 m8")
        self.put(f"g0 {self.words(X=x, Y=y)}")
        self.put("g0 z#<clearance>")
        self.put("f#<plunge>")

    def end_tool(self):
        self.put("g0 z[#<clearance> + 5]")
        self.put("m5 m9")

    def end(self):
        self.put("g53 g0 z0")
        self.put("m2")
        self.put("%")

    def move(self, code, feed=None, **values):
        self.put(f"{code.lower()} {self.words(**values)}" + (f" f{feed:g}" if feed else ""))

    def cycle(self, code, first, rest, feed, **values):
        self.put("g98")
        self.put(f"{code.lower()} {self.words(X=first[0], Y=first[1], **values)} f{feed:g}")
        for x, y in rest:
            self.put(self.words(X=x, Y=y))
        self.put("g80")

    def side(self, code, number, x, y, feed):
        self.put(f"{code.lower()} d{number}")
        self.move("G1", feed, X=x, Y=y)


class Fusion(Fanuc):
    """Program number as a comment, description of tools at the top, several G91 G28, no numbers."""

    name = "fusion"

    def __init__(self, number, title):
        self.lines, self.modal = [f"({1000 + number})", f"({title})"], None
        self.put("(T1  D=6. CR=0. - ZMIN=-5. - flat end mill)")
        self.put("(T2  D=3. CR=0. TAPER=118deg - ZMIN=-12. - drill)")
        self.put("G90 G94 G17 G49 G40 G80")
        self.put("G21")
        self.put("G28 G91 Z0.")
        self.put("G90")

    def put(self, text):
        self.lines.append(text)

    def tool(self, number, diameter, speed, x, y):
        self.modal = "G0"
        self.put("")
        self.put(f"(TOOL{number})")
        self.put(f"T{number} M6")
        self.put(f"S{speed} M3")
        self.put("G54")
        self.put("M8")
        self.put(f"G0 {self.words(X=x, Y=y)}")
        self.put(f"G43 Z15. H{number}")

    def end_tool(self):
        self.modal = None
        self.put("M5")
        self.put("M9")
        self.put("G28 G91 Z0.")
        self.put("G90")
        self.put("G49")

    def end(self):
        self.put("G28 G91 X0. Y0.")
        self.put("G90")
        self.put("M30")

    def cycle(self, code, first, rest, feed, **values):
        self.modal = None
        self.put(f"{code} {self.words(X=first[0], Y=first[1], **values)} F{self.value(feed)}")
        for x, y in rest:
            self.put(self.words(X=x, Y=y))
        self.put("G80")


class FreeCad(Fanuc):
    """Comments for each operation, every word in every line, G0 and G1 repeated, M6 before T."""

    name = "freecad"

    def __init__(self, number, title):
        self.lines, self.modal = ["(Exported by FreeCAD)", "(Post Processor: linuxcnc_post)"], None
        self.put(f"(Output Time:2024-01-{number + 1:02} 10:00:00.000000)")
        self.put("(begin preamble)")
        self.put("G17 G54 G40 G49 G80 G90")
        self.put("G21")
        self.put("(begin operation: Fixture)")
        self.put("(machine units: mm/min)")
        self.put("G54")
        self.put("(finish operation: Fixture)")
        self.put(f"(begin operation: {title})")

    def put(self, text):
        self.lines.append(text)

    @staticmethod
    def value(v):
        return f"{v:.3f}"

    def tool(self, number, diameter, speed, x, y):
        self.put(f"(TC: {diameter:g}mm Endmill)")
        self.put("M5")
        self.put(f"M6 T{number}")
        self.put(f"G43 H{number}")
        self.put(f"M3 S{speed}")
        self.put("(Coolant On:flood)")
        self.put("M8")
        self.put(f"G0 {self.words(Z=25)}")
        self.put(f"G0 {self.words(X=x, Y=y)}")

    def end_tool(self):
        self.put("M9")
        self.put(f"G0 {self.words(Z=25)}")

    def end(self):
        self.put("(begin postamble)")
        self.put("M05")
        self.put("G17 G54 G90 G80 G40")
        self.put("M2")

    def move(self, code, feed=None, **values):
        if code in ("G2", "G3"):
            values["K"] = 0
        self.put(f"{code} {self.words(**values)}" + (f" F{feed:.3f}" if feed else ""))

    def cycle(self, code, first, rest, feed, **values):
        self.put("G98")
        for x, y in [first, *rest]:
            self.put(f"{code} {self.words(X=x, Y=y, **values)} F{feed:.3f}")
        self.put("G80")


def rounded_rectangle(post, x0, y0, x1, y1, r, feed):
    """Counterclockwise from the middle of the lower side, where the tool is."""
    post.move("G1", feed, X=x1 - r, Y=y0)
    post.move("G3", X=x1, Y=y0 + r, I=0, J=r)
    post.move("G1", X=x1, Y=y1 - r)
    post.move("G3", X=x1 - r, Y=y1, I=-r, J=0)
    post.move("G1", X=x0 + r, Y=y1)
    post.move("G3", X=x0, Y=y1 - r, I=0, J=-r)
    post.move("G1", X=x0, Y=y0 + r)
    post.move("G3", X=x0 + r, Y=y0, I=r, J=0)
    post.move("G1", X=(x0 + x1) / 2, Y=y0)


def contour(post):
    post.tool(1, 6, 8000, 30, -3)
    for depth in (-1.5, -3):
        post.move("G1", 120, Z=depth)
        rounded_rectangle(post, -3, -3, 63, 43, 6, 600)
    post.move("G0", Z=15)
    post.end_tool()


def facing(post):
    post.tool(1, 6, 8000, -5, 0)
    post.move("G1", 200, Z=-0.5)
    for i in range(8):
        post.move("G1", 900, X=65 if i % 2 == 0 else -5)
        post.move("G1", 900, Y=5.0 * (i + 1))
    post.move("G0", Z=15)
    post.end_tool()


def pocket(post):
    post.tool(1, 6, 8000, 20, 20)
    post.move("G1", 100, Z=-2)
    for r in (2, 5, 8, 11):
        post.move("G1", 500, X=20 + r, Y=20)
        post.move("G2", X=20 - r, Y=20, I=-r, J=0)
        post.move("G2", X=20 + r, Y=20, I=r, J=0)
    post.move("G0", Z=15)
    post.end_tool()


def helix(post):
    post.tool(1, 6, 8000, 14, 20)
    post.move("G0", Z=1)
    for i in range(6):
        z = 0.5 - i
        post.move("G3", 300, X=26, Y=20, Z=z, I=6, J=0)
        post.move("G3", 300, X=14, Y=20, Z=z - 0.5, I=-6, J=0)
    post.move("G0", Z=15)
    post.end_tool()


HOLES = [(10, 10), (50, 10), (50, 30), (10, 30)]


def drilling(code, **values):
    def part(post):
        post.tool(2, 3, 3000, 10, 10)
        post.cycle(code, HOLES[0], HOLES[1:], 80, Z=-12, R=2, **values)
        post.end_tool()

    return part


def boring(post):
    post.tool(2, 3, 1200, 10, 10)
    post.cycle("G85", HOLES[0], HOLES[1:2], 60, Z=-8, R=2)
    post.cycle("G89", HOLES[2], HOLES[3:], 60, Z=-8, R=2, P=0.5)
    post.end_tool()


def several_tools(post):
    contour(post)
    drilling("G83", Q=3)(post)
    post.tool(3, 1, 12000, 5, 5)
    post.move("G1", 60, Z=-0.2)
    post.move("G1", 300, X=25, Y=5)
    post.move("G2", X=30, Y=10, I=0, J=5)
    post.move("G0", Z=15)
    post.end_tool()


def compensated(post):
    """A contour by its drawing, the tool beside it."""
    post.tool(1, 6, 8000, 30, -20)
    post.move("G1", 120, Z=-2)
    post.side("G42", 1, 30, 0, 500)
    rounded_rectangle(post, 0, 0, 60, 40, 5, 500)
    post.put("g40" if post.name == "linuxcnc" else "G40")
    post.move("G1", X=30, Y=-20)
    post.move("G0", Z=15)
    post.end_tool()


def waves(post):
    """Many short lines, as of a surface."""
    post.tool(3, 1, 12000, 0, 0)
    for row in range(5):
        for k in range(41):
            x = k if row % 2 == 0 else 40 - k
            post.move("G1", 700, X=x, Y=2 * row, Z=-1 + 0.6 * math.sin(x / 4 + row))
    post.move("G0", Z=15)
    post.end_tool()


def slots(post):
    post.tool(1, 6, 8000, 10, 10)
    for y in (10, 20, 30):
        post.move("G0", X=10, Y=y)
        post.move("G0", Z=1)
        for depth in (-1, -2, -3):
            post.move("G1", 150, X=30, Y=y, Z=depth)
            post.move("G1", 400, X=10, Y=y)
        post.move("G0", Z=15)
    post.end_tool()


PARTS = [
    ("contour", contour),
    ("facing", facing),
    ("pocket", pocket),
    ("helix", helix),
    ("drilling", drilling("G81")),
    ("spot", drilling("G82", P=0.2)),
    ("peck", drilling("G83", Q=4)),
    ("boring", boring),
    ("tools", several_tools),
    ("compensated", compensated),
    ("waves", waves),
    ("slots", slots),
]


def main():
    for style in (Fanuc, Mach, LinuxCnc, Fusion, FreeCad):
        for number, (title, part) in enumerate(PARTS):
            post = style(number, title)
            part(post)
            post.end()
            (FOLDER / f"{style.name}_{title}.nc").write_text(post.text(), encoding="ascii")


if __name__ == "__main__":
    main()
