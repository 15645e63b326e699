// Offers of a scene to visitors: controls (keys, buttons, sliders, a gamepad), and parameters to start it anew with.
import { $, element, onHold } from './page.js';

const WIDE = 100; // largest by smallest value, beyond which a slider is logarithmic
const DEAD = 0.2; // part of a stick's way that means nothing
// Keys that a gamepad's stick (axis, direction) and arrows (buttons of the standard layout) stand for
const STICK = { w: { axis: 1, way: -1, arrow: 12 }, s: { axis: 1, way: 1, arrow: 13 }, a: { axis: 0, way: -1, arrow: 14 }, d: { axis: 0, way: 1, arrow: 15 } };

const short = (x) => Number(x.toPrecision(4)).toString();

export class Offers extends EventTarget {
	constructor() {
		super();
		this.controls = [];
		this.held = new Set(); // controls
		this.pad = new Set(); // keys and controls that the gamepad holds
		addEventListener('blur', () => this.letAll());
	}

	// The controls and parameters of a scene, as its welcome has them.
	welcome({ controls, params, seed, look_only, role, fixed }) {
		this.letAll();
		this.pad.clear();
		this.controls = look_only ? [] : controls ?? [];
		$('#controls').replaceChildren(...this.controls.map((c) => (c.range ? this.slider(c) : this.button(c))));
		$('#params').replaceChildren(...(role === 'operate' && params && !fixed ? [...params.map((p) => this.param(p)), this.seed(seed)] : []));
		const none = $('#controls').children.length + $('#params').children.length === 0;
		$('[data-do=offers]').hidden = none;
		return !none && this.controls.length > 0;
	}

	button(c) {
		const button = element('button', { textContent: c.label || c.sends, title: [c.sends, c.key, c.gamepad === undefined ? '' : `gamepad's button ${c.gamepad}`].filter((x) => x).join(', ') });
		if (c.key)
			button.append(element('kbd', { textContent: c.key }));
		onHold(button, () => this.hold(c, true), () => this.hold(c, false));
		return button;
	}

	slider(c) {
		const [min, max] = c.range;
		return this.range({ name: c.label, min, max, value: c.values[0] }, 'input', (value) => this.send(c, [value]));
	}

	param(p) {
		const label = this.range({ ...p, name: p.label || p.name }, 'change', (value) => this.dispatchEvent(new CustomEvent('set', { detail: { name: p.name, value } })));
		label.title = `Starts the scene anew, as -D ${p.name}= does`;
		return label;
	}

	// The seed as a number, and a button that chooses another one.
	seed(now) {
		const input = element('input', { type: 'number', min: 0, max: Number.MAX_SAFE_INTEGER, step: 1, value: now, name: 'seed' });
		const button = element('button', { textContent: 'Another', title: 'Start anew with a random seed' });
		const tell = (value) => this.dispatchEvent(new CustomEvent('seed', { detail: value }));
		input.addEventListener('change', () => tell(Number(input.value)));
		button.addEventListener('click', () => tell(Math.floor(Math.random() * 1e6)));
		return element('label', {}, 'seed', input, button);
	}

	range({ name, min, max, value, whole, unit }, event, tell) {
		const scale = min > 0 && max / min > WIDE ? { to: Math.log10, from: (x) => 10 ** x } : { to: Number, from: Number };
		const input = element('input', { type: 'range', min: scale.to(min), max: scale.to(max), step: whole && scale.to === Number ? 1 : 'any', name });
		input.value = scale.to(value);
		const chosen = () => {
			const x = Math.min(max, Math.max(min, scale.from(Number(input.value))));
			return whole ? Math.round(x) : x;
		};
		const output = element('output'), show = () => { output.value = `${short(chosen())} ${unit ?? ''}`; };
		input.addEventListener('input', show);
		input.addEventListener(event, () => tell(chosen()));
		show();
		return element('label', {}, name, input, output);
	}

	// A key goes down or up; true: a control has it.
	key(key, down) {
		const name = key.length === 1 ? key.toLowerCase() : key;
		const found = this.controls.filter((c) => c.key === name);
		for (const c of found)
			this.hold(c, down);
		return found.length > 0;
	}

	hold(c, down) {
		if (this.held.has(c) === down)
			return;
		if (down)
			this.held.add(c);
		else
			this.held.delete(c);
		if (c.values.length)
			this.send(c, this.sum(c));
		else if (down)
			this.send(c, []);
	}

	// Values of all held controls that send the same to the same object.
	sum({ sends, to, values }) {
		return values.map((_, k) => [...this.held].filter((c) => c.sends === sends && c.to === to).reduce((all, c) => all + (c.values[k] ?? 0), 0));
	}

	send({ sends, to }, values) {
		const text = [sends, ...values.map((x) => Number(x.toPrecision(4)))].join(' ');
		this.dispatchEvent(new CustomEvent('control', { detail: { to, text } }));
	}

	letAll() {
		for (const c of [...this.held])
			this.hold(c, false);
	}

	// Reads the first gamepad, once a frame: its stick and arrows stand for keys, its buttons for the scene's controls.
	look() {
		const pad = this.controls.length ? navigator.getGamepads?.().find((p) => p) : null;
		const pressed = (button) => pad?.buttons[button]?.pressed ?? false;
		for (const [key, { axis, way, arrow }] of Object.entries(STICK))
			this.turn(key, way * (pad?.axes[axis] ?? 0) > DEAD || pressed(arrow), (on) => this.key(key, on));
		for (const c of this.controls.filter((x) => x.gamepad !== undefined))
			this.turn(c, pressed(c.gamepad), (on) => this.hold(c, on));
	}

	// Calls what follows when the gamepad begins or ends to hold something.
	turn(what, on, act) {
		if (on === this.pad.has(what))
			return;
		if (on)
			this.pad.add(what);
		else
			this.pad.delete(what);
		act(on);
	}
}
