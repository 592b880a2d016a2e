"""A controller as C99 that depends on nothing: no library, no heap, no recursion, one structure for its state.

The code holds the same numbers (to the last bit) and makes the same sums in the same order as the engine, so that what
was simulated is what flies. It assumes IEEE 754 double precision and a compiler that keeps to ISO C's rounding: no
-ffast-math, no contraction into fused operations (-ffp-contract=off; gcc's -std=c99 implies it).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from aeroservo.control.controller import Controller
from aeroservo.datatypes import Array

_WORD = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,40}")
_TAKEN = """
    auto break case char const continue default do double else enum extern float for goto if inline int long main
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
"""


def c_source(controller: Controller, *, name: str = "controller") -> str:
    """C99 of a sampled controller: structure, initialisation, one step; schedule, limits and anti-windup inside.

    Functions are `NAME_init(NAME_state *)` and `int NAME_step(NAME_state *, const double measured[],
    double dynamic_pressure_Pa, double command[])`. A step returns 0, or 1 where a measurement or the pressure is not
    finite: then state and command are left as they were. The computing delay is no part of the code, since it is made
    by the hardware that runs it.

    Parameters
    ----------
    controller : Controller
        Sampled, with or without a schedule.
    name : str
        Prefix of everything that the code declares.

    Returns
    -------
    source : str
        One translation unit; it declares what `c_header` declares and includes nothing.

    Raises
    ------
    ValueError
        If the controller is continuous, or the name is no C identifier.

    References
    ----------
    ISO/IEC 9899:1999, section 6; contract.md, "Controller file (JSON)"; K. J. Åström and B. Wittenmark,
    Computer-Controlled Systems, 1997, section 9.4.

    Examples
    --------
    >>> from aeroservo.control.controller import state_feedback
    >>> code = c_source(state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), 0.005), name="loop")
    >>> "int loop_step(loop_state *s" in code
    True
    """
    _check(controller, name)
    c = controller
    n_c, n_in, n_out, points = c.A.shape[-1], len(c.inputs), len(c.outputs), len(c.pressures)
    parts = [
        _heading(c, name), _declarations(c, name), "",
        f"enum {{ POINTS = {points}, STATES = {n_c}, INPUTS = {n_in}, OUTPUTS = {n_out} }};", "",
        f"static const double pressures[POINTS] = {_list(c.pressures)};", "",
        f"static const double limits[OUTPUTS] = {_list(c.limits)};  /* 0: none */", "",
        "/* per point: rows of [C D] */",
        f"static const double output_rows[POINTS][OUTPUTS][STATES + INPUTS] = {_rows((c.C, c.D))};",
    ]  # fmt: skip
    if n_c:
        parts += [
            "", "/* per point: rows of [A B W]; W acts on what the limits cut off */",
            "static const double state_rows[POINTS][STATES][STATES + INPUTS + OUTPUTS] = "
            f"{_rows((c.A, c.B, c.windup))};",
        ]  # fmt: skip
    return "\n".join([*parts, _functions(name, n_c)])


def c_header(controller: Controller, *, name: str = "controller") -> str:
    """Header of `c_source`, for those who call it.

    Parameters
    ----------
    controller : Controller
        As for `c_source`.
    name : str
        As for `c_source`.

    Returns
    -------
    header : str
        With an include guard, and `extern "C"` for C++.

    Raises
    ------
    ValueError
        As `c_source`.

    References
    ----------
    ISO/IEC 9899:1999, section 6.10.1 (guards).

    Examples
    --------
    >>> from aeroservo.control.controller import state_feedback
    >>> c_header(state_feedback([[0.3]], ("gyro_rad_s",), ("elevon_rad",), 0.005), name="loop").splitlines()[-1]
    '#endif'
    """
    _check(controller, name)
    guard = f"{name.upper()}_H"
    opened = ["#ifdef __cplusplus", 'extern "C" {', "#endif"]
    closed = ["#ifdef __cplusplus", "}", "#endif"]
    lines = [
        _heading(controller, name), f"#ifndef {guard}", f"#define {guard}", "", *opened,
        _declarations(controller, name), *closed, "", "#endif", "",
    ]  # fmt: skip
    return "\n".join(lines)


def _check(c: Controller, name: str) -> None:
    """Refuse what has no steps, or no name in C."""
    if c.dt_s is None:
        raise ValueError("a continuous controller has no steps to export: give it a sample time (--rate HZ, dt_s [s])")
    if not _WORD.fullmatch(name) or name in _TAKEN.split():
        raise ValueError(f"name of the C code must be an identifier of at most 41 letters or digits, got {name!r:.60}")


def _heading(c: Controller, name: str) -> str:
    """What the user must know, as a comment; channel names cannot end it."""

    def line(role: str, names: Sequence[str]) -> str:
        return f" * {role:8s} " + ", ".join(re.sub(r"[^A-Za-z0-9_ .-]", "?", n) for n in names)

    ends = [float(c.pressures[0]), float(c.pressures[-1])]
    schedule = (
        f"{len(c.pressures)} points, {ends[0]:g} to {ends[1]:g} Pa, held beyond" if len(c.pressures) > 1 else "none"
    )
    return "\n".join(
        [
            f"/* {name}: a sampled controller, written by aeroservo. C99, IEEE 754 doubles, no libraries.",
            " *",
            line("measured", c.inputs),
            line("command", c.outputs),
            f" * call {name}_step once every {float(c.dt_s or 0.0)!r} s; the command was designed to act"
            f" {float(c.delay_s)!r} s after the sample",
            f" * schedule {schedule}",
            " * SI units and radians. Compile without -ffast-math, and with -ffp-contract=off for the bits of Python.",
            " */",
        ]
    )


def _declarations(c: Controller, name: str) -> str:
    """The type and the prototypes."""
    n_c = c.A.shape[-1]
    comment = "" if n_c else "  /* not used: the controller has no states */"
    return "\n".join(
        [
            f"typedef struct {{ double x[{max(n_c, 1)}];{comment} }} {name}_state;",
            "",
            f"void {name}_init({name}_state *s);",
            "/* 0: done; 1: an input is not finite, state and command are as they were */",
            f"int {name}_step({name}_state *s, const double measured[{len(c.inputs)}], double dynamic_pressure_Pa, "
            f"double command[{len(c.outputs)}]);",
        ]
    )


def _list(values: Sequence[float] | Array) -> str:
    """Braces around numbers that C reads back to the same bits."""
    return "{" + ", ".join(repr(float(v)) for v in values) + "}"


def _rows(blocks: tuple[Array, ...]) -> str:
    """A table of blocks side by side, point by point."""
    points = []
    for matrices in zip(*blocks):
        rows = zip(*(m.tolist() for m in matrices))
        points.append("  {" + ",\n   ".join(_list([v for part in row for v in part]) for row in rows) + "}")
    return "{\n" + ",\n".join(points) + "\n}"


def _functions(name: str, n_c: int) -> str:
    """Initialisation and step."""
    advance = """  for (r = 0; r < STATES; ++r) {
    double total = 0.0;
    for (i = 0; i < STATES + INPUTS + OUTPUTS; ++i) {
      const double low = state_rows[left][r][i];
      total += (low + weight * (state_rows[right][r][i] - low)) * known[i];
    }
    next[r] = total;
  }
  for (r = 0; r < STATES; ++r) s->x[r] = next[r];
"""
    advance = advance if n_c else "  (void)known;\n"
    load = "  for (i = 0; i < STATES; ++i) known[i] = s->x[i];\n" if n_c else "  (void)s;\n"
    return f"""
static int is_finite(double v) {{ return v - v == 0.0; }}

void {name}_init({name}_state *s) {{
  int i;
  for (i = 0; i < (int)(sizeof s->x / sizeof s->x[0]); ++i) s->x[i] = 0.0;
}}

int {name}_step({name}_state *s, const double measured[INPUTS], double dynamic_pressure_Pa, double command[OUTPUTS]) {{
  double known[STATES + INPUTS + OUTPUTS]{", next[STATES]" if n_c else ""};
  double pressure = dynamic_pressure_Pa, weight = 0.0;
  int i, r, left = 0, right = 0;

  if (!is_finite(pressure)) return 1;
  for (i = 0; i < INPUTS; ++i) if (!is_finite(measured[i])) return 1;
  if (POINTS > 1) {{
    if (pressure < pressures[0]) pressure = pressures[0];
    if (pressure > pressures[POINTS - 1]) pressure = pressures[POINTS - 1];
    while (left < POINTS - 2 && pressure >= pressures[left + 1]) ++left;
    right = left + 1;
    weight = (pressure - pressures[left]) / (pressures[right] - pressures[left]);
  }}
{load}  for (i = 0; i < INPUTS; ++i) known[STATES + i] = measured[i];
  for (r = 0; r < OUTPUTS; ++r) {{
    double total = 0.0, held;
    for (i = 0; i < STATES + INPUTS; ++i) {{
      const double low = output_rows[left][r][i];
      total += (low + weight * (output_rows[right][r][i] - low)) * known[i];
    }}
    held = total;
    if (limits[r] > 0.0) {{
      if (held < -limits[r]) held = -limits[r];
      if (held > limits[r]) held = limits[r];
    }}
    command[r] = held;
    known[STATES + INPUTS + r] = held - total;
  }}
{advance}  return 0;
}}
"""
