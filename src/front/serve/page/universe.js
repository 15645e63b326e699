// The viewer's copy of the universe: the state that the server has sent (src/front/serve/feed.h), and the time shown.
import { addressOf } from './page.js';
import { STANDS, SWINGS, TURNS, normalize, poseAt } from './motion.js';
import { isHulled, radiusOf } from './shapes.js';

const DELAY_LEAST = 0.02, DELAY_MOST = 0.1; // s of wall time by which the shown time lags, so that messages arrive before
const DEVIATIONS = 2, MEMORY = 16; // they are needed: mean gap between messages, and its mean deviation, of about so many
const PULL = 5; // 1/s: rate at which its clock approaches the universe's
const LOST = 0.5, SETTLED = 1e-4; // s: from this difference on, the clock is set; below that, it stands
const MOTIONS = 1, CONTACTS = 2, MESH = 3, SIMULATORS = 4, JOINTS = 5, VOID = 1, PAUSED = 2, FREE_RUN = 1; // of a message
const MESH_HEAD = 12, MESH_VERTEX = 12; // bytes; floats
const STATIC = 1, FROZEN = 2, LOOKS = 4, MESH_COLOUR = 8, MESH_SURFACE = 16, SENSOR = 32, HIDDEN = 64, PATTERN = 128;
const KIND = 3, WIDE = 4, ACCELERATED = 8, BEGUN = 16; // of a motion
const V_UNIT = 1e-3, W_UNIT = 2e-3; // m/s, rad/s
const BLEND = 0.08; // s, simulated, to blend a prediction into a new motion
const ATTENTION_FADE = 1, ATTENTION_LEAST = 0.05, ATTENTION_GAP = 1; // s, share, s: as in src/run/render/draw_list.c
const ATTENTION_UNSEEN = 1e-3; // share that the viewpoint does not wait for

class Reader {
	constructor(buffer) {
		this.view = new DataView(buffer);
		this.at = 0;
	}
	u8() { return this.view.getUint8(this.at++); }
	u16() { return this.view.getUint16((this.at += 2) - 2, true); }
	i16() { return this.view.getInt16((this.at += 2) - 2, true); }
	u32() { return this.view.getUint32((this.at += 4) - 4, true); }
	f32() { return this.view.getFloat32((this.at += 4) - 4, true); }
	f64() { return this.view.getFloat64((this.at += 8) - 8, true); }
	number() {
		let value = 0, byte, shift = 0;
		do {
			byte = this.u8();
			value += (byte & 127) * 2 ** shift;
			shift += 7;
		} while (byte & 128);
		return value;
	}
	short3(unit) { return [this.i16() * unit, this.i16() * unit, this.i16() * unit]; }
	vec3() { return [this.f32(), this.f32(), this.f32()]; }
	text(bytes) {
		this.at += bytes;
		return new TextDecoder().decode(new Uint8Array(this.view.buffer, this.at - bytes, bytes));
	}
}

export class Universe extends EventTarget {
	constructor(url) {
		super();
		this.url = url;
		this.objects = new Map();
		this.contacts = [];
		this.joints = []; // { kind, ends: two of { id, p, axis }: in the object's frame, or the world's }
		this.simulators = new Map(); // by id: { home: worker, -1 unknown, island, substeps, state, lead: s, NaN in lockstep }
		this.told = 0; // s: newest received time
		this.toldAt = 0; // s of wall time of its arrival
		this.gap = this.deviation = 0; // s of wall time between messages: means
		this.speed = 0; // simulated seconds a second, measured
		this.time = 0; // s: the shown time
		this.rate = 1;
		this.paused = false;
		this.ended = false; // no step will follow
		this.bytes = this.messages = 0;
		this.news = 0; // grows with each received change
		this.tap = null; // is handed each message, too
	}

	connect() {
		this.socket = new WebSocket(this.url, 'obsim');
		this.socket.binaryType = 'arraybuffer';
		this.socket.onmessage = (e) => this.hear(e.data);
		this.socket.onopen = () => this.tell('open');
		this.socket.onclose = (e) => this.tell('close', e.reason);
	}

	// Fetches meshes, which a browser keeps as contents; a recording holds its own. Until they arrive, objects show their
	// collision shapes.
	async fetchMeshes(paths) {
		await Promise.all(paths.map(async (path) => {
			const answer = await fetch(addressOf(path));
			if (!answer.ok)
				throw new Error(`${path}: ${answer.status}`);
			this.hear(await answer.arrayBuffer());
		})).catch((error) => this.tell('error', error.message));
	}

	tell(name, detail) { this.dispatchEvent(new CustomEvent(name, { detail })); }

	send(command) {
		if (this.socket?.readyState === WebSocket.OPEN)
			this.socket.send(JSON.stringify(command));
	}

	hear(data) {
		this.tap?.(data);
		this.messages++;
		this.bytes += data.byteLength ?? data.length;
		if (typeof data === 'string') {
			for (const [name, value] of Object.entries(JSON.parse(data)))
				this.tell(name, value);
			return;
		}
		const r = new Reader(data), kind = r.u8();
		if (kind === MOTIONS)
			this.hearMotions(r);
		else if (kind === CONTACTS)
			this.hearContacts(r);
		else if (kind === SIMULATORS)
			this.hearSimulators(r, data);
		else if (kind === JOINTS)
			this.hearJoints(r);
		else if (kind === MESH)
			this.hearMesh(r, data);
	}

	hearMotions(r) {
		const flags = r.u8();
		r.u16();
		this.rate = r.f32();
		const time = r.f64(), removed = r.u32(), created = r.u32(), motions = r.u32();
		this.paused = (flags & PAUSED) !== 0;
		if (flags & VOID) {
			this.objects.clear();
			this.toldAt = 0; // messages before tell nothing about the rate of time
			this.speed = Number.isFinite(this.rate) ? this.rate : 1;
		}
		for (let i = 0; i < removed; i++)
			this.objects.delete(r.u32());
		for (let i = 0; i < created; i++)
			this.hearObject(r);
		for (let i = 0, id = -1; i < motions; i++) {
			id = (id + r.number()) % 2 ** 32;
			this.hearMotion(r, id, time);
		}
		this.follow(time);
		if ((flags & VOID) || removed || created || motions)
			this.news++;
		if ((flags & VOID) || removed || created)
			this.tell('population');
	}

	hearObject(r) {
		const id = r.u32(), generation = r.u32(), shape = r.u8(), flags = r.u16(), bytes = r.u8(), surface = r.u8();
		const size = r.vec3(), inertia = r.vec3(), colour = r.vec3(), hull = isHulled(shape) ? hearHull(r) : null;
		const mesh = flags & LOOKS ? r.u8() : 0, name = r.text(bytes);
		const known = this.objects.get(id); // with another look and the same motion
		this.objects.set(id, { ...(known?.generation === generation ? known : {}), id, generation, shape, fixed: (flags & STATIC) !== 0, frozen: (flags & FROZEN) !== 0, size, inertia, colour, hull, mesh, meshColour: (flags & MESH_COLOUR) !== 0, meshSurface: (flags & MESH_SURFACE) !== 0, sensor: (flags & SENSOR) !== 0, hidden: (flags & HIDDEN) !== 0, pattern: Math.floor(flags / PATTERN), name, roughness: (surface & 15) / 15, metal: (surface >> 4) / 15, radius: radiusOf(shape, size) });
	}

	hearMesh(r, data) {
		const number = r.u8(), parts = r.u8(), images = r.u8(), floats = MESH_VERTEX * r.u32(), indices = r.u32();
		const mesh = { number, vertices: new Float32Array(data, MESH_HEAD, floats), indices: new Uint32Array(data, MESH_HEAD + 4 * floats, indices) };
		r.at = MESH_HEAD + 4 * (floats + indices);
		mesh.parts = Array.from({ length: parts }, () => ({ indices: r.u32(), colour: r.u8(), surface: r.u8(), wrap: [r.u8(), r.u8()] }));
		mesh.images = Array.from({ length: images }, () => {
			const width = r.u32(), height = r.u32(), bytes = new Uint8Array(data, r.at, 4 * width * height);
			r.at += bytes.length;
			return { width, height, bytes };
		});
		this.tell('mesh', mesh);
	}

	hearMotion(r, id, time) {
		const flags = r.u8(), kind = flags & KIND, p = r.vec3(), q = [r.i16(), r.i16(), r.i16(), r.i16()], norm = Math.hypot(...q);
		const m = { kind, t0: time, p, q: q.map((x) => x / norm), a: [0, 0, 0] };
		if (flags & BEGUN)
			m.t0 -= r.f32();
		if (flags & ACCELERATED)
			m.a = r.vec3();
		if (kind === SWINGS)
			m.frequency = r.f64();
		if (flags & WIDE)
			Object.assign(m, { v: r.vec3(), w: r.vec3() });
		else if (kind !== STANDS)
			Object.assign(m, { v: r.short3(V_UNIT), w: r.short3(W_UNIT) });
		const body = this.objects.get(id);
		if (!body)
			return;
		body.before = body.motion;
		body.motion = m;
	}

	hearContacts(r) {
		r.u8();
		r.u16();
		const n = r.u32();
		r.f64();
		this.news++;
		this.contacts = Array.from({ length: n }, () => ({ p: r.vec3(), n: r.vec3(), impulse: r.f32() }));
	}

	hearJoints(r) {
		r.u8();
		r.u16();
		const n = r.u32();
		r.f64();
		this.news++;
		this.joints = Array.from({ length: n }, () => {
			const kind = r.u8(), ids = [r.u32(), r.u32()];
			return { kind, ends: ids.map((id) => ({ id, p: r.vec3(), axis: r.vec3() })) };
		});
	}

	// The picture changes with them only if they do.
	hearSimulators(r, data) {
		const bytes = new Uint8Array(data, 16), same = bytes.length === this.simulatorsTold?.length && bytes.every((x, i) => x === this.simulatorsTold[i]);
		this.simulatorsTold = bytes;
		const free = (r.u8() & FREE_RUN) !== 0;
		r.u16();
		const n = r.u32();
		r.f64();
		this.simulators.clear();
		for (let i = 0, id = -1; i < n; i++) {
			id = (id + r.number()) % 2 ** 32;
			this.simulators.set(id, { home: r.number() - 1, island: r.number(), substeps: r.number(), state: r.u8(), lead: free ? r.f32() : NaN });
		}
		this.news += !same;
		this.tell('simulators', this.simulators);
	}

	// The clock follows received times, at any rate.
	follow(time) {
		const now = performance.now() / 1000, since = now - this.toldAt;
		if (this.toldAt > 0) {
			const off = Math.min(since, DELAY_MOST) - this.gap;
			this.gap += off / MEMORY;
			this.deviation += (Math.abs(off) - this.deviation) / MEMORY;
		}
		if (since > 1e-4 && this.toldAt > 0) {
			const share = Math.min(1, since * 4);
			this.speed += share * ((time - this.told) / since - this.speed);
		}
		this.told = time;
		this.toldAt = now;
	}

	// Advances the shown time; call it once a frame.
	advance(seconds) {
		const speed = this.paused || this.ended ? 0 : this.speed;
		const delay = Math.max(DELAY_LEAST, Math.min(DELAY_MOST, this.gap + DEVIATIONS * this.deviation));
		const goal = this.told + speed * Math.min(performance.now() / 1000 - this.toldAt - delay, 0.25);
		const off = goal - this.time;
		if (Math.abs(off) > LOST * Math.max(1, speed) || (speed === 0 && Math.abs(off) < SETTLED))
			this.time = goal;
		else
			this.time += speed * seconds + off * Math.min(1, PULL * seconds);
		return this.time;
	}

	// Attention to a body, for an automatic viewpoint: 1 while it moves, less and less while it rests.
	attention(body) {
		const rests = body.motion.kind === STANDS && !body.fixed, goal = rests ? ATTENTION_LEAST : 1, at = body.attended;
		const goesOn = at && this.time >= at.time && this.time - at.time <= ATTENTION_GAP;
		const from = goesOn ? at.level : 1, since = goesOn ? this.time - at.time : Math.max(0, this.time - body.motion.t0);
		const left = (from - goal) * Math.exp(-since / ATTENTION_FADE);
		body.attended = { time: this.time, level: Math.abs(left) < ATTENTION_UNSEEN ? goal : goal + left };
		return body.attended.level;
	}

	// True if a body stands, and will until there is news of it.
	rests(body) { return body.fixed || (body.motion.kind === STANDS && this.time > body.motion.t0 + BLEND); }

	// A body as it is drawn, with its mesh, if there is one; null: not received yet.
	body(o, mesh) {
		const pose = this.pose(o);
		return pose && { ...o, mesh, radius: mesh?.radius ?? o.radius, attention: this.attention(o), rests: this.rests(o), kind: o.motion.kind, shown: o.colour, ...pose };
	}

	// Pose of a body at that time; null: not received yet.
	pose(body, t = this.time) {
		const { motion: now, before } = body;
		if (!now || !before)
			return now ? poseAt(now, body.inertia, t) : null;
		if (t < now.t0)
			return poseAt(before, body.inertia, t);
		const pose = poseAt(now, body.inertia, t), share = (t - now.t0) / BLEND;
		// an earlier flight may have ended in a collision: it is not blended
		return share < 1 && before.kind === TURNS ? between(poseAt(before, body.inertia, t), pose, share) : pose;
	}
}

// { number, corners: [[x, y, z]], faces: [[index]] }, in the body's frame, faces counterclockwise from outside.
function hearHull(r) {
	const corners = r.u8(), faces = r.u8(), parts = r.u8(), number = r.u16();
	return {
		number,
		corners: Array.from({ length: corners }, () => r.vec3()),
		faces: Array.from({ length: faces }, () => Array.from({ length: r.u8() }, () => r.u8())),
		parts: Array.from({ length: parts }, () => hearHull(r)), // of a compound
	};
}

// Interpolates between two poses.
export function between(a, b, share) {
	const sign = a.q[0] * b.q[0] + a.q[1] * b.q[1] + a.q[2] * b.q[2] + a.q[3] * b.q[3] < 0 ? -1 : 1;
	return {
		p: a.p.map((x, k) => x + share * (b.p[k] - x)),
		q: normalize(a.q.map((x, k) => x * sign + share * (b.q[k] - x * sign))),
	};
}
