"""Run inside the peers' environment: the thesis' wing, flat, by another program's lattice; prints one JSON object."""

import json
import math
import sys
import time
from importlib.metadata import version

ROOT, TIP, OFFSET = 0.7, 0.3, 0.524475


def aerosandbox(chordwise, spanwise):
    """Lift of the flat wing at an incidence [deg]."""
    import aerosandbox as asb
    import numpy as np

    flat = asb.Airfoil("flat", coordinates=np.array([[1.0, 1e-6], [0.5, 1e-6], [0.0, 0.0], [0.5, -1e-6], [1.0, -1e-6]]))
    sections = [
        asb.WingXSec(xyz_le=[0, 0, 0], chord=ROOT, airfoil=flat),
        asb.WingXSec(xyz_le=[OFFSET, 1, 0], chord=TIP, airfoil=flat),
    ]
    plane = asb.Airplane(wings=[asb.Wing(symmetric=True, xsecs=sections)], s_ref=1.0, c_ref=0.52667, b_ref=2.0)

    def lift(alpha):
        return asb.VortexLatticeMethod(
            airplane=plane, op_point=asb.OperatingPoint(velocity=30.0, alpha=alpha), spanwise_resolution=spanwise,
            chordwise_resolution=chordwise, spanwise_spacing_function=np.linspace,
        ).run()["CL"]  # fmt: skip

    return lift


def pterasoftware(chordwise, spanwise):
    """Lift of the flat wing at an incidence [deg]."""
    import pterasoftware as ps

    def section(chord, x, y):
        return ps.geometry.wing_cross_section.WingCrossSection(
            airfoil=ps.geometry.airfoil.Airfoil(name="naca0012"), num_spanwise_panels=spanwise if y == 0 else None,
            chord=chord, Lp_Wcsp_Lpp=(x, y, 0.0), spanwise_spacing="uniform" if y == 0 else None,
            control_surface_symmetry_type="symmetric",
        )  # fmt: skip

    def lift(alpha):
        wing = ps.geometry.wing.Wing(
            wing_cross_sections=[section(ROOT, 0.0, 0.0), section(TIP, OFFSET, 1.0)], symmetric=True,
            symmetryNormal_G=(0.0, 1.0, 0.0), symmetryPoint_G_Cg=(0.0, 0.0, 0.0), num_chordwise_panels=chordwise,
            chordwise_spacing="uniform",
        )  # fmt: skip
        plane = ps.geometry.airplane.Airplane(wings=[wing], s_ref=1.0, c_ref=0.52667, b_ref=2.0)
        point = ps.operating_point.OperatingPoint(vCg__E=30.0, alpha=alpha)
        problem = ps.problems.SteadyProblem(airplanes=[plane], operating_point=point)
        solver = ps.steady_ring_vortex_lattice_method.SteadyRingVortexLatticeMethodSolver(steady_problem=problem)
        solver.run()
        return -plane.forceCoefficients_W[2]

    return lift


def main():
    """Shortest of five, and the slope between 0 and 1 degree."""
    peer, chordwise, spanwise = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    lift = {"aerosandbox": aerosandbox, "pterasoftware": pterasoftware}[peer](chordwise, spanwise)
    zero, taken, value = float(lift(0.0)), [], 0.0
    for _ in range(5):
        start = time.perf_counter()
        value = float(lift(1.0))
        taken.append(time.perf_counter() - start)
    answer = {"version": version(peer), "seconds": min(taken), "CL_alpha": (value - zero) / math.radians(1.0)}
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
