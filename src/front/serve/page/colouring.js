// Colours that show the architecture, as in src/run/measure/colouring.c: an object's colour by its simulator, worker,
// process, rank, island, rest, cost or lag. Linear RGB.
const GOLDEN_TURN = 0.6180339887498949, MOST_SUBSTEPS = 512;
const LEAST_LEAD = 1e-3, MOST_LEAD = 1; // s
const NONE = [0.28, 0.3, 0.33];
const REST = [[0.85, 0.3, 0.04], [0.08, 0.55, 0.8], [0.1, 0.5, 0.2], [0.09, 0.13, 0.4]]; // touches, flies, in
                                                                                     // equilibrium, asleep
const RESTS_FROM = 2;

export const KEYS = ['own', 'simulator', 'worker', 'process', 'rank', 'island', 'rest', 'cost', 'lag'];

export function colourOfNumber(number) {
	const hue = 6 * ((GOLDEN_TURN * number) % 1), value = Math.floor(number / 3) % 2 ? 0.36 : 0.66, least = 0.11;
	return [0, 1, 2].map((i) => {
		const at = (hue + 4 - 2 * i) % 6, share = Math.max(0, Math.min(1, Math.abs(at - 3) - 1));
		return least + share * (value - least);
	});
}

// From dark blue by red to light yellow. share: from 0 to 1; NaN: none.
export function colourOfShare(share) {
	if (Number.isNaN(share))
		return NONE;
	share = Math.max(0, Math.min(1, share));
	return [0.03 + 0.87 * Math.min(1, 2 * share), 0.03 + 0.72 * share * share, 0.22 * Math.max(0, 1 - 2 * share) + 0.1 * share];
}

const shareOfCost = ({ state, substeps }) => (state >= RESTS_FROM || !substeps ? NaN : Math.log2(substeps) / Math.log2(MOST_SUBSTEPS));

// Place on a scale, 0 to 1, of a lead (s) of an own time over the common time. NaN stays NaN.
export const shareOfLead = (lead) => Math.log2(1 + Math.max(0, lead) / LEAST_LEAD) / Math.log2(1 + MOST_LEAD / LEAST_LEAD);

// Colour of an object by a key; s: its simulator { home, island, substeps, state, lead }, if it has one; workers:
// [{ pid, rank }].
export function colourBy(key, o, s, workers) {
	if (key === 'own')
		return o.colour;
	if (!s)
		return NONE;
	if (key === 'simulator')
		return colourOfNumber(o.id);
	if (key === 'island')
		return colourOfNumber(s.island);
	if (key === 'rest')
		return REST[s.state];
	if (key === 'cost')
		return colourOfShare(shareOfCost(s));
	if (key === 'lag')
		return colourOfShare(shareOfLead(s.lead));
	const worker = workers[s.home];
	if (!worker)
		return NONE;
	if (key === 'worker')
		return colourOfNumber(s.home);
	return colourOfNumber(key === 'rank' ? worker.rank : workers.findIndex((w) => w.pid === worker.pid));
}

// A colour for the page, from linear RGB.
const bytes = (c) => c.map((x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055)));
export const cssColour = (c) => `rgb(${bytes(c).join(' ')})`;
export const hexColour = (c) => `#${bytes(c).map((x) => Math.max(0, Math.min(255, x)).toString(16).padStart(2, '0')).join('')}`;
