// The panel of all objects: a tree by name with a search, plots that stream, pictures, video, and the viewpoint's address.
import { $, element } from './page.js';

const MOST = 100; // objects of an open group; beyond, the search finds them
const SPAN = 240; // values in a plot: a minute, a quarter of a second each
const LINES = { awake: 'objects awake', pace: 'pace, times real time', cpu: 'CPU of all simulators, cores', energy: 'energy, J', penetration: 'deepest penetration, mm', height: 'height of the picked object, m', speed: 'speed of the picked object, m/s' };
const HIGH = 34; // px
const FPS = 30;
const SVG = 'http://www.w3.org/2000/svg';

const short = (x) => (Math.abs(x) >= 1e6 || (x !== 0 && Math.abs(x) < 1e-3) ? x.toExponential(1) : Number(x.toPrecision(3)).toString());

// An empty plot, as SVG: a canvas would compete with the picture for the GPU.
function line() {
	const svg = document.createElementNS(SVG, 'svg');
	svg.setAttribute('viewBox', `0 0 ${SPAN - 1} ${HIGH}`);
	svg.setAttribute('preserveAspectRatio', 'none');
	svg.append(document.createElementNS(SVG, 'polyline'));
	return svg;
}

export function save(url, name) {
	element('a', { href: url, download: name }).click();
}

export class Explore extends EventTarget {
	constructor(universe) {
		super();
		this.universe = universe;
		this.values = Object.fromEntries(Object.keys(LINES).map((name) => [name, []]));
		this.marks = {}; // by name: { total, at: s, rate } from which the next rate is taken
		this.open = new Set(); // groups
		$('#search').addEventListener('input', () => this.list());
		$('#tree').addEventListener('click', (e) => {
			if (e.target.dataset.id)
				this.dispatchEvent(new CustomEvent('pick', { detail: Number(e.target.dataset.id) }));
		});
		for (const [name, title] of Object.entries(LINES))
			$('#plots').append(element('figure', { id: `plot-${name}`, hidden: true }, element('figcaption', { textContent: title }), element('output', {}), line()));
	}

	// Objects by the name without its number; those that the search leaves.
	list() {
		if ($('#objects').hidden)
			return;
		const wanted = $('#search').value.trim().toLowerCase(), groups = new Map();
		for (const o of this.universe.objects.values()) {
			const name = o.name || `object ${o.id}`, group = name.replace(/[\s#_-]*\d+$/, '') || name;
			if (wanted && !name.toLowerCase().includes(wanted) && `${o.id}` !== wanted)
				continue;
			groups.set(group, [...(groups.get(group) ?? []), { id: o.id, name }]);
		}
		const key = document.activeElement?.dataset.key;
		$('#tree').replaceChildren(...[...groups].sort().map(([name, members]) => this.group(name, members, wanted !== '')));
		if (key !== undefined) // the keyboard's focus stays, though objects come and go
			[...$('#tree').querySelectorAll('[data-key]')].find((e) => e.dataset.key === key)?.focus({ preventScroll: true });
	}

	group(name, members, open) {
		const leaf = (o) => {
			const b = element('button', { textContent: o.name });
			b.dataset.id = b.dataset.key = o.id;
			return b;
		};
		if (members.length === 1)
			return leaf(members[0]);
		const box = element('details', { open: open || this.open.has(name) }, element('summary', { textContent: `${name} (${members.length})` }));
		box.firstChild.dataset.key = `group ${name}`;
		const fill = () => {
			if (box.open && box.children.length === 1)
				box.append(...members.slice(0, MOST).map(leaf), ...(members.length > MOST ? [`and ${members.length - MOST} more`] : []));
		};
		box.addEventListener('toggle', () => {
			this.open[box.open ? 'add' : 'delete'](name);
			fill();
		});
		fill();
		return box;
	}

	// Adds a value to a plot.
	add(name, value) {
		const values = this.values[name];
		values.push(value);
		if (values.length > SPAN)
			values.shift();
		if (!$('#objects').hidden)
			this.draw(name, values);
	}

	// Adds the rate at which a total grows, as a mean over a second.
	addRate(name, total, now = performance.now() / 1000) {
		const mark = this.marks[name] ??= { total, at: now, rate: 0 }, span = now - mark.at;
		if (span >= 1)
			Object.assign(mark, { total, at: now, rate: Math.max(0, total - mark.total) / span });
		this.add(name, mark.rate);
	}

	drop(...names) {
		for (const name of names) {
			this.values[name].length = 0;
			$(`#plot-${name}`).hidden = true;
		}
	}

	draw(name, values) {
		const figure = $(`#plot-${name}`), low = Math.min(...values), span = Math.max(...values) - low || 1;
		figure.hidden = false;
		figure.querySelector('output').value = short(values.at(-1));
		figure.querySelector('polyline').setAttribute('points', values.map((v, i) => `${i},${(HIGH - 2 - (HIGH - 4) * (v - low) / span).toFixed(1)}`).join(' '));
	}

	picture(canvas) { save(canvas.toDataURL('image/png'), 'obsim.png'); }

	// Begins a video, or ends it and saves it.
	video(canvas) {
		if (this.recorder) {
			this.recorder.stop();
			this.recorder = null;
			return false;
		}
		const parts = [];
		this.recorder = new MediaRecorder(canvas.captureStream(FPS), { mimeType: 'video/webm' });
		this.recorder.ondataavailable = (e) => parts.push(e.data);
		this.recorder.onstop = () => save(URL.createObjectURL(new Blob(parts, { type: 'video/webm' })), 'obsim.webm');
		this.recorder.start();
		return true;
	}
}
