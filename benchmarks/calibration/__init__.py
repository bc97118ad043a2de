"""How the free numbers of qiao2021 were chosen, and what pins them (docs/calibration.md)."""
