// A visitor's hand: drags an object by a spring from the grabbed point to the pointer, and pushes.
import { turned } from './motion.js';

const INTERVAL = 33; // ms at least between two requests
const PUSH = 15; // m/s2: force of a push by the object's mass

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class Hand {
	constructor(universe, camera) {
		this.universe = universe;
		this.camera = camera;
		this.held = null; // { id, generation, point: in the body's frame, target, plane: { at, normal } }
		this.sentAt = 0;
		this.due = null; // timer of the next request
	}

	// Takes hold of a body at a place on it.
	grab({ id, p, q }, place) {
		const o = this.universe.objects.get(id);
		this.held = { id, generation: o.generation, point: turned(q, add(place, p, -1), -1), target: place, plane: { at: place, normal: this.camera.forward } };
		this.ask();
	}

	// The target follows the pointer, as far away as the grabbed place was.
	move(from, ray) {
		const { at, normal } = this.held.plane, s = dot(add(at, from, -1), normal) / dot(ray, normal);
		if (s > 0)
			this.held.target = add(from, ray, s);
		this.due ??= setTimeout(() => this.held && this.ask(), Math.max(0, this.sentAt + INTERVAL - performance.now()));
	}

	ask() {
		const { id, generation, point, target } = this.held;
		clearTimeout(this.due);
		this.due = null;
		this.sentAt = performance.now();
		this.universe.send({ do: 'drag', id, generation, point, target });
	}

	let() {
		if (this.held)
			this.universe.send({ do: 'release', id: this.held.id });
		clearTimeout(this.due);
		this.held = this.due = null;
	}

	// Pushes away from the viewer, and a little upwards, until it lets go.
	push({ id, generation }, mass) {
		const f = this.camera.forward, flat = Math.hypot(f[0], f[1]) || 1;
		this.universe.send({ do: 'push', id, generation, force: [f[0] / flat, f[1] / flat, 0.3].map((x) => PUSH * mass * x) });
	}

	// The spring, as a line between two dots.
	segments(list) {
		const body = this.held && list.find((b) => b.id === this.held.id);
		if (!body)
			return [];
		const from = add(body.p, turned(body.q, this.held.point)), to = this.held.target, colour = [1, 0.7, 0.33, 1];
		return [{ from, to, colour, width: 2.5, over: true }, { from, to: from, colour, width: 8, over: true }, { from: to, to, colour, width: 8, over: true }];
	}
}
