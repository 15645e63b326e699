"""Universes as environments of Gymnasium, which must be installed: spaces, seeds, terminated and truncated by its rules.

    import gymnasium
    import obsim.gym                                            # registers obsim/CartPole-v0
    e = gymnasium.make('obsim/CartPole-v0')                     # one universe within this program
    many = gymnasium.make_vec('obsim/CartPole-v0', 64)          # a batch of them, stepped by threads

Env and VectorEnv take any Task. An episode begins as the scene makes it of a seed, which is drawn from np_random.
"""
import os
from typing import Any, Optional

import gymnasium
import numpy
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

import obsim


class Task:
    """A problem of control, of all universes of a batch at once: arrays have a row for each."""
    scene = '' # a path, or a name
    read: tuple[str, ...] = () # joints that are observed
    steps = 1 # of a universe in one of the environment
    observation_space: gymnasium.Space # of one universe
    action_space: gymnasium.Space

    def act(self, actions: numpy.ndarray) -> dict[str, Any]:
        """Arguments targets and forces of Batch.step."""
        raise NotImplementedError

    def observe(self, batch: obsim.Batch, values: numpy.ndarray) -> numpy.ndarray:
        """Observations; values: of the joints, (universes, joints, 2)."""
        raise NotImplementedError

    def judge(self, observations: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
        """Rewards, and true where an episode ends by itself."""
        raise NotImplementedError


class CartPole(Task):
    """A cart on a rail is pushed with up to 10 N, so that the pole on it stays up. Observed: place (m), speed, lean (rad) and its
    rate. A reward of 1 for each step; the episode ends beyond 2.4 m or 12 degrees."""
    scene, read = os.path.join(os.path.dirname(__file__), 'cart_pole.lua'), ('rail', 'foot')
    PLACE, LEAN = 2.4, numpy.radians(12)
    most = numpy.array([2 * PLACE, 100, 2 * LEAN, 100], numpy.float32)
    observation_space = gymnasium.spaces.Box(-most, most, dtype=numpy.float32)
    action_space = gymnasium.spaces.Box(-1, 1, (1,), numpy.float32)

    def act(self, actions):
        return {'forces': {'cart': numpy.asarray(actions, float) * [10, 0, 0]}}

    def observe(self, batch, values):
        return values.reshape(-1, 4).astype(numpy.float32)

    def judge(self, observations):
        return numpy.ones(len(observations)), (abs(observations[:, 0]) > self.PLACE) | (abs(observations[:, 2]) > self.LEAN)


METADATA = {'render_modes': ['rgb_array'], 'render_fps': 50}


def _begin(batch, task, random, mask=None):
    """Begins episodes; returns the observations of all."""
    batch.reset(mask, seeds=random.integers(1 << 31, size=len(batch)).tolist())
    return task.observe(batch, batch.step(0, read=task.read))


def _go(batch, task, actions):
    """A step: observations, rewards, terminated."""
    seen = task.observe(batch, batch.step(task.steps, read=task.read, **task.act(actions)))
    return seen, *task.judge(seen)


class Env(gymnasium.Env):
    """One universe. how: as for obsim.batch."""
    metadata: dict[str, Any] = METADATA

    def __init__(self, task: Task, render_mode: Optional[str] = None, **how: Any) -> None:
        self.task, self.render_mode = task, render_mode
        self.observation_space, self.action_space = task.observation_space, task.action_space
        self.batch = obsim.batch(task.scene, 1, threads=1, **how)

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """(observation, info) of a new episode; options: none are known."""
        super().reset(seed=seed)
        return _begin(self.batch, self.task, self.np_random)[0], {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """(observation, reward, terminated, truncated, info); gymnasium.make truncates."""
        seen, rewards, ended = _go(self.batch, self.task, numpy.asarray(action)[None])
        return seen[0], float(rewards[0]), bool(ended[0]), False, {}

    def render(self) -> Any:
        """The state as a picture, an array (height, width, 3), if the environment was made with render_mode='rgb_array'."""
        return self.batch[0].picture() if self.render_mode else None

    def close(self) -> None:
        """Ends its universe."""
        self.batch.close()


class VectorEnv(gymnasium.vector.VectorEnv):
    """num_envs universes side by side. An episode that has ended begins anew in the next step, whose action it does not take."""
    metadata: dict[str, Any] = {**METADATA, 'autoreset_mode': AutoresetMode.NEXT_STEP}

    def __init__(self, task: Task, num_envs: int = 1, max_episode_steps: Optional[int] = None, render_mode: Optional[str] = None,
                 **how: Any) -> None:
        self.task, self.num_envs, self.render_mode, self._limit = task, num_envs, render_mode, max_episode_steps
        self.single_observation_space, self.single_action_space = task.observation_space, task.action_space
        self.observation_space = batch_space(task.observation_space, num_envs)
        self.action_space = batch_space(task.action_space, num_envs)
        self.batch = obsim.batch(task.scene, num_envs, **how)
        self._made, self._over = numpy.zeros(num_envs, int), numpy.zeros(num_envs, bool)

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """(observations, infos) of new episodes; options: none are known."""
        super().reset(seed=seed)
        self._made[:], self._over[:] = 0, False
        return _begin(self.batch, self.task, self.np_random), {}

    def step(self, actions: Any) -> tuple[Any, numpy.ndarray, numpy.ndarray, numpy.ndarray, dict[str, Any]]:
        """(observations, rewards, terminated, truncated, infos)"""
        new = self._over
        seen, rewards, terminated = _go(self.batch, self.task, actions)
        if new.any():
            seen = _begin(self.batch, self.task, self.np_random, new)
        self._made = numpy.where(new, 0, self._made + 1)
        terminated = terminated & ~new
        truncated = (self._made >= self._limit) if self._limit else numpy.zeros(self.num_envs, bool)
        self._over = terminated | truncated
        return seen, numpy.where(new, 0., rewards), terminated, truncated, {}

    def render(self) -> Any:
        """States as pictures, if the environments were made with render_mode='rgb_array'."""
        return tuple(u.picture() for u in self.batch) if self.render_mode else None

    def close_extras(self, **_how: Any) -> None:
        """Ends their universes."""
        self.batch.close()


def cart_pole(**how: Any) -> Env:
    """The environment obsim/CartPole-v0."""
    return Env(CartPole(), **how)


def cart_poles(num_envs: int = 1, **how: Any) -> VectorEnv:
    """Several of them."""
    return VectorEnv(CartPole(), num_envs, **how)


gymnasium.register('obsim/CartPole-v0', entry_point='obsim.gym:cart_pole', vector_entry_point='obsim.gym:cart_poles',
                   max_episode_steps=500)
