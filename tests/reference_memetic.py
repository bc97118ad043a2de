"""Naive twins of the memetic search and its success-history adaptation, beside those of `tests/reference.py`."""

import numpy as np

from tests.reference import compute_score, repair_bound


def draw_cauchy(stream):
    """A standard Cauchy number by its quantile function."""
    return np.tan(np.pi * (stream.uniform() - 0.5))


def draw_normal(stream):
    """Twelve uniform numbers less 6."""
    return sum(stream.uniform() for _ in range(12)) - 6.0


def draw_weight(stream, mean):
    """F [Tanabe2014, eq. 2]."""
    weight = 0.0
    while weight <= 0.0:
        weight = mean + 0.1 * draw_cauchy(stream)
    return min(weight, 1.0)


def draw_crossover(stream, mean):
    """CR [Tanabe2014, eq. 1]; None is the terminal value."""
    return 0.0 if mean is None else float(np.clip(mean + 0.1 * draw_normal(stream), 0.0, 1.0))


def lehmer_mean(values, gains):
    """sum(w v^2) / sum(w v) with w = gain / sum of gains [Tanabe2014, eq. 7]."""
    values, w = np.array(values), np.array(gains) / np.sum(gains)
    return np.sum(w * values**2) / np.sum(w * values) if np.sum(w * values) > 0.0 else 0.0


class History:
    """The memory of F and CR [Tanabe2014, algorithm 1]; `weighted` for jSO's rules [Brest2017]."""

    def __init__(self, memetic):
        self.weighted = memetic.is_weighted
        self.weight = [memetic.first_weight] * memetic.memory
        self.crossover = [memetic.first_crossover] * memetic.memory
        if self.weighted:
            self.weight[-1] = self.crossover[-1] = 0.9
        self.place, self.wins, self.archive = 0, [], []

    def update(self):
        """Write the next place from the wins (F, CR, gain) of a generation."""
        wins, self.wins = self.wins, []
        if not wins:
            return
        weights, crossovers, gains = zip(*wins, strict=True)
        old, new = self.weight[self.place], lehmer_mean(weights, gains)
        self.weight[self.place] = (old + new) / 2 if self.weighted else new
        old, new = self.crossover[self.place], lehmer_mean(crossovers, gains)
        if old is None or max(crossovers) == 0.0:
            self.crossover[self.place] = None
        else:
            self.crossover[self.place] = (old + new) / 2 if self.weighted else new
        self.place = (self.place + 1) % (len(self.weight) - self.weighted)

    def put(self, stream, member, capacity):
        """Into the archive; into a full one in place of a random member."""
        if len(self.archive) < capacity:
            self.archive.append(member)
        elif capacity:
            self.archive[stream.index(capacity)] = member

    def trim(self, stream, capacity):
        """Random members leave; the last one takes the place of each."""
        while len(self.archive) > capacity:
            place = stream.index(len(self.archive))
            self.archive[place] = self.archive[-1]
            self.archive.pop()


def make_pbest_trial(problem, memetic, stream, x, ranked, history, i, progress):
    """(trial, F, CR) for member i: current-to-pbest/1 with archive [Tanabe2014, eq. 3], jSO's rules [Brest2017]."""
    place = stream.index(memetic.memory)
    crossover = draw_crossover(stream, history.crossover[place])
    weight = draw_weight(stream, history.weight[place])
    pull = weight
    if memetic.is_weighted:
        crossover = max(crossover, 0.7 if progress < 0.25 else 0.6 if progress < 0.5 else 0.0)
        weight = min(weight, 0.7) if progress < 0.6 else weight
        pull = weight * (0.7 if progress < 0.2 else 0.8 if progress < 0.4 else 1.2)
    share = memetic.first_share + (memetic.last_share - memetic.first_share) * progress
    best = ranked[stream.index(max(round(share * len(x)), 2))]
    everybody = [*x, *history.archive]
    r1 = r2 = i
    while r1 == i:
        r1 = stream.index(len(x))
    while r2 in (i, r1):
        r2 = stream.index(len(everybody))
    forced = stream.index(x.shape[1])
    donor = x[i] + pull * (x[best] - x[i]) + weight * (x[r1] - everybody[r2])
    trial, repair = x[i].copy(), problem.settings.evolution.bounds
    for k in range(len(trial)):
        if k == forced or stream.uniform() < crossover:
            trial[k] = repair_bound(repair, stream, donor[k], x[i, k], problem.lower[k], problem.upper[k])
    return trial, weight, crossover


def evolve_memetic(problem, target, stream, memetic):
    """Without polishing: (population, scores (depth, cost), best member, met?, evaluations, history)."""
    history, count, spent = History(memetic), memetic.first_population, 0
    x, scores = np.zeros((count, len(problem.lower))), []
    for i in range(count):
        x[i] = problem.lower + np.array([stream.uniform() for _ in x[i]]) * (problem.upper - problem.lower)
        score, meets = compute_score(problem, target, x[i])
        scores.append(score)
        spent += 1
        if meets:
            return x, scores, i, True, spent, history
    while spent < memetic.evaluations:
        ranked, progress = sorted(range(count), key=lambda i: scores[i]), spent / memetic.evaluations
        next_x, next_scores = x.copy(), list(scores)
        for i in range(min(count, memetic.evaluations - spent)):
            trial, weight, crossover = make_pbest_trial(problem, memetic, stream, x, ranked, history, i, progress)
            score, meets = compute_score(problem, target, trial)
            spent += 1
            if score > scores[i]:
                continue
            if meets:
                x[i], scores[i] = trial, score
                return x, scores, i, True, spent, history
            next_x[i], next_scores[i] = trial, score
            gain = scores[i][0] - score[0] if scores[i][0] != score[0] else scores[i][1] - score[1]
            if gain > 0.0:
                history.wins.append((weight, crossover, gain))
                history.put(stream, x[i].copy(), int(memetic.archive_share * count))
        x, scores = next_x, next_scores
        history.update()
        first, last = memetic.first_population, memetic.last_population
        planned = round(first + (last - first) * spent / memetic.evaluations)
        while count > planned:
            worst = max(range(count), key=lambda i: scores[i])
            x[worst], scores[worst] = x[count - 1], scores[count - 1]
            count -= 1
            x, scores = x[:count], scores[:count]
        history.trim(stream, int(memetic.archive_share * count))
    return x, scores, min(range(count), key=lambda i: scores[i]), False, spent, history
