"""Sobol' points with scrambled digits: samples that are spread more evenly than random ones."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

REPLICATES = 8
"""Independent scramblings of each set of points: the spread of their answers is the error."""

Bits = NDArray[np.uint32]

# Degree, coefficients and first numbers of the primitive polynomials of dimensions 2, 3 and 4:
# S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
# SIAM J. Sci. Comput. 30 (2008).
_POLYNOMIALS = ((1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)))


def _reversed(x: Bits) -> Bits:
    """The 32 bits of each number from the last to the first."""
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF)):
        x = ((x >> np.uint32(shift)) & np.uint32(mask)) | (
            (x & np.uint32(mask)) << np.uint32(shift)
        )
    return (x >> np.uint32(16)) | (x << np.uint32(16))


def _columns(dimension: int) -> list[int]:
    """The 32 direction numbers of a dimension, the first of which sets the first digit."""
    if dimension == 0:
        return [1 << (31 - k) for k in range(32)]
    degree, taps, first = _POLYNOMIALS[dimension - 1]
    numbers = [m << (31 - k) for k, m in enumerate(first)]
    for k in range(degree, 32):
        new = numbers[k - degree] ^ (numbers[k - degree] >> degree)
        for j in range(1, degree):
            if (taps >> (degree - 1 - j)) & 1:
                new ^= numbers[k - j]
        numbers.append(new)
    return numbers


def mixed(numbers: Any) -> Bits:
    """32 bits for each integer, which look random: the finalizer of MurmurHash3 (Appleby, 2011)."""
    x = np.array(numbers, np.uint32, ndmin=1) + np.uint32(0x9E3779B9)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35)):
        x = (x ^ (x >> np.uint32(shift))) * np.uint32(factor)
    return x ^ (x >> np.uint32(16))


@lru_cache(maxsize=4)
def point_sets(log2_count: int, dimensions: int, seed: int = 0) -> Bits:
    """(REPLICATES, 2^log2_count, dimensions): at most 4 coordinates as multiples of 2^-32.

    Each replicate is the same set of Sobol' points with its own nested scrambling (A. B. Owen,
    "Randomly permuted (t,m,s)-nets", 1995), by a hash of the reversed digits (B. Burley, "Practical
    hash-based Owen scrambling", JCGT 9, 2020).
    """
    sets = np.empty((REPLICATES, 1 << log2_count, dimensions), np.uint32)
    for dimension in range(dimensions):
        points = np.zeros(1, np.uint32)
        for column in _columns(dimension)[:log2_count]:
            points = np.concatenate([points, points ^ np.uint32(column)])
        digits = _reversed(points)
        for replicate in range(REPLICATES):
            key = mixed(1 + dimension + 4 * (replicate + REPLICATES * seed))
            x = digits + key
            for factor in (0x6C50B47C, 0xB82F1E52, 0xC7AFE638, 0x8D22F6E6):
                x = x ^ (x * np.uint32(factor))
            sets[replicate, :, dimension] = _reversed(x)
    sets.flags.writeable = False
    return sets


def log2_at_least(count: int) -> int:
    """The exponent of the power of two for each replicate, so that all have `count` points."""
    return max(0, (-(-count // REPLICATES) - 1).bit_length())


def unit(bits: Bits) -> NDArray[np.float64]:
    """The middles of their intervals in [0, 1)."""
    return np.asarray((bits + 0.5) * 2.0**-32, np.float64)
