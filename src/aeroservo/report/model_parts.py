"""Parts on the model itself: summary, geometry, natural modes, flutter, statics."""

from __future__ import annotations

import numpy as np

from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.report.blocks import Block, Chart, Facts, Mark, Part, Prose, Scene, Series, Table
from aeroservo.report.case_marks import bands, drawn, marks, range_of, words
from aeroservo.report.figures import shown_branches
from aeroservo.report.lattice3d import Lattice3D, at_rest, lattice3d, rigid_lattice
from aeroservo.report.scene import mode_data, scene_data
from aeroservo.studies.aircraft_report import MACH_LIMIT, ReportCase

SPEED = "true airspeed V, m/s"


def summary_part(case: ReportCase) -> Part:
    """The speeds that matter, and how far they can be trusted.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        First of the report.
    """
    found, statics = case.found, case.static
    V = found.flutter_speed
    how = f"{found.method} method, air forces {case.theory}"
    facts = [
        (
            "Flutter",
            words(V, "m/s", 5),
            f"none between {case.sweep.V[0]:g} and {case.sweep.V[-1]:g} m/s"
            if V is None
            else f"{words((found.flutter_frequency or 0.0) / (2 * np.pi), 'Hz')}, mode {found.flutter_mode}; "
            f"{words(V * np.sqrt(case.rho / 1.225), 'm/s')} EAS",
        ),
        ("Divergence", words(found.divergence_speed, "m/s", 5), "static, rigid-body modes held"),
    ]
    if statics.reversal_quantity:
        facts.append(
            ("Control reversal", words(statics.reversal.V, "m/s", 5), f"of {statics.reversal_quantity} by the control")
        )
    facts.append(("Incompressible up to", words(MACH_LIMIT * case.a_sound, "m/s"), "Mach 0.3 at this altitude"))
    blocks: list[Block] = [
        Facts(items=tuple(facts)),
        Prose(
            text=f"{case.file.name}, a model of kind {case.file.kind}, at {case.options.altitude:g} m of the standard "
            f"atmosphere (density {case.rho:.4g} kg/m³): {how}. Speeds are true airspeeds. Damping is the damping "
            "ratio ζ = −Re λ/|λ|, positive where a motion dies away."
        ),
    ]
    notes = [*case.file.problems(), *found.warnings, *statics.warnings]
    told = [note for note in dict.fromkeys(notes) if not note.startswith("assumed: ")]  # those stand in the next part
    beyond = [
        f"{name} at {speed:.4g} m/s lies beyond Mach 0.3, where incompressible air forces err: take it as a sign, not "
        "as a number"
        for name, speed in (("Flutter", V), ("Divergence", found.divergence_speed))
        if speed is not None and speed > MACH_LIMIT * case.a_sound
    ]
    if told + beyond:
        blocks.append(Prose(text="\n\n".join(told + beyond), kind="warning"))
    rows = tuple(
        (i.kind, i.mode, i.start, i.end, i.frequency / (2 * np.pi) if i.frequency else None) for i in found.intervals
    )
    if rows:
        blocks.append(
            Table(
                columns=("kind", "mode", "from, m/s", "to, m/s", "frequency, Hz"),
                rows=rows,
                title="Unstable speeds",
                caption="Where a root of the whole model lies in the right half plane; a dash is an end of the sweep.",
            )
        )
    return Part(title="Summary", anchor="summary", blocks=tuple(blocks))


def model_part(case: ReportCase) -> Part:
    """What the file says and what follows from it; three views and the lattice.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Geometry and derived properties.
    """
    rows = tuple(
        (_name(key), value) for key, value in case.file.derived().items() if isinstance(value, int | float | str)
    )
    blocks: list[Block] = [
        Table(
            columns=("property", "value"), rows=rows, title="Derived properties", caption="By arithmetic from the file."
        )
    ]
    assumptions = getattr(case.file, "assumptions", None) or ()
    if assumptions:
        blocks.append(Prose(text="Assumed by the author of the file:\n\n" + "\n\n".join(assumptions), kind="note"))
    scene = drawn(
        case,
        lambda lattice: scene_data(at_rest(lattice.patches)),
        title="In three dimensions",
        caption="Turn it with the mouse or the arrow keys; controls are drawn in orange. A section or a model on "
        "springs is drawn as a plate of its chord and area.",
    )
    if isinstance(scene, Scene):
        blocks += _views(lattice3d(case.file, case.model))
    blocks.append(scene)
    return Part(title="Model", anchor="model", blocks=tuple(blocks))


#: Units at the end of a property's name.
UNITS = {
    "rad_s2": "rad/s²", "rad_s": "rad/s", "kg_m2": "kg m²", "kg_per_m2": "kg/m²", "kg_per_m": "kg/m",
    "N_per_m2": "N/m²", "N_per_m": "N/m", "N_m": "N m", "N_m2": "N m²", "m_s": "m/s", "m2": "m²", "Pa": "Pa",
    "Hz": "Hz", "deg": "°", "rad": "rad", "kg": "kg", "N": "N", "m": "m", "s": "s",
}  # fmt: skip


def _name(key: str) -> str:
    """A property's name in words, its unit after a comma."""
    suffix = next((u for u in UNITS if key.endswith("_" + u)), "")
    plain = key.removesuffix("_" + suffix) if suffix else key
    return plain.replace("_", " ") + (f", {UNITS[suffix]}" if suffix else "")


def _views(lattice: Lattice3D) -> list[Block]:
    """From above, from behind, from starboard: outlines of the patches."""
    views = (
        ("From above", 1, 0, "y (starboard), m", "x (aft), m", True),
        ("From behind", 1, 2, "y (starboard), m", "z (up), m", False),
        ("From port", 0, 2, "x (aft), m", "z (up), m", False),
    )
    out: list[Block] = []
    for title, across, up, x_label, y_label, down in views:
        curves: dict[str, list[np.ndarray]] = {"surface": [], "control": []}
        for p in lattice.patches:
            g = p.points
            ring = np.concatenate([g[0], g[1:, -1], g[-1, -2::-1], g[-2::-1, 0], np.full((1, 3), np.nan)])
            curves["control" if p.kind == "control" else "surface"].append(ring)
        series = tuple(
            Series(name=name, x=np.concatenate(v)[:, across], y=np.concatenate(v)[:, up], colour=k)
            for k, (name, v) in enumerate(curves.items())
            if v
        )
        out.append(
            Chart(
                series=series,
                x_label=x_label,
                y_label=y_label,
                title=title,
                equal=True,
                hover="point",
                y_down=down,
                caption="Outlines of the surfaces at rest, equal scales.",
            )
        )
    return out


def modes_part(case: ReportCase) -> Part:
    """Natural modes, and the wing moving in them at any speed.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Frequencies, shapes along the span, the moving lattice.
    """
    natural, modes = case.natural, case.model.modes
    rows = tuple(
        (name, float(w), float(w / (2 * np.pi)), float(m))
        for name, w, m in zip(natural.names, natural.omega, natural.generalized_mass)
    )
    blocks: list[Block] = [
        Table(
            columns=("mode", "ω, rad/s", "f, Hz", "generalised mass, kg m² per unit²"),
            rows=rows,
            title="Natural modes without air",
            caption="Frequencies of the structure alone; masses for shapes whose largest coordinate is 1.",
        )
    ]
    grid = np.asarray(modes.grid)
    if len(grid) >= 3:
        order = np.argsort(grid[:, 1], kind="stable")
        shapes = np.asarray(modes.phi)[order] @ natural.shapes[:, :6]
        y, wide = grid[order, 1], float(np.ptp(grid[:, 1])) or 1.0
        size = np.maximum(np.abs(shapes[:, 2]).max(axis=0), 0.25 * wide * np.abs(shapes[:, 4]).max(axis=0))
        for k, label, title in ((2, "deflection up, m per m", "Bending"), (4, "twist nose up, rad per m", "Twist")):
            series = tuple(
                Series(name=f"{natural.names[j]}, {natural.omega[j] / (2 * np.pi):.4g} Hz", x=y, y=shapes[:, k, j] / s)
                for j, s in enumerate(np.where(size > 0.0, size, 1.0))
            )
            blocks.append(
                Chart(
                    series=series,
                    x_label="spanwise position y, m",
                    y_label=label,
                    title=f"{title} of the natural modes",
                    caption="Each mode is scaled alike in both figures: the larger of the two says what the mode is.",
                )
            )
    blocks.append(
        drawn(
            case,
            lambda lattice: scene_data(lattice, modes=mode_data(lattice, case.found)),
            title="Modes along the root locus",
            caption="The airspeed slider takes the mode from slow flight through the boundary: see how bending and "
            "torsion fall in step where flutter begins. Amplitudes are drawn alike at every speed.",
        )
    )
    return Part(title="Modes", anchor="modes", blocks=tuple(blocks))


def flutter_part(case: ReportCase) -> Part:
    """Frequency, damping and root locus over airspeed.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        Three charts.
    """
    found, V = case.found, case.sweep.V
    shown = shown_branches(found)
    across = (float(V[0]), float(V[-1]))
    frequency, damping, locus = [], [], []
    for j in shown:
        name, root = found.names[j], found.roots[:, j]
        frequency.append(Series(name=name, x=found.speeds[:, j], y=found.frequency[:, j] / (2 * np.pi)))
        damping.append(Series(name=name, x=found.speeds[:, j], y=found.damping_ratio[:, j]))
        locus.append(
            Series(
                name=name, x=root.real, y=np.abs(root.imag), along=found.speeds[:, j], along_label="true airspeed, m/s"
            )
        )
    lines, shaded = marks(case, "flutter", "divergence", "mach"), bands(case)
    zeta = [s.y[np.abs(s.y) < 0.999] for s in damping]
    limits = range_of([*zeta, np.array([-0.02, 0.02])])
    charts = (
        Chart(
            series=tuple(frequency),
            x_label=SPEED,
            y_label="frequency, Hz",
            title="Frequency against airspeed",
            caption="Two frequencies that run together announce flutter; one that reaches zero is about to diverge.",
            marks=lines,
            bands=shaded,
            x_range=across,
        ),
        Chart(
            series=tuple(damping),
            x_label=SPEED,
            y_label="damping ratio ζ, - (positive: stable)",
            title="Damping against airspeed",
            y_range=limits,
            x_range=across,
            marks=lines,
            bands=shaded,
            caption="Flutter begins where a curve falls through zero. A steep fall leaves no warning in flight. "
            "Motions that do not oscillate have ζ = 1 or −1 and lie off this scale. (The thesis plots −100 ζ.)",
        ),
        Chart(
            series=tuple(locus),
            x_label="Re λ, 1/s (positive: unstable)",
            y_label="Im λ, rad/s",
            title="Root locus",
            hover="point",
            caption="Roots of the upper half plane as the speed grows; point at one to see its speed. "
            "What crosses the upright line at zero is unstable.",
            x_range=range_of(
                [s.x for s in locus], low=-1.2 * float(np.nanmax([np.nanmax(s.y, initial=1.0) for s in locus]))
            ),
            marks=(Mark(at=0.0, text="", kind="zero"),),
        ),
    )
    hidden = len(found.names) - len(shown)
    note = () if hidden < 1 else (Prose(text=f"{hidden} higher modes that stay stable are not drawn."),)
    return Part(title="Flutter", anchor="flutter", blocks=(*charts, *note))


def static_part(case: ReportCase) -> Part:
    """Effectiveness, twist and trim against airspeed.

    Parameters
    ----------
    case : ReportCase
        The model.

    Returns
    -------
    part : Part
        As far as the model has a control, a steady incidence and a weight.
    """
    s, V = case.static, case.sweep.V
    across, lines = (float(V[0]), float(V[-1])), marks(case, "divergence", "reversal", "mach")
    blocks: list[Block] = []

    def chart(title: str, label: str, caption: str, *curves: tuple[str, np.ndarray], low: float, high: float) -> None:
        if any(np.any(np.isfinite(y)) for _, y in curves):
            series = tuple(Series(name=name, x=V, y=y) for name, y in curves if np.any(np.isfinite(y)))
            limits = range_of([x.y for x in series], low=low, high=high)
            blocks.append(
                Chart(
                    series=series,
                    x_label=SPEED,
                    y_label=label,
                    title=title,
                    caption=caption,
                    marks=lines,
                    x_range=across,
                    y_range=limits,
                )
            )

    chart(
        "Control effectiveness",
        "elastic over rigid, -",
        "1 is a rigid wing; where a curve crosses zero the control reverses. Nothing is given past divergence.",
        (f"steady {s.reversal_quantity or 'effect'} per control angle", s.effectiveness),
        ("moment (or lift) with the motion held", s.moment_effectiveness),
        low=-3.0,
        high=3.0,
    )
    chart(
        "Lift slope",
        "elastic over rigid, -",
        "How much more lift the twisting wing takes per incidence.",
        ("lift per incidence", s.lift_slope_ratio),
        low=-5.0,
        high=10.0,
    )
    chart(
        "Twist",
        "tip twist per root incidence, -",
        "Elastic twist of the tip for one radian of root incidence; it grows without bound at divergence.",
        ("twist", s.twist),
        low=-5.0,
        high=10.0,
    )
    chart(
        "Trim",
        "angle, °",
        "Root incidence at which lift carries the weight, and the twist of the tip there.",
        ("root incidence", np.degrees(s.trim_incidence)),
        ("twist", np.degrees(s.trim_twist)),
        low=-30.0,
        high=30.0,
    )
    facts = [("Divergence", words(s.divergence.V, "m/s", 5), words(s.divergence.q, "Pa"))]
    if s.reversal_quantity:
        facts.append((f"Reversal of {s.reversal_quantity}", words(s.reversal.V, "m/s", 5), words(s.reversal.q, "Pa")))
    return Part(title="Statics", anchor="statics", blocks=(Facts(items=tuple(facts)), *blocks))


def rigid_part(case: ReportCase) -> Part:
    """An aircraft without a structure: geometry alone.

    Parameters
    ----------
    case : ReportCase
        Of kind `aircraft` without `[structure]`.

    Returns
    -------
    part : Part
        Three views and the lattice.
    """
    assert isinstance(case.file, AircraftFile)
    lattice = rigid_lattice(case.file)
    derived = case.file.derived().items()
    rows = tuple((_name(key), value) for key, value in derived if isinstance(value, int | float | str))
    blocks: list[Block] = [
        Prose(text="This aircraft has no [structure] table, so it is rigid: no modes, no flutter.", kind="note"),
        Table(columns=("property", "value"), rows=rows, title="Derived properties"),
        *_views(lattice),
        Scene(data=scene_data(lattice), title="In three dimensions"),
    ]
    return Part(title="Model", anchor="model", blocks=tuple(blocks))
