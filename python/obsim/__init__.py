"""obsim from Python: run scenes step by step, change them, read all of their states, and put them back to the bit.

    import obsim
    with obsim.run('falling_boxes', n=100, options={'workers': 2}) as u:
        u.step(60)
        print(u.time, u.position.mean(axis=0))
        start = u.snapshot()
        u['box#3'].force = 0, 0, 20
        u.step(60)
        u.restore(start)

A universe that another program runs is read by obsim.attach(name). Rows of arrays are objects by ascending id: u.id and
u.name say which. Units are SI and radians, vectors are in the world frame (right-handed, z up), quaternions are w, x, y, z.
Arrays are copies. Not thread-safe: use one thread at a time for each universe.
"""
import concurrent.futures
import ctypes
import difflib
import itertools
import os
import subprocess
import sys
import tempfile
import time
import weakref

import numpy

from obsim import _native
from obsim._native import Error

__all__ = ['Batch', 'Error', 'Joint', 'Object', 'Run', 'Sensor', 'Universe', 'Unknown', 'attach', 'batch', 'names', 'run']

CONTACT = numpy.dtype([('a', 'u4'), ('b', 'u4'), ('position', 'f8', 3), ('normal', 'f8', 3), ('impulse', 'f8')])
CONTACT_EVENT = numpy.dtype([('a', 'u4'), ('b', 'u4'), ('step', 'u4'), ('begins', 'u4')])
PIXEL = numpy.dtype({'names': ['depth', 'id', 'colour'], 'formats': ['f4', 'u4', ('u1', 3)], 'offsets': [0, 4, 8], 'itemsize': 12})
CHANGE = numpy.dtype([('id', 'u4'), ('generation', 'u4'), ('value', 'f8', 13)])
POINT = numpy.dtype([('time', 'f8'), ('position', 'f8', 3), ('attitude', 'f8', 4)])
RUN_STEP = numpy.dtype([*((name, 'u8') for name in ('controller', 'universe', 'snapshot', 'motor', 'force', 'motors', 'forces', 'joint',
                                                    'joints', 'values')), ('states', 'u8', 6), ('objects', 'u8'), ('failed', '?'),
                        ('error', 'S1024')], align=True)
COLUMNS = {'id': (numpy.uint32, ()), 'generation': (numpy.uint32, ()), 'position': (float, (3,)), 'attitude': (float, (4,)),
           'velocity': (float, (3,)), 'angular_velocity': (float, (3,))}
_PRESENT, _STATIC, _FROZEN, _KINEMATIC, _SENSOR = 1, 2, 4, 8, 64
_WORLD = 0xffffffff
_SAME = object()
_numbers = itertools.count()
_OPTIONS = {'step', 'seed', 'duration', 'arch', 'isolation', 'workers', 'harden', 'tolerance', 'on_death', 'name', 'room', 'check', 'resume', 'record'}  # all others are settings


def names():
    """Names of the universes that run on this machine, newest first."""
    most = 1000
    list_ = (ctypes.c_char * _native.NAME_MAX * most)()
    n = _native.library().ob_universe_list(list_, most)
    return [list_[i].value.decode() for i in range(min(n, most))]


def attach(name):
    """The running universe of this name, to read."""
    return Universe(name)


class Unknown(Error, KeyError, AttributeError):
    """No object, joint or attribute has this name."""
    __str__ = Exception.__str__


def _unknown(what, name, known):
    """The error, with the most similar of the known names."""
    meant = difflib.get_close_matches(str(name), known, 1)
    return Unknown(f'no {what} {name!r}' + (f', did you mean {meant[0]!r}?' if meant else ''))


class _Strict:
    """Takes no other attributes than it has: a misspelt one would set nothing."""

    def _known(self):
        return [name for name in dir(type(self)) if name[0] != '_']

    def __getattr__(self, name):
        raise _unknown('attribute', name, self._known())

    def __setattr__(self, name, value):
        if name[0] == '_':
            object.__setattr__(self, name, value)
            return
        attribute = getattr(type(self), name, None)
        if attribute is None:
            raise _unknown('attribute', name, self._known())
        if not isinstance(attribute, property) or not attribute.fset:
            raise Error(f'{name} cannot be set')
        attribute.fset(self, value)


class Object(_Strict):
    """One object of a universe. Its values are read when they are asked for, and set at once."""

    def __init__(self, universe, passport):
        self._universe, self._id, self._generation = universe, passport.id, passport.generation

    def __repr__(self):
        return f'<object {self._id} "{self.name}">'

    @property
    def id(self):
        """Another object may have it later: see generation."""
        return self._id

    @property
    def generation(self):
        """Grows each time that the id is given to another object."""
        return self._generation

    def _passport(self):
        p = self._universe._passport(self._id)
        if not p or p.generation != self._generation:
            raise Error(f'object {self._id} has gone')
        return p

    @property
    def exists(self):
        """False once it has gone."""
        p = self._universe._passport(self._id)
        return bool(p) and p.generation == self._generation

    name = property(lambda self: self._passport().name.decode(), doc='As the scene has it.')
    mass = property(lambda self: self._passport().mass, doc='kg; 0 if no force moves it.')
    restitution = property(lambda self: self._passport().restitution, doc='0 to 1.')
    shape = property(lambda self: _native.library().ob_shape_name(self._passport().shape).decode(), doc='"box", for one.')
    size = property(lambda self: _vector(self._passport().size), doc='m: half extents, or radius and half length.')
    inertia = property(lambda self: _vector(self._passport().inertia), doc='Principal moments, kg m^2.')
    static = property(lambda self: bool(self._passport().flags & _STATIC), doc='It never moves.')
    kinematic = property(lambda self: bool(self._passport().flags & _KINEMATIC), doc='It moves as prescribed.')
    group = property(lambda self: self._passport().flags >> 12 & 15, doc='Collision group, 0 to 15.')
    sensor = property(lambda self: bool(self._passport().flags & _SENSOR), doc='It is no obstacle.')
    frozen = property(lambda self: bool(self._passport().flags & _FROZEN), doc='Static since its simulator died.')

    def _row(self, which):
        self._passport()
        states = self._universe.states('id', which)
        return states[which][numpy.searchsorted(states['id'], self._id)]

    def _move(self, **change):
        """Sets some parts of the state, and keeps the others."""
        self._universe.set_states([self._id], **change)

    position = property(lambda self: self._row('position'), lambda self, p: self._move(position=p), doc='m, centre of mass.')
    attitude = property(lambda self: self._row('attitude'), lambda self, q: self._move(attitude=q), doc='w, x, y, z.')
    velocity = property(lambda self: self._row('velocity'), lambda self, v: self._move(velocity=v), doc='m/s.')
    angular_velocity = property(lambda self: self._row('angular_velocity'), lambda self, w: self._move(angular_velocity=w),
                                doc='rad/s.')

    def inside(self):
        """Objects that overlap this sensor now."""
        ids = numpy.empty(len(self._universe.id), numpy.uint32)
        found = _native.library().ob_universe_get_inside(self._universe._u, self._id, ids.ctypes.data, len(ids))
        return [Object(self._universe, p) for p in map(self._universe._passport, ids[:found].tolist()) if p]

    @property
    def force(self):
        """N: a constant force at the centre of mass, beside gravity."""
        return _vector(self._passport().force)

    @force.setter
    def force(self, newtons):
        self._universe.set_forces([self._id], [newtons])

    def _set_torque(self, newton_metres):
        self._universe.set_torques([self._id], [newton_metres])

    torque = property(None, _set_torque, doc='N m: a torque, from now on; to set.')

    @property
    def surface_velocity(self):
        """Of a static or kinematic object: m/s, body frame."""
        p = self._passport()
        return _vector(p.force) if p.flags & (_STATIC | _KINEMATIC) else numpy.zeros(3) # they share memory

    @surface_velocity.setter
    def surface_velocity(self, velocity):
        self._universe.set_surface_velocities([self._id], [velocity])

    @property
    def friction(self):
        """Coulomb coefficient."""
        return self._passport().friction

    @friction.setter
    def friction(self, coefficient):
        self._universe.set_frictions([self._id], coefficient)

    def push(self, force, point=(0, 0, 0)):
        """A force (N) at a point of the body (m, from its centre of mass, body frame), until it is 0 or released."""
        self._universe.push([self._id], [force], [point])

    def drag(self, target, point=(0, 0, 0), frequency=0):
        """A spring from a point of the body to a target (m), until it is released; frequency: Hz, 0 is 3."""
        self._universe.drag([self._id], [target], [point], frequency)

    def release(self):
        """Ends torque, push and drag."""
        self._universe.release([self._id])

    def follow(self, times, positions, attitudes=None, loop=False):
        """A kinematic object's path from now on: from where it stands through positions (m), at times from now (s). With
        attitudes it turns to them; loop: it begins again at the last point, which is where it stands now."""
        self._universe.set_path(self._id, times, positions, attitudes, loop)

    def kill(self):
        """Kills the worker process that simulates it; the run goes on to the same bits."""
        self._universe.kill([self._id])

    @property
    def colour(self):
        """Linear red, green, blue, each 0 to 1, and alpha: 1."""
        return numpy.array(self._passport().colour)

    @colour.setter
    def colour(self, rgba):
        self._universe.set_colours([self._id], [rgba])

    def kick(self, impulse=(0, 0, 0), twist=(0, 0, 0)):
        """Adds an impulse (N s) at the centre of mass and an angular impulse (N m s)."""
        self._universe.kick([self._id], [impulse], [twist])

    def send(self, *words):
        """Sends its script a message: numbers, texts, True and False."""
        self._universe.send(self._id, *words)

    def remove(self):
        """Removes it, and its joints."""
        self._universe.remove([self._id])


class Joint(_Strict):
    """One joint of a universe. Its values are read when they are asked for; its motor's target is set at once."""

    def __init__(self, universe, number, passport):
        self._universe, self._number = universe, number
        self._name, self._kind = passport.name.decode(), _native.library().ob_joint_kind_name(passport.kind).decode()

    def __repr__(self):
        return f'<{self.kind} {self._number} "{self.name}">'

    name = property(lambda self: self._name, doc='As the scene has it.')
    kind = property(lambda self: self._kind, doc='"hinge", for one.')

    def _passport(self):
        p = self._universe._joint(self._number)
        if not p or p.name.decode() != self.name: # another joint may have its number by now
            raise Error(f'joint {self._number} ({self.name}) has ended')
        return p

    def _read(self):
        value, rate = ctypes.c_double(), ctypes.c_double()
        self._passport()
        if not _native.library().ob_universe_get_joint_value(self._universe._u, self._number, ctypes.byref(value), ctypes.byref(rate)):
            raise Error(f'joint {self._number} ({self.name}) has broken, or has no axis')
        return value.value, rate.value

    @property
    def objects(self):
        """Its two objects; one if it is joined to the world."""
        return [self._universe[id_] for id_ in self._passport().object if id_ != _WORLD]

    value = property(lambda self: self._read()[0], doc='Of a hinge rad, of a slider or a distance m.')
    rate = property(lambda self: self._read()[1], doc='rad/s or m/s.')

    def _load(self):
        load = _native.JointLoad()
        self._passport()
        if not _native.library().ob_universe_get_joint_load(self._universe._u, self._number, ctypes.byref(load)):
            raise Error(f'joint {self._number} ({self.name}) has ended')
        return load

    force = property(lambda self: _vector(self._load().force), doc='On its first object (N), world frame, mean over the last step.')
    torque = property(lambda self: _vector(self._load().torque), doc='The same (N m), about the joint\'s origin.')
    along = property(lambda self: self._load().along, doc='Force (N) or torque (N m) along its free axis.')
    broken = property(lambda self: self._load().broke > 0, doc='True once it has broken; force and torque are those that it broke by.')

    @property
    def target(self):
        """Of its motor: the rate that it holds, or the value that it pulls to."""
        return self._passport().axis.target

    @target.setter
    def target(self, target):
        self._universe.set_motors([self], [target])

    def remove(self):
        """Removes it; its objects stay."""
        self._universe.unjoin([self])


class Sensor(_Strict):
    """A sensor of a scene: imu, encoder, force_torque, touch, lidar, camera. It is read as often as you like: values stay until
    the next. A camera's are pixels: arrays (height, width) with the fields depth (m, along the view; infinite: nothing), id (of the
    object; 0xffffffff: none) and colour (red, green, blue, 0 to 255), as value['depth']."""

    def __init__(self, universe, number, passport):
        self._universe, self._number, self._passport = universe, number, passport
        self._name, self._kind = passport.name.decode(), _native.library().ob_sensor_kind_name(passport.kind).decode()

    def __repr__(self):
        return f'<{self.kind} {self._number} "{self.name}">'

    name = property(lambda self: self._name, doc='As the scene has it.')
    kind = property(lambda self: self._kind, doc='"imu", for one.')
    object = property(lambda self: self._universe[self._passport.object], doc='It is fixed to this one.')
    rate = property(lambda self: self._passport.rate, doc='Samples in a second.')
    delay = property(lambda self: self._passport.delay, doc='s, from its instant until a sample can be read.')
    shape = property(lambda self: (self._passport.rows, self._passport.beams) if self._passport.rows > 1 or self.kind == 'camera' else (self._passport.width,),
                     doc='Of the values of a sample: (6,), for one; of a lidar rows and beams, of a camera height and width.')
    angles = property(lambda self: _angles(self._passport), doc='Of a lidar: of its beams in a row, rad, from its x axis to the left. Of a camera: of its view, across and up.')

    def samples(self, after=0, most=None):
        """The samples that are kept, above a number, the newest `most` of them: arrays of numbers, times (s) and values."""
        n, width = self._passport.kept if most is None else most, self._passport.width
        number, time_, values = numpy.empty(n, numpy.uint64), numpy.empty(n), numpy.empty((n, width))
        found = _native.library().ob_universe_get_samples(self._universe._u, self._number, after, number.ctypes.data, time_.ctypes.data,
                                                          values.ctypes.data, n)
        if self.kind == 'camera':
            values = values.view('u1')[:, :PIXEL.itemsize * self._passport.rows * self._passport.beams].view(PIXEL)
        return number[:found], time_[:found], values[:found].reshape(found, *self.shape)

    def _newest(self):
        found = self.samples(0, 1)
        if not len(found[0]):
            raise Error(f'{self.kind} "{self.name}" has no sample yet')
        return found

    value = property(lambda self: self._newest()[2][0], doc='Its newest sample: an array.')
    time = property(lambda self: float(self._newest()[1][0]), doc='s: the instant of that.')


def _angles(p):
    if _native.library().ob_sensor_kind_name(p.kind) == b'camera':
        return numpy.array([p.fan, p.rise])
    i = numpy.arange(p.beams)
    return i * (2 * numpy.pi / p.beams) - numpy.pi if p.fan >= 2 * numpy.pi else numpy.linspace(-p.fan / 2, p.fan / 2, p.beams) if p.beams > 1 else i * 0.


def _rows(column, n, width):
    """n rows of so many numbers, from as many, from one row for all, or from _SAME."""
    if column is _SAME:
        return numpy.nan
    try:
        rows = numpy.asarray(column, float)
    except (TypeError, ValueError):
        rows = None
    if rows is None or rows.shape not in ((width,), (n, width), *(((), (n,)) if width == 1 else ())):
        raise Error(f'expected {width} number{"s" * (width > 1)} for each of {n} object{"s" * (n != 1)}, got {column!r:.80}')
    return rows.reshape(-1, width)


def _vector(v):
    return numpy.array([v.x, v.y, v.z])


class _Named(dict):
    def __init__(self, what, found):
        super().__init__(found)
        self._what = what

    def __missing__(self, name):
        raise _unknown(self._what, name, self)


class Universe(_Strict):
    """A universe, read from shared memory: no request reaches its simulators."""

    def __init__(self, name):
        self._u = _native.call('ob_universe_attach', name.encode())
        self._last = {} # results of states, for their memory
        self._detach = weakref.finalize(self, _native.library().ob_universe_detach, self._u)

    def _info(self):
        info = _native.Info()
        _native.library().ob_universe_get_info(self._u, ctypes.byref(info))
        return info

    def _passport(self, id_):
        p = _native.Passport()
        return p if _native.library().ob_universe_get_passport(self._u, id_, ctypes.byref(p)) else None

    time = property(lambda self: self._info().time, doc='s, simulated.')
    steps = property(lambda self: self._info().step, doc='Steps that are complete.')
    step_length = property(lambda self: self._info().step_length, doc='s.')
    gravity = property(lambda self: _vector(self._info().gravity), doc='m/s^2.')
    deaths = property(lambda self: self._info().deaths, doc='Times that simulators died.')
    universe_name = property(lambda self: self._info().name.decode(), doc='As obsim top shows it.')

    def wait(self, steps, timeout=numpy.inf):
        """Waits until so many steps are complete; False if that takes longer (s), or no further step will come."""
        until = time.monotonic() + timeout
        while not _native.library().ob_universe_wait(self._u, steps, min(.1, max(0, until - time.monotonic()))): # hears Ctrl-C
            if time.monotonic() >= until or self._info().state > 1 or not _native.library().ob_universe_is_hosted(self._u):
                return self.steps >= steps
        return True

    def __len__(self):
        """Number of objects."""
        return _native.library().ob_universe_get_states(self._u, ctypes.byref(_native.StateArrays()), 0)

    def _column(self, name, shape, dtype):
        """Memory for a result: that of the last one if nobody has it any more, as the system takes longest to give new pages."""
        if name not in self._last or self._last[name].shape != shape or sys.getrefcount(self._last[name]) > 2:
            self._last[name] = numpy.empty(shape, dtype)
        return self._last[name]

    def states(self, *which):
        """Arrays by name, of one instant while the universe stands: id, generation, position, attitude, velocity,
        angular_velocity; all unless some are named."""
        n = self._info().objects
        while True:
            arrays = {name: self._column(name, (n, *COLUMNS[name][1]), COLUMNS[name][0]) for name in which or COLUMNS}
            pointers = _native.StateArrays(**{name: a.ctypes.data for name, a in arrays.items()})
            found = _native.library().ob_universe_get_states(self._u, ctypes.byref(pointers), n)
            if found <= n:
                return {name: a[:found] for name, a in arrays.items()}
            n = found

    id = property(lambda self: self.states('id')['id'], doc='Ids, shape (objects,).')
    position = property(lambda self: self.states('position')['position'], doc='m, centres of mass, shape (objects, 3).')
    attitude = property(lambda self: self.states('attitude')['attitude'], doc='Quaternions w, x, y, z, shape (objects, 4).')
    velocity = property(lambda self: self.states('velocity')['velocity'], doc='m/s, shape (objects, 3).')
    angular_velocity = property(lambda self: self.states('angular_velocity')['angular_velocity'],
                                doc='rad/s, shape (objects, 3).')

    @property
    def name(self):
        """Names of the objects, a list in the order of the arrays."""
        return [p.name.decode() if p else '' for p in map(self._passport, self.id.tolist())]

    @property
    def mass(self):
        """kg, shape (objects,); 0: no force moves it."""
        return numpy.array([p.mass if p else 0 for p in map(self._passport, self.id.tolist())])

    @property
    def contacts(self):
        """Contact points of the last step: a structured array of ids a < b, position (m), normal (unit, from b towards a),
        impulse (N s, of the last substep)."""
        n = 256
        while True:
            points = numpy.empty(n, CONTACT)
            found = _native.library().ob_universe_get_contacts(self._u, points.ctypes.data, n)
            if found <= n:
                return points[:found]
            n = found

    def _joint(self, number):
        j = _native.Joint()
        return j if _native.library().ob_universe_get_joint(self._u, number, ctypes.byref(j)) else None

    @property
    def joints(self):
        """Joints by name, of objects that exist."""
        found = ((n, self._joint(n)) for n in range(_native.library().ob_universe_joints(self._u)))
        return _Named('joint', {j.name.decode(): Joint(self, n, j) for n, j in found if j})

    def _sensor(self, number):
        s = _native.Sensor()
        return s if _native.library().ob_universe_get_sensor(self._u, number, ctypes.byref(s)) else None

    @property
    def sensors(self):
        """Sensors by name. (Objects that list who is in them are Object.sensor.)"""
        found = ((n, self._sensor(n)) for n in range(_native.library().ob_universe_sensors(self._u)))
        return _Named('sensor', {s.name.decode(): Sensor(self, n, s) for n, s in found if s})

    def _find(self, key):
        if not isinstance(key, str):
            return self._passport(int(key))
        return next((p for p in map(self._passport, self.id.tolist()) if p and p.name.decode() == key), None)

    def __getitem__(self, key):
        """The object of this id or name."""
        p = self._find(key)
        if not p:
            raise _unknown('object', key, self.name if isinstance(key, str) else [])
        return Object(self, p)

    def __iter__(self):
        """All objects, by ascending id."""
        return (Object(self, p) for p in map(self._passport, self.id.tolist()) if p)

    def __contains__(self, key):
        return self._find(key) is not None

    def _refuse(self, *_arguments, **_named):
        """For universes of this program's own: obsim.run."""
        raise Error('this universe is read only: obsim.run starts one that can be changed')

    step = reset = set_states = set_forces = set_colours = kick = send = remove = create = snapshot = restore = _refuse
    save = picture = watch_contacts = contact_events = set_torques = set_frictions = set_surface_velocities = set_motors = set_path = _refuse
    push = drag = release = kill = _refuse


class Run(Universe):
    """A universe that this program leads. It ends with close, with the end of a with statement, or with this program."""

    def __init__(self, scene, options, program, parameters, resume=None, inside=False):
        self._program = program
        self._options, self._parameters = dict(options or {}), parameters
        self._name = self._options.get('name') or f'python-{os.getpid()}-{next(_numbers)}'
        words = [*([str(scene)] if scene else []), *(['--resume', str(resume)] if resume else []), *self._words(),
                 *([] if 'name' in self._options else ['--name', self._name])]
        self._messages = self._process = self._controller = None
        self._changed = self._joints_read = None, None # as of the last step
        if inside:
            self._begin_inside([word.encode() for word in words])
        else:
            self._begin_outside(words)
        self._start = self.snapshot() if self._options.get('arch') != 'monolith' else None

    def _words(self):
        words = [word for name, value in self._parameters.items() for word in ('-D', f'{name}={_text(value)}')]
        for name, value in self._options.items():
            option = '--' + name.replace('_', '-')
            if name.replace('-', '_') not in _OPTIONS:
                words += ['--set', f"{name.replace('-', '_')}={'on' if value is True else 'off' if value is False else value}"]
            else:
                words += [option] if value is True else [] if value is False else [f'{option}={value}']
        return words

    def _begin_inside(self, words):
        self._controller = _native.call('ob_controller_open_inside', (ctypes.c_char_p * len(words))(*words), len(words),
                                        ctypes.create_string_buffer(_native.NAME_MAX))
        self._stop = weakref.finalize(self, _native.library().ob_controller_close, self._controller)
        super().__init__(self._name)

    def _begin_outside(self, words):
        self._messages = tempfile.TemporaryFile()
        self._process = subprocess.Popen([self._program or _native.find_program(), 'control', *words], stdin=subprocess.DEVNULL,
                                         stdout=subprocess.PIPE, stderr=self._messages, start_new_session=True)
        self._stop = weakref.finalize(self, _stop, self._process, self._messages)
        if not self._process.stdout.readline():
            self._process.wait()
            said = self.messages.strip()
            self._stop()
            raise Error(said or 'the run has ended')
        super().__init__(self._name)
        self._controller = _native.call('ob_controller_open', self._u)

    def _call(self, name, *arguments):
        if not self._controller:
            raise Error('the run is closed')
        try:
            return _native.call(name, self._controller, *arguments)
        except Error as e:
            if str(e) != 'the run has ended' or not self._process:
                raise
            self._process.wait()
            raise Error(self.messages.strip().splitlines()[-1] if self.messages.strip() else str(e)) from None

    @property
    def messages(self):
        """All that the program has said so far: warnings, for one. Empty once the run is closed, and inside."""
        if not self._messages or self._messages.closed:
            return ''
        self._messages.seek(0)
        return self._messages.read().decode('utf-8', 'replace')

    # -- time

    def step(self, n=1, targets=None, forces=None, read=None):
        """Runs n steps. Before, in the same exchange, the motors of joints get targets, {joint: number}, and objects constant
        forces, {object: (x, y, z)}, N. read: joints, of which it then returns values and rates, an array (joints, 2)."""
        if targets or forces:
            self._step_with(min(n, 1), targets or {}, forces or {})
            n -= 1
        _in_pieces(n, lambda now: self._call('ob_controller_step', now))
        return None if read is None else self._read_joints(read)

    def _step_with(self, n, targets, forces):
        key = (*targets, *forces)
        if key != self._changed[0]: # the same are changed each time, as a rule
            changes = (_native.Change * len(key))()
            for change, joint in zip(changes, targets):
                change.id, change.value[0] = joint._passport().object[0], joint._number
            for change, object_ in zip(changes[len(targets):], forces):
                change.id, change.generation = object_._id, object_._generation
            self._changed = key, changes
        changes = self._changed[1]
        try:
            for change, target in zip(changes, targets.values()):
                change.value[1] = target
            for change, force in zip(changes[len(targets):], forces.values()):
                change.value[0], change.value[1], change.value[2] = force
        except (TypeError, ValueError) as e:
            raise Error(f'expected a number for each joint and three for each object: {e}') from None
        self._call('ob_controller_step_with', n, changes, len(targets),
                   ctypes.byref(changes, len(targets) * ctypes.sizeof(_native.Change)), len(forces))

    def _read_joints(self, joints):
        joints = tuple(joints)
        if joints != self._joints_read[0]:
            for joint in joints:
                joint._passport() # it has not ended
            self._joints_read = joints, (ctypes.c_uint32 * len(joints))(*(joint._number for joint in joints))
        values = numpy.empty((len(joints), 2))
        if not _native.library().ob_universe_get_joint_values(self._u, self._joints_read[1], len(joints), values.ctypes.data):
            raise Error('a joint that is read has ended, has broken, or has no axis')
        return values

    def run_until(self, seconds):
        """Runs steps up to the first at or after this simulated time."""
        h = self.step_length
        self.step(max(0, int(numpy.ceil(seconds / h - 1e-6)) - self.steps))

    def go(self, pace=1.):
        """Lets the run go on by itself, at so many simulated seconds a second (numpy.inf: as fast as it can), until it is
        paused or stepped."""
        self._call('ob_controller_run', pace)

    def pause(self):
        """Ends what go began, at the next step boundary."""
        self._call('ob_controller_pause')

    def reset(self, seed=None, **parameters):
        """Begins again: in the same state, or as the scene makes it of a seed, and of parameters in place of those of the
        same names. Snapshots are lost then, and objects from before must be looked up again."""
        if seed is None and not parameters and self._start is not None:
            self.restore(self._start)
            return
        words = [f'{name}={_text(value)}'.encode() for name, value in parameters.items()]
        self._call('ob_controller_reset', None if seed is None else ctypes.byref(ctypes.c_uint64(seed)),
                   (ctypes.c_char_p * len(words))(*words), len(words))
        self._detach()
        super().__init__(self._name)
        self._start = self.snapshot() if self._options.get('arch') != 'monolith' else None

    def save(self, path):
        """Writes the state into a checkpoint file, from which obsim.run(resume=path) and obsim run --resume go on."""
        self._call('ob_controller_save', os.fsencode(os.path.abspath(path)))

    def picture(self, width=640, height=360, camera=None, quality='draft'):
        """The present state as the renderer draws it: an array (height, width, 3) of red, green and blue, 0 to 255. Another
        process draws it, from a saved state, in about half a second."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'state.ck')
            self.save(path)
            h, now = self.step_length, self.steps
            words = [self._program or _native.find_program(), 'run', '--resume', path, '--duration', repr((now + 1.5) * h), '--fps', repr(1 / h),
                     '--out', '-', '--workers', '1', '--size', f'{width}x{height}', '--quality', quality, *(['--camera', camera] if camera else [])]
            done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=False)
        if done.returncode != 0 or len(done.stdout) < 3 * width * height:
            raise Error(done.stderr.decode('utf-8', 'replace').strip().splitlines()[-1] if done.stderr else 'no picture')
        return numpy.frombuffer(done.stdout, numpy.uint8, 3 * width * height).reshape(height, width, 3)

    # -- contacts

    def watch_contacts(self, on=True):
        """Notes the contacts that begin and end in each step from now on, for contact_events."""
        self._call('ob_controller_subscribe_contacts', on)

    def contact_events(self):
        """Takes what was noted, oldest first: a structured array of ids a < b, the step, begins (or it ended)."""
        parts, n, lost = [], ctypes.c_size_t(), ctypes.c_uint64()
        while not parts or len(parts[-1]) == len(events):
            events = numpy.empty(1 << 14, CONTACT_EVENT)
            self._call('ob_controller_take_contacts', events.ctypes.data, len(events), ctypes.byref(n), ctypes.byref(lost))
            if lost.value:
                raise Error(f'{lost.value} contact events were lost: take them more often')
            parts.append(events[:n.value])
        return numpy.concatenate(parts)

    # -- snapshots

    def snapshot(self):
        """Keeps the whole state in memory; returns its number."""
        number = ctypes.c_uint64()
        self._call('ob_controller_snapshot', ctypes.byref(number))
        return number.value

    def restore(self, snapshot):
        """Puts the state back, to the bit, with all objects, scripts and the clock."""
        self._call('ob_controller_restore', snapshot)

    def forget(self, snapshot):
        """Frees the memory of a snapshot."""
        self._call('ob_controller_forget', snapshot)

    # -- changes: ids is a list or array of ids, the others have a row for each

    def _change(self, function, ids, *columns):
        ids = numpy.atleast_1d(numpy.asarray(ids, numpy.uint32))
        changes = numpy.zeros(len(ids), CHANGE)
        changes['id'] = ids
        at = 0
        for column, width in columns:
            changes['value'][:, at:at + width] = _rows(column, len(ids), width)
            at += width
        self._call(function, changes.ctypes.data, len(changes))

    def set_forces(self, ids, force):
        """Constant external forces (N) at the centres of mass, from now on."""
        self._change('ob_controller_set_forces', ids, (force, 3))

    def kick(self, ids, impulse, twist=(0, 0, 0)):
        """Impulses (N s) and angular impulses (N m s)."""
        self._change('ob_controller_kick', ids, (impulse, 3), (twist, 3))

    def set_torques(self, ids, torque):
        """Torques (N m), from now on."""
        self._change('ob_controller_set_torques', ids, (torque, 3))

    def push(self, ids, force, point=(0, 0, 0)):
        """Forces (N) at points of bodies (m, from the centre of mass, body frame), from now on."""
        self._change('ob_controller_push', ids, (force, 3), (point, 3))

    def drag(self, ids, target, point=(0, 0, 0), frequency=0):
        """Springs from points of bodies to targets (m), from now on."""
        self._change('ob_controller_drag', ids, (target, 3), (point, 3), (frequency, 1))

    def release(self, ids):
        """Ends torques, pushes and drags."""
        self._change('ob_controller_release', ids)

    def set_frictions(self, ids, coefficient):
        """Coulomb coefficients. The contacts of these objects begin anew."""
        self._change('ob_controller_set_frictions', ids, (coefficient, 1))

    def set_surface_velocities(self, ids, velocity):
        """Velocities of the surfaces of static and kinematic objects, as of belts (m/s, body frame)."""
        self._change('ob_controller_set_surface_velocities', ids, (velocity, 3))

    def unjoin(self, joints):
        """Removes joints."""
        self._change('ob_controller_unjoin', [j._passport().object[0] for j in joints], ([[j._number] for j in joints], 1))

    def set_motors(self, joints, target):
        """Targets of the motors of joints: rates that they hold, or values that they pull to."""
        numbers = [[j._number] for j in joints]
        self._change('ob_controller_set_motors', [j._passport().object[0] for j in joints], (numbers, 1),
                     (target, 1))

    def set_path(self, id_, times, positions, attitudes=None, loop=False):
        """Path of a kinematic object from now on: Object.follow has the arguments."""
        points = numpy.zeros(len(times), POINT)
        points['time'], points['position'] = times, _rows(positions, len(times), 3)
        points['attitude'] = _rows((1, 0, 0, 0) if attitudes is None else attitudes, len(times), 4)
        self._call('ob_controller_set_path', id_, points.ctypes.data, len(points), attitudes is not None, loop)

    def kill(self, ids):
        """Kills the worker processes that simulate these objects."""
        self._change('ob_controller_kill', ids)

    def set_states(self, ids, position=_SAME, attitude=_SAME, velocity=_SAME, angular_velocity=_SAME):
        """States to go on from, also of static and kinematic objects; a part that is left away stays as it is. Their
        contacts end."""
        self._change('ob_controller_set_states', ids, (position, 3), (attitude, 4), (velocity, 3), (angular_velocity, 3))

    def set_colours(self, ids, rgba):
        """Linear red, green, blue, 0 to 1, and alpha: 1."""
        self._change('ob_controller_set_colours', ids, (rgba, 4))

    def remove(self, ids):
        """Removes objects, and their joints."""
        self._change('ob_controller_remove', ids)

    def create(self, text):
        """Creates objects as scenes do: 'box { size = { 1, 1, 1 }, at = { 0, 0, 5 } }'. Returns them."""
        most = 1000
        ids, n = (ctypes.c_uint32 * most)(), ctypes.c_size_t()
        self._call('ob_controller_create', text.encode(), ids, most, ctypes.byref(n))
        return [self[ids[i]] for i in range(min(n.value, most))]

    def send(self, id_, *words):
        """Sends the script of an object a message: numbers, texts, True and False."""
        texts = [_text(w).encode() for w in words]
        self._call('ob_controller_message', id_, (ctypes.c_char_p * len(texts))(*texts), len(texts))

    # -- the end

    def close(self):
        """Ends the run; again has no effect."""
        if self._controller and self._process:
            _native.library().ob_controller_close(self._controller)
        self._controller = None
        self._stop()

    def __enter__(self):
        return self

    def __exit__(self, *_what):
        self.close()


class Batch(_Strict):
    """Universes of one scene within this program, which threads step side by side. Arrays have a row for each universe.
    b[0] is the first of them, as obsim.run returns it."""

    def __init__(self, scene, n, threads, seeds, options, parameters):
        self._threads = threads or len(os.sched_getaffinity(0))
        how = [options or {}] * n if seeds is None else [{**(options or {}), 'seed': int(s)} for s in self._one_each(seeds, n)]
        self._runs = self._each(lambda o: Run(scene, o, None, parameters, None, True), how)
        self._attach()

    @staticmethod
    def _one_each(values, n):
        if len(values) != n:
            raise Error(f'expected one for each of {n} universes, got {len(values)}')
        return values

    def _each(self, function, *columns):
        """Results of a function of each row, by the threads."""
        with concurrent.futures.ThreadPoolExecutor(self._threads) as threads:
            return list(threads.map(function, *columns))

    def _attach(self):
        self._base = numpy.zeros(len(self), RUN_STEP) # the rows of any call
        self._base['controller'], self._base['universe'] = [r._controller for r in self._runs], [r._u for r in self._runs]
        self._plan = None # names, and changes and joints of these

    def __len__(self):
        """Number of universes."""
        return len(self._runs)

    def __getitem__(self, k):
        """Universe k."""
        return self._runs[k]

    def __iter__(self):
        """All universes."""
        return iter(self._runs)

    def _call(self, rows, steps):
        if not all(r._controller for r in self._runs):
            raise Error('a universe of the batch is closed')
        try:
            _native.call('ob_controller_step_all', rows.ctypes.data, len(rows), steps, self._threads)
        except Error:
            self._plan = None # it may name what has gone
            raise

    def _look_up(self, targets, forces, read):
        """The rows of a step with these names: changes of each universe, and numbers and values of joints."""
        names_ = targets, forces, read
        if self._plan and self._plan[0] == names_:
            return self._plan[1:]
        changes = numpy.zeros((len(self), len(targets) + len(forces)), CHANGE)
        numbers = numpy.zeros((len(self), len(read)), numpy.uint32)
        for r, change, number in zip(self._runs, changes, numbers):
            joints = r.joints if targets or read else {}
            number[:] = [joints[name]._number for name in read]
            for c, name in zip(change, targets):
                c['id'], c['value'][0] = joints[name]._passport().object[0], joints[name]._number
            for c, name in zip(change[len(targets):], forces):
                c['id'], c['generation'] = r[name]._id, r[name]._generation
        values = numpy.empty((len(self), len(read), 2))
        rows, k = self._base.copy(), numpy.arange(len(self), dtype=numpy.uint64)
        rows['motor'], rows['joints'], rows['joint'], rows['values'] = _at(changes, k), len(read), _at(numbers, k), _at(values, k)
        rows['force'] = rows['motor'] + len(targets) * CHANGE.itemsize
        self._plan = names_, rows, numbers, changes['value'], values
        return self._plan[1:]

    def step(self, n=1, targets=None, forces=None, read=()):
        """Runs n steps of all. Before, motors get targets, {joint's name: one number, or one a universe}, and objects constant
        forces, {object's name: (x, y, z), or one row a universe}, N. Returns values and rates of the joints that read names, an
        array (universes, joints, 2)."""
        targets, forces = targets or {}, forces or {}
        rows, _, changes, values = self._look_up(tuple(targets), tuple(forces), tuple(read))
        for k, target in enumerate(targets.values()):
            changes[:, k, 1] = _rows(target, len(self), 1)[:, 0]
        for k, force in enumerate(forces.values(), len(targets)):
            changes[:, k, :3] = _rows(force, len(self), 3)
        rows['motors'], rows['forces'] = len(targets), len(forces)
        self._call(rows, min(n, 1))
        if n > 1:
            rows['motors'] = rows['forces'] = 0
            _in_pieces(n - 1, lambda steps: self._call(rows, steps))
        return values.copy()

    def states(self, *which):
        """Arrays by name as those of Universe.states, with a first axis more."""
        n, rows, k = len(self._runs[0]), self._base.copy(), numpy.arange(len(self), dtype=numpy.uint64)
        arrays = {name: numpy.empty((len(self), n, *COLUMNS[name][1]), COLUMNS[name][0]) for name in which or COLUMNS}
        for name, a in arrays.items():
            rows['states'][:, list(COLUMNS).index(name)] = _at(a, k)
        rows['objects'] = n
        self._call(rows, 0)
        if (rows['objects'] != n).any():
            raise Error('these universes have different numbers of objects: read one by one, as b[0].position')
        return arrays

    id = property(lambda self: self.states('id')['id'], doc='Ids, shape (universes, objects).')
    position = property(lambda self: self.states('position')['position'], doc='m, shape (universes, objects, 3).')
    attitude = property(lambda self: self.states('attitude')['attitude'], doc='w, x, y, z, shape (universes, objects, 4).')
    velocity = property(lambda self: self.states('velocity')['velocity'], doc='m/s, shape (universes, objects, 3).')
    angular_velocity = property(lambda self: self.states('angular_velocity')['angular_velocity'],
                                doc='rad/s, shape (universes, objects, 3).')
    time = property(lambda self: numpy.array([r.time for r in self._runs]), doc='s, shape (universes,).')

    def snapshot(self):
        """Keeps all states in memory; returns their numbers, one a universe."""
        return numpy.array([r.snapshot() for r in self._runs], numpy.uint64)

    def restore(self, snapshots, mask=None):
        """Puts states back, to the bit: of all, or of the universes for which the mask is true."""
        rows = self._base.copy()
        rows['snapshot'] = self._one_each(snapshots, len(self))
        rows = rows if mask is None else rows[numpy.asarray(self._one_each(mask, len(self)), bool)]
        self._call(rows, 0)

    def forget(self, snapshots):
        """Frees the memory of snapshots."""
        for r, number in zip(self._runs, snapshots):
            r.forget(int(number))

    def reset(self, mask=None, seeds=None):
        """Begins again: all, or the universes for which the mask is true, in the same states, or as the scene makes them of
        seeds, one a universe. Snapshots of these universes are lost then."""
        if seeds is None:
            self.restore(numpy.array([r._start for r in self._runs], numpy.uint64), mask)
            return
        chosen = numpy.flatnonzero(numpy.ones(len(self)) if mask is None else self._one_each(mask, len(self)))
        self._one_each(seeds, len(self))
        self._each(lambda k: self._runs[k].reset(int(seeds[k])), chosen)
        self._attach()

    def close(self):
        """Ends all; again has no effect."""
        for r in self._runs:
            r.close()

    def __enter__(self):
        return self

    def __exit__(self, *_what):
        self.close()


def _at(array, k):
    """Addresses of rows k."""
    return array.ctypes.data + k * numpy.uint64(array.strides[0])


def _in_pieces(n, step):
    """Makes n steps by several calls, so that Ctrl-C is heard between two."""
    piece = 1
    while n > 0:
        now = min(n, piece)
        began = time.perf_counter()
        step(now)
        n -= now
        piece = piece * 2 if time.perf_counter() - began < .1 else max(piece // 2, 1)


def _text(value):
    return {True: 'true', False: 'false'}[value] if isinstance(value, bool) else str(value)


def _stop(process, messages):
    """Waits until the run has ended; a run that nobody controls any more ends by itself."""
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.terminate()
        process.wait()
    process.stdout.close()
    messages.close()


def run(scene=None, options=None, program=None, resume=None, inside=False, **parameters):
    """Starts a scene, a path or the name of one that comes with obsim, and takes control of it. Keyword arguments are the
    scene's parameters; options are those of obsim control and its settings (--set), as {'workers': 2, 'harden': True,
    'solver': 'jacobi'}. resume: a checkpoint file to go on from, in place of a scene. inside: the universe is in this program, whose thread is its only worker: steps are
    function calls; it has no processes, so nothing can be killed, and goes on by its steps alone."""
    return Run(scene, options, program, parameters, resume, inside)


def batch(scene, n, /, threads=None, seeds=None, options=None, **parameters):
    """Starts n universes of a scene within this program, each the same as one of obsim.run(scene, inside=True), to the bit.
    threads that step them: one a core, if not told otherwise; seeds: one for each universe. The rest is as for obsim.run."""
    return Batch(scene, n, threads, seeds, options, parameters)
