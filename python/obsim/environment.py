"""Universes as problems of control, by the conventions of Gymnasium (reset, step), whose package is not needed.

    def observe(u): return u['cart'].position[[0]]
    def act(u, action): u['cart'].force = action, 0, 0
    def reward(u): return -abs(u['cart'].position[0])
    environment = Environment('cart.lua', observe, act, reward, limit=500)
    observation, info = environment.reset(seed=1)
    observation, reward, terminated, truncated, info = environment.step(3.)

Environments steps several of them side by side, each in a process of its own.
"""
import concurrent.futures
from typing import Any, Callable, Iterable, Optional

import numpy

import obsim


class Environment:
    """One universe. observe(u) gives an observation, act(u, action) sets what an action does, reward(u) is the reward of the
    state after it; ended(u), if given, is true where an episode ends. steps: of the universe in each of the environment's;
    limit: the most of these in an episode. The rest is as for obsim.run."""

    def __init__(self, scene: Any, observe: Callable[[obsim.Run], Any], act: Callable[[obsim.Run, Any], Any],
                 reward: Callable[[obsim.Run], float], ended: Optional[Callable[[obsim.Run], Any]] = None, steps: int = 1,
                 limit: Optional[int] = None, **how: Any) -> None:
        self._observe, self._act, self._reward, self._ended = observe, act, reward, ended
        self._steps, self._limit, self._made = steps, limit, 0
        self.universe = obsim.run(scene, **how)

    def reset(self, seed: Optional[int] = None) -> tuple[Any, dict[str, Any]]:
        """(observation, info) of a new episode: from the same start, or from the one that the scene makes of a seed."""
        self.universe.reset(seed)
        self._made = 0
        return self._observe(self.universe), {'time': self.universe.time}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """(observation, reward, terminated, truncated, info)"""
        u = self.universe
        self._act(u, action)
        u.step(self._steps)
        self._made += 1
        return (self._observe(u), float(self._reward(u)), bool(self._ended and self._ended(u)),
                self._limit is not None and self._made >= self._limit, {'time': u.time})

    def render(self, **how: Any) -> numpy.ndarray:
        """The state as a picture, an array (height, width, 3) of 0 to 255; arguments are as for Run.picture."""
        return self.universe.picture(**how)

    def close(self) -> None:
        """Ends its universe."""
        self.universe.close()

    def __enter__(self) -> 'Environment':
        return self

    def __exit__(self, *_what: Any) -> None:
        self.close()


class Environments:
    """n environments side by side; arrays have a row for each. Arguments are as for Environment."""

    def __init__(self, n: int, *arguments: Any, **how: Any) -> None:
        how['options'] = {'workers': 1, **(how.get('options') or {})}
        self._threads = concurrent.futures.ThreadPoolExecutor(n)
        self.each = list(self._threads.map(lambda _: Environment(*arguments, **how), range(n)))

    def __len__(self) -> int:
        return len(self.each)

    def reset(self, seeds: Optional[Iterable[int]] = None) -> tuple[numpy.ndarray, list[dict[str, Any]]]:
        """(observations, infos); seeds: one for each, or None."""
        done = list(self._threads.map(lambda e, s: e.reset(s), self.each, [None] * len(self) if seeds is None else list(seeds)))
        return numpy.array([d[0] for d in done]), [d[1] for d in done]

    def step(self, actions: Any) -> tuple[Any, ...]:
        """(observations, rewards, terminated, truncated, infos)"""
        done = list(self._threads.map(lambda e, a: e.step(a), self.each, actions))
        return (*(numpy.array([d[i] for d in done]) for i in range(4)), [d[4] for d in done])

    def close(self) -> None:
        """Ends their universes."""
        for e in self.each:
            e.close()
        self._threads.shutdown()

    def __enter__(self) -> 'Environments':
        return self

    def __exit__(self, *_what: Any) -> None:
        self.close()
