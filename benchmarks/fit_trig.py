"""Where the coefficients of `ikde/kernels/trig.py` come from: Chebyshev interpolation in 80-bit arithmetic.

    python benchmarks/fit_trig.py

prints them, with the largest error of each polynomial against long-double libm on its interval.
"""

import numpy as np

REAL = np.longdouble


def fit(function, degree: int, upper: float) -> list[float]:
    """Polynomial of `degree` through the Chebyshev nodes of (0, upper], lowest coefficient first."""
    k = np.arange(degree + 1)
    nodes = (np.cos(np.pi * (2 * k + 1) / (2 * (degree + 1))).astype(REAL) + 1) / 2 * REAL(upper)
    divided = function(nodes)
    for order in range(1, degree + 1):
        divided[order:] = (divided[order:] - divided[order - 1 : -1]) / (nodes[order:] - nodes[:-order])
    coefficients = np.array([divided[degree]], dtype=REAL)
    for order in range(degree - 1, -1, -1):
        shifted = np.concatenate([[REAL(0)], coefficients])
        coefficients = shifted - np.concatenate([coefficients * nodes[order], [REAL(0)]])
        coefficients[0] += divided[order]
    return [float(c) for c in coefficients]


def series(first: int, step: int, sign: int, factorial: bool):
    """The Taylor tail as a function of u = x^2: no cancellation near 0, unlike (sin(x)/x - 1)/u."""

    def tail(u):
        total, power = np.zeros_like(u), np.ones_like(u)
        denominator = REAL(1)
        for m in range(2, first + 1):
            denominator *= m
        for n in range(60):
            total += (-1) ** n * sign * power / (denominator if factorial else REAL(first + step * n))
            for m in range(first + step * n + 1, first + step * (n + 1) + 1):
                denominator *= m
            power = power * u
        return total

    return tail


def report(name: str, function, degree: int, upper: float) -> None:
    """Print one coefficient table and its largest error."""
    coefficients = fit(function, degree, upper)
    u = np.linspace(0, upper, 20001).astype(REAL)
    error = np.abs(sum(REAL(c) * u**n for n, c in enumerate(coefficients)) - function(u)).max()
    print(f"{name} = (  # largest error {float(error):.1e}")
    for c in coefficients:
        print(f"    {c!r},")
    print(")")


if __name__ == "__main__":
    quarter_pi = (np.pi / 4 + 1e-3) ** 2
    tangent = (np.tan(np.pi / 8) + 1e-3) ** 2
    report("SIN", series(3, 2, -1, True), 5, quarter_pi)  # sin(x) = x + x u P(u)
    report("COS", series(4, 2, 1, True), 5, quarter_pi)  # cos(x) = 1 - u/2 + u^2 P(u)
    report("ATAN", series(3, 2, -1, False), 10, tangent)  # atan(x) = x + x u P(u)
