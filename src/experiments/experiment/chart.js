// Draws the diagrams of a report: each description (chart.c) becomes an SVG, with tooltips and with buttons that save it. Colours
// have classes, which the page's style changes for a dark screen; a saved SVG has them as attributes, too. On a logarithmic axis values of zero or less lie in a band at the lower rim, named "0"; failed points without a value in
// one at the upper rim.
'use strict';
(() => {
const FAMILY = 'Liberation Sans, Arial, Helvetica, DejaVu Sans, sans-serif';
// c0 and on: colours that people with any kind of colour vision can distinguish (after Okabe and Ito 2008)
const PAINT = {paper: '#ffffff', ink: '#1f2328', muted: '#59626e', grid: '#e4e7eb', band: '#f3f4f6', good: '#1a7f37', meadow: '#eef8f0',
	c0: '#0072b2', c1: '#56b4e9', c2: '#009e73', c3: '#cc79a7', c4: '#7a7a7a', c5: '#d55e00', c6: '#e69f00', c7: '#222222'};
const DASH = ['', '6 3', '1.5 2.5', '8 3 1.5 3'];
const SUPER = .72, RAISE = .42, ASCENT = .74, DESCENT = .21; // of an exponent; of a text: shares of its size
const TITLE = {size: 15, paint: 'ink', bold: true}, SUBTITLE = {size: 11, paint: 'muted'}, TICK = {size: 11.5, paint: 'muted'},
	NAME = {size: 12.5, paint: 'ink', anchor: .5}, ROW = {size: 12, paint: 'ink', anchor: 1}, LABEL = {size: 10.5, paint: 'muted'},
	TARGET = {size: 11.5, paint: 'good'}, ENTRY = {size: 12, paint: 'ink'};
const {isFinite: finite} = Number, clamp = (v, low, high) => Math.min(Math.max(v, low), high), number = v => String(Math.round(v * 100) / 100);
const meet = (a, b) => a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
const within = (a, b) => a.x0 >= b.x0 && a.x1 <= b.x1 && a.y0 >= b.y0 && a.y1 <= b.y1;
const grown = (r, by) => ({x0: r.x0 - by, x1: r.x1 + by, y0: r.y0 - by, y1: r.y1 + by});
const escaped = text => text.replace(/[\x00-\x1f\x7f]/g, ' ').replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);

const pen = document.createElement('canvas').getContext('2d');

function widthOf(text, {size, bold}, raised = '') {
	pen.font = `${bold ? 'bold ' : ''}100px ${FAMILY}`;
	return (pen.measureText(text).width + pen.measureText(raised).width * SUPER) * size / 100;
}

// As much of a text as fits, with an ellipsis if it is cut.
function cut(text, room, type) {
	const letters = [...text];
	while (letters.length > 1 && widthOf(text, type) > room)
		text = letters.slice(0, letters.length-- - 2).join('') + '…';
	return text;
}

function wrap(text, room, type, most) {
	const lines = [], words = text.split(' ').filter(Boolean);
	while (words.length && lines.length < most) {
		let n = 1;
		while (n < words.length && widthOf(words.slice(0, n + 1).join(' '), type) <= room)
			n++;
		lines.push(cut(words.splice(0, lines.length + 1 < most ? n : words.length).join(' '), room, type));
	}
	return lines;
}

// Extent of a text. anchor: the share of it that lies left of x
function boxOf(x, y, text, type, raised = '') {
	const wide = widthOf(text, type, raised), before = wide * (type.anchor || 0), down = type.size * DESCENT;
	const up = type.size * (raised ? RAISE + SUPER * ASCENT : ASCENT);
	return type.turned ? {x0: x - up, x1: x + down, y0: y - (wide - before), y1: y + before} :
		{x0: x - before, x1: x + wide - before, y0: y - up, y1: y + down};
}

// ---- curves: colour, marker and dash together, so that three signs identify one

function styleOf({style: n, hollow}) {
	if (n < 0) // a guide
		return {stroke: 'muted', marker: -1, dash: 1, width: 1, size: 0};
	const shape = n + Math.floor(n / 8);
	return {stroke: 'c' + n % 8, marker: shape % 8, hollow, width: n ? 1.4 : 2.2, size: n ? 3.6 : 4.4,
		dash: hollow ? 2 : shape % 4 === 3 ? 3 : shape % 2};
}

// Corners, turns to the first, radius, inner radius: of a square, triangle, diamond, inverted triangle, pentagon, star, hexagon.
const MARKERS = [, [4, .125, 1.25], [3, 0, 1.35], [4, 0, 1.35], [3, .5, 1.35], [5, 0, 1.2], [10, 0, 1.5, .75], [6, 0, 1.2]];

// ---- ticks: {v, text, raised}; without a text a minor one. Logarithmic axes: v is the logarithm

const signed = (v, decimals) => (v < 0 ? '−' : '') + Math.abs(v).toFixed(clamp(decimals, 0, 20));
const powerOfTen = (digit, power) => ({text: digit === 1 ? '10' : signed(digit, 0) + '×10', raised: signed(power, 0)});

// Smallest step of 1, 2, 5 x 10^power from "least" up.
function niceStep(least) {
	const power = Math.floor(Math.log10(least) + 1e-9), digit = [1, 2, 5, 10].find(d => d * 10 ** power >= least * (1 - 1e-9));
	return {step: digit * 10 ** power, power: digit === 10 ? power + 1 : power};
}

function linearScale(from, to, wanted) {
	if (!(to > from)) {
		const half = Math.abs(from) / 2 || 1;
		[from, to] = [from - half, to + half];
	} else if (from > 0 && from < to / 2) {
		from = 0;
	}
	const {step, power} = niceStep(Math.max(to / wanted - from / wanted, 1e-290)), largest = Math.max(-from, to);
	const shown = largest >= 1e5 || largest < 1e-3 ? Math.floor(Math.log10(largest)) : 0, ticks = [];
	const first = Math.floor(from / step + 1e-9), last = Math.max(Math.ceil(to / step - 1e-9), first + 1);
	for (let k = first; k <= last && k < first + 64; k++)
		ticks.push({v: k * step, text: k === 0 ? '0' : signed(k * step / 10 ** shown, shown - power) + (shown ? '×10' : ''),
			raised: k && shown ? signed(shown, 0) : ''});
	return {from: first * step, to: last * step, ticks};
}

function logarithmicScale(from, to, wanted, binary) {
	const more = Math.max(0, (binary ? 2.1 : .9) - (to - from)) / 2 + (to - from) * .04, ticks = [];
	[from, to] = [from - more, to + more];
	const span = to - from, plain = Math.floor(from) >= -3 && Math.ceil(to) <= (binary ? 16 : 5);
	const stride = [1, 2, 3, 5, 10, 20, 50, 100, 200].find(s => span / s <= wanted) || 200;
	for (let power = Math.floor(from); power <= Math.ceil(to); power++)
		for (let digit = 1; digit < (binary || stride > 1 || span > 12 ? 2 : 10); digit++) {
			const named = power % stride === 0 && (digit === 1 || (span < 1.6 && (digit === 2 || digit === 5)));
			const text = binary ? plain ? {text: String(2 ** power)} : {text: '2', raised: signed(power, 0)} :
				plain ? {text: signed(digit * 10 ** power, -power)} : powerOfTen(digit, power);
			if (named || span <= 40)
				ticks.push({v: power + (binary ? 0 : Math.log10(digit)), ...named ? text : {}});
		}
	return {from, to, ticks};
}

// ---- an axis with its bands at both ends, in px. Points of a band lie in lanes, so that they do not cover each other.

const LANE = 11, LANES = 6, BAND_RIM = 8, BAND_GAP = 3, bounded = v => clamp(v, -1e300, 1e300);

class Side {
	constructor({label, scale}, rows, vertical) {
		Object.assign(this, {label, rows, vertical, log: scale.startsWith('log'), binary: scale === 'log2', values: []});
		this.lanes = [0, 0]; // of the low and the high band; 0: there is none
		this.of = !this.log ? v => v : this.binary ? Math.log2 : Math.log10;
	}

	// The band of a value: 0 low, 1 high, -1 none.
	bandOf(v) {
		return !finite(v) ? 1 : this.log && v <= 0 ? 0 : -1;
	}

	include(v) {
		return this.bandOf(v) < 0 ? this.values.push(bounded(v)) : this.lanes[this.bandOf(v)] ||= 1;
	}

	place(begin, end) {
		this.way = Math.sign(end - begin);
		const room = n => n ? this.way * (BAND_RIM + LANE * n + BAND_GAP) : 0, wanted = clamp(Math.floor(Math.abs(end - begin) / (this.vertical ? 42 : 74)), 2, 12);
		[this.begin, this.end] = [begin + room(this.lanes[0]), end - room(this.lanes[1])];
		const values = this.values.length ? this.values : this.log ? [1, 10] : [0, 1];
		const [from, to] = [Math.min, Math.max].map(f => this.of(values.reduce((a, b) => f(a, b))));
		this.scale = this.rows ? {from: this.rows.length - .5, to: -.5, ticks: this.rows.map((text, v) => ({v, text}))} : // downwards
			this.log ? logarithmicScale(from, to, wanted, this.binary) : linearScale(from, to, wanted);
		this.ticks = this.scale.ticks.map(t => ({...t, at: this.along(t.v)})).filter(t => (t.at - this.begin) * this.way > -.01 && (this.end - t.at) * this.way > -.01);
	}

	along(v) {
		return this.begin + (v - this.scale.from) / (this.scale.to - this.scale.from) * (this.end - this.begin);
	}

	rims(band) { // inner and outer
		const away = band ? this.way : -this.way, inner = (band ? this.end : this.begin) + away * BAND_GAP;
		return [inner, inner + away * (BAND_RIM + LANE * this.lanes[band])];
	}

	at(v, lane = 0) {
		const band = this.bandOf(v), away = (band ? this.way : -this.way) * (BAND_RIM / 2 + LANE * (lane + .5));
		return band < 0 ? this.along(this.of(bounded(v))) : this.rims(band)[0] + away;
	}

	// A target of zero stands at the inner rim of its band: all of that is beyond it.
	mark(v) {
		return this.bandOf(v) === 0 ? this.rims(0)[0] : this.at(v);
	}
}

const EDGE = 14, MAJOR = 5, MINOR = 3, AWAY = 4, BELOW = MAJOR + AWAY + 12 + 22, SAMPLE = 33; // px
const snap = v => Math.floor(v) + .5; // lines of 1 px are sharp in the middle of a pixel

function draw(chart) {
	const width = Math.max(chart.width || 760, 240), rows = chart.category, x = new Side(chart.x, null, false), y = new Side(chart.y, rows, true);
	const marks = chart.marks.filter(m => finite(m.at)), spots = [], taken = [], pieces = []; // taken: labels must not cover them
	let markup = '', outer, rowWidth;
	function shape(path, style, hint) {
		const fill = ` fill="${PAINT[style.fill] || 'none'}"`, stroke = style.stroke ?
			` stroke="${PAINT[style.stroke]}" stroke-width="${style.width || 1}"${style.dash ? ` stroke-dasharray="${DASH[style.dash]}"` : ''}` : '';
		const classes = [style.fill && 'f-' + style.fill, style.stroke && 's-' + style.stroke].filter(Boolean).join(' ');
		markup += `<path class="${classes}" d="${path}"${fill}${stroke}${hint ? `><title>${escaped(hint)}</title></path>` : '/>'}\n`;
	}

	const line = (points, style, hint) => shape(points.map(([px, py], i) => (i ? 'L' : 'M') + number(px) + ' ' + number(py)).join('') + (style.fill ? 'Z' : ''), style, hint);
	const rect = (r, fill) => line([[r.x0, r.y0], [r.x1, r.y0], [r.x1, r.y1], [r.x0, r.y1]], {fill});

	function text(px, py, words, type, raised) {
		markup += `<text x="${number(px)}" y="${number(py)}" font-size="${type.size}"` +
			(type.anchor ? ` text-anchor="${type.anchor === 1 ? 'end' : 'middle'}"` : '') + (type.bold ? ' font-weight="bold"' : '') +
			(type.turned ? ` transform="rotate(-90 ${number(px)} ${number(py)})"` : '') + ` class="f-${type.paint}" fill="${PAINT[type.paint]}">` + escaped(words) +
			(raised ? `<tspan dy="${number(-type.size * RAISE)}" font-size="${number(type.size * SUPER)}">${escaped(raised)}</tspan>` : '') + '</text>\n';
	}

	function marker([px, py], s, hint) {
		const look = s.hollow ? {stroke: s.stroke, fill: 'paper', width: 1.4} : {stroke: 'paper', fill: s.stroke, width: .8};
		const [corners, turn, far, near = far] = MARKERS[s.marker] || [0], half = `a${s.size} ${s.size} 0 0 1 `;
		const around = Array.from({length: corners}, (_, i) => [2 * Math.PI * (turn + i / corners), s.size * (i % 2 ? near : far)]);
		if (corners)
			line(around.map(([angle, r]) => [px + r * Math.sin(angle), py - r * Math.cos(angle)]), look, hint);
		else
			shape(`M${number(px - s.size)} ${number(py)}${half}${2 * s.size} 0${half}${-2 * s.size} 0Z`, look, hint);
	}

	function cross([px, py], {stroke}, hint) {
		const [l, r, t, b] = [px - 3.6, px + 3.6, py - 3.6, py + 3.6].map(number);
		shape(`M${l} ${t}L${r} ${b}M${l} ${b}L${r} ${t}`, {stroke, width: 1.8}, hint);
	}

	function heading(words, top, type) {
		wrap(words, width - 2 * EDGE, type, 3).forEach(l => text(EDGE, (top += type.size * 1.3) - type.size * .3, l, type));
		return top;
	}

	// Margins depend on the axes' labels, and these on the room left.
	function place(top, bottom, right) {
		let from = EDGE + 60, to = width - EDGE - right;
		for (let pass = 0; pass < 4; pass++) {
			x.place(from, to);
			y.place(bottom, top);
			spreadOverLanes();
			outer = {x0: from, x1: to, y0: top, y1: bottom};
			rowWidth = Math.min(Math.max(TICK.size, y.lanes[1] ? widthOf('failed', TICK) : 0, ...y.ticks.map(t => t.text ? widthOf(t.text, rows ? ROW : TICK, t.raised) : 0)), width * .45);
			const beyond = Math.max(x.lanes[1] ? 14 : 0, ...x.ticks.map(t => t.text ? t.at + widthOf(t.text, TICK, t.raised) / 2 - to : 0));
			if (pass < 2)
				[from, to] = [EDGE + (y.label ? NAME.size + 10 : 2) + rowWidth + MAJOR + AWAY, Math.max(width - EDGE - Math.max(right, beyond + 4), from + 60)];
		}
	}

	function spreadOverLanes() {
		for (const s of spots)
			s.at = [x.at(s.p.x), y.at(s.p.y)];
		for (const [side, across] of [[y, 1], [x, 0]])
			for (const band of [0, 1])
				spots.filter(s => side.bandOf(across ? s.p.y : s.p.x) === band).forEach((s, i, all) => {
					const near = all.slice(0, i).filter(o => Math.abs(o.at[1 - across] - s.at[1 - across]) < LANE);
					for (s.lane = 0; s.lane < LANES - 1 && near.some(o => o.lane === s.lane);)
						s.lane++;
					s.at[across] = side.at(across ? s.p.y : s.p.x, s.lane);
					side.lanes[band] = Math.max(side.lanes[band], s.lane + 1);
				});
	}

	function ground() {
		for (const side of [x, y])
			for (const [a, b] of [0, 1].filter(band => side.lanes[band]).map(band => side.rims(band).sort((p, q) => p - q)))
				rect(side.vertical ? {...outer, y0: a, y1: b} : {...outer, x0: a, x1: b}, 'band');
		for (const m of marks.filter(m => m.tinted))
			rect(m.vertical ? {...outer, x1: clamp(x.mark(m.at), outer.x0, outer.x1)} : {...outer, y0: clamp(y.mark(m.at), outer.y0, outer.y1)}, 'meadow');
		for (const side of [x, y])
			for (const at of side.ticks.filter(t => t.text).map(t => snap(t.at)))
				line(side.vertical ? [[x.begin, at], [x.end, at]] : [[at, y.end], [at, y.begin]], {stroke: 'grid'});
		line([[snap(outer.x0), outer.y0], [snap(outer.x0), snap(outer.y1)], [outer.x1, snap(outer.y1)]], {stroke: 'muted'});
	}

	function axis(side) {
		const {vertical} = side, rim = vertical ? outer.x0 : outer.y1, seen = [], type = side.rows ? ROW : {...TICK, anchor: vertical ? 1 : .5};
		const bands = [0, 1].filter(band => side.lanes[band]).map(band => ({at: (side.rims(band)[0] + side.rims(band)[1]) / 2, text: band ? 'failed' : '0'}));
		for (const t of [...bands, ...side.ticks]) {
			const length = t.text ? MAJOR : MINOR, words = cut(t.text || '', vertical ? rowWidth : Infinity, type);
			const px = vertical ? rim - MAJOR - AWAY : t.at, py = vertical ? t.at + type.size * .36 : rim + MAJOR + AWAY + type.size * .78;
			const box = boxOf(px, py, words, type, t.raised), near = vertical ? box : grown(box, 3);
			if (t.v !== undefined && !rows)
				line(vertical ? [[rim - length, snap(t.at)], [rim, snap(t.at)]] : [[snap(t.at), rim], [snap(t.at), rim + length]], {stroke: 'muted'});
			if (words && !seen.some(s => meet(near, s)))
				seen.push(box) && text(px, py, words, type, t.raised);
		}
		text(...vertical ? [EDGE + NAME.size, (outer.y0 + outer.y1) / 2, cut(side.label, outer.y1 - outer.y0, NAME)] :
			[(outer.x0 + outer.x1) / 2, outer.y1 + BELOW - 6, cut(side.label, outer.x1 - outer.x0, NAME)], {...NAME, turned: vertical});
	}

	// The boldest curve comes last, so that nothing covers it.
	function curves() {
		const front = s => s.series.style === 0, inOrder = [...spots.filter(s => !front(s)), ...spots.filter(front)];
		for (const m of marks) {
			const at = (m.vertical ? x : y).mark(m.at);
			line(m.vertical ? [[at, outer.y0], [at, outer.y1]] : [[outer.x0, at], [outer.x1, at]], {stroke: 'good', width: 1.3, dash: 1});
		}
		let run = [];
		inOrder.filter(s => s.whole && s.series.line).forEach((s, i, all) => {
			// lanes of the band of zeros have no meaning, so no line joins them
			const next = all[i + 1], joined = next?.series === s.series && !(y.bandOf(s.p.y) === 0 && y.bandOf(next.p.y) === 0);
			run.push(s.at);
			if (joined)
				pieces.push([s.at, next.at]);
			else if (run.length > 1)
				line(run, s.style);
			run = joined ? run : [];
		});
		for (const s of inOrder.filter(s => s.p.failed || s.style.marker >= 0)) {
			const {p, style, at: [px, py]} = s, r = style.size + 1, four = v => Number(v.toPrecision(4));
			const values = finite(p.x) && finite(p.y) ? `${four(p.x)}, ${four(p.y)}${p.failed ? ', failed' : ''}` : 'failed';
			const [low, high] = [p.low, p.high].map(v => finite(v) && number(clamp(y.at(v), outer.y0, outer.y1)));
			if (!p.failed && low && high)
				shape(`M${number(px)} ${low}V${high}M${number(px - 3.5)} ${low}h7M${number(px - 3.5)} ${high}h7`, {stroke: style.stroke, width: 1.2});
			(p.failed ? cross : marker)(s.at, style, p.hint || `${[s.series.title, p.label].filter(Boolean).join(', ')}: ${values}`);
			taken.push({x0: px - r, x1: px + r, y0: py - r, y1: py + r});
		}
	}

	// Curves and targets that cross a box.
	function crossings(box) {
		const outside = (a, b, from, to) => Math.max(a, b) < from || Math.min(a, b) > to;
		return pieces.filter(([[ax, ay], [bx, by]]) => {
			const sides = [[box.x0, box.y0], [box.x1, box.y0], [box.x0, box.y1], [box.x1, box.y1]].map(([px, py]) => (bx - ax) * (py - ay) > (by - ay) * (px - ax));
			return !outside(ax, bx, box.x0, box.x1) && !outside(ay, by, box.y0, box.y1) && new Set(sides).size > 1;
		}).length + marks.filter(m => m.vertical ? x.mark(m.at) > box.x0 && x.mark(m.at) < box.x1 : y.mark(m.at) > box.y0 && y.mark(m.at) < box.y1).length;
	}

	// Writes at the first place that covers nothing, or, with "over", only curves.
	function put(words, places, room, over) {
		const boxes = places.map(at => grown(boxOf(...at), 1)), free = words ? boxes.filter(b => within(b, room) && !taken.some(t => meet(t, b))) : [];
		const best = free.find(b => !crossings(b)) || (over && free[0]);
		if (best)
			taken.push(best) && text(...places[boxes.indexOf(best)]);
	}

	function labelMark(m) {
		const words = cut(m.label || '', (outer.x1 - outer.x0) * .8, TARGET), at = (m.vertical ? x : y).mark(m.at), places = [];
		for (let share = 0; share <= 1; share += .1)
			for (const side of [0, 1])
				places.push(m.vertical ? [at + (side ? -5 : 5), outer.y0 + share * (outer.y1 - outer.y0) + TARGET.size, words, {...TARGET, anchor: side}] :
					[outer.x1 - share * (outer.x1 - outer.x0) - 4, at + (side ? TARGET.size + 1.5 : -4.5), words, {...TARGET, anchor: 1}]);
		put(words, places, outer, true);
	}

	// Beside the point, in its own band if it lies in one.
	function labelSpot({p, style, at: [px, py]}) {
		const words = cut(p.label || '', 120, LABEL), {size} = LABEL, away = style.size + 2.5;
		const room = {...outer, y0: py > y.begin ? y.begin : py < y.end ? outer.y0 : y.end, y1: py < y.end ? y.end : py > y.begin ? outer.y1 : y.begin};
		put(words, [[1, -1, 0], [0, -1, .5], [1, 0, 0], [0, 1, .5], [1, 1, 0], [-1, -1, 1], [-1, 0, 1], [-1, 1, 1]].map(([dx, dy, anchor]) => [px + dx * away * (dx && dy ? .75 : 1),
			py + dy * away + size * (dy < 0 ? -DESCENT : dy > 0 ? ASCENT : .36), words, {...LABEL, anchor}]), room, false);
	}

	// The legend lies outside the data, at the right if there is room, else below.
	function arrange(entries, room, below) {
		let left = 0, top = 0, wide = 0;
		for (const e of entries) {
			e.lines = wrap(e.series ? e.series.title : 'failed', room - SAMPLE, ENTRY, below ? 1 : 3);
			const own = SAMPLE + Math.max(0, ...e.lines.map(l => widthOf(l, ENTRY)));
			if (below && left > 0 && left + own > room)
				[left, top] = [0, top + 18];
			Object.assign(e, {left, top});
			wide = Math.max(wide, left + own);
			[left, top] = below ? [left + own + 20, top] : [0, top + 21 + (e.lines.length - 1) * 14];
		}
		return {entries, below, width: wide, height: entries.length ? top + (below ? 18 : 0) : 0};
	}

	function planLegend(height) {
		const entries = [...chart.series.filter(s => s.title), ...spots.some(s => s.p.failed) ? [null] : []].map(series => ({series}));
		const shown = chart.series.length > 1 || entries.length > 1 ? entries : [], beside = arrange(shown, 219, false);
		return beside.width > (width - 2 * EDGE) * .3 || beside.height > height ? arrange(shown, width - 2 * EDGE, true) : beside;
	}

	function legendAt(entries, left, top) {
		for (const e of entries) {
			const at = [left + e.left + 13, top + e.top + 9], style = e.series && styleOf(e.series);
			if (e.series?.line)
				line([[at[0] - 13, at[1]], [at[0] + 13, at[1]]], style);
			if (!(style?.marker < 0))
				(style ? marker : cross)(at, style || {stroke: 'ink'});
			e.lines.forEach((l, i) => text(at[0] - 13 + SAMPLE, at[1] + ENTRY.size * .36 + i * 14, l, ENTRY));
		}
	}

	for (const series of chart.series)
		for (const p of series.points.filter(p => p.failed || (finite(p.x) && finite(p.y)))) {
			spots.push({series, style: styleOf(series), p, whole: !p.failed && finite(p.x) && finite(p.y)});
			x.include(p.x);
			[p.y, p.low, p.high].filter((v, i) => i === 0 || finite(v)).forEach(v => y.include(v));
		}
	marks.forEach(m => (m.vertical ? x : y).include(m.at));
	const top = heading(chart.subtitle, heading(chart.title, EDGE, TITLE) + 2, SUBTITLE) + 12, asked = chart.height || 480;
	const legend = planLegend(asked - top - EDGE), below = BELOW + (legend.below ? legend.height + 12 : 0) + EDGE / 2, data = Math.max(asked - top - below, 130);
	place(top, top + data, legend.below || !legend.entries.length ? 0 : legend.width + 16);
	ground();
	axis(y);
	axis(x);
	curves();
	marks.forEach(labelMark);
	const inside = (s, i) => spots[i - 1]?.series === s.series && spots[i + 1]?.series === s.series;
	[...spots.filter((s, i) => !inside(s, i)), ...spots.filter(inside)].forEach(labelSpot); // ends of curves matter most
	legendAt(legend.entries, legend.below ? EDGE : width - EDGE - legend.width, legend.below ? top + data + BELOW + 12 : top);
	const [w, h] = [width, top + data + below].map(number);
	return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${w} ${h}" width="${w}" height="${h}" role="img" aria-label="${escaped(chart.title)}" ` +
		`font-family="${FAMILY}" stroke-linejoin="round">\n<rect width="100%" height="100%" class="f-paper" fill="${PAINT.paper}"/>\n${markup}</svg>`;
}

// ---- the page

async function save(svg, name, pixels) {
	const image = new Image(), canvas = document.createElement('canvas'), link = document.createElement('a');
	image.src = link.href = 'data:image/svg+xml,' + encodeURIComponent(svg);
	link.download = name.replace(/[^\w.-]+/g, '-') + (pixels ? '.png' : '.svg');
	await image.decode();
	[canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
	canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
	if (pixels)
		link.href = canvas.toDataURL();
	link.click();
}

for (const script of document.querySelectorAll('script.chart')) {
	const chart = JSON.parse(script.textContent), svg = draw(chart);
	script.insertAdjacentHTML('afterend', svg + '<p class="save">Save as <button>SVG</button> <button>PNG</button></p>');
	script.parentElement.querySelectorAll('.save button').forEach((button, pixels) => button.onclick = () => save(svg, chart.name, pixels));
}
})();
