"""Success-history adaptation: the weights F and crossover rates CR that won, and the population that they breed.

A trial goes towards one of the best and along a difference with the archive; the population shrinks [Tanabe2014].

Draws are built from uniform numbers with + - * /, a sine and a cosine of our own, so that the bits hang on nothing
else: Cauchy by tan(pi (u - 1/2)), normal by the sum of twelve uniforms less 6 (mean 0, variance 1, within +-6).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.evolution import is_better, keep
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.mutation import repair_bound
from ikde.kernels.rng import next_index, next_uniform
from ikde.kernels.trig import sin_cos

SPREAD = 0.1  # scale of the Cauchy and of the normal distribution around the remembered means
TERMINAL = -1.0  # a remembered mean of CR that stays: every later CR is 0
LAST_WEIGHT, LAST_CROSSOVER = 0.9, 0.9  # [Brest2017]: the last place of the memory never changes
ARCHIVED, PLACE, SUCCESSES = range(3)  # places of `HistoryWorkspace.counts`


class HistoryWorkspace(NamedTuple):
    """The memory of one population and its archive of beaten members."""

    weight: Floats  # [H] remembered means of F
    crossover: Floats  # [H] remembered means of CR
    success: Floats  # [NP, 3] F, CR and the gain of each win in this generation
    archive: Floats  # [A, N]
    counts: Ints  # [3] members in the archive, place of the memory written next, wins in this generation


@kernel
def make_history(memory, population, archive, joints):
    """Allocate a memory of `memory` places, for populations up to `population` and archives up to `archive` members."""
    return HistoryWorkspace(
        np.empty(memory),
        np.empty(memory),
        np.empty((population, 3)),
        np.empty((max(archive, 1), joints)),
        np.empty(3, dtype=np.int64),
    )


@inline_kernel
def reset_history(history, weight, crossover, is_weighted):
    """Forget: every place holds the first means; with jSO's rules the last one holds its own for ever."""
    for h in range(history.weight.size):
        history.weight[h], history.crossover[h] = weight, crossover
    if is_weighted:
        history.weight[-1], history.crossover[-1] = LAST_WEIGHT, LAST_CROSSOVER
    history.counts[ARCHIVED] = history.counts[PLACE] = history.counts[SUCCESSES] = 0


@inline_kernel
def draw_cauchy(state):
    """A standard Cauchy number."""
    s, c = sin_cos(math.pi * (next_uniform(state) - 0.5))
    return s / c


@inline_kernel
def draw_normal(state):
    """A nearly standard normal number: the sum of twelve uniform ones less 6."""
    total = -6.0
    for _ in range(12):
        total += next_uniform(state)
    return total


@inline_kernel
def draw_weight(state, mean):
    """F: Cauchy about the mean, drawn again until positive, cut to 1 [Tanabe2014, eq. 2]."""
    weight = 0.0
    while weight <= 0.0:
        weight = mean + SPREAD * draw_cauchy(state)
    return min(weight, 1.0)


@inline_kernel
def draw_crossover(state, mean):
    """CR: normal about the mean, cut to [0, 1]; 0 for the terminal value [Tanabe2014, eq. 1]."""
    if mean == TERMINAL:
        return 0.0
    return min(max(mean + SPREAD * draw_normal(state), 0.0), 1.0)


@inline_kernel
def soften(weight, crossover, progress):
    """Limits of jSO early in a run: CR at least 0.7, then 0.6; F at most 0.7 [Brest2017, section III]."""
    if progress < 0.25:
        crossover = max(crossover, 0.7)
    elif progress < 0.5:
        crossover = max(crossover, 0.6)
    if progress < 0.6:
        weight = min(weight, 0.7)
    return weight, crossover


@inline_kernel
def pull_factor(progress):
    """What jSO multiplies F by in the pull towards the best: 0.7, 0.8, then 1.2 [Brest2017, section III]."""
    if progress < 0.2:
        return 0.7
    return 0.8 if progress < 0.4 else 1.2


@inline_kernel
def add_success(history, weight, crossover, gain):
    """Note a win: its F, its CR, and how much better the trial was than its parent, in m."""
    n = history.counts[SUCCESSES]
    history.success[n, 0], history.success[n, 1], history.success[n, 2] = weight, crossover, gain
    history.counts[SUCCESSES] += 1


@inline_kernel
def lehmer_mean(success, count, column):
    """Mean of a column of wins, sum(g v^2) / sum(g v), weighted by the gains g; 0 where all v are 0."""
    top, bottom = 0.0, 0.0
    for n in range(count):
        top += success[n, 2] * success[n, column] * success[n, column]
        bottom += success[n, 2] * success[n, column]
    return top / bottom if bottom > 0.0 else 0.0


@inline_kernel
def update_memory(history, is_weighted):
    """Write the generation's weighted Lehmer means into the next place; without a gain nothing changes.

    [Tanabe2014, algorithm 1]. With jSO's rules the new mean is halfway from the old, and the last place stays.
    """
    count, place = history.counts[SUCCESSES], history.counts[PLACE]
    history.counts[SUCCESSES] = 0
    total, largest = 0.0, 0.0
    for n in range(count):
        total += history.success[n, 2]
        largest = max(largest, history.success[n, 1])
    if not total > 0.0:
        return
    weight, crossover = lehmer_mean(history.success, count, 0), lehmer_mean(history.success, count, 1)
    if largest == 0.0 or history.crossover[place] == TERMINAL:
        history.crossover[place] = TERMINAL
    elif is_weighted:
        history.crossover[place] = 0.5 * (history.crossover[place] + crossover)
    else:
        history.crossover[place] = crossover
    history.weight[place] = 0.5 * (history.weight[place] + weight) if is_weighted else weight
    places = history.weight.size - 1 if is_weighted else history.weight.size
    history.counts[PLACE] = (place + 1) % max(places, 1)


@inline_kernel
def add_to_archive(state, history, capacity, x, i):
    """Keep member `i` of the population `x` that was beaten; in a full archive it replaces a random one."""
    if capacity < 1:
        return
    if history.counts[ARCHIVED] < capacity:
        place = history.counts[ARCHIVED]
        history.counts[ARCHIVED] += 1
    else:
        place = next_index(state, capacity)
    for k in range(x.shape[1]):
        history.archive[place, k] = x[i, k]


@inline_kernel
def trim_archive(state, history, capacity):
    """Drop random members until the archive fits."""
    while history.counts[ARCHIVED] > capacity:
        history.counts[ARCHIVED] -= 1
        place, last = next_index(state, history.counts[ARCHIVED] + 1), history.counts[ARCHIVED]
        for k in range(history.archive.shape[1]):
            history.archive[place, k] = history.archive[last, k]


@inline_kernel
def plan_population(first, last, progress):
    """Linear population size reduction [Tanabe2014, eq. 10]: from `first` at progress 0 to `last` at 1."""
    return np.int64(np.rint(first + (last - first) * progress))


@inline_kernel
def sort_members(score, order, count):
    """Put the first `count` members of `order` into Deb's order, best first; quick where it is nearly sorted."""
    for n in range(1, count):
        member, m = order[n], n
        while m > 0 and not is_better(score[order[m - 1], 0], score[order[m - 1], 1], score[member]):
            order[m] = order[m - 1]
            m -= 1
        order[m] = member


@inline_kernel
def drop_worst(members, order, fresh, count, kept):
    """Keep the `kept` best of `count` sorted members, renumbered so that they stand first; they stay sorted.

    The last member moves into the place of each one that is dropped.
    """
    for size in range(count, kept, -1):
        worst, last = order[size - 1], size - 1
        if worst != last:
            keep(members.x, members.score, worst, members.x[last], members.score[last, 0], members.score[last, 1])
            fresh[worst] = fresh[last]
            for n in range(size - 1):
                if order[n] == last:
                    order[n] = worst


@inline_kernel
def fill_trial(search, memetic, box, state, work, i, count, progress, weight, crossover):
    """Current-to-pbest/1 with the archive, binomial crossover, bound repair: the trial for member `i` of `count`.

    [Tanabe2014, eq. 3]; v = x_i + F' (x_pbest - x_i) + F (x_r1 - x_r2), with r2 from the population or the archive.
    """
    members, history, x = work.members, work.history, work.members.x
    share = memetic.first_share + (memetic.last_share - memetic.first_share) * progress
    best = work.order[next_index(state, max(np.int64(np.rint(share * count)), 2))]
    r1, r2 = i, i
    while r1 == i:
        r1 = next_index(state, count)
    while r2 in (i, r1):
        r2 = next_index(state, count + history.counts[ARCHIVED])
    pull = weight * pull_factor(progress) if memetic.is_weighted else weight
    joints = members.trial.size
    forced = next_index(state, joints)
    for k in range(joints):
        members.trial[k] = x[i, k]
        if k == forced or next_uniform(state) < crossover:
            other = x[r2, k] if r2 < count else history.archive[r2 - count, k]
            donor = x[i, k] + pull * (x[best, k] - x[i, k]) + weight * (x[r1, k] - other)
            members.trial[k] = repair_bound(search.repair, state, donor, x[i, k], box[0, k], box[1, k])
