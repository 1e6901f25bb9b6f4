"""The fit of a power. Its argument: the folder of the bench."""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))

from fit import fit_power


class FitPower(unittest.TestCase):
    def test_finds_factor_and_exponent_of_an_exact_power(self):
        for exponent in [-1.0, 0.0, 0.5, 1.0, 2.0]:
            fit = fit_power([(x, 3.0 * x**exponent) for x in [1, 2, 5, 40]])
            self.assertAlmostEqual(fit.exponent, exponent)
            self.assertAlmostEqual(fit.factor, 3.0)
            self.assertAlmostEqual(fit.exponent_sigma, 0.0)
            self.assertAlmostEqual(fit.at(7.0), 3.0 * 7.0**exponent)

    def test_tells_how_sure_it_is(self):
        # By hand, in powers of two: slope 1, residuals 2/3, -4/3, 2/3, one degree of freedom, spread 2.
        fit = fit_power([(1, 2), (2, 1), (4, 8)])
        self.assertAlmostEqual(fit.exponent, 1.0)
        self.assertAlmostEqual(fit.exponent_sigma, (4.0 / 3.0) ** 0.5)

    def test_needs_two_places(self):
        self.assertIsNone(fit_power([]))
        self.assertIsNone(fit_power([(2, 1), (2, 3)]))
        self.assertAlmostEqual(fit_power([(1, 1), (2, 4)]).exponent, 2.0)
        self.assertIsNone(fit_power([(0, 1), (2, 4)]))


unittest.main()
