"""Search lengths with which the printed optima of Dong and Zhao come out, alone and all three together.

    python -m benchmarks.dong_zhao_lengths            # about fifteen minutes on one core
    python -m benchmarks.dong_zhao_lengths --chain rigid

For each chain, range of lengths and optimum: the lengths with which the value at the printed optimum is least below the
largest of its figure (theta1 = 0, range 0 .. 360 deg). A search proves nothing: what it does not find may be there.
`ikde/paper/dong_zhao.yaml` keeps what was found; `ikde bench paper --only manipulability` computes it again.
"""

import argparse
import time
from collections.abc import Sequence

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.paper.evolve import evolve
from ikde.paper.inputs import load_dong_zhao
from ikde.paper.manipulability import read_surfaces
from ikde.paper.optima import PAIR_STEP_DEG, Surface, fall_short, find_pair_peak, newton_step_deg
from ikde.paper.tracked_arm import CHAINS, Chain, TrackedArm

COARSE_DEG, SEEDS = 7.5, (1, 2)


def main() -> None:
    """Print what is found, a line a case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chain", choices=[chain.name for chain in CHAINS], help="only this one")
    chosen = parser.parse_args().chain
    surfaces = read_surfaces(load_dong_zhao())
    for chain in CHAINS:
        if chosen in (None, chain.name):
            for name in load_dong_zhao()["ranges_m"]:
                for asked in (*((surface,) for surface in surfaces), tuple(surfaces)):
                    report(chain, name, asked)


def report(chain: Chain, name: str, surfaces: Sequence[Surface]) -> None:
    """Search one case and print it."""
    began = time.perf_counter()
    arm = min((search(chain, name, surfaces, seed) for seed in SEEDS), key=lambda arm: cost(arm, surfaces))
    lengths = [*arm.links_m, arm.arm_offset_m, arm.track_m]
    figures = [surface.figure for surface in surfaces]
    print(f"- {{chain: {chain.name}, range: {name}, figures: {figures}, lengths_m: {lengths}}}")
    for surface in surfaces:
        peak, step = find_pair_peak(arm, surface), newton_step_deg(arm, surface)
        print(
            f"#   figure {surface.figure}: {100 * fall_short(arm, surface):.3f} % below {peak.theta_deg[1:]}, "
            f"Newton's step {'-' if step is None else f'{step:.2f} deg'}"
        )
    print(f"#   {time.perf_counter() - began:.1f} s", flush=True)


def search(chain: Chain, name: str, surfaces: Sequence[Surface], seed: int) -> TrackedArm:
    """The best lengths of a coarse search, then of a fine one around them; to four digits."""
    low, high = (np.log(load_dong_zhao()["ranges_m"][name][end]) for end in ("low", "high"))

    def costs(step_deg: float, X: Floats) -> Floats:
        return np.array([cost(make_arm(chain, np.exp(x)), surfaces, step_deg) for x in X])

    x, _ = evolve(lambda X: costs(COARSE_DEG, X), low.tolist(), high.tolist(), generations=120, seed=seed)
    near = np.maximum(x - 0.15, low), np.minimum(x + 0.15, high)
    x, _ = evolve(
        lambda X: costs(PAIR_STEP_DEG, X),
        near[0].tolist(), near[1].tolist(), population=12, generations=25, seed=seed,
    )  # fmt: skip
    return make_arm(chain, [float(f"{length:.4g}") for length in np.exp(x)])


def make_arm(chain: Chain, lengths_m: Sequence[float] | Floats) -> TrackedArm:
    """An arm of l1, l2, l3 + l4, l_m and b."""
    l1, l2, l3, offset, track = map(float, lengths_m)
    return TrackedArm(links_m=(l1, l2, l3), arm_offset_m=offset, track_m=track, chain=chain)


def cost(arm: TrackedArm, surfaces: Sequence[Surface], step_deg: float = PAIR_STEP_DEG) -> float:
    """The worst of the optima's shortfalls."""
    return max(fall_short(arm, surface, step_deg=step_deg) for surface in surfaces)


if __name__ == "__main__":
    main()
