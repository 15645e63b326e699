"""libobsim by ctypes: the functions of <ob/universe.h>, <ob/motion.h>, <ob/joint.h>, <ob/sensor.h> and <ob/control.h>, as they are declared there."""
import ctypes
import ctypes.util
import os
import pathlib
import shutil

NAME_MAX, DEATH_MAX, ERROR_MAX = 48, 248, 1024


class Error(RuntimeError):
    """What the library or the program says, in one line."""


class Vec3(ctypes.Structure):
    _fields_ = [(c, ctypes.c_double) for c in 'xyz']


class Passport(ctypes.Structure):
    _fields_ = [('id', ctypes.c_uint32), ('generation', ctypes.c_uint32), ('flags', ctypes.c_uint32), ('shape', ctypes.c_uint8),
                ('mesh', ctypes.c_uint8), ('hull', ctypes.c_uint16), ('size', Vec3), ('mass', ctypes.c_double), ('inertia', Vec3),
                ('friction', ctypes.c_double), ('restitution', ctypes.c_double), ('colour', ctypes.c_float * 4),
                ('name', ctypes.c_char * NAME_MAX), ('force', Vec3), ('roughness', ctypes.c_float), ('metal', ctypes.c_float)]


class Pose(ctypes.Structure):
    _fields_ = [('p', Vec3), ('q', ctypes.c_double * 4)]


class JointAxis(ctypes.Structure):
    _fields_ = [*((name, ctypes.c_double) for name in ('low', 'high', 'restitution', 'stiffness', 'rest', 'damping', 'friction')),
                ('motor', ctypes.c_uint32), ('reserved', ctypes.c_uint32),
                *((name, ctypes.c_double) for name in ('target', 'most', 'motor_stiffness', 'motor_damping', 'armature'))]


class Joint(ctypes.Structure):
    _fields_ = [('object', ctypes.c_uint32 * 2), ('generation', ctypes.c_uint32 * 2), ('kind', ctypes.c_uint32),
                ('flags', ctypes.c_uint32), ('frame', Pose * 2), ('length', ctypes.c_double), ('axis', JointAxis), ('second', JointAxis),
                ('breaks_force', ctypes.c_double), ('breaks_torque', ctypes.c_double),
                ('name', ctypes.c_char * NAME_MAX)]


class JointLoad(ctypes.Structure):
    _fields_ = [('force', Vec3), ('torque', Vec3), ('along', ctypes.c_double), ('broke', ctypes.c_uint64)]


class Sensor(ctypes.Structure):
    _fields_ = [*((name, ctypes.c_uint32) for name in ('kind', 'object', 'generation', 'joint', 'width', 'kept')),
                ('first', ctypes.c_uint64), ('seed', ctypes.c_uint64), ('pose', Pose), ('rate', ctypes.c_double), ('delay', ctypes.c_double),
                ('noise', ctypes.c_double * 3 * 2), ('beams', ctypes.c_uint32), ('rows', ctypes.c_uint32),
                *((name, ctypes.c_double) for name in ('fan', 'rise', 'reach')), ('name', ctypes.c_char * NAME_MAX)]


class Info(ctypes.Structure):
    _fields_ = [('name', ctypes.c_char * NAME_MAX), ('isolation', ctypes.c_char * 16), ('arch', ctypes.c_char * 16),
                ('host_pid', ctypes.c_int32), ('capacity', ctypes.c_uint32), ('objects', ctypes.c_uint32),
                ('workers', ctypes.c_uint32), ('gravity', Vec3), ('step_length', ctypes.c_double), ('step', ctypes.c_uint64),
                ('time', ctypes.c_double), ('state', ctypes.c_int), ('awake', ctypes.c_uint32), ('pairs', ctypes.c_uint32),
                ('islands', ctypes.c_uint32), ('deaths', ctypes.c_uint32), ('frozen', ctypes.c_uint32),
                ('last_death', ctypes.c_char * DEATH_MAX), ('hulls', ctypes.c_uint32), ('created', ctypes.c_uint64)]


class Change(ctypes.Structure):
    _fields_ = [('id', ctypes.c_uint32), ('generation', ctypes.c_uint32), ('value', ctypes.c_double * 13)]


class StateArrays(ctypes.Structure):
    _fields_ = [(name, ctypes.c_void_p) for name in ('id', 'generation', 'position', 'attitude', 'velocity', 'angular_velocity')]


def find_program():
    """Path of the program obsim: $OBSIM, or what PATH has."""
    path = os.environ.get('OBSIM') or shutil.which('obsim')
    if not path:
        raise Error('no program obsim: set PATH, or the environment variable OBSIM')
    return path


def _candidates():
    if os.environ.get('OBSIM_LIBRARY'):
        yield os.environ['OBSIM_LIBRARY']
        return
    program = os.environ.get('OBSIM') or shutil.which('obsim')
    if program:
        folder = pathlib.Path(program).resolve().parent
        yield from map(str, [folder / 'include/ob/libobsim.so.0', *sorted(folder.parent.glob('lib*/libobsim.so.0')),
                             *sorted(folder.parent.glob('lib*/*/libobsim.so.0'))])
    yield 'libobsim.so.0'


_pointer, _u32, _u64, _size = ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_size_t
# Requests with a number in src/run/control/packet.h: changes of many objects, whose values are the fields in the order of the table
# of requests (docs/control.md)
_changes = ('set_forces', 'kick', 'set_states', 'set_colours', 'remove', 'set_torques', 'push', 'drag', 'release', 'set_frictions', 'kill',
            'set_motors', 'unjoin', 'set_surface_velocities')
_functions = {
    'ob_universe_attach': (_pointer, [ctypes.c_char_p, _pointer]),
    'ob_universe_detach': (None, [_pointer]),
    'ob_universe_is_hosted': (ctypes.c_bool, [_pointer]),
    'ob_universe_list': (_size, [_pointer, _size]),
    'ob_universe_get_info': (None, [_pointer, _pointer]),
    'ob_universe_wait': (ctypes.c_bool, [_pointer, _u64, ctypes.c_double]),
    'ob_universe_get_passport': (ctypes.c_bool, [_pointer, _u32, _pointer]),
    'ob_universe_get_states': (_size, [_pointer, _pointer, _size]),
    'ob_universe_get_contacts': (_size, [_pointer, _pointer, _size]),
    'ob_universe_get_inside': (_size, [_pointer, _u32, _pointer, _size]),
    'ob_universe_joints': (_u32, [_pointer]),
    'ob_universe_get_joint': (ctypes.c_bool, [_pointer, _u32, _pointer]),
    'ob_universe_get_joint_value': (ctypes.c_bool, [_pointer, _u32, _pointer, _pointer]),
    'ob_universe_get_joint_values': (ctypes.c_bool, [_pointer, _pointer, _size, _pointer]),
    'ob_universe_get_joint_load': (ctypes.c_bool, [_pointer, _u32, _pointer]),
    'ob_universe_sensors': (_u32, [_pointer]),
    'ob_universe_get_sensor': (ctypes.c_bool, [_pointer, _u32, _pointer]),
    'ob_universe_get_samples': (_size, [_pointer, _u32, _u64, _pointer, _pointer, _pointer, _size]),
    'ob_sensor_kind_name': (ctypes.c_char_p, [_u32]),
    'ob_joint_kind_name': (ctypes.c_char_p, [_u32]),
    'ob_shape_name': (ctypes.c_char_p, [ctypes.c_int]),
    'ob_controller_open': (_pointer, [_pointer, _pointer]),
    'ob_controller_open_inside': (_pointer, [_pointer, _size, ctypes.c_char_p, _pointer]),
    'ob_controller_close': (None, [_pointer]),
    'ob_controller_step': (ctypes.c_bool, [_pointer, _u64, _pointer]),
    'ob_controller_step_with': (ctypes.c_bool, [_pointer, _u64, _pointer, _size, _pointer, _size, _pointer]),
    'ob_controller_step_all': (ctypes.c_bool, [_pointer, _size, _u64, ctypes.c_uint, _pointer]),
    'ob_controller_run': (ctypes.c_bool, [_pointer, ctypes.c_double, _pointer]),
    'ob_controller_pause': (ctypes.c_bool, [_pointer, _pointer]),
    'ob_controller_snapshot': (ctypes.c_bool, [_pointer, ctypes.POINTER(_u64), _pointer]),
    'ob_controller_restore': (ctypes.c_bool, [_pointer, _u64, _pointer]),
    'ob_controller_forget': (ctypes.c_bool, [_pointer, _u64, _pointer]),
    **{'ob_controller_' + name: (ctypes.c_bool, [_pointer, _pointer, _size, _pointer]) for name in _changes},
    'ob_controller_set_path': (ctypes.c_bool, [_pointer, _u32, _pointer, _size, ctypes.c_bool, ctypes.c_bool, _pointer]),
    'ob_controller_reset': (ctypes.c_bool, [_pointer, ctypes.POINTER(_u64), _pointer, _size, _pointer]),
    'ob_controller_save': (ctypes.c_bool, [_pointer, ctypes.c_char_p, _pointer]),
    'ob_controller_subscribe_contacts': (ctypes.c_bool, [_pointer, ctypes.c_bool, _pointer]),
    'ob_controller_take_contacts': (ctypes.c_bool, [_pointer, _pointer, _size, ctypes.POINTER(_size), ctypes.POINTER(_u64),
                                                    _pointer]),
    'ob_controller_create': (ctypes.c_bool, [_pointer, ctypes.c_char_p, _pointer, _size, ctypes.POINTER(_size), _pointer]),
    'ob_controller_message': (ctypes.c_bool, [_pointer, _u32, _pointer, _size, _pointer]),
}


def _load():
    tried = []
    for path in _candidates():
        try:
            library = ctypes.CDLL(path)
        except OSError as e:
            tried.append(str(e))
            continue
        for name, (result, arguments) in _functions.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
        return library
    raise Error('no library libobsim: set the environment variable OBSIM_LIBRARY; ' + '; '.join(tried))


_library = None


def library():
    """The library, loaded once."""
    global _library
    _library = _library or _load()
    return _library


def call(name, *arguments):
    """Calls a function whose last argument is an ob_error; raises what that says."""
    error = ctypes.create_string_buffer(ERROR_MAX)
    result = getattr(library(), name)(*arguments, error)
    if not result:
        raise Error(error.value.decode('utf-8', 'replace'))
    return result
