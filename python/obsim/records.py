"""Records of runs (obsim run --record) as NumPy arrays or pandas data frames. Needs h5py; data frames need pandas.

    record = Record('boxes.h5')
    record.time, record.position        # s, shape (states,); m, shape (states, ids, 3)
    record.frame('position', 'velocity').query('name == "box#3"').plot('time', 'position_z')
"""
from typing import Any

import numpy

COLUMNS = {'position': 'xyz', 'attitude': 'wxyz', 'velocity': 'xyz', 'angular_velocity': 'xyz', 'asleep': ''}
EVENTS = {1: 'came', 2: 'changed', 3: 'went'}


class Record:
    """A record as arrays, read when they are asked for. Rows are recorded states, columns are ids; NaN: no such object then."""

    def __init__(self, path: Any) -> None:
        import h5py # pylint: disable=import-outside-toplevel
        self._file = h5py.File(path, 'r')
        if self._file.attrs.get('format') not in ('obsim record', b'obsim record') or self._file.attrs['format_version'] != 2:
            raise ValueError(f'{path}: expected an obsim record of version 2')

    time = property(lambda self: self._file['time'][:], doc='s, shape (states,).')
    step = property(lambda self: self._file['step'][:], doc='Steps that were complete, shape (states,).')
    position = property(lambda self: self._file['position'][:], doc='m, centres of mass, shape (states, ids, 3).')
    attitude = property(lambda self: self._file['attitude'][:], doc='Quaternions w, x, y, z, shape (states, ids, 4).')
    velocity = property(lambda self: self._file['velocity'][:], doc='m/s, shape (states, ids, 3).')
    angular_velocity = property(lambda self: self._file['angular_velocity'][:], doc='rad/s, shape (states, ids, 3).')
    asleep = property(lambda self: self._file['asleep'][:], doc='1: asleep, 255: no such object; shape (states, ids).')

    @property
    def name(self) -> list[str]:
        """Names of the last objects that had each id."""
        return [n.decode() for n in self._file['objects/name'][:]]

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the run, and facts of the file, by name."""
        both = {**self._file.attrs, **self._file['settings'].attrs}
        return {name: value.decode() if isinstance(value, bytes) else value for name, value in both.items()}

    def frame(self, *which: str) -> Any:
        """A data frame with a line for each state and object that exists then: time, step, id, name, and columns of what is
        named: position (the default), attitude, velocity, angular_velocity, asleep."""
        import pandas # pylint: disable=import-outside-toplevel
        there = self.asleep != 255
        state, id_ = numpy.nonzero(there)
        names = numpy.array(self.name, object)
        columns = {'time': self.time[state], 'step': self.step[state], 'id': id_, 'name': names[id_]}
        for quantity in which or ('position',):
            values = self._file[quantity][:][there]
            parts = COLUMNS[quantity]
            columns.update({f'{quantity}_{c}': values[:, i] for i, c in enumerate(parts)} if parts else {quantity: values})
        return pandas.DataFrame(columns)

    def events(self) -> Any:
        """A data frame of the objects that came, changed and went."""
        import pandas # pylint: disable=import-outside-toplevel
        e = self._file['events'][:]
        return pandas.DataFrame({'time': e['time'], 'step': e['step'], 'id': e['id'], 'generation': e['generation'],
                                 'name': [n.decode() for n in e['name']], 'what': [EVENTS[k] for k in e['kind']]})

    def samples(self, sensor: str) -> Any:
        """Samples of a sensor: arrays of numbers, times (s) and values, shape (samples, width); of a camera pixels, shape (samples,
        height, width), with the fields depth (m), id and colour (red, green, blue, alpha)."""
        known = [n.decode() for n in self._file['sensors']['name']] if 'sensors' in self._file else []
        if sensor not in known:
            raise KeyError(f'no sensor {sensor!r}, expected one of {known}')
        about = self._file['sensors'][known.index(sensor)]
        width = int(about['width'])
        rows = self._file['samples'][:]
        rows = rows[rows['sensor'] == known.index(sensor)]
        whole = rows[rows['first'] == 0]
        if about['kind'] == 5: # a camera
            shape = int(about['rows']), int(about['beams'])
            first, n = whole['value'][:, 0].astype(int), shape[0] * shape[1]
            pixels = [self._file['pixels'][f:f + n].reshape(shape) for f in first]
            return whole['number'], whole['time'], numpy.array(pixels) if pixels else numpy.empty((0, *shape), self._file['pixels'].dtype)
        return whole['number'], whole['time'], rows['value'].reshape(len(whole), -1)[:, :width]

    def close(self) -> None:
        """Closes the file."""
        self._file.close()

    def __enter__(self) -> 'Record':
        return self

    def __exit__(self, *_what: Any) -> None:
        self.close()
