// The strip of workers: colour, process, CPU, and what each does now; the choice of colours; and the own times of a free run.
import { colourOfNumber, colourOfShare, cssColour, shareOfLead } from './colouring.js';

const SPAN = 1; // s over which a share of CPU is taken: the host refreshes CPU times twice a second
const MOST = 16; // rows: beyond that, the workers with the most CPU
const PLACES = 128; // in the ribbon of own times: simulators at one place share a line
const SVG = 'http://www.w3.org/2000/svg';

const $ = (selector) => document.querySelector(selector);

export class Workers extends EventTarget {
	constructor() {
		super();
		this.list = []; // { pid, rank, objects, cpu, busy, share }, by worker
		this.marks = []; // { at, cpu } a worker, from which shares are taken
		$('#colours').addEventListener('change', () => this.dispatchEvent(new CustomEvent('colours', { detail: this.key })));
	}

	get key() { return $('#colours').value; }

	show(on) { $('#workers').hidden = !on; }

	// A recording holds where simulators ran only if it is a viewer's own.
	film() {
		this.filmed = true;
		this.offer(false);
		$('#workers table').hidden = true;
	}

	// Offers colours by workers, or hides them.
	offer(on) {
		for (const value of ['worker', 'process', 'rank'])
			$(`#colours [value=${value}]`).hidden = !on;
	}

	// simulators: as the universe has them; those of a free run have own times, and each worker runs its own ones.
	hear(rows, nameOf, simulators, now = performance.now() / 1000) {
		const own = Array(rows.length).fill(0), free = [...simulators.values()].filter((s) => !Number.isNaN(s.lead));
		for (const { home } of free)
			own[home]++;
		this.list = rows.map(([pid, rank, objects, cpu, busy], i) => {
			const mark = this.marks[i] ??= { at: now, cpu, share: null, pid }, span = now - mark.at;
			if (mark.pid !== pid)
				Object.assign(mark, { at: now, cpu, share: null, pid });
			else if (span >= SPAN)
				Object.assign(mark, { at: now, share: Math.max(0, cpu - mark.cpu) / span, cpu });
			return { pid, rank, objects: free.length ? own[i] : objects, cpu, busy, share: mark.share };
		});
		if (this.filmed)
			this.offer(true);
		if ($('#workers').hidden)
			return;
		const rowsShown = this.list.map((w, i) => ({ ...w, i }));
		if (rowsShown.length > MOST)
			rowsShown.sort((a, b) => (b.share ?? 0) - (a.share ?? 0) || a.i - b.i);
		$('#workers tbody').replaceChildren(...rowsShown.slice(0, MOST).map((w) => this.row(w, nameOf)));
		const more = rowsShown.length - MOST;
		$('#workers .rest').textContent = more > 0 ? `and ${more} more, with less CPU` : '';
	}

	// The ribbon: a line for each place on the scale of leads, the higher the more simulators are there.
	times(simulators) {
		const leads = [...simulators.values()].map((s) => s.lead).filter((lead) => !Number.isNaN(lead)), counts = Array(PLACES).fill(0);
		$('#times').hidden = leads.length === 0;
		if ($('#workers').hidden || leads.length === 0)
			return;
		for (const lead of leads)
			counts[Math.round((PLACES - 1) * Math.min(1, shareOfLead(lead)))]++;
		$('#times output').value = `${leads.length} simulators`;
		$('#times svg').replaceChildren(...counts.flatMap((n, i) => {
			if (n === 0)
				return [];
			const bar = document.createElementNS(SVG, 'rect'), high = 0.3 + 0.7 * Math.sqrt(n / Math.max(...counts));
			for (const [name, value] of Object.entries({ x: i / PLACES, y: 1 - high, width: 1 / PLACES, height: high, fill: cssColour(colourOfShare(i / (PLACES - 1))) }))
				bar.setAttribute(name, value);
			return [bar];
		}));
	}

	row({ i, pid, rank, objects, share, busy }, nameOf) {
		const tr = document.createElement('tr'), chip = document.createElement('i'), bar = document.createElement('meter');
		chip.style.background = cssColour(colourOfNumber(i));
		Object.assign(bar, { max: 1, value: share ?? 0, title: share === null ? '' : `${Math.round(100 * share)} % of a core` });
		const ranks = this.list.some((w) => w.rank > 0);
		const cells = [chip, `${i}`, `pid ${pid}${ranks ? `, rank ${rank}` : ''}`, bar, `${objects}`, busy === null ? 'waits' : nameOf(busy)];
		tr.append(...cells.map((content) => {
			const td = document.createElement('td');
			td.append(content);
			return td;
		}));
		return tr;
	}
}
