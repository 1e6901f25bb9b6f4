"""How a cost grows: the exponent p of time = c x^p, by least squares in logarithms."""

from dataclasses import dataclass
from math import exp, log, sqrt


@dataclass(frozen=True)
class Power:
    factor: float
    exponent: float
    exponent_sigma: float  # standard error; 0 for two points

    def at(self, x):
        return self.factor * x**self.exponent


def fit_power(points):
    """Of (x, y) pairs, all above 0; None when they have fewer than two different x."""
    logs = [(log(x), log(y)) for x, y in points if x > 0 and y > 0]
    n = len(logs)
    if len({u for u, _ in logs}) < 2:
        return None
    mean_u, mean_v = sum(u for u, _ in logs) / n, sum(v for _, v in logs) / n
    spread = sum((u - mean_u) ** 2 for u, _ in logs)
    exponent = sum((u - mean_u) * (v - mean_v) for u, v in logs) / spread
    rest = sum((v - mean_v - exponent * (u - mean_u)) ** 2 for u, v in logs)
    sigma = sqrt(rest / (n - 2) / spread) if n > 2 else 0.0
    return Power(exp(mean_v - exponent * mean_u), exponent, sigma)
