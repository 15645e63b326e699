"""Entity state PDUs of a running universe, for simulators that speak DIS (IEEE 1278.1-2012, version 7), by UDP.

    python3 -m obsim.dis NAME [--to ADDRESS:PORT] [--exercise N] [--origin LATITUDE,LONGITUDE,ALTITUDE]

An entity is sent when what receivers extrapolate (dead reckoning model 4: constant acceleration and spin, world coordinates) is
off by a centimetre or a degree, every five seconds otherwise, and, when its object has gone, once more as deactivated. x is
east, y north and z up at the origin (degrees, m above the ellipsoid WGS 84), and the front of an entity is its x axis. The
number of an entity is 1 + the object's id, in application 1; ids from 65,533 on begin anew at 1 in application 2, and so on.
Planes are no entities. Reads the universe alone: no simulator waits for it.
"""
import argparse
import socket
import struct
import sys
import time
from typing import Any, Optional, Sequence

import numpy

import obsim
from obsim import _native

PDU = struct.Struct('>BBBBIHBB HHH BB BBHBBBB BBHBBBB 3f 3d 3f I B15s3f3f B11s I') # 144 bytes
ENTITY_STATE, FAMILY, VERSION, MODEL_RVW, DEACTIVATED = 1, 1, 7, 4, 1 << 23
SITE, PORT = 1, 3000
NUMBERS = 65533 # of an application, from 1; 0 and what is left of 16 bits have meanings of their own
NEAR, ALIKE, HEARTBEAT = .01, numpy.radians(1), 5. # m, rad, s
PERIOD = 1 / 60 # s between two looks at the universe
MAJOR, FLATTENING = 6378137., 1 / 298.257223563 # WGS 84


class Place:
    """Turns and moves the universe's frame to geocentric coordinates."""

    def __init__(self, latitude: float = 0., longitude: float = 0., altitude: float = 0.) -> None:
        a, o = numpy.radians([latitude, longitude])
        squared = FLATTENING * (2 - FLATTENING)
        normal = MAJOR / numpy.sqrt(1 - squared * numpy.sin(a) ** 2)
        up = numpy.array([numpy.cos(a) * numpy.cos(o), numpy.cos(a) * numpy.sin(o), numpy.sin(a)])
        east = numpy.array([-numpy.sin(o), numpy.cos(o), 0])
        self.turn = numpy.stack([east, numpy.cross(up, east), up], axis=1)
        self.at = (normal + altitude) * up - [0, 0, squared * normal * numpy.sin(a)]

    def position(self, p: numpy.ndarray) -> numpy.ndarray:
        """Geocentric coordinates (m) of a point."""
        return self.at + p @ self.turn.T

    def vector(self, v: numpy.ndarray) -> numpy.ndarray:
        """A vector in the geocentric frame."""
        return v @ self.turn.T

    def angles(self, q: numpy.ndarray) -> tuple[float, float, float]:
        """psi, theta, phi of an entity's frame (front, right, down) with the attitude q in the universe."""
        r = self.turn @ matrix(q) @ numpy.diag([1., -1, -1])
        return numpy.arctan2(r[1, 0], r[0, 0]), -numpy.arcsin(numpy.clip(r[2, 0], -1, 1)), numpy.arctan2(r[2, 1], r[2, 2])


def matrix(q: numpy.ndarray) -> numpy.ndarray:
    """Rotation of a quaternion."""
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def product(a: numpy.ndarray, b: numpy.ndarray) -> numpy.ndarray:
    """Quaternion a b."""
    return numpy.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + numpy.cross(a[1:], b[1:]))])


class Entity:
    """An object as receivers know it."""

    def __init__(self, name: str) -> None:
        self.name, self.sent = name, -numpy.inf
        self.time = self.position = self.velocity = self.acceleration = self.attitude = self.spin = None # type: Any

    def set(self, now: float, state: Sequence[numpy.ndarray], acceleration: numpy.ndarray) -> None:
        """Keeps what receivers are sent."""
        self.time, self.sent = now, time.monotonic()
        self.position, self.attitude, self.velocity, self.spin = state
        self.acceleration = acceleration

    def is_off(self, now: float, state: Sequence[numpy.ndarray]) -> bool:
        """True if extrapolation is off by too much."""
        if self.time is None or now < self.time or time.monotonic() - self.sent > HEARTBEAT:
            return True
        dt = now - self.time
        position = self.position + dt * self.velocity + .5 * dt * dt * self.acceleration
        angle = numpy.linalg.norm(self.spin) * dt
        axis = self.spin / (numpy.linalg.norm(self.spin) or 1)
        attitude = product(numpy.array([numpy.cos(angle / 2), *(numpy.sin(angle / 2) * axis)]), self.attitude)
        between = 2 * numpy.arccos(min(1, abs(attitude @ state[1])))
        return bool(numpy.linalg.norm(position - state[0]) > NEAR or between > ALIKE)


class Sender:
    """Sends a universe's entities; look sends what is due now."""

    def __init__(self, universe: obsim.Universe, address: tuple[str, int], exercise: int = 1, place: Optional[Place] = None) -> None:
        self._u, self._address, self._exercise, self._place = universe, address, exercise, place or Place()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._known: dict[tuple[int, int], Entity] = {}
        self._last: Any = None

    def look(self) -> int:
        """Returns the number of PDUs sent."""
        now, states, sent = self._u.time, self._u.states(), 0
        objects = list(zip(states['id'].tolist(), states['generation'].tolist()))
        before, self._last = self._last, (now, dict(zip(objects, states['velocity'])))
        for gone in set(self._known) - set(objects):
            self._send(gone[0], self._known.pop(gone), DEACTIVATED)
            sent += 1
        for i, object_ in enumerate(objects):
            entity = self._known.get(object_) or self._meet(*object_)
            if not entity:
                continue
            state = [states[name][i] for name in ('position', 'attitude', 'velocity', 'angular_velocity')]
            if entity.is_off(now, state):
                acceleration = (state[2] - before[1][object_]) / (now - before[0]) if before and now > before[0] and \
                    object_ in before[1] else numpy.zeros(3)
                entity.set(now, state, acceleration)
                self._send(object_[0], entity, 0)
                sent += 1
        return sent

    def _meet(self, id_: int, generation: int) -> Optional[Entity]:
        """The entity of a new object; None: it is none, or has gone since its state was read."""
        p = self._u._passport(id_)
        if not p or p.generation != generation or _native.library().ob_shape_name(p.shape) == b'plane':
            return None
        entity = self._known[id_, generation] = Entity(p.name.decode())
        return entity

    def _send(self, id_: int, e: Entity, appearance: int) -> None:
        stamp = int(e.time % 3600 / 3600 * 2 ** 31) << 1 # relative
        place, marking = self._place, e.name.encode('ascii', 'replace')[:11]
        self._socket.sendto(PDU.pack(
            VERSION, self._exercise, ENTITY_STATE, FAMILY, stamp, PDU.size, 0, 0, SITE, 1 + id_ // NUMBERS,
            1 + id_ % NUMBERS, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, *place.vector(e.velocity), *place.position(e.position),
            *place.angles(e.attitude), appearance, MODEL_RVW, bytes(15), *place.vector(e.acceleration),
            *(matrix(e.attitude).T @ e.spin * [1, -1, -1]), 1, marking, 0), self._address)

    def close(self) -> None:
        """Closes its socket."""
        self._socket.close()


def main() -> None:
    """Sends the entities of a universe until it ends."""
    p = argparse.ArgumentParser(prog='python3 -m obsim.dis', description=__doc__.split('\n', 1)[0])
    p.add_argument('name', help='of the universe, as obsim top shows it')
    p.add_argument('--to', default=f'127.0.0.1:{PORT}', help='address and port (127.0.0.1:3000)')
    p.add_argument('--exercise', type=int, default=1, choices=range(1, 256), metavar='N', help='identifier of the exercise (1)')
    p.add_argument('--origin', default='0,0,0', help='latitude, longitude (degrees), altitude (m)')
    a = p.parse_args()
    try:
        host, port = a.to.rsplit(':', 1)
        place = Place(*map(float, a.origin.split(',')))
        sender = Sender(obsim.attach(a.name), (host, int(port)), a.exercise, place)
        while sender._u._info().state <= 1:
            sender.look()
            time.sleep(PERIOD)
    except (obsim.Error, OSError, ValueError, TypeError) as e:
        sys.exit(f'obsim.dis: {e}')
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
