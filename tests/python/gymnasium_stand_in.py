"""A stand-in for Gymnasium, which is no package of Debian: what obsim.gym takes of it, by its documentation, and no more."""
import enum
import importlib
import sys
import types

import numpy


class Space:
    """Box alone: numbers between bounds."""

    def __init__(self, low, high, shape=None, dtype=numpy.float32):
        self.low, self.high = (numpy.broadcast_to(numpy.asarray(b, dtype), shape or numpy.shape(b)) for b in (low, high))
        self.shape, self.dtype, self._random = self.low.shape, numpy.dtype(dtype), numpy.random.default_rng()

    def seed(self, seed):
        self._random = numpy.random.default_rng(seed)

    def sample(self):
        return self._random.uniform(self.low, self.high).astype(self.dtype)

    def __contains__(self, x):
        return isinstance(x, numpy.ndarray) and x.dtype == self.dtype and x.shape == self.shape and \
            bool((x >= self.low).all() and (x <= self.high).all())


class Random:
    """The generator of an environment: seeded by reset, else by chance."""
    _np_random = None
    spec = render_mode = None
    closed = False

    def reset(self, *, seed=None, options=None): # pylint: disable=unused-argument # as the original
        if seed is not None:
            self._np_random = numpy.random.default_rng(seed)

    @property
    def np_random(self):
        if self._np_random is None:
            self._np_random = numpy.random.default_rng()
        return self._np_random

    unwrapped = property(lambda self: self)


class VectorEnv(Random):
    def close(self):
        if not self.closed:
            self.close_extras()
        self.closed = True


class AutoresetMode(enum.Enum):
    NEXT_STEP = 'NextStep'


class TimeLimit:
    """An environment that truncates, as make returns it."""

    def __init__(self, environment, limit):
        self.unwrapped, self._limit, self._made = environment, limit, 0

    def __getattr__(self, name):
        return getattr(self.unwrapped, name)

    def reset(self, **how):
        self._made = 0
        return self.unwrapped.reset(**how)

    def step(self, action):
        seen, reward, terminated, truncated, info = self.unwrapped.step(action)
        self._made += 1
        return seen, reward, terminated, truncated or self._made >= self._limit, info


registered = {}


def register(id, **how): # pylint: disable=redefined-builtin # as the original
    registered[id] = how


def _find(path):
    module, name = path.split(':')
    return getattr(importlib.import_module(module), name)


def make(id, **how): # pylint: disable=redefined-builtin # as the original
    limit = how.pop('max_episode_steps', registered[id]['max_episode_steps'])
    return TimeLimit(_find(registered[id]['entry_point'])(**how), limit)


def make_vec(id, num_envs=1, **how): # pylint: disable=redefined-builtin # as the original
    return _find(registered[id]['vector_entry_point'])(num_envs=num_envs, **{'max_episode_steps': registered[id]['max_episode_steps'], **how})


def _module(name, **parts):
    module = sys.modules[name] = types.ModuleType(name)
    vars(module).update(parts)
    return module


utils = _module('gymnasium.vector.utils', batch_space=lambda space, n: Space(
    numpy.repeat(space.low[None], n, 0), numpy.repeat(space.high[None], n, 0), dtype=space.dtype))
vector = _module('gymnasium.vector', VectorEnv=VectorEnv, AutoresetMode=AutoresetMode, utils=utils)
_module('gymnasium', Env=type('Env', (Random,), {}), Space=Space, spaces=_module('gymnasium.spaces', Box=Space), vector=vector,
        register=register, make=make, make_vec=make_vec)
