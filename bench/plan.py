"""Plan of bench/run.py: scenes, the sides compared in each, and the errors at which they are compared."""

# Sides: the engine of bench_engine, and its options.
SIDES = {
    'obsim': ('obsim', {}),  # in the caller's thread, one worker
    'obsim 1 thread': ('host', {'workers': 1}),
    'obsim 1 process': ('host', {'workers': 1, 'processes': 1}),
    'obsim 2 threads': ('host', {'workers': 2}),
    'obsim 2 processes': ('host', {'workers': 2, 'processes': 1}),
    'obsim ODE worlds': ('obsim-ode', {}),  # each object with an ODE world of its own
    'ode-quick': ('ode-quick', {}),
    'ode-advised': ('ode-advised', {}),
    'ode-hash': ('ode-hash', {}),
    'ode-world': ('ode-world', {}),
    'bullet': ('bullet', {}),
    'mujoco': ('mujoco', {}),
}
POOLS = ['obsim 1 thread', 'obsim 1 process', 'obsim 2 threads', 'obsim 2 processes']
OTHERS = ['ode-quick', 'bullet']

# Scenes at their usual settings: (scene, sides, knobs for all). Scenes that run for less than their own duration have
# it among the knobs. "looks": False if observing every frame would take longer than all else.
FULL = [
    ('sparse-10000', ['obsim', *POOLS, 'ode-quick', 'ode-hash', 'bullet'], {}),
    ('sparse-10000', ['obsim', 'obsim 1 thread', 'ode-quick', 'ode-hash', 'bullet'], {'duration': 3}),
    ('balls-49', ['obsim', 'obsim 1 thread', *OTHERS], {}),
    ('balls-1000', ['obsim', *POOLS, *OTHERS], {}),
    ('stack-10', ['obsim', *POOLS, *OTHERS], {}),
    ('pyramid-15', ['obsim', *POOLS, *OTHERS], {}),
    ('falling-1000', ['obsim', *POOLS, 'ode-quick', 'ode-hash', 'bullet'], {}),
    ('falling-4000', ['obsim', *POOLS, *OTHERS], {}),
    ('pile', ['obsim', *POOLS, *OTHERS], {}),
    ('heavy-1000', ['obsim', 'ode-world', *OTHERS], {}),
    ('hit-wall', ['obsim', *POOLS, *OTHERS, 'ode-advised', 'mujoco'], {}),
    ('rolling-diagonal', ['obsim', *OTHERS], {}),
    ('666', ['obsim', *POOLS, *OTHERS], {}),
    ('falling-10', ['obsim', *POOLS], {}),
    ('sparse-10', ['obsim', *POOLS], {}),
    ('sparse-1000', ['obsim', 'obsim 1 thread', *OTHERS], {'duration': 3}),
    ('sparse-100000', ['obsim', 'obsim 1 thread', *OTHERS], {'duration': 3}),
    ('sparse-100000', ['obsim', 'obsim ODE worlds'], {'duration': .5}),
    ('falling-1000', ['obsim', 'obsim 1 thread', *OTHERS], {'duration': 2}),
    ('falling-10000', ['obsim', 'obsim 1 thread', *OTHERS], {'duration': 2}),
    ('falling-100000', ['obsim', 'obsim 1 thread'], {'duration': 2}),
]
SHORT = [
    ('sparse-2000', ['obsim', 'ode-quick', 'bullet'], {'duration': 2}),
    ('balls-49', ['obsim', *OTHERS], {'duration': 5}),
    ('stack-10', ['obsim', *OTHERS], {'duration': 5}),
    ('pyramid-15', ['obsim', *OTHERS], {'duration': 1}),
    ('falling-200', ['obsim', 'obsim 2 threads', 'obsim 2 processes', *OTHERS], {'duration': 2}),
    ('cylinders-200', ['obsim'], {'duration': 2}),
    ('capsules-200', ['obsim'], {'duration': 2}),
    ('pile', ['obsim', *OTHERS], {'duration': 1}),
    ('heavy-1000', ['obsim', 'ode-world'], {'duration': 5}),
    ('hit-wall', ['obsim', *OTHERS, 'mujoco'], {'duration': 1}),
    ('rolling-diagonal', ['obsim', 'bullet'], {'duration': 4}),
    ('666', ['obsim', *OTHERS], {'duration': 2}),
]
TINY = [  # for the tests
    ('stack-10', ['obsim', 'obsim 2 processes', 'ode-quick'], {'duration': .2}),
    ('falling-8', ['obsim'], {'duration': .2}),
]

# Cheapest setting of each side that keeps errors below bounds: (scene, simulated s for ordering the settings by cost,
# {side: {error: bound}}). It is searched among the knobs below, cheapest first, and then measured like the others.
# obsim has to keep all targets of the lab's case, the others the error of the comparison.
SAG, WORST, GROWTH = 'worst penetration', 'worst penetration at any moment', 'growth of energy'
EQUAL = [
    ('stack-10', 20, {'obsim': {SAG: .5}, 'bullet': {SAG: 1}, 'ode-quick': {SAG: 1}}),
    ('pyramid-15', 5, {'obsim': {SAG: .5, 'drift': 1}, 'bullet': {SAG: 1}, 'ode-quick': {SAG: 1}}),
    ('pile', 5, {'obsim': {WORST: 2, GROWTH: 1e-5, 'settled mean penetration': .5, 'settled worst penetration': 2}}),
    ('falling-1000', 10, {'obsim': {WORST: 20, 'resting mean penetration': .1, GROWTH: 1e-5}}),
    ('heavy-1000', 20, {'obsim': {SAG: 2}, 'ode-world': {SAG: 2}}),
    ('rolling-diagonal', 4, {'obsim': {'mean squared error of velocities': 1e-5}}),
    ('666', 3, {'obsim': {'mean sum of squared penetrations': 1e-5}}),
]
KNOBS = {
    'obsim': [{'substeps': n, 'iterations': i, 'tolerance': 0} for n in (1, 2, 4, 8) for i in (4, 16, 64)] +
             [{'substeps': 1, 'iterations': i, 'tolerance': t} for i in (16, 64) for t in (.02, .01, .005, .002, .001)] +
             [{'substeps': n, 'iterations': 16, 'tolerance': t} for n in (2, 4) for t in (.02, .005, .002)],
    'ode-quick': [{'substeps': n, 'iterations': i} for n in (1, 2, 4, 8, 16) for i in (10, 20, 50)],
    'ode-world': [{'substeps': n} for n in (1, 2, 4, 8)],
    'bullet': [{'substeps': n, 'iterations': i} for n in (1, 2, 4, 8, 16) for i in (5, 10, 20, 50)],
}

# Profile: (scene, from, to, description), one worker, usual settings; whole runs by function; and scenes with the
# critical path for one worker and for two: the duration of their steps on cores of their own.
PARTS = [
    ('falling-1000', 0, 2, 'landing'),
    ('falling-1000', 8, 10, 'at rest'),
    ('sparse-10000', 0, 3, 'in flight'),
    ('sparse-10000', 3, 10, 'rattling to rest'),
    ('stack-10', 0, 20, 'standing'),
]
CRITICAL = [('falling-1000', 10), ('falling-4000', 10)]
# Potential gain of 16 workers, and the serial part of the arranger: (scene, from, to, description).
SHARED = [('falling-10000', 1.2, 2, 'landing'), ('sparse-10000', .1, 3, 'in flight')]
FUNCTIONS = [('falling-1000', 3), ('sparse-10000', 5), ('stack-10', 600)]
