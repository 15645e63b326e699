// A viewer's own viewpoint: it orbits a target (drag), moves (right button, shift, two fingers, arrows), turns its head
// (alt, or keys), comes nearer and goes away (wheel, pinch). Until the user moves it, an automatic one follows moving
// objects.
import { turned } from './motion.js';

const STEEPEST = 89 * Math.PI / 180;
const LOST_RANGES = 1.5, LEFT_RANGES = 20, PRESENT = [0.05, 0.1], SPREAD = 2.45, NEAREST = 0.3; // for an
                                                                 // automatic viewpoint: see src/run/render/draw_list.c
const NARROWEST = 1.3; // width over height, below which the angle of view grows with the height
const FADE = 0.2; // s, in which a viewpoint approaches a followed object
const NEAR = 30; // distance to it, in radii
const CLEARANCE = 0.05; // height of the eye above the ground, relative to its distance

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => add([0, 0, 0], a, 1 / Math.hypot(...a));

// Returns how much a body counts, by its distance from the middle of those that move, and from the initial target: as
// presence_of of the renderer.
function lookAbout(bodies, target, range) {
	const near2 = (a, b) => dot(add(a, b, -1), add(a, b, -1));
	const from = (place) => {
		const left = (b) => 1 / (1 + (near2(b.p, target) / (LEFT_RANGES * range) ** 2) ** 2);
		const motion = (b, presence) => b.attention ** 6 * presence(b);
		let all = 0, near = 0;
		for (const b of bodies) {
			const moves = motion(b, left);
			all += moves;
			near += moves / (near2(b.p, place) + 0.25 * range ** 2) ** 2;
		}
		const lost = LOST_RANGES ** 4 * (range ** 4 + (near > 0 ? all / near : 0));
		const presence = (b) => left(b) / (1 + (near2(b.p, place) ** 2 / lost) ** 2);
		return { presence, moves: (b) => motion(b, presence) };
	};
	const { presence, moves } = from(target), weight = bodies.reduce((sum, b) => sum + moves(b), 0);
	const middle = bodies.reduce((sum, b) => add(sum, b.p, moves(b) / weight), [0, 0, 0]);
	return weight > 0 ? from(middle).presence : presence;
}

export class Camera {
	constructor() {
		this.ground = -Infinity; // m: height of level ground, under which an eye that began above it does not go
		this.set({ eye: [8, -10, 6], target: [0, 0, 1], fov: 0.8 });
	}

	set({ eye, target, fov, automatic, follow, aboard }) {
		const d = add(target, eye, -1), range = Math.hypot(...d) || 1;
		this.target = [...target];
		this.range = range;
		this.azimuth = Math.atan2(d[1], d[0]);
		this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, Math.asin(d[2] / range)));
		this.fov = fov;
		this.first = { target: [...target], range, elevation: this.elevation, height: eye[2] };
		this.following = automatic === true;
		this.off = null;
		this.goes = follow ? { name: follow, aboard, eye, target } : null; // along with the object of this name
	}

	get forward() {
		const c = Math.cos(this.elevation);
		return [Math.cos(this.azimuth) * c, Math.sin(this.azimuth) * c, Math.sin(this.elevation)];
	}
	get eye() { return add(this.target, this.forward, -this.range); }

	get floor() { return this.first.height > this.ground ? this.ground : -Infinity; }

	orbit(right, up) {
		this.leave();
		this.azimuth -= right;
		this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation - up));
		this.keepAbove();
	}
	leave() {
		this.following = false;
		this.goes = null;
	}
	// Tilts until the eye is above the ground, and lifts the target if that does not suffice.
	keepAbove() {
		const lowest = this.floor + CLEARANCE * this.range;
		if (this.eye[2] >= lowest)
			return;
		this.target[2] = Math.max(this.target[2], lowest - this.range * Math.sin(STEEPEST));
		this.elevation = Math.max(-STEEPEST, Math.min(this.elevation, Math.asin((this.target[2] - lowest) / this.range)));
	}
	// The head turns, the eye stays.
	turn(right, up) {
		const eye = this.eye;
		this.off = null;
		this.leave();
		this.azimuth -= right;
		this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + up));
		this.target = add(eye, this.forward, this.range);
	}
	// m, along the picture and into it
	translate(right, up, ahead) {
		const f = this.forward, r = unit(cross(f, [0, 0, 1])), u = cross(r, f);
		this.leave();
		this.off = null;
		this.target = add(add(add(this.target, r, right), u, up), f, ahead);
		this.target[2] += Math.max(0, this.floor + CLEARANCE * this.range - this.eye[2]);
	}
	zoom(factor) {
		this.range = this.near = Math.max(0.05, Math.min(1e5, this.range * factor));
		this.leave();
		this.keepAbove();
	}

	// From now on it follows a body at p, and orbits it, until it is moved away.
	get holds() { return this.off !== null; }
	hold(p, radius) {
		this.following = false;
		this.off = add(this.target, p, -1);
		this.near = Math.min(this.range, NEAR * radius);
	}
	release() { this.off = null; }
	accompany(p, seconds) {
		const left = Math.exp(-seconds / FADE);
		this.off = this.off.map((x) => x * left);
		this.target = add(p, this.off);
		this.range = this.near + left * (this.range - this.near);
		this.keepAbove();
	}

	// Goes along with the object that the scene has named, as ob_camera_follow of the renderer.
	go(bodies) {
		const body = bodies.find((b) => b.name === this.goes.name);
		if (!body)
			return;
		const { eye, target, aboard } = this.goes;
		const place = (v) => add(body.p, aboard ? turned(body.q, v) : add(v, target, -1));
		const [from, to] = [place(eye), place(target)], d = add(to, from, -1);
		this.target = to;
		this.azimuth = Math.atan2(d[1], d[0]);
		this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, Math.asin(d[2] / this.range)));
	}

	// Places the viewpoint to see moving objects, as ob_camera_follow of the renderer, but in the part of the picture that nothing
	// covers: room, from 0 to 1.
	follow(bodies, width, height, room = { left: 0, right: 1, top: 0, bottom: 1 }) {
		const whole = this.view(width, height), v = { ...whole, tanX: whole.tanX * (room.right - room.left), tanY: whole.tanY * (room.bottom - room.top) }, { target, range } = this.first, moving = [];
		const free = bodies.filter((b) => !b.fixed && !b.hidden && Number.isFinite(b.radius)), about = lookAbout(free, target, range);
		let all = 0, present = 0, middle = [0, 0, 0];
		for (const b of free) {
			const presence = about(b), weight = b.attention * presence;
			present += presence;
			moving.push({ p: b.p, radius: b.radius, weight });
			all += weight;
			middle = add(middle, b.p, weight);
		}
		const sight = Math.min(1, (present - PRESENT[0]) / (PRESENT[1] - PRESENT[0]));
		if (!(sight > 0))
			return;
		middle = [0, 1, 2].map((k) => middle[k] / all);
		const placed = moving.map(({ p, radius, weight }) => {
			const d = add(p, middle, -1);
			return { right: dot(d, v.right), up: dot(d, v.up), ahead: dot(d, v.forward), radius, share: weight / all };
		});
		// Extent of bodies beyond the sides of a pyramid of view, along an axis of the picture
		const reach = (axis, tangent) => {
			const slant = Math.hypot(1, tangent);
			let high = 0, low = 0;
			for (const b of placed) {
				const r = b.radius * slant - b.ahead * tangent;
				high += b.share * Math.max(r + b[axis], 0) ** 4;
				low += b.share * Math.max(r - b[axis], 0) ** 4;
			}
			return [SPREAD * high ** 0.25, SPREAD * low ** 0.25];
		};
		const needed = (axis, tangent) => reach(axis, tangent).reduce((a, b) => a + b) / (2 * tangent);
		const away = Math.max(needed('right', v.tanX), needed('up', v.tanY), NEAREST * range);
		const centre = (axis, tangent) => {
			let [high, low] = reach(axis, tangent);
			for (let i = 0; i < 4; i++)
				[high, low] = reach(axis, Math.min((high + low) / (2 * away), tangent));
			return (high - low) / 2;
		};
		const goal = add(add(middle, v.right, centre('right', v.tanX) - away * whole.tanX * (room.left + room.right - 1)), v.up, centre('up', v.tanY) + away * whole.tanY * (room.top + room.bottom - 1));
		this.target = add(target, add(goal, target, -1), sight);
		this.range = range + sight * (away - range);
		this.elevation = this.first.elevation;
		this.keepAbove();
	}

	// The axes and the frustum, as ob_view of the renderer.
	view(width, height) {
		const forward = this.forward, right = unit(cross(forward, [0, 0, 1])), up = cross(right, forward);
		const tanY = Math.tan(this.fov / 2) * Math.max(1, NARROWEST * height / width), tanX = tanY * width / height;
		return {
			eye: this.eye, forward, right, up, tanX, tanY, range: this.range,
			near: Math.max(0.01, Math.min(0.5, 0.01 * this.range)), far: Math.max(2000, 60 * this.range),
		};
	}

	// True if the picture has moved by half a pixel since another view: { eye, target }, or null.
	moved(since, height) {
		const pixel = 2 * this.range * Math.tan(this.fov / 2) / height, apart = (a, b) => Math.hypot(...add(a, b, -1));
		return !since || apart(since.eye, this.eye) + apart(since.target, this.target) > 0.5 * pixel;
	}

	// Direction through a point of the picture, x and y from -1 to 1.
	ray(x, y, width, height) {
		const v = this.view(width, height);
		return unit(add(add(v.forward, v.right, x * v.tanX), v.up, y * v.tanY));
	}
}

// Mouse, touch and keys. onClick(x, y): a press without motion, in CSS pixels. onGrab(x, y, always): true if the pointer
// holds an object from there on; hand.move(x, y) and hand.end() follow.
export function control(canvas, camera, onClick, onGrab, hand) {
	const fingers = new Map();
	let holds = false;
	let way = 0, mode = 'orbit', spread = 0;
	const span = () => {
		const [a, b] = [...fingers.values()];
		return { size: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
	};
	const move = (dx, dy) => {
		const metres = 2 * camera.range * Math.tan(camera.fov / 2) / canvas.clientHeight;
		if (mode === 'translate')
			camera.translate(-dx * metres, dy * metres, 0);
		else if (mode === 'turn')
			camera.turn(-dx * 0.004, dy * 0.004);
		else
			camera.orbit(dx * 0.006, dy * 0.006);
	};
	canvas.addEventListener('pointerdown', (e) => {
		canvas.setPointerCapture(e.pointerId);
		fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
		way = fingers.size > 1 ? 1e9 : 0;
		mode = e.button === 2 || e.shiftKey ? 'translate' : e.altKey || e.button === 1 ? 'turn' : 'orbit';
		spread = fingers.size === 2 ? span().size : 0;
		if (holds)
			hand.end();
		holds = fingers.size === 1 && e.button === 0 && mode === 'orbit' && onGrab(e.clientX, e.clientY, e.ctrlKey || e.metaKey);
	});
	canvas.addEventListener('pointermove', (e) => {
		const at = fingers.get(e.pointerId);
		if (!at)
			return;
		const before = fingers.size === 2 ? span() : null;
		const dx = e.clientX - at.x, dy = e.clientY - at.y;
		at.x = e.clientX;
		at.y = e.clientY;
		way += Math.abs(dx) + Math.abs(dy);
		if (before) {
			const after = span();
			mode = 'translate';
			move(after.x - before.x, after.y - before.y);
			camera.zoom(spread > 0 ? before.size / Math.max(1, after.size) : 1);
		} else if (holds) {
			hand.move(e.clientX, e.clientY);
		} else if (fingers.size === 1) {
			move(dx, dy);
		}
	});
	const up = (e) => {
		if (holds)
			hand.end();
		holds = false;
		if (fingers.delete(e.pointerId) && way < 5 && e.type === 'pointerup' && e.button === 0)
			onClick(e.clientX, e.clientY);
		if (fingers.size === 1)
			mode = 'orbit'; // as with one finger, after any gesture of two
	};
	canvas.addEventListener('pointerup', up);
	canvas.addEventListener('pointercancel', up);
	canvas.addEventListener('contextmenu', (e) => e.preventDefault());
	canvas.addEventListener('wheel', (e) => {
		e.preventDefault();
		camera.zoom(Math.exp(Math.max(-1, Math.min(1, e.deltaY * 0.0015))));
	}, { passive: false });
}

// Moves by keys while they are held; true if the key is one of these.
export function moveByKey(camera, key) {
	const s = 0.06 * camera.range;
	const moves = {
		ArrowLeft: () => camera.translate(-s, 0, 0), ArrowRight: () => camera.translate(s, 0, 0),
		ArrowUp: () => camera.translate(0, 0, s), ArrowDown: () => camera.translate(0, 0, -s),
		PageUp: () => camera.translate(0, s, 0), PageDown: () => camera.translate(0, -s, 0),
		a: () => camera.turn(-0.08, 0), d: () => camera.turn(0.08, 0), w: () => camera.turn(0, 0.08), s: () => camera.turn(0, -0.08),
		'+': () => camera.zoom(0.9), '-': () => camera.zoom(1.1),
	};
	if (!moves[key])
		return false;
	moves[key]();
	return true;
}
