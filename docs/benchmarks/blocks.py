"""Pictures of two programs, compared by the means of blocks of pixels."""

from typing import NamedTuple

import numpy as np

WIDTH, HEIGHT, BLOCK = 48, 36, 6


def block_means(pictures):
    """Of pictures of WIDTH × HEIGHT pixels with three channels."""
    size = (len(pictures), HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3)
    return np.array(pictures).reshape(size).mean(axis=(2, 4))


def standard_error(theirs, ours):
    """Of the difference of their means, each of as many pictures."""
    return np.sqrt((theirs.var(axis=0, ddof=1) + ours.var(axis=0, ddof=1)) / len(theirs))


class Comparison(NamedTuple):
    """How far our pictures are from theirs."""

    #: The relative difference of the means of all pixels, and that in standard errors.
    change: float
    z: float
    #: The number of block means that are farther apart than the tolerance and six standard errors, of so many.
    differ: int
    count: int


def compare(theirs, ours, tolerance):
    """Block means of several pictures by each program; a tolerance is relative."""
    want, got = theirs.mean(axis=0), ours.mean(axis=0)
    apart, scale = np.abs(got - want), 0.02 * want.mean()
    is_unlikely = apart > 6 * (standard_error(theirs, ours) + 1e-4 * want.mean())
    differ = is_unlikely & (apart > tolerance * (want + scale))
    means = [each.mean(axis=(1, 2, 3)) for each in (theirs, ours)]
    z = (got.mean() - want.mean()) / (standard_error(*means) + 1e-9)
    return Comparison(got.mean() / want.mean() - 1, z, differ.sum(), differ.size)
