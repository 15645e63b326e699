// Records what this viewer is sent, as a page that plays by itself: the messages as src/front/serve/film.h has them, within
// the server's empty page for one.
import { save } from './explore.js';

const MOTIONS = 1, SIMULATORS = 4, JOINTS = 5, VOID = 1, FLAGS_AT = 1, TIME_AT = 8; // of a message
const DIED = 5; // place of the last death in a worker's row
const MOST = 2 ** 26; // bytes
const EMPTY = '<script type="text/plain" id="recording"><' + '/script>'; // in one piece it would end this script in a page

// A message with its length before it.
function framed(data) {
	const bytes = typeof data === 'string' ? new TextEncoder().encode(data) : new Uint8Array(data);
	return [new Uint32Array([bytes.length]), bytes];
}

async function base64(blob) {
	const packed = await new Response(blob.stream().pipeThrough(new CompressionStream('gzip'))).blob();
	return new Promise((resolve, reject) => {
		const reader = new FileReader();
		reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(',') + 1));
		reader.onerror = () => reject(reader.error);
		reader.readAsDataURL(packed);
	});
}

export class Recorder extends EventTarget {
	constructor(universe) {
		super();
		this.universe = universe;
		this.page = null; // the last record: a promise of its text
		this.workers = null; // rows of the last message of them
		universe.addEventListener('workers', (e) => { this.workers = e.detail.map((w) => w.slice(0, DIED)); });
	}

	get on() { return this.universe.tap !== null; }

	// Begins at the next whole state, which it asks for.
	start() {
		Object.assign(this, { messages: [], bytes: 0, begin: null, end: null });
		this.universe.tap = (data) => this.hear(data);
		this.universe.send({ do: 'anew' });
	}

	hear(data) {
		const view = typeof data === 'string' ? null : new DataView(data), kind = view?.getUint8(0);
		if (![MOTIONS, SIMULATORS, JOINTS].includes(kind))
			return;
		const time = view.getFloat64(TIME_AT, true), whole = kind === MOTIONS && (view.getUint8(FLAGS_AT) & VOID) !== 0;
		if (this.begin === null && !whole)
			return;
		this.begin ??= time;
		if (time < this.end && kind === MOTIONS) { // the universe went back
			this.dispatchEvent(new CustomEvent('end'));
			return;
		}
		this.end = Math.max(this.end, time);
		this.messages.push(...framed(data));
		this.bytes += data.byteLength;
		if (this.bytes > MOST)
			this.dispatchEvent(new CustomEvent('end'));
	}

	// Ends, and saves the page. address: of a content of the server; welcome: the scene's look.
	stop(welcome, address) {
		this.universe.tap = null;
		this.page = this.begin === null ? Promise.reject(new Error('nothing has come to record')) : this.make(welcome, address);
		return this.page.then((text) => save(URL.createObjectURL(new Blob([text], { type: 'text/html' })), 'obsim.html'));
	}

	async make(welcome, address) {
		const { begin, end, messages } = this, fetched = async (path) => {
			const answer = await fetch(address(path));
			if (!answer.ok)
				throw new Error(`${path}: ${answer.status}`);
			return answer;
		};
		const meshes = await Promise.all(welcome.meshes.map(async (path) => (await fetched(path)).arrayBuffer()));
		const looksOnly = { ...welcome, role: 'watch', look_only: true, meshes: [], controls: [], params: [], pictures: [] };
		const film = { begin, end, interval: welcome.step_length, created: new Date().toISOString(), version: welcome.version, commit: '', objects: [], events: [], gaps: true };
		const workers = this.workers ? [JSON.stringify({ workers: this.workers })] : [];
		const head = [JSON.stringify({ welcome: looksOnly }), JSON.stringify({ film }), ...workers, ...meshes].flatMap(framed);
		const text = await base64(new Blob([...head, ...messages]));
		return (await (await fetched('player.html')).text()).replace(EMPTY, () => EMPTY.replace('><', `>${text}<`));
	}
}
