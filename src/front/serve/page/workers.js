// The strip of workers: colour, process, CPU, simulators and deaths of each; the choice of colours; and own times.
import { colourOfNumber, colourOfShare, cssColour, shareOfLead } from './colouring.js';
import { $, count, element } from './page.js';

const SPAN = 1; // s over which a share of CPU is taken: the host refreshes CPU times twice a second
const FEW = 8; // workers that have a row each; more have a bar each
const ROW = 24, BAR = 18, GAP = 10; // px: heights, and between panels (style.css)
const MOST = 128; // bars: beyond that, the workers with the most CPU
const PALE = 2.5; // s in which the objects of a worker that died come back
const PLACES = 128; // in the ribbon of own times: simulators at one place share a line
const SVG = 'http://www.w3.org/2000/svg';
const show = (e, text) => e.textContent === text || (e.textContent = text); // a changed page is composed anew
const MEANINGS = {
	own: '', simulator: 'each object a colour of its own: it is a simulator of its own', worker: 'by the worker that ran its simulator last, as in the strip',
	process: 'by the process of its worker', rank: 'by the rank of its worker', island: 'bodies that are solved together have one colour',
	rest: 'orange: touches; cyan: flies; green: in equilibrium; blue: asleep', cost: 'dark to bright: substeps that its island needs; grey: not solved',
	lag: 'dark to bright: how far its own time is ahead',
};

export class Workers extends EventTarget {
	constructor() {
		super();
		this.list = []; // { pid, rank, ran, objects, cpu, busy, share, died }, by worker; ran: objects of the last step; objects: all that are at home there
		this.marks = []; // { at, cpu, died } a worker, from which shares are taken; died: s, of the clock
		this.homes = new Map(); // worker of each simulator, by id
		this.past = []; // { at: s, of the clock, homes }, by message, for as long as a death shows
		this.pale = new Map(); // by id: s, of the clock, at which its worker died
		$('#colours').addEventListener('change', () => this.choose(this.key));
		const resized = new ResizeObserver(() => this.fold());
		for (const panel of [$('#left'), ...$('#left').children])
			resized.observe(panel);
	}

	get key() { return $('#colours').value; }

	choose(key) {
		$('#colours').value = key;
		$('#meaning').textContent = MEANINGS[key];
		this.dispatchEvent(new CustomEvent('colours', { detail: key }));
	}

	// kills: a visitor may kill processes.
	welcome({ workers, isolation, arch }, kills) {
		Object.assign(this, { workers, isolation, kills, world: arch === 'monolith' });
		$('#strip p span').textContent = isolation === 'process' ? 'Process' : 'Thread';
	}

	// A recording holds where simulators ran only if it is a viewer's own.
	film() {
		this.filmed = true;
		this.offer(false);
	}

	// Offers colours by workers, or hides them.
	offer(on) {
		for (const value of ['worker', 'process', 'rank'])
			$(`#colours [value=${value}]`).hidden = !on;
	}

	// The idea in one line, of a universe with n objects that move.
	idea(n) {
		const ranks = 1 + Math.max(0, ...this.list.map((w) => w.rank)), workers = this.list.length || this.workers;
		const where = this.isolation === 'process' ? count(workers, 'process', 'processes') : `${count(workers, 'thread')} of one process`;
		if (this.world)
			return `${count(n, 'object')} in one world, for comparison`;
		return this.filmed ? `${count(n, 'simulator')}, recorded` :
			`${count(n, 'simulator')} in ${where}${ranks > 1 ? ` on ${ranks} ranks` : ''}: click one${this.kills ? ', kill one' : ''}`;
	}

	hear(rows, nameOf, now = performance.now() / 1000) {
		const own = Array(rows.length).fill(0);
		for (const home of this.homes.values())
			own[home]++;
		this.list = rows.map(([pid, rank, ran, cpu, busy, ago], i) => {
			const mark = this.marks[i] ??= { at: now, cpu, share: null, pid, died: -Infinity }, span = now - mark.at;
			if (mark.pid !== pid)
				Object.assign(mark, { at: now, cpu, share: null, pid });
			else if (span >= SPAN)
				Object.assign(mark, { at: now, share: Math.max(0, cpu - mark.cpu) / span, cpu });
			if (typeof ago === 'number' && ago < PALE && now - ago > mark.died + SPAN)
				this.die(i, mark.died = now - ago);
			return { pid, rank, ran, objects: own[i], cpu, busy, share: mark.share, died: now - mark.died < PALE };
		});
		if (this.filmed)
			this.offer(true);
		const shown = this.list.map((w, i) => ({ ...w, i }));
		if (shown.length > MOST)
			shown.sort((a, b) => b.died - a.died || (b.share ?? 0) - (a.share ?? 0) || a.i - b.i);
		$('#strip').hidden = this.world;
		this.rows(shown.slice(0, MOST));
		this.fold();
		const more = shown.length - MOST;
		$('#strip .rest').textContent = more > 0 ? `and ${more} more, with less CPU` : '';
		const busy = this.list.filter((w) => w.busy !== null);
		$('#busy').textContent = busy.length ? `Busy now: ${busy.slice(0, FEW).map((w) => nameOf(w.busy)).join(', ')}${busy.length > FEW ? ' ..' : ''}` : 'All wait for the next step.';
	}

	// Worker i died: the objects that it simulated then turn pale. All leave their homes as they start again.
	die(i, at) {
		for (const [id, home] of this.past.findLast((p) => p.at < at && [...p.homes.values()].includes(i))?.homes ?? [])
			if (home === i)
				this.pale.set(id, at);
	}

	// Share by which an object is pale, from 1 at its worker's death to 0.
	paleness(id, now = performance.now() / 1000) {
		const share = 1 - (now - this.pale.get(id)) / PALE;
		if (share <= 0)
			this.pale.delete(id);
		return share > 0 ? share : 0;
	}

	// Notes homes of simulators, and draws the ribbon: a line for each place on the scale of leads, the higher the more are there.
	times(simulators) {
		const now = performance.now() / 1000;
		this.homes = new Map([...simulators].map(([id, s]) => [id, s.home]));
		this.past = [...this.past.filter((p) => p.at > now - PALE), { at: now, homes: this.homes }];
		const leads = [...simulators.values()].map((s) => s.lead).filter((lead) => !Number.isNaN(lead)), counts = Array(PLACES).fill(0);
		$('#times').hidden = leads.length === 0;
		if (leads.length === 0)
			return;
		for (const lead of leads)
			counts[Math.round((PLACES - 1) * Math.min(1, shareOfLead(lead)))]++;
		$('#times output').value = count(leads.length, 'simulator');
		$('#times svg').replaceChildren(...counts.flatMap((n, i) => {
			if (n === 0)
				return [];
			const bar = document.createElementNS(SVG, 'rect'), high = 0.3 + 0.7 * Math.sqrt(n / Math.max(...counts));
			for (const [name, value] of Object.entries({ x: i / PLACES, y: 1 - high, width: 1 / PLACES, height: high, fill: cssColour(colourOfShare(i / (PLACES - 1))) }))
				bar.setAttribute(name, value);
			return [bar];
		}));
	}

	// Rows stay as long as their number does, so that the keyboard's focus does.
	rows(workers) {
		const list = $('#strip ol'), ranks = this.list.some((w) => w.rank > 0);
		while (list.children.length > workers.length)
			list.lastChild.remove();
		while (list.children.length < workers.length)
			list.append(this.row());
		workers.forEach(({ i, pid, rank, ran, objects, share, died }, k) => {
			const row = list.children[k], [chip, name, bar, home, kill] = row.children;
			const text = `${ranks ? `rank ${rank}, ` : ''}${this.isolation === 'process' ? `process ${pid}` : `thread ${i}`}${died ? ': died' : ''}`;
			const used = share === null ? '' : `, ${Math.round(100 * share)} % of a core`, colour = cssColour(colourOfNumber(i));
			row.dataset.worker = i;
			row.title = `worker ${i}, ${text}${used}, ${count(objects, 'simulator')}, of which ${ran} ran in the last step`;
			row.classList.toggle('died', died);
			chip.style.background = bar.style.color = colour;
			bar.style.setProperty('--share', `${100 * Math.min(1, share ?? 0)}%`);
			show(name, text);
			show(home, `${objects}`);
			kill.hidden = !this.kills;
		});
	}

	// Many rows become bars, and few where that alone makes the panels below whole.
	fold() {
		const many = $('#strip').classList, rows = $('#strip ol').children.length, gain = ROW * rows - BAR, left = $('#left');
		const need = [...left.children].filter((e) => e.offsetHeight).reduce((sum, e) => sum + e.offsetHeight + GAP, -GAP);
		const room = left.clientHeight - (many.contains('many') ? gain : 0);
		many.toggle('many', rows > FEW || (left.clientHeight > 0 && room < need && need <= room + gain));
	}

	row() {
		const kill = element('button', { textContent: 'Kill', className: 'kill' }), row = element('li', {}, element('i'), element('span'), element('b'), element('output'), kill);
		kill.addEventListener('click', () => this.dispatchEvent(new CustomEvent('kill', { detail: Number(row.dataset.worker) })));
		return row;
	}
}
