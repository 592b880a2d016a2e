"""Data of the live panel, for `assets/live_model.js` and `assets/live.js`: linear models, and how one is shown.

`liveModel(data)` takes an object with

- `V`, `rho`, `factor`: nodes of airspeed [m/s], density [kg/m^3] and torsional stiffness over the model's own [-];
- `A`, `B`: matrices at the nodes, row by row, the last axes first to change, as base64 of little-endian 64-bit floats;
- `states`, `inputs`, `controls`: names, and how many of the inputs are controls (gust zones follow);
- `offsets`: places of the gust zones behind the reference point [m];
- `pressures`, `K`, `dt`: dynamic pressures [Pa] and gains (base64) of a sampled state feedback, its sample time [s];
- `atmosphere`: constants of the standard atmosphere up to 11 km;
- `outputs`: list of {name, unit, row, scale}: what is drawn over time, a row over the states, or {control: k};
- `start`: {V, altitude, factor, gust, on}; `limits`: {V, altitude, factor, gust}: of the sliders;
- `gust`: {length}: whole wavelength of the 1-cosine gust [m];
- `shapes`: list of {shape, state} or {shape, control}: what moves the scene; `scene`: of `report/scene.py`;
- `largest`: tip deflection at which a run that grows is stopped [m], `frequency` of the first instability [Hz].
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aeroservo.atmosphere import STANDARD_GRAVITY, atmosphere
from aeroservo.report.lattice3d import Lattice3D
from aeroservo.report.scene import scene_data
from aeroservo.studies.live_model import LiveFamily

Array = NDArray[Any]

#: Highest altitude of the slider: where the temperature stops falling. [m]
TROPOPAUSE = 11_000.0


def packed(values: Array) -> str:
    """An array as text without loss.

    Parameters
    ----------
    values : ndarray, shape (...)
        Numbers. [any]

    Returns
    -------
    text : str
        Base64 of little-endian 64-bit floats, the last axis first.
    """
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def live_data(
    family: LiveFamily,
    lattice: Lattice3D,
    *,
    start_speed: float,
    frequency: float,
    gust: float,
    gust_length: float,
    altitude: float = 0.0,
) -> dict[str, Any]:
    """Everything that the live panel needs.

    Parameters
    ----------
    family : LiveFamily
        Of `live_family`.
    lattice : Lattice3D
        What is drawn; may have more coordinates than the family.
    start_speed : float
        Airspeed to begin with. [m/s]
    frequency : float
        Of the first instability or the first mode: the clock on the screen follows it. [Hz]
    gust : float
        Gust velocity to begin with; the slider goes to three times that. [m/s]
    gust_length : float
        Whole wavelength of the gust. [m]
    altitude : float
        To begin with. [m]

    Returns
    -------
    data : dict
        As above. [SI]
    """
    span = float(np.ptp(lattice.points, axis=0).max())
    V, rho = family.V, family.rho
    top = TROPOPAUSE
    while top > 0.0 and float(atmosphere(top).rho) < rho[0] * (1.0 - 1e-9):
        top -= 100.0
    return {
        "V": [float(x).hex() for x in V],
        "rho": [float(x).hex() for x in rho],
        "factor": [float(x).hex() for x in family.factor],
        "A": packed(family.A),
        "B": packed(family.B),
        "states": family.states,
        "inputs": family.inputs,
        "controls": family.controls,
        "offsets": family.offsets,
        "pressures": packed(family.pressures),
        "K": packed(family.K),
        "dt": family.dt_s,
        "atmosphere": _air(),
        "outputs": _outputs(family),
        "start": {"V": start_speed, "altitude": min(altitude, top), "factor": 1.0, "gust": gust, "on": False},
        "limits": {
            "V": [float(V.min()), float(V.max())],
            "altitude": [0.0, top],
            "factor": [float(family.factor.min()), float(family.factor.max())],
            "gust": [0.0, 3.0 * gust],
        },
        "gust": {"length": gust_length},
        "shapes": _shapes(family, lattice),
        "scene": scene_data(lattice) | {"scale": 3.0},
        "largest": 0.5 * span,
        "frequency": frequency,
    }


def _air() -> dict[str, str]:
    """Density rho0 (1 - h/H)^n of the troposphere, its constants found from the atmosphere itself, to the last bit."""
    low, high = atmosphere(0.0), atmosphere(TROPOPAUSE)
    H = TROPOPAUSE / (1.0 - float(high.T) / float(low.T))
    n = float(np.log(float(high.rho) / float(low.rho)) / np.log(1.0 - TROPOPAUSE / H))
    constants = {"rho0": float(low.rho), "H": H, "n": n, "a0": float(low.a_sound), "g": STANDARD_GRAVITY}
    return {name: value.hex() for name, value in constants.items()}


def _outputs(family: LiveFamily) -> list[dict[str, Any]]:
    """Tip deflection, tip twist, controls."""
    out: list[dict[str, Any]] = []
    row: Any
    for name, unit, row, scale in (("deflection up", "m", 0, 1.0), ("twist nose up", "°", 1, 180.0 / np.pi)):
        if np.any(family.tip[row]):
            out.append({"name": name, "unit": unit, "row": family.tip[row] * scale})
    for k, name in enumerate(family.inputs[: family.controls]):
        plain = name.removesuffix("_rad").removesuffix("_command")
        row = np.array([180.0 / np.pi * (s == f"{plain}_rad") for s in family.states])
        moved: dict[str, Any] = {"row": row} if np.any(row) else {"control": k, "factor": 180.0 / np.pi}
        out.append({"name": plain.replace("_", " "), "unit": "°", **moved})
    return out


def _shapes(family: LiveFamily, lattice: Lattice3D) -> list[dict[str, int]]:
    """Which states and controls move which shapes."""
    out = []
    units = dict(zip(family.model.modes.names, family.model.modes.units))
    for k, name in enumerate(lattice.names):
        plain = name.replace(" ", "_")
        state = plain + (f"_{units[name]}" if units.get(name) else "")
        if name in units and state in family.states:
            out.append({"shape": k, "state": family.states.index(state)})
        elif f"{name}_rad" in family.states:
            out.append({"shape": k, "state": family.states.index(f"{name}_rad")})
        elif f"{name}_rad" in family.inputs[: family.controls]:
            out.append({"shape": k, "control": family.inputs.index(f"{name}_rad")})
    return out
