"""The grid of surface points that the paper's slower judgement compares [Qiao2021, eq. 11, 14, 17, 18, 20].

The paper prints the angles' ranges, m in [0, 2 pi] and n in [0, pi], but no steps. Ours are calibrated: 36 x 18, ten
degrees each way, with which one judgement costs tenths of a second, the order of the paper's Tables 3 and 4.
"""

import numpy as np

from ikde.kernels.arrays import Floats

M_STEPS, N_STEPS = 36, 18


def surface_directions(m_steps: int = M_STEPS, n_steps: int = N_STEPS) -> Floats:
    """Unit vectors (cos m, sin m cos n, sin m sin n) of the grid [m_steps * n_steps, 3], each end once."""
    m = np.repeat(np.arange(m_steps) * 2.0 * np.pi / m_steps, n_steps)
    n = np.tile(np.arange(n_steps) * np.pi / n_steps, m_steps)
    return np.column_stack([np.cos(m), np.sin(m) * np.cos(n), np.sin(m) * np.sin(n)])


def covering_angle_rad(m_steps: int = M_STEPS, n_steps: int = N_STEPS) -> float:
    """No point of a sphere is farther than R times this from a grid point: half the diagonal of a grid cell.

    It is d_i / R_i of eq. 20. A cell is at most as wide as its angles, so two spheres whose surfaces share a point
    have grid points within d_i + d_j of each other: no contact of surfaces is missed.
    """
    return float(np.hypot(np.pi / m_steps, 0.5 * np.pi / n_steps))
