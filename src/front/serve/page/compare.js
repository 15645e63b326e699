// Worlds side by side: the same scene in each, at one instant, seen from one viewpoint. src/front/cli/compare_live.c holds their pace
// to each other, and sends the figures.
import { Camera, control, moveByKey } from './camera.js';
import { Drawing } from './drawing.js';
import { Sharpness } from './sharpness.js';
import { Universe } from './universe.js';
import { isEndless } from './shapes.js';
import { $, addressOf, count, element } from './page.js';

const GLOW = [5, 0.3, 1.5], HALO = [1, 0.2, 0.6]; // linear RGB, more than any surface reflects; sRGB
const HALOS = [[2.6, 0.04], [1.7, 0.07], [1, 0.12]]; // radii of its body, and opacity
const LEAST = 0.1, DECADES = 2.3; // share of the glow from the tolerance on; powers of 10 until it is whole
const FADE = 0.4; // s, in which a glow goes out
const AGAIN = 2; // s: wait before it connects again
const FACTS = ['CPU per object and second', 'deepest overlap so far', 'overlap now'];

const worlds = [], camera = new Camera(), sharpness = new Sharpness(), calm = matchMedia('(prefers-reduced-motion: reduce)');
const show = (e, text) => e.textContent === text || (e.textContent = text);
const number = (x) => (x < 0.0095 ? '0.01' : x < 9.95 ? x.toPrecision(2) : Math.round(x).toLocaleString('en'));
let tolerance = 0, frames = 0, told = null, begun = false;

function notice(text) {
	$('#notice').textContent = text;
	$('#notice').hidden = !text;
}

class World {
	constructor(n) {
		this.glow = new Map(); // by id: { depth: m, at: s }
		this.canvas = element('canvas', { tabIndex: 0 });
		this.name = element('h2');
		this.facts = element('dl');
		$('#worlds').append(element('figure', {}, this.canvas, element('figcaption', { className: 'panel' }, this.name, this.facts)));
		this.drawing = new Drawing(this.canvas, new URLSearchParams(location.hash.slice(1)).get('light'));
		this.universe = new Universe(`ws://${location.host}${addressOf(`/universe?world=${n}`)}`);
		this.universe.addEventListener('welcome', (e) => this.welcome(e.detail));
		this.universe.addEventListener('mesh', (e) => this.drawing.addMesh(e.detail));
		for (const what of ['error', 'notice'])
			this.universe.addEventListener(what, (e) => notice(e.detail));
		this.universe.addEventListener('close', (e) => {
			notice(`${e.detail || 'the server does not answer'}; trying again`);
			setTimeout(() => this.universe.connect(), 1000 * AGAIN);
		});
		control(this.canvas, camera, () => {}, () => false);
		this.universe.connect();
	}

	welcome(look) {
		this.look = look;
		notice('');
		show($('#title'), look.title);
		this.drawing.forgetMeshes();
		this.universe.fetchMeshes(look.meshes);
		if (!camera.placed)
			camera.set(look.cameras[0]);
		camera.placed = true;
	}

	// Figures of this world: s a body and simulated second, m. least: the lowest CPU of all.
	hear({ name, cpu, depth, deepest, deep }, least, now) {
		this.canvas.ariaLabel = name;
		show(this.name, name);
		const values = [cpu === null ? '–' : `${number(1e6 * cpu)} µs${cpu > least ? `, ${(cpu / least).toFixed(1)}\u202f×` : ''}`,
			...[deepest, depth].map((x) => (x === null ? '–' : x === 0 ? 'none' : `${number(1000 * x)} mm`))];
		if (!this.facts.children.length)
			this.facts.append(...FACTS.flatMap((what) => [element('dt', { textContent: what }), element('dd')]));
		this.facts.querySelectorAll('dd').forEach((e, i) => {
			show(e, values[i]);
			e.classList.toggle('deep', i > 0 && [deepest, depth][i - 1] > tolerance);
		});
		if (this.stands)
			this.glow.clear();
		for (const [id, m] of deep)
			this.glow.set(id, { depth: m, at: now });
		this.deep = deep.join();
	}

	get stands() { return this.universe.paused || this.universe.ended; }

	glowOf(id, now) {
		const glow = this.glow.get(id);
		return glow ? Math.min(1, LEAST + Math.log10(glow.depth / tolerance) / DECADES) * (this.stands ? 1 : Math.exp(-(now - glow.at) / FADE)) : 0;
	}

	bodies(now) {
		return [...this.universe.objects.values()].map((o) => {
			const body = this.universe.body(o, this.drawing.looks.get(o.mesh)), share = isEndless(o.shape) ? 0 : this.glowOf(o.id, now);
			if (body && share > 0.01)
				Object.assign(body, { glow: share, shown: body.shown.map((c, k) => c + share * (GLOW[k] - c)), meshColour: false });
			return body;
		}).filter((b) => b);
	}

	// Light around what glows, through what hides it.
	halos(list, view, height) {
		return list.filter((b) => b.glow).flatMap((b) => {
			const away = [0, 1, 2].reduce((sum, k) => sum + (b.p[k] - view.eye[k]) * view.forward[k], 0), pixels = b.radius * height / view.tanY / away;
			return away > 0 ? HALOS.map(([radii, opacity]) => ({ from: b.p, to: b.p, colour: [...HALO, b.glow * opacity], width: radii * pixels, over: true })) : [];
		});
	}

	// An unchanged picture is not drawn again.
	draw(list, view, width, height, moved, seconds) {
		const { universe, drawing, canvas } = this, glows = list.some((b) => b.glow);
		const seen = [list.every((b) => b.rests) || universe.time, universe.news, drawing.looks.size, width, height, glows && (this.stands ? this.deep : performance.now())].join();
		const changes = moved || seen !== this.seen, share = drawing.software ? sharpness.next(seconds, changes) : 1, smooth = !drawing.software || !changes;
		const form = `${share} ${smooth}`;
		if (!changes && form === this.form)
			return;
		[this.seen, this.form] = [seen, form];
		const size = [width, height].map((x) => Math.round(x * share));
		if (canvas.width !== size[0] || canvas.height !== size[1])
			[canvas.width, canvas.height] = size;
		drawing.draw(list, view, this.look, this.halos(list, view, canvas.height), smooth, share);
	}
}

let before = performance.now(), shownView = null;
function frame(now) {
	const seconds = Math.min(0.25, (now - before) / 1000), scale = Math.min(2, devicePixelRatio || 1), { canvas } = worlds[0];
	const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * scale)));
	const ready = worlds.filter((w) => w.look && w.universe.toldAt > 0);
	before = now;
	// One instant for all pictures, which all worlds have reached.
	const instant = Math.min(...ready.flatMap(({ universe }) => [universe.advance(seconds), universe.told]));
	for (const w of ready)
		w.universe.time = instant;
	const lists = ready.map((w) => w.bodies(now / 1000));
	if (camera.following && !calm.matches)
		camera.follow(lists.flat(), width, height);
	if (camera.goes)
		camera.go(lists.flat());
	const view = camera.view(width, height), moved = camera.moved(shownView, height);
	ready.forEach((w, i) => w.draw(lists[i], view, width, height, moved, seconds));
	if (moved)
		shownView = { eye: view.eye, target: [...camera.target] };
	if (!begun && told && ready.length === worlds.length) { // the first visitor is there
		begun = true;
		if (told.worlds[0].time === 0)
			worlds[0].universe.send({ do: 'resume' });
	}
	if (ready.length) {
		show($('#clock'), `${Math.max(0, instant).toFixed(2)} s`);
		show($('[data-do=pause]'), ready[0].stands ? '▶' : '❚❚');
	}
	frames++;
	requestAnimationFrame(frame);
}

function hear(message) {
	const now = performance.now() / 1000, [{ time }] = message.worlds, least = Math.min(...message.worlds.map((w) => w.cpu ?? Infinity));
	told = message;
	({ tolerance } = told);
	while (worlds.length < told.worlds.length)
		add();
	for (const w of worlds)
		w.universe.ended = told.ended;
	told.worlds.forEach((w, i) => worlds[i].hear(w, least, now));
	const together = told.worlds.every((w) => w.time === time);
	show($('#idea'), `The same scene in ${count(worlds.length, 'run')}. What glows is more than ${1000 * tolerance}\u00a0mm inside another object.`);
	show($('#statistics'), together ? `${told.ended ? 'The end: all' : 'All'} at the same instant, ${time.toFixed(2)} s` : 'Not at the same instant');
}

function add() {
	const world = new World(worlds.length);
	if (worlds.length === 0)
		world.universe.addEventListener('comparison', (e) => hear(e.detail));
	worlds.push(world);
}

// All worlds have one pace, which the first takes requests for.
const ask = {
	pause: () => (worlds[0].universe.ended ? ask.again() : worlds[0].universe.send({ do: worlds[0].universe.paused ? 'resume' : 'pause' })),
	step: () => worlds[0].universe.send({ do: 'step' }),
	again: () => worlds[0].universe.send({ do: 'seed', value: worlds[0].look.seed }),
};
document.querySelectorAll('[data-do]').forEach((e) => e.addEventListener('click', () => ask[e.dataset.do]()));
$('#rate').addEventListener('change', (e) => worlds[0].universe.send({ do: 'rate', rate: Number(e.target.value) }));
document.addEventListener('keydown', (e) => {
	const what = { ' ': 'pause', '.': 'step', r: 'again' }[e.key];
	if (e.ctrlKey || e.metaKey || e.target.closest('select') || (what === 'pause' && e.target.closest('button')))
		return;
	if (what)
		ask[what]();
	if (what || moveByKey(camera, e.key))
		e.preventDefault();
});

add();
requestAnimationFrame(frame);
window.obsim = { worlds, camera, frames: () => frames }; // for tests and the console
