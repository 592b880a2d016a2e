"""NeuralFoil, where it is installed: polars of any airfoil in milliseconds, always of the deflected outline."""

from __future__ import annotations

from importlib.metadata import version
from importlib.util import find_spec
from typing import Literal

import numpy as np

from aeroservo.aero.airfoil import Airfoil, repanel
from aeroservo.aero.airfoil_deflect import hinged_outline, morphed_outline
from aeroservo.aero.polars import Polar

#: Below this the network does not trust itself. [-]
CONFIDENCE = 0.7


def neuralfoil_polar(
    foil: Airfoil,
    *,
    alpha: np.ndarray,
    delta: np.ndarray,
    reynolds: np.ndarray,
    hinge: float = 0.75,
    kind: Literal["hinged", "morphed"] = "hinged",
    n_crit: float = 9.0,
    model: str = "xlarge",
    confidence: float = CONFIDENCE,
) -> Polar:
    """A polar of an airfoil with a control by NeuralFoil.

    Parameters
    ----------
    foil : Airfoil
        The undeflected outline.
    alpha, delta, reynolds : array_like, shapes (n_a,), (n_d,), (n_r,)
        Ascending axes: angle of attack [rad], deflection [rad], Reynolds number [-].
    hinge : float
        Hinge, or where the bending starts, in chords. [-]
    kind : {"hinged", "morphed"}
        Kind of the control. The outline itself is deflected: NeuralFoil's own control surfaces give wrong moments.
    n_crit : float
        Amplification at transition. [-]
    model : str
        Size of the network.
    confidence : float
        Points that the network trusts less become NaN. [-]

    Returns
    -------
    Polar
        See `Polar`.

    Raises
    ------
    ValueError
        If NeuralFoil is not installed.

    References
    ----------
    P. Sharpe, NeuralFoil, 2023, section "Usage" of its README.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> try:
    ...     p = neuralfoil_polar(airfoil("naca0012"), alpha=[0.0, 0.1], delta=[0.0], reynolds=[1e6], model="medium")
    ...     print(p.CL.shape)
    ... except ValueError as error:
    ...     print("(1, 1, 2)" if "pip install aeroservo[airfoil]" in str(error) else error)
    (1, 1, 2)
    """
    if find_spec("neuralfoil") is None:
        raise ValueError(
            "NeuralFoil is not installed: pip install aeroservo[airfoil] (738 MB with AeroSandbox). Without it "
            "there are the shipped tables of MH 62 and an installed XFOIL"
        )
    import neuralfoil

    alpha, delta, reynolds = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (alpha, delta, reynolds))
    tables = np.full((3, len(reynolds), len(delta), len(alpha)), np.nan)
    for j, d in enumerate(delta):
        shape = _deflected(foil, kind, hinge, float(d))
        for i, re in enumerate(reynolds):
            found = neuralfoil.get_aero_from_coordinates(
                np.array(shape.points), alpha=np.degrees(alpha), Re=float(re), n_crit=n_crit, model_size=model
            )
            trusted = np.asarray(found["analysis_confidence"]) >= confidence
            for k, key in enumerate(("CL", "CD", "CM")):
                tables[k, i, j] = np.where(trusted, np.asarray(found[key]), np.nan)
    return Polar(
        name=f"{foil.name} {kind}",
        source=f"NeuralFoil {version('neuralfoil')} ({model}), Ncrit {n_crit:g}, deflected outline",
        alpha=alpha,
        delta=delta,
        reynolds=reynolds,
        CL=tables[0],
        CD=tables[1],
        CM=tables[2],
    )


def _deflected(foil: Airfoil, kind: str, hinge: float, delta: float) -> Airfoil:
    if delta == 0.0:
        return repanel(foil, 200)
    return hinged_outline(foil, hinge, delta) if kind == "hinged" else morphed_outline(foil, hinge, delta)
