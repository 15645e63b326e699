#!/usr/bin/env python3
"""Cost of a run that Python leads: one step and all positions over the step itself, reading, waiting for a step, restoring.

    control.py OBSIM LIBOBSIM [ROUNDS]

Each figure is measured in ROUNDS rounds (20), in turns with what it is compared with. Printed are the fastest, the median and
the slowest, in us. "Denied" is the time in which threads of the run or of this program were ready and had no core, so a busy
machine can be told from a slow program.
"""
import ctypes
import multiprocessing
import os
import statistics
import sys
import tempfile
import time

os.environ['OBSIM'], os.environ['OBSIM_LIBRARY'] = sys.argv[1:3]
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'python'))
import obsim # pylint: disable=wrong-import-position
from obsim import _native # pylint: disable=wrong-import-position

ROUNDS = int(sys.argv[3]) if len(sys.argv) > 3 else 20
STEPS = 200


def schedule(pids):
    """CPU time and time without a core of all threads so far (s)."""
    cpu = denied = 0
    for pid in pids:
        for task in os.listdir(f'/proc/{pid}/task'):
            try:
                with open(f'/proc/{pid}/task/{task}/schedstat', encoding='ascii') as f:
                    numbers = f.read().split()
            except OSError:
                continue
            cpu += 1e-9 * int(numbers[0])
            denied += 1e-9 * int(numbers[1])
    return cpu, denied


def pids_of(u):
    """The program that leads, the run's process, and its simulators."""
    info = _native.Info()
    library = _native.library()
    library.ob_universe_get_info(u._u, ctypes.byref(info))
    return {os.getpid(), info.host_pid}


class Figure:
    def __init__(self, what, u):
        self.what, self.pids = what, pids_of(u)
        self.wall, self.cpu, self.denied = [], [], []

    def measure(self, times, function, *arguments):
        """Time of each call (us)."""
        cpu, denied = schedule(self.pids)
        began = time.perf_counter()
        for _ in range(times):
            function(*arguments)
        wall = time.perf_counter() - began
        cpu_after, denied_after = schedule(self.pids)
        for list_, seconds in (self.wall, wall), (self.cpu, cpu_after - cpu), (self.denied, denied_after - denied):
            list_.append(1e6 * seconds / times)
        return self.wall[-1]

    def report(self):
        middle = statistics.median
        print(f'{self.what:52} {min(self.wall):8.1f} {middle(self.wall):8.1f} {max(self.wall):8.1f}   CPU {middle(self.cpu):8.1f}   '
              f'denied {middle(self.denied):8.1f}', flush=True)


def compare(what, u, start, one, other):
    """Both from the same state, in turns: the cost of `other` over that of `one`, which makes all steps at once."""
    figures = Figure(what + ': the step itself', u), Figure(what, u)
    over = []
    for _ in range(ROUNDS):
        u.restore(start)
        u.step(3)
        itself = figures[0].measure(1, one) / STEPS
        u.restore(start)
        u.step(3)
        over.append(figures[1].measure(STEPS, other) - itself)
    for list_ in (figures[0].wall, figures[0].cpu, figures[0].denied):
        list_[:] = [x / STEPS for x in list_]
    for figure in figures:
        figure.report()
    print(f'{"  over the step itself":52} {min(over):8.1f} {statistics.median(over):8.1f} {max(over):8.1f}')


def bench_steps(options):
    with obsim.run('falling_boxes', n=1000, options=options) as u:
        u.step(400) # they have landed
        start = u.snapshot()
        words = ' '.join(f'{k} {v}' for k, v in options.items())

        def step_and_read():
            u.step()
            return u.position
        compare(f'step and positions of 1,000, {words}', u, start, lambda: u._call('ob_controller_step', STEPS), step_and_read)
        restore = Figure(f'restore 1,000, {words}', u)
        for _ in range(ROUNDS):
            restore.measure(1, u.restore, start)
            u.step(3)
        restore.report()


def bench_reading(objects):
    with obsim.run('falling_boxes', n=objects, options={'workers': 1}) as u:
        for steps in 5, 120:
            u.step(steps)
            for what, function in (f'positions of {objects:,}', lambda: u.position), (f'states of {objects:,}', u.states):
                figure = Figure(f'{what}, at {u.time:.1f} s', u)
                for _ in range(ROUNDS):
                    figure.measure(20, function)
                figure.report()


def note_steps(name, first, woken):
    """In another process: waits for each step, and notes when it woke (ns)."""
    u = obsim.attach(name)
    for i in range(len(woken)):
        u.wait(first + 1 + i)
        woken[i] = time.monotonic_ns()


def bench_waiting():
    """From a step's end to the return of u.wait in another process. The run goes on in real time; this process reads its
    clock all the time, on a core of its own, and notes when it moves."""
    with obsim.run('falling_boxes', n=10, options={'workers': 1}) as u:
        u.step(10)
        woken = multiprocessing.Array('q', 20 * ROUNDS, lock=False)
        waiter = multiprocessing.Process(target=note_steps, args=(u.universe_name, u.steps, woken))
        waiter.start()
        time.sleep(.5) # it has attached
        first, ended = u.steps, []
        u.go()
        for step in range(first + 1, first + 1 + len(woken)):
            while u.steps < step:
                pass
            ended.append(time.monotonic_ns())
        waiter.join()
        took = sorted(1e-3 * (t - e) for t, e in zip(woken, ended))
        what = "step's end to return of u.wait elsewhere"
        print(f'{what:52} {took[0]:8.1f} {statistics.median(took):8.1f} {took[-1]:8.1f}', flush=True)


POLE = """
scene { step = 1/500 }
box { name = "cart", size = { .4, .2, .1 }, at = { 0, 0, 1 }, mass = 2 }
slider { "cart", name = "rail", axis = { 1, 0, 0 }, motor = { rate = 0, most = 100 } }
box { name = "pole", size = { .05, .05, 1 }, at = { 0, 0, 1.55 }, mass = .5, velocity = { .1, 0, 0 } }
hinge { "pole", "cart", name = "foot", at = { 0, 0, 1.05 }, axis = { 0, 1, 0 } }
"""


def bench_feedback():
    """The cart and pole of docs/control.md at 500 Hz: one feedback a step, outside and within this program in turns; and the
    same exchange without a step, which is all that is not the simulators' own work."""
    with tempfile.NamedTemporaryFile('w', suffix='.lua') as f:
        f.write(POLE)
        f.flush()
        with obsim.run(f.name, options={'workers': 1}) as outside, obsim.run(f.name, inside=True) as inside:
            figures = {(u, steps): Figure(f'{"feedback and step" if steps else "feedback alone"}, {where}', u)
                       for u, where in ((outside, 'outside'), (inside, 'inside')) for steps in (1, 0)}

            def feed_back(u, steps, rail, foot):
                lean, place = u.step(0, read=[foot, rail]).tolist()
                u.step(steps, targets={rail: place[1] + .002 * (60 * lean[0] + 15 * lean[1] + 2 * place[0] + 4 * place[1])})
            for _ in range(ROUNDS):
                for (u, steps), figure in figures.items():
                    figure.measure(STEPS, feed_back, u, steps, u.joints['rail'], u.joints['foot'])
            for figure in figures.values():
                figure.report()


def main():
    print(f'{"us":52} {"fastest":>8} {"median":>8} {"slowest":>8}')
    for options in {'workers': 1}, {'workers': 2}, {'workers': 2, 'isolation': 'process'}:
        bench_steps(options)
    bench_feedback()
    bench_waiting()
    bench_reading(1000)
    bench_reading(10000)


if __name__ == '__main__':
    main()
