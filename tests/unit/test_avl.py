"""AVL geometry files: what is read, what is left out and said, and every refusal."""

import numpy as np
import pytest

from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice
from aeroservo.aircraft.avl import parse_avl, read_avl

WING = """Thesis wing         ! title
#Mach
 0.0
#IYsym IZsym Zsym
 0     0     0.0
1.0  0.52667  2.0    | Sref Cref Bref
0.3589 0.0   0.0
0.012                ! CDp
SURFACE
Main wing
16 1.0  32 -2.0
COMPONENT
1
YDUPLICATE
0.0
ANGLE
1.0
SECTION
0.0 0.0 0.0 0.7 0.0
NACA
2412
SECTION
0.2622 0.5 0.0 0.5 -2.5  8 1.0
CONTROL
elevator 1.0 0.75 0.0 0.0 0.0  1.0
CONTROL
aileron  0.5 0.75 0.0 0.0 0.0 -1.0
SECTION
0.5245 1.0 0.0 0.3 -5.0
AFILE
tip.dat
CONTROL
elevator 1.0 0.75 0.0 0.0 0.0  1.0
CONTROL
aileron  0.5 0.75 0.0 0.0 0.0 -1.0
CLAF
1.1
BODY
fuselage
20 1
TRANSLATE
0 0 0
BFILE
fuse.dat
SURFACE
Fin
8 1.0
SCALE
2.0 1.0 2.0
TRANSLATE
0.6 0.0 0.1
NOWAKE
SECTION
0 0 0 0.1 0
SECTION
0.05 0 0.1 0.05 0
"""


def test_reading(tmp_path):
    path = tmp_path / "wing.avl"
    path.write_text(WING)
    found = read_avl(path)
    model = found.model
    assert model.name == "Thesis wing"
    wing, fin = model.surface
    assert (wing.name, wing.mirrored, fin.mirrored) == ("Main_wing", True, False)
    assert [s.twist_deg for s in wing.section] == [1.0, -1.5, -4.0]
    assert wing.section[0].airfoil == "naca2412" and wing.section[2].airfoil == str(tmp_path / "tip.dat")
    (control,) = wing.control
    assert (control.name, control.symmetric, control.antisymmetric) == ("elevator_aileron", 1.0, 0.5)
    assert control.from_span == pytest.approx(0.5) and control.to_span == 1.0 and control.hinge_from == 0.75
    assert (
        fin.section[0].chord_m == 0.2 and fin.section[0].x_le_m == 0.6 and fin.section[1].x_le_m == pytest.approx(0.7)
    )
    assert fin.section[1].z_le_m == pytest.approx(0.3)
    r = model.references()
    assert (r.S, r.c, r.b, r.x) == (1.0, 0.52667, 2.0, 0.3589)
    for word in ("CDp", "bodies", "CLAF", "NOWA", "hinge line"):
        assert any(word in note for note in found.notes), word


def test_the_imported_wing_has_avl_s_derivatives():
    """AVL's own CL_alpha, neutral point and CL_q of the thesis wing (16 x 32 panels), 2 %."""
    text = WING.replace("AFILE\ntip.dat\n", "")
    model = parse_avl(text.split("BODY")[0]).model
    d = aircraft_lattice(model.surfaces(), model.references()).derivatives
    assert d.of("CL", "alpha") == pytest.approx(3.675, rel=0.02)
    assert d.neutral_point == pytest.approx(0.3578, abs=0.003)
    assert d.of("CL", "q") == pytest.approx(3.79, rel=0.02)


def test_controls_join_and_split():
    head = "w\n0\n0 0 0\n1 1 2\n0 0 0\nSURFACE\nw\n4 1\nYDUP\n0\n"
    control = "CONTROL\n{} {} {} 0 0 0 1\n"

    def section(y, *controls):
        return f"SECTION\n0 {y} 0 1 0\n" + "".join(control.format(*c) for c in controls)

    straight = parse_avl(
        head + section(0) + section(1, ("f", 1, 0.8)) + section(2, ("f", 1, 0.8)) + section(3, ("f", 1, 0.8))
    )
    (joined,) = straight.model.surface[0].control
    np.testing.assert_allclose([joined.from_span, joined.to_span], [1 / 3, 1.0])
    kinked = parse_avl(head + section(0, ("f", 1, 0.7)) + section(1, ("f", 1, 0.8)) + section(2, ("f", 1, 0.8)))
    assert [c.name for c in kinked.model.surface[0].control] == ["f", "f_w_2"]
    with pytest.raises(ValueError, match="different hinges"):
        parse_avl(head + section(0, ("f", 1, 0.7), ("g", 1, 0.8)) + section(1, ("f", 1, 0.7), ("g", 1, 0.8)))
    with pytest.raises(ValueError, match="leading-edge device"):
        parse_avl(head + section(0, ("s", 1, -0.2)) + section(1))


def test_half_models_get_their_twins():
    text = WING.replace(" 0     0     0.0", " 1     0     0.0").replace("YDUPLICATE\n0.0\n", "")
    found = parse_avl(text)
    assert [s.mirrored for s in found.model.surface] == [True, False]
    assert any("iYsym" in note for note in found.notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("title\n", "ends where"),
        (WING.replace("1.0  0.52667  2.0    | Sref Cref Bref", "one two three"), r"line 6: 3 number\(s\) expected"),
        (WING.split("SURFACE")[0], "no SURFACE"),
        (WING.replace("0.0 0.0 0.0 0.7 0.0", "0.0 0.0 0.0"), "5 number"),
        (WING.replace("YDUPLICATE\n0.0", "YDUPLICATE\n1.0"), "plane other than y = 0"),
        (WING.replace(" 0     0     0.0", "-1     0     0.0"), "antisymmetric flow"),
        (WING.replace("NACA\n2412", "WING\n2412"), "no AVL keyword"),
        (WING.replace("SECTION\n0.0 0.0 0.0 0.7 0.0\n", ""), "before the first SECTION"),
        (WING.replace("0.0 0.0 0.0 0.7 0.0", "0.0 0.0 0.0 -0.7 0.0"), "chord_m"),
    ],
)
def test_bad_files_are_refused(text, message):
    with pytest.raises(ValueError, match=message):
        parse_avl(text)


def test_absent_file(tmp_path):
    with pytest.raises(ValueError, match="cannot be read"):
        read_avl(tmp_path / "no.avl")
