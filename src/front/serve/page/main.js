// The viewer: a user's own window into the universe that obsim serves.
import { Camera, control, moveByKey } from './camera.js';
import { Drawing, boxSegments, contactSegments, edgeColour, halfBounds, jointSegments } from './drawing.js';
import { Film } from './film.js';
import { Panel } from './panel.js';
import { isEndless, isHulled, outlineOf } from './shapes.js';
import { Universe } from './universe.js';
import { turned } from './motion.js';
import { colourBy } from './colouring.js';
import { Workers } from './workers.js';
import { Hand } from './hand.js';
import { Explore } from './explore.js';
import { Recorder } from './recorder.js';
import { Offers } from './offers.js';
import { Pictures } from './pictures.js';
import { Sharpness } from './sharpness.js';
import { addressOf, count, kept, token } from './page.js';
import { Walk } from './walk.js';
import { Tour } from './tour.js';

const THROWN = 12; // m/s
const PICKED = [1, 0.7, 0.33, 1];
const READING = [1, 0.42, 0.7, 0.9];
const PALE = [0.9, 0.92, 0.95];
const AGAIN = [0.5, 1, 2, 5]; // s: waits before attempts to reconnect

const canvas = document.querySelector('#picture');
const asked = new URLSearchParams(location.hash.slice(1));
const recording = document.querySelector('meta[name=recording]').content;
const universe = recording ? new Film(recording) : new Universe(`ws://${location.host}${addressOf('/universe')}`), camera = new Camera(), panel = new Panel(), workers = new Workers(), hand = new Hand(universe, camera), explore = new Explore(universe), offers = new Offers(), pictures = new Pictures(), recorder = new Recorder(universe), sharpness = new Sharpness(), walk = new Walk(), tour = new Tour(universe, workers, walk, kill);
let drawing, look, cameras = [], shownCamera = 0, picked = null, avatar = null, read = [], tries = 0, frames = 0, framesTold = 0, shown = '', shownForm = '', shownView = null;

// ---- the picture

const paled = (colour, share) => (share > 0 ? colour.map((c, k) => c + share * (PALE[k] - c)) : colour);

function bodies() {
	const out = [], key = workers.key, others = key !== 'own';
	for (const o of universe.objects.values()) {
		const body = universe.body(o, drawing.looks.get(o.mesh));
		if (body)
			out.push(Object.assign(body, { name: o.id === avatar?.id ? look.avatar : o.name, meshColour: o.meshColour && !others && !workers.pale.has(o.id), pattern: others && !isEndless(o.shape) ? 0 : o.pattern,
				shown: paled(colourBy(key, o, universe.simulators.get(o.id), workers.list), workers.paleness(o.id)) }));
	}
	return out;
}

// Lines from the picked object to those that its simulator reads.
function readings(list) {
	const from = list.find((b) => b.id === picked), others = new Set(read);
	return from ? list.filter((b) => others.has(b.id) && !isEndless(b.shape)).map((b) => ({ from: from.p, to: b.p, colour: READING, width: 2, over: true })) : [];
}

function overlay(list, view) {
	const out = panel.on.contacts ? contactSegments(universe.contacts, view, canvas.height) : [];
	if (panel.on.joints)
		out.push(...jointSegments(universe.joints, list, view, canvas.height));
	for (const b of list) {
		if (!isEndless(b.shape) && b.id === picked)
			out.push(...boxSegments(b, PICKED, 2.5));
		else if (!isEndless(b.shape) && (panel.on.boxes || b.frozen))
			out.push(...boxSegments(b, edgeColour(b)));
	}
	return out.concat(hand.segments(list), panel.on.simulators ? readings(list) : []);
}

// Follows the picked object with the viewpoint, if requested.
function accompany(list, seconds) {
	const body = camera.holds && list.find((b) => b.id === picked);
	if (body)
		camera.accompany(body.p, seconds);
	else
		camera.release();
	panel.follows(camera.holds);
}

function draw(list, view, width, height, smooth, share) {
	if (canvas.width !== width || canvas.height !== height)
		[canvas.width, canvas.height] = [width, height];
	drawing.draw(list, view, look, overlay(list, view), smooth, share);
}

// The part of the picture that is free of the title and the buttons, from 0 to 1.
function freePart() {
	const head = document.querySelector('header').getBoundingClientRect(), nav = document.querySelector('nav').getBoundingClientRect(), beside = head.right < innerWidth / 2;
	return { left: beside ? head.right / innerWidth : 0, right: 1, top: beside ? 0 : head.bottom / innerHeight, bottom: nav.top / innerHeight };
}

// For people who want little motion the viewpoint moves when they move it, or when the scene's camera goes with an object.
const calm = matchMedia('(prefers-reduced-motion: reduce)');

let before = performance.now();
function frame(now) {
	const seconds = Math.min(0.25, (now - before) / 1000), scale = Math.min(2, devicePixelRatio || 1);
	const width = Math.max(1, Math.round(canvas.clientWidth * scale)), height = Math.max(1, Math.round(canvas.clientHeight * scale));
	before = now;
	universe.advance(seconds);
	offers.look();
	const list = bodies();
	if (camera.following && !calm.matches)
		camera.follow(list, width, height, freePart());
	if (camera.goes)
		camera.go(list);
	accompany(list, calm.matches ? Infinity : seconds);
	const view = camera.view(width, height);
	// An unchanged picture is not drawn again: a universe that is paused or at rest costs nothing.
	const { on } = panel, seen = [list.every((b) => b.rests) || universe.time, universe.news, drawing.looks.size, width, height, camera.fov, picked, on.boxes,
		on.contacts, on.joints, on.simulators, workers.key, workers.pale.size && now, read, hand.held?.target].join();
	const changes = seen !== shown || camera.moved(shownView, height), share = drawing.software && !explore.recorder ? sharpness.next(seconds, changes) : 1;
	const smooth = !drawing.software || !changes, form = `${share} ${smooth}`;
	if (changes || form !== shownForm)
		draw(list, view, Math.round(width * share), Math.round(height * share), smooth, share);
	if (changes)
		shownView = { eye: view.eye, target: [...camera.target] };
	[shown, shownForm] = [seen, form];
	panel.clock(universe.time, universe.rate, universe.paused);
	frames++;
	requestAnimationFrame(frame);
}

function movers() { return [...universe.objects.values()].filter((o) => !o.fixed).length; }

// m: height of the highest level ground.
function groundHeight() {
	const level = [...universe.objects.values()].filter((o) => isEndless(o.shape) && o.motion && turned(o.motion.q, [0, 0, 1])[2] > 0.999);
	return Math.max(...level.map((o) => o.motion.p[2]));
}

// ---- picking

// Hit of a ray with a hull: the ray, in its frame, against the planes of all faces.
function hitHull(hull, from, ray) {
	let enter = -Infinity, leave = Infinity, normal = null;
	for (const face of hull.faces) {
		const [p, u, v] = face.slice(0, 3).map((k, i) => hull.corners[k].map((x, j) => (i ? x - hull.corners[face[0]][j] : x)));
		const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
		const rate = n[0] * ray[0] + n[1] * ray[1] + n[2] * ray[2];
		const height = n[0] * (from[0] - p[0]) + n[1] * (from[1] - p[1]) + n[2] * (from[2] - p[2]), s = -height / rate;
		if (rate === 0 && height > 0)
			return null;
		if (rate < 0 && s > enter)
			[enter, normal] = [s, n];
		if (rate > 0)
			leave = Math.min(leave, s);
	}
	if (!normal || !(enter <= leave) || enter <= 0)
		return null;
	const l = Math.hypot(...normal);
	return { s: enter, normal: normal.map((x) => x / l) };
}

// First hit with the body's hull, or with any of a compound's parts.
function hitHulls(b, from, ray) {
	const hits = (b.hull.parts.length ? b.hull.parts : [b.hull]).map((hull) => hitHull(hull, from, ray)).filter((at) => at);
	const first = hits.sort((x, y) => x.s - y.s)[0];
	return first ? { s: first.s, normal: turned(b.q, first.normal) } : null;
}

// m along the ray to the body's surface, and its normal there; null: no hit. Capsules and cylinders as their boxes.
function hit(b, from, ray) {
	const d = turned(b.q, [0, 1, 2].map((k) => from[k] - b.p[k]), -1), r = turned(b.q, ray, -1);
	if (isEndless(b.shape)) {
		const s = -d[2] / r[2];
		return d[2] > 0 && s > 0 ? { s, normal: turned(b.q, [0, 0, 1]) } : null;
	}
	if (isHulled(b.shape))
		return hitHulls(b, d, r);
	const o = outlineOf(b.shape, b.size);
	if (o.ball && !o.half[2]) {
		const half = d[0] * r[0] + d[1] * r[1] + d[2] * r[2], c = half * half - (d[0] ** 2 + d[1] ** 2 + d[2] ** 2 - o.ball ** 2);
		const s = -half - Math.sqrt(c);
		return c >= 0 && s > 0 ? { s, normal: turned(b.q, [0, 1, 2].map((k) => (d[k] + s * r[k]) / o.ball)) } : null;
	}
	const h = halfBounds({ ...b, q: [1, 0, 0, 0] });
	let enter = -Infinity, leave = Infinity, axis = 0;
	for (let k = 0; k < 3; k++) {
		const a = (-h[k] - d[k]) / r[k], c = (h[k] - d[k]) / r[k];
		if (Math.min(a, c) > enter)
			[enter, axis] = [Math.min(a, c), k];
		leave = Math.min(leave, Math.max(a, c));
	}
	if (!(enter <= leave) || enter <= 0)
		return null;
	return { s: enter, normal: turned(b.q, [0, 1, 2].map((k) => (k === axis ? -Math.sign(r[k]) : 0))) };
}

function rayAt(x, y) {
	const box = canvas.getBoundingClientRect();
	return { from: camera.eye, ray: camera.ray(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height, box.width, box.height) };
}

function pointAt(x, y) {
	const { from, ray } = rayAt(x, y);
	let best = null;
	for (const b of bodies().filter((x) => !x.hidden)) {
		const at = hit(b, from, ray);
		if (at && (!best || at.s < best.s))
			best = { ...at, body: b };
	}
	return { ray, from, best, place: best && [0, 1, 2].map((k) => from[k] + best.s * ray[k]) };
}

function pick(id) {
	picked = id;
	read = [];
	explore.drop('height', 'speed');
	if (id === null)
		panel.details(null);
	universe.send(id === null ? { do: 'inspect' } : { do: 'inspect', id });
	if (camera.holds)
		hold();
}

function hold() {
	const o = universe.objects.get(picked), pose = o && universe.pose(o);
	if (pose)
		camera.hold(pose.p, o.radius);
	else
		camera.release();
}

function click(x, y) {
	const { best, place } = pointAt(x, y);
	if (panel.on.make) {
		if (!best)
			return panel.notice('click on the ground, or on an object');
		const { command, over } = panel.wanted;
		universe.send({ ...command, at: [place[0], place[1], place[2] + over] });
	} else {
		pick(best && !isEndless(best.body.shape) ? best.body.id : null);
	}
	return undefined;
}

// Takes hold of the picked object, or, where asked, of any.
function grab(x, y, any) {
	const { best, place } = pointAt(x, y), body = best?.body;
	if (panel.looksOnly || recording || panel.on.make || !body || body.fixed || isEndless(body.shape) || !(any || body.id === picked))
		return false;
	hand.grab(body, place);
	return true;
}

function throwOne() {
	const { command } = panel.wanted, from = camera.eye, f = camera.forward;
	const ahead = Math.max(...command.size) * 2 + 0.5;
	universe.send({ ...command, at: [0, 1, 2].map((k) => from[k] + ahead * f[k]), velocity: f.map((x) => THROWN * x) });
}

// ---- requests

// The first steps: who simulates whom, a kill, a drag, time.
function showSteps() {
	const { isolation, workers: n, look_only } = look, where = isolation === 'process' ? count(n, 'process', 'processes') : `${count(n, 'thread')} of one process`;
	const colours = { about: '#strip', begin: () => workers.choose('worker'), end: () => workers.choose('own') };
	const kills = panel.kills ? 'Kill one: its objects turn pale, all start again from the last checkpoint, and reach the same bits.' : 'In processes (--isolation process) one may be killed: all reach the same bits.';
	walk.start([
		{ text: 'Each object is a simulator of its own. Click one to see what it knows and reads.' },
		{ text: `They live in ${where}, each with its colour. ${kills}`, ...colours },
		...look_only ? [] : [
			{ text: 'Drag an object that you have clicked: a spring pulls it to the pointer, before all visitors.' },
			{ text: 'Time is yours: pause, single steps, another pace, back to the start.', about: 'nav .group' },
		],
	], () => kept('walked', true));
}

// Kills the process of a worker, by an object that it simulates.
function kill(worker) {
	const id = [...workers.homes].find(([, home]) => home === worker)?.[0], o = universe.objects.get(id);
	if (o)
		universe.send({ do: 'kill', id, generation: o.generation });
	else
		panel.notice('this worker simulates no object now');
}

function askJoints() {
	universe.send({ do: 'joints', on: panel.on.joints || recorder.on });
}

panel.addEventListener('pause', () => universe.send({ do: universe.paused ? 'resume' : 'pause' }));
panel.addEventListener('step', () => universe.send({ do: 'step' }));
if (recording) {
	panel.addEventListener('back', () => universe.send({ do: 'step', steps: -1 }));
	panel.addEventListener('seek', (e) => universe.seek(e.detail));
}
panel.addEventListener('rate', (e) => universe.send({ do: 'rate', rate: e.detail }));
panel.addEventListener('contacts', (e) => universe.send({ do: 'contacts', on: e.detail }));
panel.addEventListener('joints', askJoints);
workers.addEventListener('kill', (e) => kill(e.detail));
panel.addEventListener('objects', (e) => {
	explore.list();
	universe.send({ do: 'energy', on: e.detail });
});
offers.addEventListener('set', (e) => universe.send({ do: 'set', ...e.detail }));
offers.addEventListener('seed', (e) => universe.send({ do: 'seed', value: e.detail }));
offers.addEventListener('control', ({ detail: { to, text } }) => {
	const o = to ? [...universe.objects.values()].find((x) => x.name === to) : avatar;
	if (o)
		universe.send({ do: 'message', id: o.id, generation: o.generation, text });
});
explore.addEventListener('pick', (e) => pick(e.detail));
panel.addEventListener('picture', () => {
	const scale = Math.min(2, devicePixelRatio || 1), size = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * scale)));
	draw(bodies(), camera.view(...size), ...size, true); // in full resolution
	explore.picture(canvas);
});
panel.addEventListener('video', () => document.querySelector('[data-do=video]').setAttribute('aria-pressed', explore.video(canvas)));
// Begins a record, with joints and with who simulates what, or ends it.
function record() {
	if (recorder.on)
		recorder.stop(look, addressOf).catch((error) => panel.notice(error.message));
	else
		recorder.start();
	document.querySelector('[data-do=record]').setAttribute('aria-pressed', recorder.on);
	askJoints();
}
panel.addEventListener('record', record);
recorder.addEventListener('end', () => {
	record();
	panel.notice('the record ends here: the universe went back, or it has become too long', 8);
});
panel.addEventListener('link', () => {
	asked.set('view', [...camera.eye, ...camera.target].map((x) => Number(x.toFixed(4)) + 0).join());
	asked.delete('token'); // the receiver needs one of their own
	const address = `${location.origin}${location.pathname}#${asked}`;
	if (!token)
		history.replaceState(null, '', address);
	navigator.clipboard?.writeText(address).catch(() => {});
	panel.notice(`this viewpoint: ${address}`, 10);
});
panel.addEventListener('save', () => universe.send({ do: 'save' }));
panel.addEventListener('restart', () => universe.send({ do: 'restart' }));
for (const what of ['edit', 'message'])
	panel.addEventListener(what, (e) => {
		const o = universe.objects.get(picked);
		if (o)
			universe.send({ do: what, id: o.id, generation: o.generation, ...e.detail });
	});
panel.addEventListener('kill', () => {
	const o = universe.objects.get(picked);
	if (o)
		universe.send({ do: 'kill', id: o.id, generation: o.generation });
});
panel.addEventListener('throw', throwOne);
panel.addEventListener('walk', showSteps);
panel.addEventListener('next', () => walk.next());
panel.addEventListener('skip', () => walk.end());
panel.addEventListener('follow', () => {
	if (picked === null)
		camera.set({ ...cameras[shownCamera], automatic: true });
	else if (camera.holds)
		camera.release();
	else
		hold();
});
panel.addEventListener('deselect', () => pick(null));
panel.addEventListener('remove', () => {
	const o = universe.objects.get(picked);
	if (o)
		universe.send({ do: 'remove', id: o.id, generation: o.generation });
});
panel.addEventListener('view', () => {
	shownCamera = (shownCamera + 1) % cameras.length;
	camera.set(cameras[shownCamera]);
	panel.notice(cameras[shownCamera].name || `viewpoint ${shownCamera + 1}`, 1.5);
});

document.addEventListener('keydown', (e) => {
	if (e.ctrlKey || e.metaKey || e.target.closest('input:not(#time), select') || ([' ', 'Enter'].includes(e.key) && e.target.closest('button, summary')))
		return;
	if (offers.key(e.key, true) || panel.key(e.key) || moveByKey(camera, e.key))
		e.preventDefault();
});
document.addEventListener('keyup', (e) => offers.key(e.key, false));
control(canvas, camera, click, grab, {
	move: (x, y) => {
		const { from, ray } = rayAt(x, y);
		hand.move(from, ray);
	},
	end: () => hand.let(),
});
for (const what of ['push', 'let'])
	panel.addEventListener(what, () => {
		const o = universe.objects.get(picked);
		if (o && what === 'push')
			hand.push(o, panel.mass);
		else if (o)
			universe.send({ do: 'release', id: o.id });
	});

// ---- messages

// The viewpoint in the address, as eye and target; null: none.
function askedView() {
	const view = asked.get('view')?.split(',').map(Number) ?? [];
	return view.length === 6 && view.every(Number.isFinite) ? { eye: view.slice(0, 3), target: view.slice(3), fov: cameras[0].fov } : null;
}

universe.addEventListener('welcome', (e) => {
	look = e.detail;
	cameras = look.cameras;
	panel.welcome(look);
	pictures.welcome(look);
	avatar = null;
	workers.welcome(look, panel.kills);
	if (offers.welcome(look) && !panel.on.offers && (kept('panels')?.offers ?? true))
		panel.ask('offers');
	drawing.forgetMeshes();
	universe.fetchMeshes(look.meshes);
	if (!camera.placed)
		camera.set(askedView() ?? cameras[0]);
	camera.placed = true;
	tries = 0;
	panel.notice('');
	if (panel.on.contacts)
		universe.send({ do: 'contacts', on: true });
	if (panel.on.joints)
		askJoints();
	universe.send({ do: 'simulators', on: true });
	if (panel.on.objects)
		universe.send({ do: 'energy', on: true });
});
// The visitor's own avatar: at the first one, the viewpoint goes behind it, where the scene has such a camera.
universe.addEventListener('avatar', (e) => {
	const behind = cameras.findIndex((c) => c.follow === look.avatar);
	avatar = e.detail;
	if (behind >= 0 && !asked.get('view') && !camera.behind)
		camera.set(cameras[shownCamera = behind]);
	camera.behind = true;
});
universe.addEventListener('workers', (e) => {
	workers.hear(e.detail, (id) => universe.objects.get(id)?.name || `object ${id}`);
	panel.idea(workers.idea(movers()));
	if (recording || workers.world || walk.steps.length)
		return;
	if (look.tour && look.role === 'operate')
		tour.start(look);
	else if (!kept('walked'))
		showSteps();
});
universe.addEventListener('simulators', (e) => workers.times(e.detail));
universe.addEventListener('mesh', (e) => drawing.addMesh(e.detail));
universe.addEventListener('population', () => {
	camera.ground = groundHeight();
	explore.list();
	panel.idea(workers.idea(movers()));
});
universe.addEventListener('film', (e) => {
	panel.film(e.detail);
	workers.film();
});
universe.addEventListener('statistics', (e) => {
	universe.ended = e.detail.ended;
	explore.add('awake', e.detail.awake);
	explore.add('pace', universe.paused || universe.ended ? 0 : universe.speed);
	explore.addRate('cpu', e.detail.cpu);
	if (e.detail.energy !== null)
		explore.add('energy', e.detail.energy);
	if (e.detail.penetration !== null)
		explore.add('penetration', 1000 * e.detail.penetration);
	panel.statistics(e.detail);
});
setInterval(() => {
	panel.speed(frames - framesTold, drawing?.software, frames > 0);
	framesTold = frames;
}, 1000);
universe.addEventListener('details', (e) => {
	if (e.detail.id !== picked)
		return;
	const { island, gone } = e.detail, others = [...universe.simulators.values()].filter((s) => s.island === island);
	panel.details({ ...e.detail, together: Math.max(1, others.length), colour: gone ? undefined : universe.objects.get(picked)?.colour });
	if (e.detail.p) {
		explore.add('height', e.detail.p[2]);
		explore.add('speed', Math.hypot(...e.detail.v));
	}
	read = e.detail.reads ?? [];
});
universe.addEventListener('error', (e) => panel.notice(e.detail));
universe.addEventListener('notice', (e) => panel.notice(e.detail, 15));
universe.addEventListener('close', (e) => {
	const wait = AGAIN[Math.min(tries++, AGAIN.length - 1)];
	panel.notice(`${e.detail || 'the server does not answer'}; trying again`, 0);
	setTimeout(() => universe.connect(), 1000 * wait);
});

async function begin() {
	panel.restore();
	drawing = new Drawing(canvas, asked.get('light'));
	await new Promise((resolve, reject) => {
		universe.addEventListener('population', resolve, { once: true }); // the first objects
		universe.connect()?.catch(reject);
	});
	requestAnimationFrame(frame);
}

// For tests and the console
window.obsim = { avatar: () => avatar, offers, walk, tour, kill, universe, camera, panel, workers, hand, explore, recorder, pick, frames: () => frames, drawing: () => drawing };
begin().catch((error) => panel.notice(error.message, 0));
