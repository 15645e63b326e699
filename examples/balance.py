"""Learns to keep up the pole on a cart, by the cross-entropy method: 64 universes try 64 policies at once.

    python3 balance.py
"""
import pathlib
import time

import numpy
import obsim

SCENE = pathlib.Path(obsim.__file__).parent / 'cart_pole.lua'
N, BEST, GENERATIONS, LEARNED, WANTED = 64, 8, 6, 150, 500 # universes; those that teach; rounds; steps in learning, and of a test
PLACE, LEAN = 2.4, numpy.radians(12) # m, rad: beyond them it has fallen


def play(batch, policies, steps):
    """Steps that each policy, a row of four gains, kept its pole up, with a little less for a pole that swings."""
    score, up = numpy.zeros(N), numpy.ones(N, bool)
    seen = batch.step(0, read=['rail', 'foot']).reshape(N, 4) # place, speed, lean, its rate
    for _ in range(steps):
        push = numpy.clip((policies * seen).sum(axis=1), -1, 1) * 10 # N
        seen = batch.step(forces={'cart': numpy.outer(push, [1, 0, 0])}, read=['rail', 'foot']).reshape(N, 4)
        up &= (abs(seen[:, 0]) < PLACE) & (abs(seen[:, 2]) < LEAN)
        score += up * (1 - .1 * abs(seen[:, 0]) - abs(seen[:, 2]))
        if not up.any():
            break
    return score, up


def main():
    began, chance = time.perf_counter(), numpy.random.default_rng(1)
    mean, spread = numpy.zeros(4), numpy.array([1., 1, 10, 3])
    with obsim.batch(SCENE, N, seeds=range(N)) as batch:
        print(f'without a policy {play(batch, numpy.zeros((N, 4)), WANTED)[1].sum()} of {N} poles stay up')
        for generation in range(GENERATIONS):
            policies = chance.normal(mean, spread, (N, 4))
            batch.reset()
            score, up = play(batch, policies, LEARNED)
            best = policies[numpy.argsort(score)[-BEST:]]
            mean, spread = best.mean(axis=0), best.std(axis=0) + .05
            print(f'round {generation + 1}: {up.sum()} of {N} poles stay up for {LEARNED} steps')
        batch.reset(seeds=range(1000, 1000 + N)) # starts that it has not seen
        up = play(batch, numpy.tile(mean, (N, 1)), WANTED)[1]
        print(f'learned in {time.perf_counter() - began:.0f} s: {mean.round(2)} keeps up {up.sum()} of {N} poles for {WANTED} steps')
    return up.all()


if __name__ == '__main__':
    main()
