"""An aircraft file as an elastic wing: the lattice's loads on the strips, and the beam wing that it must be."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import aeroservo as av
from aeroservo.aero.strip import QuasiSteady, Theodorsen
from aeroservo.aero.vlm import VortexLattice
from aeroservo.aero.vlm_loads import panel_forces
from aeroservo.aero.vlm_normalwash import join_normalwash, slope_normalwash
from aeroservo.aero.vlm_solve import solve_lattice
from aeroservo.aeroelastic.aircraft_lattice import aircraft_lattice, control_columns
from aeroservo.aeroelastic.aircraft_wing import SectionLoading, aircraft_wing, section_loading
from aeroservo.aeroelastic.build import build
from aeroservo.aeroelastic.build_beam import beam_model, beam_wing
from aeroservo.aeroelastic.static import divergence, reversal, static
from aeroservo.aircraft.aircraft_schema import AircraftFile
from aeroservo.aircraft.overrides import override
from aeroservo.aircraft.schema_beam import BeamWing
from aeroservo.datatypes import AeroelasticModel, FlightCondition
from aeroservo.structure.beam import modes as beam_shapes
from aeroservo.structure.modal import natural_modes

SEA = FlightCondition(V=1.0, rho=1.225)


def aircraft(
    sections: list[tuple[float, float, float]], *, axis: float = 0.4, kind: str = "hinged", **structure: Any
) -> AircraftFile:
    """A wing of (y, x of the leading edge, chord) with an elevon over its outer 40 %."""
    stations = [
        {
            "y_m": y,
            "flexural_axis": axis,
            "cg_axis": 0.45,
            "mass_kg_per_m": 4.0 * chord,
            "inertia_kg_m": 0.5 * chord**3,
            "EI_N_m2": 2000.0,
            "GJ_N_m2": 1500.0,
        }
        for y, _, chord in sections
    ]
    control = {
        "name": "elevon",
        "from_span": 0.6,
        "to_span": 1.0,
        "hinge_from": 0.75,
        "kind": kind,
        "antisymmetric": 1.0,
    }
    rows = [
        {"y_m": y, "x_le_m": x, "chord_m": c, "twist_deg": -2.0 * y / sections[-1][0], "airfoil": "mh62"}
        for y, x, c in sections
    ]
    return AircraftFile.model_validate(
        {
            "kind": "aircraft",
            "name": "a wing",
            "surface": [{"name": "wing", "section": rows, "control": [control]}],
            "structure": {"surface": "wing", "station": stations} | structure,
        }
    )


WINGS = {
    "straight": [(0.0, 0.0, 0.5), (2.5, 0.05, 0.3)],
    "aft": [(0.0, 0.0, 0.5), (1.5, 1.2, 0.25)],
    "forward": [(0.0, 0.0, 0.5), (2.0, -0.8, 0.4)],
    "cranked": [(0.0, 0.0, 0.6), (0.7, 0.0, 0.5), (2.0, 0.9, 0.3)],
}


@pytest.mark.parametrize("name", WINGS)
@pytest.mark.parametrize("kind", ["hinged", "morphed"])
def test_the_strips_carry_the_lattice(name: str, kind: str) -> None:
    """Lift per incidence, per elevon and of camber and twist, and pitching moment per elevon: the lattice's, 0.5 %."""
    model = aircraft(WINGS[name], kind=kind)
    d, ref = aircraft_lattice(model.surfaces(), model.references()).derivatives, model.references()
    built = build(model, "quasi_steady")
    lift = built.loads.row("lift")
    for ours, theirs in (("incidence", "alpha"), ("elevon", "elevon"), ("camber", "steady")):
        assert 2.0 * lift[built.column(ours)] == pytest.approx(d.of("CL", theirs) * ref.S, rel=5e-3), ours
    wing, j = aircraft_wing(model), built.column("elevon")
    s = np.interp(built.loads.y, wing.beam.position(wing.beam.y)[:, 1], wing.beam.y)
    x, cos = wing.beam.position(s)[:, 0], np.cos(wing.beam.at("sweep", s))
    loads = built.loads
    moment = loads.width @ (loads.lift[:, j] * (ref.x - x) + loads.torque[:, j] / cos)
    assert 2.0 * moment == pytest.approx(d.of("CM", "elevon") * ref.S * ref.c, rel=1e-2)


def test_thesis_uav_carries_the_lattice() -> None:
    """0.1 % in lift for every column; roll of an aileron within 4 %: normal sections lean off the streamwise ones."""
    model = av.read("thesis-uav")
    d, ref = aircraft_lattice(model.surfaces(), model.references()).derivatives, model.references()
    built = build(model)
    for ours, theirs in (("incidence", "alpha"), ("elevon", "elevon"), ("camber", "steady")):
        assert 2.0 * built.loads.row("lift")[built.column(ours)] == pytest.approx(d.of("CL", theirs) * ref.S, rel=1e-3)
    roll = -2.0 * built.loads.row("roll")[built.column("elevon_antisymmetric")]
    assert roll == pytest.approx(d.of("Cl", "elevon_antisymmetric") * ref.S * ref.b, rel=0.04)
    assert built.mass == pytest.approx(5.0, rel=1e-12)


@pytest.mark.parametrize("name", ["straight", "forward", "cranked"])
@pytest.mark.parametrize("root", [{}, {"root": "free", "symmetry": "antisymmetric"}])
def test_the_strips_roll_like_the_lattice(name: str, root: dict[str, str]) -> None:
    """Lift of the half wing, weighted by its arm, per rate of roll: the lattice's damping in roll, 1 %."""
    model = aircraft(WINGS[name], **root)
    d, ref = aircraft_lattice(model.surfaces(), model.references()).derivatives, model.references()
    loads, j = build(model, "quasi_steady").loads, build(model, "quasi_steady").column("roll_rate")
    ours = 2.0 * loads.width @ (loads.lift[:, j] * loads.y)
    assert ours == pytest.approx(-d.of("Cl", "p") * ref.S * ref.b, rel=0.01)


def test_antisymmetric_motion_has_the_slopes_of_roll() -> None:
    """Less than in symmetric motion, as neighbours across the root work against each other; alike on a long wing."""
    ratio = []
    for span in (1.0, 40.0):
        free = {"root": "free", "symmetry": "antisymmetric"}
        slopes = [
            aircraft_wing(aircraft([(0.0, 0.0, 0.5), (span, 0.0, 0.5)], **how))
            .strips(np.array([0.7 * span]), np.ones(1))
            .lift_slope[0]
            for how in ({}, free)
        ]
        ratio.append(slopes[1] / slopes[0])
    assert ratio[0] < 0.8
    assert ratio[1] == pytest.approx(1.0, abs=0.03)


def even(lift: dict[str, float], chord: float, moment: dict[str, float], ends: tuple[float, float]) -> SectionLoading:
    """The same section everywhere; the control between two fractions of the span."""
    edges = np.array([0.0, *ends, 1.0])
    on = np.array([0.0, 1.0, 0.0])

    def column(values: dict[str, float], name: str) -> np.ndarray:
        return values.get(name, 0.0) * (on if name == "elevon" else np.ones(3))

    names = ("alpha", "steady", "elevon")
    return SectionLoading(
        names=names,
        edges=edges,
        lift=chord * np.stack([column(lift, name) for name in names], axis=1),
        moment=chord**2 * np.stack([column(moment, name) for name in names], axis=1),
        breaks=ends,
    )


def twins(sweep_deg: float) -> tuple[BeamWing, AircraftFile, SectionLoading]:
    """Goland's wing, swept, as a beam wing along its axis and as an aircraft along the span, with the same sections."""
    station = {
        "chord_m": 1.8288,
        "flexural_axis": 0.33,
        "cg_axis": 0.43,
        "mass_kg_per_m": 35.717,
        "inertia_kg_m": 8.642,
        "EI_N_m2": 9.773e6,
        "GJ_N_m2": 0.9876e6,
    }
    wing = {
        "root": "clamped",
        "sweep_deg": sweep_deg,
        "lift_slope_per_rad": 5.5,
        "station": [
            {"y_m": y, "incidence_deg": 1.5, "cm0": 0.02} | station  # built-in incidence and moment alike
            for y in (0.0, 6.096)
        ],
        "elevon": {"from_y_m": 0.5 * 6.096, "to_y_m": 0.75 * 6.096, "lift_per_rad": 2.5, "moment_per_rad": -0.4},
    }
    cos = float(np.cos(np.radians(sweep_deg)))
    span, chord = 6.096 * cos, station["chord_m"] / cos
    per_span = station | {
        "mass_kg_per_m": station["mass_kg_per_m"] / cos,
        "inertia_kg_m": station["inertia_kg_m"] / cos**3,
    }
    del per_span["chord_m"]
    tip = float(6.096 * np.sin(np.radians(sweep_deg)))
    sections = [{"y_m": 0.0, "chord_m": chord}, {"y_m": span, "x_le_m": tip, "chord_m": chord}]
    control = {"name": "elevon", "from_span": 0.5, "to_span": 0.75, "hinge_from": 0.75, "antisymmetric": 0.0}
    plane = AircraftFile.model_validate(
        {
            "kind": "aircraft",
            "name": "goland",
            "surface": [{"name": "wing", "section": sections, "control": [control]}],
            "structure": {"surface": "wing", "station": [{"y_m": y} | per_span for y in (0.0, span)]},
        }
    )
    c_l = {"alpha": 5.5 * cos, "steady": 5.5 * cos**2 * float(np.radians(1.5)), "elevon": 2.5 * cos**2}
    c_m = {"steady": 0.02 * cos**2, "elevon": -0.4 * cos**2 - 0.08 * c_l["elevon"]}
    beam = BeamWing.model_validate({"kind": "beam_wing", "name": "goland", "wing": wing})
    return beam, plane, even(c_l, chord, c_m, (0.5, 0.75))


@pytest.mark.parametrize("sweep_deg", [0.0, 30.0, -20.0])
def test_equal_sections_are_the_beam_wing(sweep_deg: float) -> None:
    """With the same normal sections every matrix is that of the `beam_wing`; swept the conversions are all in it."""
    beam, plane, loading = twins(sweep_deg)
    for theory in (Theodorsen(), QuasiSteady()):
        one, two = beam_model(beam_wing(beam), theory), beam_model(aircraft_wing(plane, loading), theory)
        np.testing.assert_allclose(natural_modes(two.modes).omega, natural_modes(one.modes).omega, rtol=1e-9)
        for mine, its in ((two.aero(0.3, 0.0), one.aero(0.3, 0.0)), (two.loads.Q, one.loads.Q)):
            assert np.abs(mine - its).max() <= 1e-8 * np.abs(its).max()
        assert [i.name for i in two.aero.inputs] == [i.name for i in one.aero.inputs]
    sweep = FlightCondition(V=np.linspace(50.0, 300.0, 26), rho=1.225)
    mine, its = static(two, sweep), static(one, sweep)
    for quantity in ("divergence", "reversal"):
        a, b = getattr(mine, quantity).V, getattr(its, quantity).V
        assert (a is None) == (b is None)
        assert a is None or a == pytest.approx(b, rel=1e-8)
    np.testing.assert_allclose(mine.trim_twist, its.trim_twist, rtol=1e-7, equal_nan=True)
    np.testing.assert_allclose(mine.effectiveness, its.effectiveness, rtol=1e-7, equal_nan=True)
    flutter = [av.flutter(model, sweep, av.PK()).flutter_speed for model in (one, two)]
    assert flutter[0] is None or flutter[1] == pytest.approx(flutter[0], rel=1e-7)
    assert (flutter[0] is None) == (flutter[1] is None)


def test_high_aspect_ratio_is_two_dimensional() -> None:
    """Far from the tips of a long rectangle the section has 2 pi, and the thin hinge's derivatives."""
    long = aircraft([(0.0, 0.0, 1.0), (200.0, 0.0, 1.0)])
    loading = section_loading(long, VortexLattice(chordwise=16, spanwise=60))
    lift, moment = loading.at(np.array([0.3, 0.8]))
    assert lift[0, 0] == pytest.approx(2.0 * np.pi, rel=0.01)
    theta = np.arccos(1.0 - 2.0 * 0.75)  # Glauert: hinge at 3/4 of the chord
    j = loading.names.index("elevon")
    assert lift[1, j] == pytest.approx(2.0 * (np.pi - theta + np.sin(theta)), rel=0.02)
    assert moment[1, j] == pytest.approx(-0.5 * np.sin(theta) * (1.0 - np.cos(theta)), rel=0.02)
    assert abs(lift[0, j]) < 0.01 * lift[1, j]


def test_sweep_moves_divergence() -> None:
    """Swept forward it diverges sooner than straight, and aft (all the same span and chord) later or not at all."""
    speeds = []
    for tip in (-0.6, 0.0, 0.6):
        found = divergence(build(aircraft([(0.0, 0.0, 0.4), (2.0, tip, 0.4)]), "quasi_steady"), SEA).V
        speeds.append(np.inf if found is None else found)
    assert speeds[0] < 0.8 * speeds[1] < speeds[1] < speeds[2]
    model = aircraft([(0.0, 0.0, 0.4), (2.0, -0.6, 0.4)])
    for theory in ("theodorsen", "jones", "quasi_steady_damped"):  # one steady limit
        found = divergence(build(model, theory), SEA).V
        assert found == pytest.approx(speeds[0], rel=1e-9)


def test_straight_wing_diverges_as_integrated_by_hand() -> None:
    """GJ theta'' + q c^2 e a(y) theta = 0 with the lattice's a(y), by shooting: a second route to divergence."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    model = aircraft([(0.0, 0.0, 0.4), (2.0, 0.0, 0.4)], axis=0.4)
    y = np.linspace(0.0, 2.0, 4001)
    loading = section_loading(model).at(y / 2.0)[0][:, 0]

    def tip_torque(q: float) -> float:
        def slope(at: float, state: np.ndarray) -> list[float]:
            carried = 0.4 * (0.4 - 0.25) * np.interp(at, y, loading)
            return [state[1] / 1500.0, -q * carried * state[0]]

        return float(solve_ivp(slope, (0.0, 2.0), [0.0, 1.0], rtol=1e-7, atol=1e-9, max_step=0.05).y[1, -1])

    found = divergence(build(model, "quasi_steady"), SEA).q
    assert found == pytest.approx(brentq(tip_torque, 0.7 * found, 1.3 * found, rtol=1e-7), rel=2e-3)


def test_elevons_reverse_both_ways() -> None:
    """Roll by the antisymmetric elevon, lift by the symmetric one of the clamped thesis wing: there the load is 0."""
    model = build(av.read("thesis-uav"))
    quantity, roll = reversal(model, SEA)
    assert quantity == "roll"
    assert roll == reversal(model, SEA, quantity="roll", control="elevon_antisymmetric")[1]
    assert roll.V is not None
    assert 95.0 < roll.V < 110.0
    lift = reversal(model, SEA, quantity="lift", control="elevon")[1]
    assert lift.V is not None
    for q, row, column in ((roll.q, "roll", "elevon_antisymmetric"), (lift.q, "lift", "elevon")):
        wing = model.rolling if row == "roll" else model.statics
        assert abs(_held(wing, q, row, column)) < 1e-6 * abs(_held(wing, 0.0, row, column))
    single = override(av.read("thesis-uav"), {"surface[0].control[0].antisymmetric": 0.0})
    assert build(single).columns("control") == [build(single).column("elevon")]


def _held(wing: AeroelasticModel, q: float, row: str, column: str) -> float:
    """Load of a control at a dynamic pressure, root held."""
    n, j, loads = wing.modes.n, wing.column(column), wing.loads.row(row)
    Q = wing.aero(0.0, 0.0).real
    return float(loads[j] + loads[:n] @ np.linalg.solve(wing.modes.K - q * Q[:, :n], q * Q[:, j]))


@pytest.mark.parametrize(
    ("symmetry", "rigid", "controls"),
    [("symmetric", ("heave", "pitch"), ["elevon"]), ("antisymmetric", ("roll",), ["elevon_antisymmetric"])],
)
def test_free_root(symmetry: str, rigid: tuple[str, ...], controls: list[str]) -> None:
    """Half of a free wing: its rigid modes, and the control that goes with its motion."""
    model = build(aircraft(WINGS["aft"], root="free", symmetry=symmetry))
    assert model.modes.names[: len(rigid)] == rigid
    assert [model.aero.inputs[j].name for j in model.columns("control")] == controls


def test_a_heavy_fuselage_clamps_the_root() -> None:
    """A lump on the plane of symmetry: half of it in the model; without limit it holds the root. Lone ones are told."""
    free = aircraft(WINGS["aft"], root="free")
    bare = build(free).mass
    body = {"name": "body", "mass_kg": 3.0, "x_m": 0.4, "Iyy_kg_m2": 0.3}
    heavy = body | {"mass_kg": 1e7, "Iyy_kg_m2": 1e7}
    data = free.model_dump(exclude_unset=True)
    assert build(AircraftFile.model_validate(data | {"mass": [body]})).mass == pytest.approx(bare + 1.5)
    clamped = natural_modes(build(aircraft(WINGS["aft"])).modes).omega
    held = natural_modes(build(AircraftFile.model_validate(data | {"mass": [heavy]})).modes).omega
    np.testing.assert_allclose(held[2:6], clamped[:4], rtol=1e-4)
    pod = {"name": "pod", "mass_kg": 2.0, "x_m": 0.5, "y_m": 0.8}
    lone = AircraftFile.model_validate(data | {"mass": [pod]})
    assert build(lone).mass == pytest.approx(bare)
    assert any("pod" in note for note in lone.problems())
    both = AircraftFile.model_validate(data | {"mass": [pod | {"mirrored": True}]})
    assert build(both).mass == pytest.approx(bare + 2.0)


def _pitch_inertia(model: AircraftFile, about: float) -> float:
    """Twice the kinetic energy per squared rate of the half wing's lumps, pitching rigidly about x = `about`."""
    beam, total = aircraft_wing(model).beam, 0.0
    for lump in beam.masses:
        twist = np.cos(float(beam.at("sweep", lump.y)))  # of the axis, and h down, per pitch rate nose up
        plunge = float(beam.position(lump.y)[0]) - about
        total += lump.mass * (plunge + lump.x * twist) ** 2 + lump.inertia * twist**2
    return total


def test_lumps_have_their_own_arms_in_pitch() -> None:
    """Fuselage of a free swept wing, and pods of a straight one: m (x - x0)^2 + I_y, whatever the axis does."""
    body = {"name": "body", "mass_kg": 3.0, "x_m": -0.2, "Iyy_kg_m2": 0.3}
    pod = {"name": "pod", "mass_kg": 2.0, "x_m": 0.9, "y_m": 0.8, "Iyy_kg_m2": 0.1, "mirrored": True}
    swept = aircraft(WINGS["aft"], root="free").model_dump(exclude_unset=True) | {"mass": [body]}
    expected = 0.5 * (3.0 * (-0.2 - 0.1) ** 2 + 0.3)
    assert _pitch_inertia(AircraftFile.model_validate(swept), 0.1) == pytest.approx(expected, rel=1e-12)
    straight = aircraft([(0.0, 0.0, 0.5), (2.0, 0.0, 0.5)], root="free").model_dump(exclude_unset=True)
    expected += 2.0 * (0.9 - 0.1) ** 2 + 0.1
    both = AircraftFile.model_validate(straight | {"mass": [body, pod]})
    assert _pitch_inertia(both, 0.1) == pytest.approx(expected, rel=1e-12)


def test_cranked_beam_keeps_its_mass() -> None:
    """Mass and first moment about y of the beam are the integrals over the span of the file's, to 1e-3 at a crank."""
    model = aircraft(WINGS["cranked"])
    beam = aircraft_wing(model).beam
    y, s = np.linspace(0.0, 2.0, 20001), np.linspace(0.0, beam.length, 20001)
    stations = model.structure.station
    mass = np.interp(y, [st.y_m for st in stations], [st.mass_kg_per_m for st in stations])
    ours = beam.at("mass", s)
    assert np.trapezoid(ours, s) == pytest.approx(np.trapezoid(mass, y), rel=1e-3)
    assert np.trapezoid(ours * beam.position(s)[:, 1], s) == pytest.approx(np.trapezoid(mass * y, y), rel=1e-3)
    tip = beam.position(beam.y[-1])
    np.testing.assert_allclose(tip[:2], [0.9 + 0.4 * 0.3, 2.0], rtol=1e-12)


def test_dihedral_and_masses_that_disagree_are_told() -> None:
    """Findings, not faults."""
    data = av.read("thesis-uav").model_dump(exclude_unset=True)
    data["mass"][0]["mass_kg"] = 12.0
    data["surface"][0]["section"][1]["z_le_m"] = 0.1
    notes = AircraftFile.model_validate(data).problems()
    assert any("10 kg on both sides" in note and "12 kg" in note for note in notes)
    raised = AircraftFile.model_validate(data)
    assert any("dihedral" in note for note in notes)
    assert aircraft_wing(raised).beam.length > aircraft_wing(av.read("thesis-uav")).beam.length


def test_bad_input() -> None:
    """Each refusal says what to do."""
    whole = av.read("thesis-uav")
    rigid = whole.model_copy(update={"structure": None})
    with pytest.raises(ValueError, match=r"\[structure\]"):
        build(rigid)
    with pytest.raises(ValueError, match="dlm"):
        build(whole, "dlm")
    fin = whole.model_dump(exclude_unset=True)
    step = {"y_m": 1.0, "z_le_m": -0.3, "x_le_m": 0.5, "chord_m": 0.3, "airfoil": "mh62"}
    fin["surface"][0]["section"] = [fin["surface"][0]["section"][0], step, fin["surface"][0]["section"][1]]
    with pytest.raises(ValueError, match="runs outboard"):
        build(AircraftFile.model_validate(fin))
    loading = section_loading(whole)
    upside_down = replace(loading, lift=-loading.lift)
    with pytest.raises(ValueError, match="lift slope is negative"):
        build_with(whole, upside_down)


def build_with(model: AircraftFile, loading: SectionLoading) -> AeroelasticModel:
    """The model with a loading of one's own."""
    return beam_model(aircraft_wing(model, loading), QuasiSteady())


def _on_the_lattice(parity: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """K, Q (modes, incidence, elevon) and the rows of lift and roll: the beam of thesis-uav on its full lattice.

    Every point of the wing moves rigidly with the foot of its normal on the axis; no strips, no section slopes.
    """
    model, modes = av.read("thesis-uav"), 12
    grid = aircraft_lattice(model.surfaces(), model.references()).solution.lattice
    beam, surface = aircraft_wing(model).beam, model.surfaces()[0]
    along = np.array([np.sin(beam.sweep[0]), np.cos(beam.sweep[0])])

    def up(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s = np.clip((points[:, :2] - beam.origin[:2]) @ along, 0.0, beam.length)
        feet, which = np.unique(s, return_inverse=True)
        shapes = beam_shapes(beam, n=modes, points=feet)
        phi, arm = np.asarray(shapes.phi)[which], points - beam.position(s)
        return phi[:, 2] + phi[:, 3] * arm[:, 1, None] - phi[:, 4] * arm[:, 0, None], np.asarray(shapes.K)

    step = np.array([1e-5, 0.0, 0.0])
    slope = (up(grid.control + step)[0] - up(grid.control - step)[0]) / 2e-5
    columns = [slope_normalwash(grid, f"mode {j}", slope[:, j], parity=parity) for j in range(modes)]
    columns.append(slope_normalwash(grid, "incidence", -np.ones(len(grid)), parity=parity))
    columns.append(control_columns(grid, surface, surface.controls[0])[0 if parity > 0 else 1])
    force, where = panel_forces(solve_lattice(grid, join_normalwash(columns)))
    shapes, K = up(where)
    lift = force[:, :, 2]
    return K, shapes.T @ lift, lift.sum(axis=0), where[:, 1] @ lift


def test_static_aeroelasticity_on_the_lattice_itself() -> None:
    """Strips against the beam on the whole lattice: elastic lift within 0.5 %, roll reversal within 3 % in pressure."""
    model = build(av.read("thesis-uav"))
    K, Q, lift, _ = _on_the_lattice(1)
    n, pressure = len(K), np.array([1000.0, 2500.0, 4000.0])
    ours = static(model, FlightCondition(V=np.sqrt(2.0 * pressure / 1.225), rho=1.225)).lift_slope_ratio
    for q, ratio in zip(pressure, ours):
        bent = np.linalg.solve(K - q * Q[:, :n], q * Q[:, n])
        assert ratio == pytest.approx(1.0 + float(lift[:n] @ bent) / lift[n], rel=5e-3)
    K, Q, _, roll = _on_the_lattice(-1)
    found = reversal(model, SEA)[1].q

    def held(q: float) -> float:
        return float(roll[n + 1] + roll[:n] @ np.linalg.solve(K - q * Q[:, :n], q * Q[:, n + 1]))

    assert held(0.97 * found) * held(found) < 0.0


def test_damping_of_the_file_is_applied() -> None:
    """`[damping.modal]` of an aircraft."""
    data = av.read("thesis-uav").model_dump(exclude_unset=True) | {"damping": {"modal": {"ratios": [0.02, 0.03]}}}
    model = build(AircraftFile.model_validate(data))
    ratios = np.diag(model.modes.D)[:2] / (2.0 * natural_modes(model.modes).omega[:2])
    np.testing.assert_allclose(ratios, [0.02, 0.03], rtol=1e-6)
