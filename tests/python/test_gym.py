"""obsim.gym by the rules that Gymnasium's checker documents (gymnasium.utils.env_checker), and by the checker itself where
Gymnasium is installed. Without it the rules are held with a stand-in."""
import copy
import unittest

import numpy

try:
    import gymnasium
    from gymnasium.utils.env_checker import check_env
except ImportError:
    import gymnasium_stand_in # pylint: disable=unused-import # installs itself
    import gymnasium
    check_env = None

import obsim
import obsim.gym

NAME = 'obsim/CartPole-v0'


class One(unittest.TestCase):
    def setUp(self):
        self.e = gymnasium.make(NAME)
        self.addCleanup(self.e.close)

    def test_checker(self):
        if not check_env:
            self.skipTest('needs Gymnasium')
        check_env(self.e.unwrapped, skip_render_check=True)

    def test_seeds(self):
        """A seed gives the episode and all that follow; none goes on with the generator."""
        found = []
        for seed in 123, None, 123, None, 456:
            seen, info = self.e.reset(seed=seed)
            self.assertIn(seen, self.e.observation_space)
            self.assertIsInstance(info, dict)
            found.append((seen.tobytes(), copy.deepcopy(self.e.unwrapped.np_random).bit_generator.state))
        self.assertEqual(found[0], found[2])
        self.assertEqual(found[1], found[3])
        self.assertEqual(len({seen for seen, _ in found}), 3)
        self.assertNotEqual(found[4][1], found[0][1])
        self.e.reset(options={})

    def test_steps(self):
        self.e.action_space.seed(5)
        action, found = self.e.action_space.sample(), []
        self.assertIn(action, self.e.action_space)
        for _ in range(2):
            self.e.reset(seed=7)
            before = copy.deepcopy(self.e.unwrapped.np_random).bit_generator.state
            seen, reward, terminated, truncated, info = self.e.step(action)
            self.assertEqual(self.e.unwrapped.np_random.bit_generator.state, before) # a step draws nothing
            self.assertIn(seen, self.e.observation_space)
            self.assertEqual([type(x) for x in (reward, terminated, truncated, info)], [float, bool, bool, dict])
            found.append((seen.tobytes(), reward, terminated, truncated))
        self.assertEqual(*found)

    def test_ends(self):
        """An episode that is pushed to one side terminates, one that is short is truncated, and neither begins anew by itself."""
        self.e.reset(seed=1)
        for k in range(200):
            seen, _, terminated, truncated, _ = self.e.step(self.e.action_space.high)
            self.assertFalse(truncated)
            if terminated:
                break
        self.assertGreater(k, 3)
        self.assertTrue(abs(seen[0]) > 2.4 or abs(seen[2]) > numpy.radians(12))
        short = gymnasium.make(NAME, max_episode_steps=3)
        self.addCleanup(short.close)
        short.reset(seed=1)
        ends = [short.step(numpy.zeros(1, numpy.float32))[2:4] for _ in range(3)]
        self.assertEqual(ends, [(False, False), (False, False), (False, True)])

    def test_render(self):
        self.assertEqual(self.e.unwrapped.metadata['render_modes'], ['rgb_array'])
        self.e.reset()
        self.assertIsNone(self.e.unwrapped.render())
        self.e.close()
        self.e.close() # again is allowed


class Many(unittest.TestCase):
    N = 6

    def setUp(self):
        self.e = gymnasium.make_vec(NAME, self.N, max_episode_steps=20)
        self.addCleanup(self.e.close)

    def test_spaces(self):
        e, mode = self.e, gymnasium.vector.AutoresetMode
        self.assertEqual((e.num_envs, e.observation_space.shape, e.action_space.shape), (self.N, (self.N, 4), (self.N, 1)))
        self.assertEqual((e.single_observation_space.shape, e.single_action_space.shape), ((4,), (1,)))
        self.assertEqual(e.metadata['autoreset_mode'], mode.NEXT_STEP)

    def test_episodes(self):
        """The step after an end begins anew: no reward, no end, and the observation of a new start. All of it follows from the seed."""
        runs = []
        for _ in range(2):
            seen, _ = self.e.reset(seed=3)
            self.assertEqual(len({row.tobytes() for row in seen}), self.N)
            self.e.action_space.seed(4)
            over, run, made = numpy.zeros(self.N, bool), [seen.tobytes()], numpy.zeros(self.N, int)
            for _ in range(60):
                seen, rewards, terminated, truncated, infos = self.e.step(self.e.action_space.sample())
                self.assertIn(seen, self.e.observation_space)
                self.assertEqual([x.shape for x in (rewards, terminated, truncated)], [(self.N,)] * 3)
                self.assertEqual([x.dtype for x in (terminated, truncated)], [bool] * 2)
                self.assertIsInstance(infos, dict)
                self.assertFalse((terminated | truncated)[over].any())
                self.assertEqual(rewards.tolist(), (~over).astype(float).tolist())
                self.assertFalse(seen[over][:, [0, 2]].any()) # the scene begins upright, at the middle of its rail
                made = numpy.where(over, 0, made + 1)
                self.assertEqual(truncated.tolist(), (made >= 20).tolist())
                over = terminated | truncated
                run.append((seen.tobytes(), terminated.tolist(), truncated.tolist()))
            runs.append(run)
        self.assertEqual(*runs)

    def test_as_one(self):
        """A universe of many ends in the bits of one alone."""
        one = obsim.gym.Env(obsim.gym.CartPole())
        self.addCleanup(one.close)
        seen, _ = self.e.reset(seed=8)
        seed = int(numpy.random.default_rng(1).integers(1 << 31))
        self.e.batch.reset(seeds=[seed] * self.N)
        one.reset()
        one.batch.reset(seeds=[seed])
        for k in range(10):
            actions = numpy.full((self.N, 1), numpy.sin(k), numpy.float32)
            seen = self.e.step(actions)[0]
            alone = one.step(actions[0])[0]
            self.assertEqual([row.tobytes() for row in seen], [alone.tobytes()] * self.N)


if __name__ == '__main__':
    unittest.main()
