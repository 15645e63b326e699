// A recording that plays by itself (src/front/serve/film.h): the messages of a universe, with a clock of the viewer's own,
// which runs backwards, too.
import { halfBounds } from './drawing.js';
import { FREE, STANDS, normalize, poseAt } from './motion.js';
import { addressOf } from './page.js';
import { isEndless } from './shapes.js';
import { Universe, between } from './universe.js';

const LENGTH = 4, TIME_AT = 8, FLAGS_AT = 1, VOID = 1, JSON_BEGINS = 0x7b, MESH_BEGINS = 3, ASIDE = new Set([4, 5]); // of a message; ASIDE: simulators and joints
const JUMP = 1; // s: for a longer jump, it begins at a whole state
const GROWN = 0.02; // of a radius: by so much bounds are taken larger than shapes
const NEWS = 0.15; // s of wall time between two details of the picked object

// source: "#id", an element of this page that holds the recording in base64; else an address to fetch.
async function load(source) {
	let packed;
	if (source.startsWith('#')) {
		const text = document.querySelector(source).textContent;
		packed = new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]);
	} else {
		const answer = await fetch(addressOf(source));
		if (!answer.ok)
			throw new Error(`the recording: ${(await answer.text()).replace(/<[^>]*>/g, ' ').trim() || answer.status}`);
		packed = await answer.blob();
	}
	return new Response(packed.stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

export class Film extends Universe {
	constructor(source) {
		super(null);
		this.source = source;
		this.steps = []; // { time, data, anew }: messages, in the order of their times
		this.shown = -1; // index of the last applied message
		this.since = this.heard = 0; // s: times of the message before it, and its own
		this.facts = new Map(); // of objects: details that are not in their motions
		this.inspected = undefined;
		this.newsAt = 0;
	}

	async connect() {
		const buffer = await load(this.source), view = new DataView(buffer);
		for (let at = 0; at < buffer.byteLength;) {
			const size = view.getUint32(at, true), data = buffer.slice(at + LENGTH, at + LENGTH + size);
			at += LENGTH + size;
			const first = view.getUint8(at - size);
			if (first === JSON_BEGINS)
				this.hear(new TextDecoder().decode(data));
			else if (first === MESH_BEGINS)
				this.hear(data);
			else
				this.steps.push({ aside: ASIDE.has(first), time: view.getFloat64(at - size + TIME_AT, true), data, anew: (view.getUint8(at - size + FLAGS_AT) & VOID) !== 0 });
		}
		this.seek(this.begin);
		this.rate = 1;
		this.paused = false;
	}

	tell(name, detail) {
		if (name === 'film') {
			// gaps: a viewer's own record, in which whole states stand where messages were left out
			Object.assign(this, { begin: detail.begin, end: detail.end, interval: detail.interval, time: detail.begin, gaps: detail.gaps === true });
			for (const [id, generation, mass, friction, restitution] of detail.objects)
				this.facts.set(`${id} ${generation}`, { mass, friction, restitution });
		}
		super.tell(name, detail);
	}

	// Applies messages up to time t, and one more, for the motion between two states.
	seek(t) {
		this.time = Math.max(this.begin, Math.min(this.end, t));
		const { rate, paused } = this;
		if (this.shown < 0 || this.time < this.since || this.time > this.heard + JUMP)
			this.begins(this.steps.findLastIndex((s) => s.anew && s.time <= this.time));
		while (this.heard < this.time && this.shown + 1 < this.steps.length) {
			const step = this.steps[++this.shown];
			if (step.anew && !this.gaps)
				continue; // only for a start there
			if (!step.aside)
				[this.since, this.heard] = [this.heard, step.time];
			this.hear(step.data);
		}
		Object.assign(this, { rate, paused });
	}

	// Begins at a whole state, unless playing on from the current one is shorter.
	begins(index) {
		if (this.shown >= 0 && this.time >= this.since && index <= this.shown)
			return;
		this.shown = Math.max(0, index);
		this.since = this.heard = this.steps[this.shown].time;
		this.hear(this.steps[this.shown].data);
	}

	advance(seconds) {
		if (!this.paused)
			this.seek(this.time + seconds * this.rate);
		if (this.time >= this.end)
			this.paused = true;
		this.newsAt += seconds;
		if (this.inspected !== undefined && this.newsAt > NEWS)
			this.inspect();
		return this.time;
	}

	// Pose between two states as in the renderer (ob_motion_between): a flight is continued, other motions are
	// interpolated.
	pose(body, t = this.time) {
		const { motion: now, before } = body;
		if (!now || !before || t >= now.t0)
			return now ? poseAt(now, body.inertia, t) : null;
		const from = Math.max(before.t0, now.t0 - this.interval);
		if (now.kind >= FREE || t <= from)
			return poseAt(before, body.inertia, t);
		return between(poseAt(before, body.inertia, from), now, (t - from) / (now.t0 - from));
	}

	send(command) {
		switch (command.do) {
		case 'pause':
			this.paused = true;
			break;
		case 'resume':
			if (this.time >= this.end)
				this.seek(this.begin);
			this.paused = false;
			break;
		case 'step':
			this.paused = true;
			this.seek(this.begin + this.interval * (Math.round((this.time - this.begin) / this.interval) + (command.steps ?? 1)));
			break;
		case 'rate':
			this.rate = command.rate;
			break;
		case 'simulators':
		case 'joints':
			break; // it has them anyway
		case 'inspect':
			this.inspected = command.id;
			if (command.id !== undefined)
				this.inspect();
			break;
		default:
		}
	}

	// Objects that the body's simulator reads: their bounds overlap. A recording has none, so they are taken from shapes.
	readings(body) {
		const boundsOf = (o) => {
			const { p, q } = this.pose(o), half = halfBounds({ ...o, q });
			return p.map((x, k) => [x - half[k] - GROWN * o.radius, x + half[k] + GROWN * o.radius]);
		};
		if (body.fixed || isEndless(body.shape))
			return [];
		const own = boundsOf(body), others = [...this.objects.values()].filter((o) => o !== body && o.motion && !isEndless(o.shape));
		return others.filter((o) => boundsOf(o).every(([low, high], k) => low <= own[k][1] && own[k][0] <= high)).map((o) => o.id);
	}

	inspect() {
		const id = this.inspected, body = this.objects.get(id);
		this.newsAt = 0;
		if (!body?.motion)
			return this.tell('details', { id, gone: true });
		const h = 1e-4, { p } = this.pose(body), { q } = this.pose(body);
		const early = this.pose(body, this.time - h), late = this.pose(body, this.time + h);
		return this.tell('details', {
			id, generation: body.generation, name: body.name, size: body.size, p, q,
			state: body.frozen ? 'frozen' : body.fixed ? 'static' : body.motion.kind === STANDS ? 'rests' : body.motion.kind === FREE ? 'flies' : 'moves',
			v: p.map((_, k) => (late.p[k] - early.p[k]) / (2 * h)), w: rateOf(early.q, late.q, 2 * h),
			...this.facts.get(`${id} ${body.generation}`), reads: this.readings(body),
		});
	}
}

// rad/s, world, of the rotation from a to b in s.
function rateOf(a, b, s) {
	const [w, x, y, z] = normalize([
		b[0] * a[0] + b[1] * a[1] + b[2] * a[2] + b[3] * a[3],
		-b[0] * a[1] + b[1] * a[0] - b[2] * a[3] + b[3] * a[2],
		-b[0] * a[2] + b[1] * a[3] + b[2] * a[0] - b[3] * a[1],
		-b[0] * a[3] - b[1] * a[2] + b[2] * a[1] + b[3] * a[0],
	]);
	return [x, y, z].map((c) => 2 * c * Math.sign(w || 1) / s);
}
