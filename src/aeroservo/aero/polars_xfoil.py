"""XFOIL: reading its polar files, and driving an installed copy of it.

The driver runs under a wall-clock limit and sweeps up and down from zero, each from a fresh start. Debian's build turns
on a floating-point trap that aborts every viscous run with SIGFPE; the driver recognises that, and where a C compiler
is at hand it runs XFOIL again with a one-line library that leaves the trap off. The results are then those of XFOIL
6.99 to the last printed digit.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aeroservo.aero.airfoil import Airfoil
from aeroservo.aero.polars_cache import cached_array
from aeroservo.aero.polars_points import reject_wild_points

TRAP = (
    "XFOIL aborted with SIGFPE: this build (Debian's, for one) traps floating-point exceptions that XFOIL expects to "
    "pass over. Install a C compiler (cc) so that the trap can be left off, or use an XFOIL built without -ffpe-trap"
)
#: Angles in a row that may fail before a sweep is given up.
RESTARTS = 6
#: Printing this much without a new point, XFOIL is lost: four angles of 200 iterations print about a third. [bytes]
LOST = 1_000_000
#: Printing nothing for so long, it loops; an iteration prints every few hundredths of a second. [s]
SILENCE = 3.0


@dataclass(frozen=True, kw_only=True, eq=False)
class XfoilPolar:
    """One polar as XFOIL writes it; see `parse_xfoil_polar`."""

    name: str  # name of the airfoil
    reynolds: float  # [-]
    mach: float  # [-]
    n_crit: float  # [-] amplification at transition
    alpha: np.ndarray  # (n,) [rad] ascending
    CL: np.ndarray  # (n,) [-]
    CD: np.ndarray  # (n,) [-]
    CM: np.ndarray  # (n,) [-] about the quarter chord
    transition_top: np.ndarray  # (n,) [-]
    transition_bottom: np.ndarray  # (n,) [-]


@dataclass(frozen=True, kw_only=True)
class Xfoil:
    """Options of an XFOIL run.

    Parameters
    ----------
    n_crit : float
        Amplification at transition. [-]
    mach : float
        Mach number. [-]
    alpha_from, alpha_to, alpha_step : float
        Sweep, from negative to positive. [rad]
    iterations : int
        Largest number of iterations of a point.
    seconds : float
        Wall-clock limit of one run; the points found until then are kept. [s]
    executable : str
        Name or path of the program.
    """

    n_crit: float = 9.0
    mach: float = 0.0
    alpha_from: float = float(np.radians(-10.0))
    alpha_to: float = float(np.radians(18.0))
    alpha_step: float = float(np.radians(0.5))
    iterations: int = 200
    seconds: float = 60.0
    executable: str = "xfoil"

    def __post_init__(self) -> None:
        if not self.alpha_from <= 0.0 <= self.alpha_to or self.alpha_step <= 0.0:
            raise ValueError(
                "the sweep must hold zero and its step be positive [rad], got "
                f"{self.alpha_from:g} to {self.alpha_to:g} by {self.alpha_step:g}"
            )
        if self.seconds <= 0.0 or self.iterations < 1:
            raise ValueError(f"seconds and iterations must be positive, got {self.seconds:g} s, {self.iterations}")


def parse_xfoil_polar(text: str) -> XfoilPolar:
    """A polar file of XFOIL or XFLR5.

    Parameters
    ----------
    text : str
        Content of the file.

    Returns
    -------
    XfoilPolar
        Points in ascending angle of attack; a repeated angle keeps its last point.

    Raises
    ------
    ValueError
        If the text is no such file or holds no point.

    References
    ----------
    M. Drela, XFOIL 6.99, 2013, guide section "OPER" (polar save file).

    Examples
    --------
    >>> text = '''Calculated polar for: NACA 0012
    ... xtrf =   1.000 (top)        1.000 (bottom)
    ... Mach =   0.000     Re =     1.000 e 6     Ncrit =   9.000
    ...   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr
    ...  ------ -------- --------- --------- -------- -------- --------
    ...   0.000   0.0000   0.00540   0.00050   0.0000   0.68     0.68
    ... '''
    >>> parse_xfoil_polar(text).reynolds
    1000000.0
    """
    name, head, order, rows = "", {"Re": np.nan, "Mach": 0.0, "Ncrit": np.nan}, [], []
    for line in text.splitlines():
        words = line.split()
        if "alculated polar for:" in line:
            name = line.split(":", 1)[1].strip()
        elif "Re =" in line:
            head |= _header(line)
        elif words[:2] == ["alpha", "CL"]:
            order = words
        elif order and len(words) >= len(order[:5]) and _is_number(words[0]):
            rows.append([float(w) for w in words[: len(order)]])
    needed = {"alpha", "CL", "CD", "CM"}
    if not needed <= set(order):
        raise ValueError('this is no XFOIL polar file: no line "alpha  CL  CD  CDp  CM" in it')
    if not rows:
        raise ValueError(f"the XFOIL polar of {name!r} holds no point: no angle converged")
    if not np.isfinite(head["Re"]):
        raise ValueError(f"the XFOIL polar of {name!r} does not state its Reynolds number")
    short = min(len(r) for r in rows)
    table = np.array([r[:short] for r in rows])
    _, last = np.unique(table[::-1, 0], return_index=True)
    table = table[::-1][last]

    def column(key: str) -> np.ndarray:
        return table[:, order.index(key)] if key in order[:short] else np.full(len(table), np.nan)

    return XfoilPolar(
        name=name,
        reynolds=head["Re"],
        mach=head["Mach"],
        n_crit=head["Ncrit"],
        alpha=np.radians(table[:, 0]),
        CL=column("CL"),
        CD=column("CD"),
        CM=column("CM"),
        transition_top=column("Top_Xtr"),
        transition_bottom=column("Bot_Xtr"),
    )


def xfoil_points(
    foil: Airfoil, reynolds: float, *, options: Xfoil = Xfoil(), cache: bool = True, folder: Path | None = None
) -> np.ndarray:
    """Converged points of a section by an installed XFOIL.

    Parameters
    ----------
    foil : Airfoil
        The outline, deflected already where there is a control.
    reynolds : float
        Reynolds number. [-]
    options : Xfoil
        How to run.
    cache : bool
        Keep the result on disk, keyed by outline and options, unless the wall-clock limit cut it short.
    folder : Path, optional
        Folder of the cache.

    Returns
    -------
    points : ndarray, shape (n, 4)
        Angle of attack [rad], CL, CD, CM [-], ascending, wild points dropped; n = 0 where nothing converged.

    Raises
    ------
    ValueError
        If the Reynolds number is not positive, XFOIL is not installed, or it aborts.

    References
    ----------
    M. Drela, XFOIL: an analysis and design system for low Reynolds number airfoils, 1989, section 4.

    Examples
    --------
    >>> from aeroservo.aero.airfoil_files import airfoil
    >>> try:
    ...     xfoil_points(airfoil("mh62"), 1e6, options=Xfoil(executable="no-such-program"), cache=False)
    ... except ValueError as error:
    ...     print(str(error)[:22])
    XFOIL is not installed
    """
    if not reynolds > 0.0:
        raise ValueError(f"reynolds must be > 0 [-], got {reynolds:g}")

    def compute() -> np.ndarray:
        return _run(foil, reynolds, options)

    try:
        if not cache:
            return compute()
        return cached_array(["xfoil 1", foil.points, float(reynolds), repr(options)], compute, folder=folder)
    except _TimeUp as partial:
        return partial.rows


def _header(line: str) -> dict[str, float]:
    """Mach, Re and Ncrit of the header line; XFOIL writes 1.000 e 6."""
    values = {}
    for key in ("Mach", "Re", "Ncrit"):
        if f"{key} =" in line:
            text = line.split(f"{key} =", 1)[1].strip()
            words = text.replace(" e ", "e").split()
            values[key] = float(words[0])
    return values


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _run(foil: Airfoil, reynolds: float, options: Xfoil) -> np.ndarray:
    """Sweeps up and down from zero; with the trap left off if it strikes."""
    program = shutil.which(options.executable)
    if program is None:
        raise ValueError(
            f"XFOIL is not installed: no program {options.executable!r} on the path. Install it (Debian: apt-get "
            "install xfoil), or use the shipped tables or NeuralFoil (pip install aeroservo[airfoil])"
        )
    deadline = time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory(prefix="aeroservo-xfoil-") as place:
        session = _Session(program=program, folder=Path(place), reynolds=reynolds, options=options, deadline=deadline)
        coordinates = "\n".join(f"{x:.8f} {z:.8f}" for x, z in foil.points)
        (session.folder / "foil.dat").write_text(f"foil\n{coordinates}\n", encoding="ascii")
        found: dict[float, list[float]] = {}
        library = None
        trapped, _ = _sweep(session, 0.0, 0.0, None)
        if trapped:
            library = _untrapped(session.folder)
            if library is None:
                raise ValueError(TRAP)
        for sign, end in ((1.0, options.alpha_to), (-1.0, options.alpha_from)):
            _half(session, sign, end, library, found)
    rows = np.array([found[key] for key in sorted(found)]).reshape(-1, 4)
    rows = rows[np.all(np.isfinite(rows), axis=1) & (rows[:, 2] > 0.0)]
    kept = reject_wild_points(rows)
    if time.monotonic() >= deadline:
        raise _TimeUp(kept)
    return kept


class _TimeUp(Exception):
    """The wall-clock limit struck: what was found is good, but not all there is, so it is not kept in the cache."""

    def __init__(self, rows: np.ndarray) -> None:
        super().__init__("XFOIL's time was up")
        self.rows = rows


@dataclass(frozen=True, kw_only=True, eq=False)
class _Session:
    program: str
    folder: Path
    reynolds: float
    options: Xfoil
    deadline: float


def _half(session: _Session, sign: float, end: float, library: Path | None, found: dict[float, list[float]]) -> None:
    """One direction, starting afresh behind an angle that does not converge."""
    step = session.options.alpha_step
    start, idle = (0.0 if sign > 0 else -step), 0
    while sign * (end - start) > -1e-9 and idle < RESTARTS and time.monotonic() < session.deadline:
        trapped, rows = _sweep(session, start, end, library)
        if trapped:
            raise ValueError(TRAP)
        for row in rows:
            found.setdefault(round(float(row[0]) / step, 3), [float(v) for v in row])
        if len(rows):
            idle = 0
            last = float(rows[-1, 0] if sign > 0 else rows[0, 0])
            start = (round(last / step) + sign * 2.0) * step
        else:
            idle += 1
            start = (round(start / step) + sign) * step


def _sweep(session: _Session, start: float, end: float, library: Path | None) -> tuple[bool, np.ndarray]:
    """Whether the trap struck, and the points (n, 4) of one session; it ends early when XFOIL loses itself in NaN."""
    out, log = session.folder / "polar.txt", session.folder / "log.txt"
    out.unlink(missing_ok=True)
    (session.folder / "keys.txt").write_text("\n".join(_commands(session, start, end)) + "\n", encoding="ascii")
    environment = dict(os.environ)
    if library is not None:
        environment["LD_PRELOAD"] = str(library)
    with open(session.folder / "keys.txt", "rb") as keys, open(log, "wb") as screen:
        process = subprocess.Popen(
            [session.program], stdin=keys, stdout=screen, stderr=subprocess.STDOUT, cwd=session.folder, env=environment
        )
        try:
            _watch(process, log, session.deadline)
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()
    trapped = process.returncode in (-signal.SIGFPE, 128 + signal.SIGFPE)
    try:
        polar = parse_xfoil_polar(out.read_text(encoding="ascii", errors="replace"))
    except (OSError, ValueError):
        return trapped, np.zeros((0, 4))
    return trapped, np.stack([polar.alpha, polar.CL, polar.CD, polar.CM], axis=-1)


def _watch(process: subprocess.Popen[bytes], log: Path, deadline: float) -> None:
    """Return when XFOIL ends, prints NaN or much without a new point, falls silent, or the time is up."""
    written, silent = b"Point written", 0
    with open(log, "rb") as file:
        tail, heard = b"", time.monotonic()
        while process.poll() is None and time.monotonic() < deadline:
            new = file.read()
            heard = time.monotonic() if new else heard
            if time.monotonic() - heard > SILENCE:
                return
            text = tail + new
            silent = len(text) - text.rfind(written) if written in text else silent + len(new)
            if b"NaN" in text or silent > LOST:
                return
            tail = text[-16:]
            time.sleep(0.01)


def _commands(session: _Session, start: float, end: float) -> Sequence[str]:
    """Keyboard input of one sweep from a fresh start."""
    options = session.options
    first, last, step = np.degrees(start), np.degrees(end), np.degrees(options.alpha_step)
    return [
        "PLOP", "G F", "", "LOAD foil.dat", "PANE", "OPER", "VPAR", f"N {options.n_crit:g}", "",
        f"VISC {session.reynolds:.8g}", f"MACH {options.mach:g}", f"ITER {options.iterations}", "PACC", "polar.txt", "",
        f"ASEQ {first:.6g} {last:.6g} {step if last >= first else -step:.6g}", "PACC", "", "QUIT",
    ]  # fmt: skip


def _untrapped(folder: Path) -> Path | None:
    """A library whose set_fpe does nothing, or None without a C compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or os.name != "posix":
        return None
    source, library = folder / "set_fpe.c", folder / "set_fpe.so"
    source.write_text("void _gfortran_set_fpe(int options) { (void)options; }\n", encoding="ascii")
    done = subprocess.run([compiler, "-shared", "-fPIC", "-o", str(library), str(source)], capture_output=True)
    return library if done.returncode == 0 else None
