"""Compiled sums over horseshoe vortices. Plain arrays in, plain arrays out; imports nothing of ours.

A horseshoe runs from x = +infinity along -x to `a`, along the straight bound segment to `b`, and back along +x to
infinity. For unit circulation the velocity at r, with r1 = r - a and r2 = r - b, is

    1/(4 pi) * [ (r1 x r2)(1/|r1| + 1/|r2|)/(|r1||r2| + r1.r2) + (r1 x e_x)/(|r1|(|r1| - r1.e_x))
                 - (r2 x e_x)/(|r2|(|r2| - r2.e_x)) ]

(M. Drela, Flight Vehicle Aerodynamics, MIT Press 2014, section 6.5). Behind a leg |r| - r.e_x cancels and
d^2/(|r| + r.e_x) is used for it; beside the segment |r1||r2| + r1.r2 cancels and |r1 x r2|^2/(|r1||r2| - r1.r2) is
used. Inside the core radius a piece is left out.
"""

import math

import numpy as np
from numba import njit

FOUR_PI = 4.0 * math.pi


@njit(cache=True, fastmath={"nsz", "arcp", "contract", "reassoc"}, error_model="numpy", inline="always")
def _bound(m1, m2, dot, cross2):
    """(1/m1 + 1/m2)/(m1 m2 + dot); beside the segment, where the sum cancels, by way of the cross product."""
    product = m1 * m2
    numerator = product - dot if dot < 0.0 else 1.0
    denominator = cross2 if dot < 0.0 else product + dot
    return (m1 + m2) * numerator / (product * denominator)


@njit(cache=True, fastmath={"nsz", "arcp", "contract", "reassoc"}, error_model="numpy", inline="always")
def _leg(dx, d2, r, core2):
    """1/(r (r - dx)) for a leg leaving along +x, zero inside the core."""
    denominator = d2 if dx > 0.0 else r * (r - dx)
    numerator = 1.0 + dx / r if dx > 0.0 else 1.0
    return numerator / denominator if d2 > core2 else 0.0


@njit(cache=True, fastmath={"nsz", "arcp", "contract", "reassoc"}, error_model="numpy")
def normal_influence(px, py, pz, ny, nz, ax, ay, az, bx, by, bz, core2, out):
    """Velocity along (0, ny, nz) at each point for unit circulation of each horseshoe; adds into `out` (m, n)."""
    for i in range(px.shape[0]):
        x, y, z, n_y, n_z = px[i], py[i], pz[i], ny[i], nz[i]
        for j in range(ax.shape[0]):
            r1x, r1y, r1z = x - ax[j], y - ay[j], z - az[j]
            r2x, r2y, r2z = x - bx[j], y - by[j], z - bz[j]
            d1 = r1y * r1y + r1z * r1z
            d2 = r2y * r2y + r2z * r2z
            m1 = math.sqrt(r1x * r1x + d1)
            m2 = math.sqrt(r2x * r2x + d2)
            cx = r1y * r2z - r1z * r2y
            cy = r1z * r2x - r1x * r2z
            cz = r1x * r2y - r1y * r2x
            lx, ly, lz = r1x - r2x, r1y - r2y, r1z - r2z
            bound = _bound(m1, m2, r1x * r2x + r1y * r2y + r1z * r2z, cx * cx + cy * cy + cz * cz)
            if cx * cx + cy * cy + cz * cz <= core2 * (lx * lx + ly * ly + lz * lz):
                bound = 0.0
            g1 = _leg(r1x, d1, m1, core2)
            g2 = _leg(r2x, d2, m2, core2)
            v_y = cy * bound + r1z * g1 - r2z * g2
            v_z = cz * bound - r1y * g1 + r2y * g2
            out[i, j] += (v_y * n_y + v_z * n_z) / FOUR_PI


@njit(cache=True, fastmath={"nsz", "arcp", "contract", "reassoc"}, error_model="numpy")
def velocity_influence(px, py, pz, ax, ay, az, bx, by, bz, core2, out):
    """Velocity at each point for unit circulation of each horseshoe; adds into `out` (m, n, 3)."""
    for i in range(px.shape[0]):
        x, y, z = px[i], py[i], pz[i]
        for j in range(ax.shape[0]):
            r1x, r1y, r1z = x - ax[j], y - ay[j], z - az[j]
            r2x, r2y, r2z = x - bx[j], y - by[j], z - bz[j]
            d1 = r1y * r1y + r1z * r1z
            d2 = r2y * r2y + r2z * r2z
            m1 = math.sqrt(r1x * r1x + d1)
            m2 = math.sqrt(r2x * r2x + d2)
            cx = r1y * r2z - r1z * r2y
            cy = r1z * r2x - r1x * r2z
            cz = r1x * r2y - r1y * r2x
            lx, ly, lz = r1x - r2x, r1y - r2y, r1z - r2z
            bound = _bound(m1, m2, r1x * r2x + r1y * r2y + r1z * r2z, cx * cx + cy * cy + cz * cz)
            if cx * cx + cy * cy + cz * cz <= core2 * (lx * lx + ly * ly + lz * lz):
                bound = 0.0
            g1 = _leg(r1x, d1, m1, core2)
            g2 = _leg(r2x, d2, m2, core2)
            out[i, j, 0] += cx * bound / FOUR_PI
            out[i, j, 1] += (cy * bound + r1z * g1 - r2z * g2) / FOUR_PI
            out[i, j, 2] += (cz * bound - r1y * g1 + r2y * g2) / FOUR_PI


@njit(cache=True, error_model="numpy")
def wake_influence(py, pz, ny, nz, ay, az, by, bz, core2, out):
    """Velocity along (ny, nz) far downstream of unit horseshoes (two line vortices each); adds into `out` (m, n)."""
    for i in range(py.shape[0]):
        for j in range(ay.shape[0]):
            y1, z1 = py[i] - ay[j], pz[i] - az[j]
            y2, z2 = py[i] - by[j], pz[i] - bz[j]
            d1, d2 = y1 * y1 + z1 * z1, y2 * y2 + z2 * z2
            g1 = 2.0 / d1 if d1 > core2 else 0.0
            g2 = 2.0 / d2 if d2 > core2 else 0.0
            v_y = z1 * g1 - z2 * g2
            v_z = -y1 * g1 + y2 * g2
            out[i, j] += (v_y * ny[i] + v_z * nz[i]) / FOUR_PI


def columns(points):
    """The three coordinates of points (n, 3) as contiguous arrays."""
    points = np.asarray(points, dtype=float)
    return tuple(np.ascontiguousarray(points[:, k]) for k in range(3))
