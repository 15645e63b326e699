// Controls around the picture: the clock, the tools, and details of the picked object. Independent of drawing.
import { hexColour } from './colouring.js';
import { $, count, kept, onHold } from './page.js';
import { makeShape } from './shapes.js';

const MATERIALS = { // kg/m3, friction, restitution, linear RGB, roughness, metal
	wood: [600, 0.5, 0.1, [0.43, 0.22, 0.08], 0.62, 0], steel: [7800, 0.4, 0.3, [0.56, 0.57, 0.58], 0.32, 1],
	rubber: [1100, 0.9, 0.7, [0.09, 0.09, 0.11], 0.8, 0], ice: [917, 0.03, 0.1, [0.55, 0.72, 0.83], 0.1, 0],
};
const KEYS = { ' ': 'pause', '.': 'step', ',': 'back', n: 'make', b: 'boxes', c: 'contacts', j: 'joints', v: 'view', m: 'simulators', o: 'objects', p: 'offers', f: 'follow', '?': 'help', t: 'throw', r: 'restart', Delete: 'remove',
	Escape: 'leave' };

const EDITS = { // fields of the picked object: their numbers, as expected, and as its details have them
	friction: { numbers: 1, expected: 'a number', of: (d) => [d.friction] },
	at: { numbers: 3, expected: 'three numbers, as 0 0 1.5', of: (d) => d.p },
	attitude: { numbers: 4, expected: 'an axis and degrees, as 0 0 1 45', of: (d) => axisAndDegrees(d.q) },
	velocity: { numbers: 3, expected: 'three numbers, as 0 0 1.5', of: (d) => d.v },
	spin: { numbers: 3, expected: 'three numbers, as 0 0 1.5', of: (d) => d.w },
};
const PANELS = { simulators: '#workers', objects: '#objects', offers: '#offers', make: '#maker', help: '#help' };
const CLOCK_GAP = 100; // ms
const MARKS_MOST = 400; // on the time bar
const MORE = new Set(['friction', 'restitution', 'island', 'substeps']); // details that small screens leave out

const number = (x, digits = 3) => (Math.abs(x) < 5e-4 ? '0' : Number(x.toPrecision(digits)).toString());
const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
// Changes what an element shows, if it shows something else: a changed page is composed anew.
const show = (selector, property, value) => {
	const e = $(selector);
	if (e[property] !== value)
		e[property] = value;
};
// Hides a panel, or shows it where its column shows it, too.
const unfold = (panel, on) => {
	const shows = on && panel.hidden;
	panel.hidden = !on;
	if (shows)
		panel.scrollIntoView({ block: 'nearest' });
};
const vector = (v, between = ', ') => v.map((x) => number(x)).join(between);

// A unit quaternion (w x y z) as an axis and degrees from 0 to 180 about it, and back; the axis has any length but 0.
function axisAndDegrees([w, ...v]) {
	const long = Math.hypot(...v), sign = w < 0 ? -1 : 1;
	return [...(long > 1e-9 ? v.map((x) => sign * x / long) : [0, 0, 1]), 360 / Math.PI * Math.atan2(long, Math.abs(w))];
}
function quaternion([x, y, z, degrees]) {
	const half = degrees * Math.PI / 360, share = Math.sin(half) / Math.hypot(x, y, z);
	return [Math.cos(half), x * share, y * share, z * share];
}

export class Panel extends EventTarget {
	constructor() {
		super();
		this.off = new Set(); // unavailable controls
		this.clockAt = -Infinity; // ms, of its last change
		this.on = { make: false, boxes: false, contacts: false, joints: false, simulators: false, objects: false, offers: false, help: false };
		document.addEventListener('click', (e) => {
			const button = e.target.closest('[data-do]');
			if (button)
				this.ask(button.dataset.do);
		});
		for (const button of document.querySelectorAll('nav [title]'))
			button.ariaLabel = button.title;
		const folds = [...document.querySelectorAll('details.panel')];
		for (const panel of folds) {
			panel.open = !kept('folded')?.includes(panel.id);
			panel.addEventListener('toggle', () => kept('folded', folds.filter((p) => !p.open).map((p) => p.id)));
		}
		onHold($('[data-hold=push]'), () => this.tell('push'), () => this.tell('let'));
		$('#rate').addEventListener('change', (e) => this.tell('rate', Number(e.target.value)));
		$('#time').addEventListener('input', (e) => this.tell('seek', Number(e.target.value)));
		$('#talk').addEventListener('submit', (e) => {
			e.preventDefault();
			const { text } = e.target.elements;
			if (text.value)
				this.tell('message', { text: text.value });
			text.value = '';
		});
		$('#edit').addEventListener('change', (e) => this.edit(e.target.name, e.target.value));
		for (const input of document.querySelectorAll('#maker input')) {
			const show = () => { input.nextElementSibling.value = `${Number(input.value)} m`; };
			input.addEventListener('input', show);
			show();
		}
	}

	tell(name, detail) { this.dispatchEvent(new CustomEvent(name, { detail })); }

	// Handles a key; true: it has a meaning here.
	key(key) {
		const what = KEYS[key.length === 1 ? key.toLowerCase() : key];
		if (what)
			this.ask(what);
		return what !== undefined;
	}

	// Esc leaves one thing after the other, the uppermost first.
	leave() {
		const open = ['help', 'make'].find((what) => this.on[what]);
		this.ask(open ?? 'deselect');
	}

	ask(what) {
		if (what === 'leave')
			return this.leave();
		if (this.off.has(what))
			return undefined;
		if (what in this.on) {
			this.on[what] = !this.on[what];
			$(`[aria-pressed][data-do=${what}]`).setAttribute('aria-pressed', this.on[what]);
			if (what in PANELS)
				unfold($(PANELS[what]), this.on[what]);
			$('#picture').classList.toggle('making', this.on.make);
			const { make, help, ...lasting } = this.on;
			kept('panels', lasting);
		}
		this.tell(what, this.on[what]);
		return undefined;
	}

	// Opens what was open at the last visit.
	restore() {
		for (const [what, on] of Object.entries(kept('panels') ?? {}))
			if (on && !this.on[what])
				this.ask(what);
	}

	// A changed field of the picked object.
	edit(name, text) {
		if (name === 'colour')
			return this.tell('edit', { colour: [1, 3, 5].map((i) => linear(parseInt(text.slice(i, i + 2), 16) / 255)) });
		const given = text.trim().split(/[\s,]+/).map(Number), { numbers, expected } = EDITS[name];
		const value = name === 'attitude' ? quaternion(given) : numbers === 1 ? given[0] : given;
		if (given.length !== numbers || [value].flat().some((x) => !Number.isFinite(x)))
			return this.notice(`${name}: expected ${expected}`);
		return this.tell('edit', { [name]: value });
	}

	// Fills in the fields to edit, but for one that is being written.
	fillEdit(d) {
		const hidden = $('#edit').hidden = !(d.mass > 0) || !this.operates;
		for (const field of hidden ? [] : $('#edit').querySelectorAll('input')) {
			if (field !== document.activeElement)
				field.value = field.name === 'colour' ? hexColour(d.colour) : vector(EDITS[field.name].of(d), ' ');
		}
	}

	// Object to create, without its place: { shape, size, mass, colour .. } of a command, and its height over the
	// place.
	get wanted() {
		const value = (name) => $(`#maker [name=${name}]`).value;
		const s = Number(value('size')), shape = value('shape');
		const [density, friction, restitution, colour, roughness, metal] = MATERIALS[value('material')];
		const make = makeShape(shape, s);
		const shade = 0.85 + 0.3 * Math.random();
		return {
			command: { do: 'create', shape, size: make.size, mass: density * make.volume, friction, restitution, roughness, metal,
				colour: colour.map((c) => Math.min(1, c * shade)) },
			over: Number(value('height')) + s / 2,
		};
	}

	welcome(w) {
		$('#title').textContent = w.title;
		document.title = `${w.title} – obsim`;
		const operates = this.operates = w.role === 'operate';
		for (const what of ['pause', 'step', 'restart', 'make', 'remove', 'throw'])
			for (const button of document.querySelectorAll(`[data-do=${what}]`))
				button.disabled = w.look_only || (!operates && ['pause', 'step', 'restart'].includes(what));
		$('#rate').disabled = !operates;
		$('[data-do=save]').hidden = !(operates && w.saves);
		this.looksOnly = w.look_only;
		this.isolation = w.isolation;
		this.kills = operates && w.isolation === 'process';
		this.free = w.sync === 'free';
		$('#colours [value=lag]').hidden = !this.free;
		this.pool = `one of ${w.isolation === 'process' ? count(w.workers, 'process', 'processes') : count(w.workers, 'thread')}`;
	}

	idea(text) { show('#idea', 'textContent', text); }

	// Shows if the viewpoint follows the picked object
	follows(on) { $('[data-do=follow]').setAttribute('aria-pressed', on); }

	// Shows pictures per second, from the first on; software rendering has few.
	speed(frames, software, began) {
		$('#speed').textContent = !began ? '' : `${count(frames, 'picture')} a second${software ? ', drawn without a GPU' : ''}`;
	}

	// Shows the controls of a recording: a time bar, and none that change objects.
	film(f) {
		const span = f.end - f.begin || 1;
		document.body.classList.add('film');
		for (const what of ['pause', 'step', 'back'])
			$(`[data-do=${what}]`).disabled = $(`[data-do=${what}]`).hidden = false;
		this.off = new Set(['make', 'throw', 'contacts', 'remove', 'restart', 'record']);
		for (const what of ['make', 'contacts', 'remove', 'restart', 'record'])
			$(`[data-do=${what}]`).hidden = true;
		for (const part of document.querySelectorAll('#film, .film'))
			part.hidden = false;
		$('#rate').disabled = false;
		Object.assign($('#rate').options[4], { value: '16', textContent: '16 ×' });
		Object.assign($('#time'), { min: f.begin, max: f.end });
		$('#length').value = `${f.end.toFixed(2)} s`;
		$('#statistics').textContent = `recorded ${f.created.slice(0, 10)} by obsim ${f.version}${f.seed ? `, seed ${f.seed}` : ''}`;
		$('#statistics').title = `commit ${f.commit}`;
		const shown = f.events.filter((_, i) => i % Math.ceil(f.events.length / MARKS_MOST) === 0);
		$('#marks').replaceChildren(...shown.map(([time, kind, , name]) => {
			const mark = document.createElement('i');
			mark.className = kind > 0 ? 'came' : 'went'; // 0: a joint breaks
			mark.style.left = `${100 * (time - f.begin) / span}%`;
			mark.title = `${name} ${['ends', 'breaks', 'begins'][kind + 1]}`;
			return mark;
		}));
	}

	statistics(s) {
		const parts = [s.ended && `ended after ${count(s.step, 'step')}`, `${s.awake} of ${count(s.objects, 'object')} awake`, count(s.islands, 'island'), count(s.viewers, 'viewer'),
			s.frozen && `${s.frozen} frozen`, s.deaths && count(s.deaths, 'death'), s.hash && `hash ${s.hash}`];
		show('#statistics', 'textContent', parts.filter((part) => part).join(', '));
		if (this.deaths !== undefined && s.deaths > this.deaths)
			this.notice(`${s.last_death}. ${this.free ? 'It goes on where it had published.' : 'All simulators were started again from the last checkpoint, and reach the same bits.'}`, 8);
		else if (s.ended && !this.ended)
			this.notice(`The run has ended after ${count(s.step, 'step')}${s.deaths ? `, with ${count(s.deaths, 'death')}` : ''}; hash of its state: ${s.hash}`, 0);
		this.deaths = s.deaths;
		this.ended = s.ended;
	}

	// Shows the clock, ten times a second: without a GPU changed text costs a fifth of a frame's time.
	clock(time, rate, paused, now = performance.now()) {
		if (now - this.clockAt < CLOCK_GAP)
			return;
		this.clockAt = now;
		show('#clock', 'value', `${time.toFixed(2)} s`);
		show('#time', 'value', `${time}`);
		show('#pause', 'textContent', paused ? '▶' : '❚❚');
		const option = [...$('#rate').options].find((o) => Number(o.value) === (Number.isFinite(rate) ? Number(rate.toPrecision(6)) : 0));
		if (option && document.activeElement !== $('#rate'))
			show('#rate', 'value', option.value);
	}

	// null: none is picked
	details(d) {
		if (!d) {
			$('#details').hidden = true;
			return;
		}
		$('#details h2').textContent = d.gone ? `object ${d.id} no longer exists` : d.name || `object ${d.id}`;
		const facts = d.gone ? [] : [['number', d.id], ['state', d.state]];
		if (!d.gone && d.mass > 0)
			facts.push(['mass', `${number(d.mass, 4)} kg`], ['friction', number(d.friction)], ['restitution', number(d.restitution)],
				['position', `${vector(d.p)} m`], ['velocity', `${vector(d.v)} m/s`], ['rotation', `${vector(d.w)} rad/s`]);
		if (d.mass > 0 && d.island !== undefined && !this.free)
			facts.push(['island', count(d.together, 'object')], ['substeps', d.substeps || 'none: it rests']);
		if (d.script)
			facts.push(['script', d.script]);
		if (d.home !== undefined)
			facts.push(['simulator', `worker ${d.home}, process ${d.pid}`], ['CPU of worker', `${d.cpu_s.toFixed(2)} s`], ['reads', d.reads === undefined ? 'many objects' : count(d.reads.length, 'object')]);
		else if (d.island !== undefined && d.mass > 0)
			facts.push(['simulator', this.pool]);
		else if (d.reads && d.mass > 0) // of a recording
			facts.push(['reads', count(d.reads.length, 'object')]);
		if (d.ahead_s !== undefined && d.mass > 0)
			facts.push(['own time', `${number(1000 * d.ahead_s)} ms ahead`], ['waits for', d.waits_for === undefined ? 'none' : `object ${d.waits_for}`]);
		this.mass = d.mass;
		this.offerKill(d);
		this.fillEdit(d);
		$('#talk').hidden = d.gone || !d.script || this.looksOnly;
		$('[data-hold=push]').hidden = d.gone || !(d.mass > 0) || this.looksOnly;
		$('#details dl').replaceChildren(...facts.flatMap(([name, value]) => {
			const dt = document.createElement('dt'), dd = document.createElement('dd');
			dt.className = dd.className = MORE.has(name) ? 'more' : '';
			dt.textContent = name;
			dd.textContent = value;
			return [dt, dd];
		}));
		unfold($('#details'), true);
	}

	// Offers to kill the process that simulates the picked object, with the names of all objects in it.
	offerKill(d) {
		const button = $('[data-do=kill]'), why = $('#details .why'), shared = d.shares ?? [];
		button.hidden = d.gone || d.home === undefined || !this.operates;
		button.disabled = this.isolation !== 'process';
		button.textContent = `Kill worker ${d.home}`;
		why.hidden = button.hidden;
		const named = shared.map((name, i) => name || `object ${i}`).join(', '), more = (d.shared ?? 0) - shared.length;
		why.textContent = button.disabled ? 'Its simulator is a thread of one process, which a kill would end as a whole; serve with --isolation process.' :
			`It simulates ${named}${more > 0 ? ` and ${more} more` : ''}. ${this.free ? 'They go on where they had published; others do not wait.' : 'All simulators start again from the last checkpoint, and reach the same bits.'}`;
	}

	// Shows a notice for some seconds, or, with none, until the next
	notice(text, seconds = 4) {
		clearTimeout(this.fading);
		$('#notice').textContent = text;
		$('#notice').hidden = !text;
		if (seconds)
			this.fading = setTimeout(() => { $('#notice').hidden = true; }, 1000 * seconds);
	}
}
