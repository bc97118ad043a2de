"""Draw docs/track.png, the README's picture: qiao2021 at three moments of task 2 of Qiao et al. 2022.

python benchmarks/readme_picture.py
"""

from pathlib import Path

import ikde
from ikde.plot.images import to_png
from ikde.plot.moments import plot_moments
from ikde.scene.drawn_motion import draw_motion
from ikde.track.summary import summarise_track

ROOT = Path(__file__).parent.parent
MOMENTS = 0, 180, 500  # samples of 20 ms
DPI = 220  # 1,600 pixels wide: sharp where a page shows 800


def main() -> None:
    """Follow the path and draw."""
    plan = ikde.load_track(ROOT / "configs" / "tracks" / "qiao2022_task2.yaml")
    motion = summarise_track(plan.collision, ikde.run_track(plan))
    (ROOT / "docs" / "track.png").write_bytes(to_png(plot_moments(draw_motion(motion, MOMENTS)), dpi=DPI))


if __name__ == "__main__":
    main()
