// The tour of a scene that asks for one: falls in which simulators are killed, or slow. Each is an act: a sentence, and the figures
// of what has happened, beside those of the first.
import { count, kept } from './page.js';

const END = 4; // s, simulated, at which an act pauses
const HASTE = 4; // simulated seconds a second that the act of the slow one asks for
const NEAR = 1e-6; // s
const AHEAD = 200; // ms, that simulators of a free run are ahead at most (ob_free_window: 12 steps)

export class Tour {
	// kill: kills the process of a worker.
	constructor(universe, workers, walk, kill) {
		Object.assign(this, { universe, workers, walk, kill, act: null });
		universe.addEventListener('welcome', () => this.begin());
		universe.addEventListener('statistics', (e) => this.look(e.detail));
	}

	start({ sync, isolation, version, seed }) {
		const step = (text, act, colours) => ({ text, about: '#strip', begin: () => this.play({ text, kills: [], slow: 0, ...act }, colours), end: () => { this.act = null; } });
		const free = sync === 'free', kills = isolation === 'process', by = free ? 'lag' : 'process';
		const told = 'In processes simulators can be killed: obsim serve tour.';
		Object.assign(this, { free, most: 0, name: `hash ${version} ${seed}` });
		this.walk.start([
			step(`Boxes fall. Each is a simulator of its own; colours show ${free ? 'how far its own time is ahead' : `its ${by}`}.`, {}, by),
			...kills ? [
				step('The same fall. At 1 s one process is killed.', { kills: [1] }, by),
				step('Three more die, one after another.', { kills: [0.6, 1.2, 1.8] }, by),
			] : [{ text: told }],
			...free ? [] : [step(`One simulator is slow, and time should pass ${HASTE} times as fast. In lockstep all wait for it.`, { slow: 1, rate: HASTE }, by)],
			{ text: '', begin: () => this.conclude() },
		], () => {
			this.workers.choose('own');
			this.universe.send({ do: 'resume' });
		});
	}

	// Starts the scene anew for an act.
	play(act, colours) {
		this.workers.choose(colours);
		this.act = { ...act, deaths: 0, most: 0, began: null };
		this.universe.send({ do: 'set', name: 'slow', value: act.slow });
	}

	// It goes on to the first kill, or to the end.
	begin() {
		if (!this.act)
			return;
		this.act.began = performance.now() / 1000;
		this.universe.send({ do: 'rate', rate: this.act.rate ?? 1 });
		this.goOn();
	}

	// Only in lockstep there is a step at which all stand; a free run is paused when it has come so far.
	goOn() { this.universe.send(this.free ? { do: 'resume' } : { do: 'until', value: this.stop }); }

	get stop() { return this.act.kills[this.act.deaths] ?? END; }

	look(s) {
		const { act, universe } = this;
		if (!act?.began || act.done)
			return;
		if (this.free)
			act.most = Math.max(act.most, ...[...universe.simulators.values()].map((x) => x.lead || 0));
		if (universe.told < this.stop - NEAR)
			return;
		if (!universe.paused) {
			if (this.free)
				universe.send({ do: 'pause' });
		} else if (this.stop < END) {
			if (s.deaths > act.deaths) {
				act.deaths++;
				act.asked = false;
				this.goOn();
			} else if (!act.asked) {
				act.asked = true;
				this.kill(act.deaths % this.workers.list.length);
			}
		} else if (s.hash || this.free) {
			this.end(s);
		}
	}

	conclude() {
		this.workers.choose('own');
		this.walk.say(this.free ? `That was a free run: only those near a dead one waited, and simulators were up to ${this.most.toFixed(0)} ms ahead. In obsim serve tour all go in lockstep, and reach the same bits.` :
			`That was lockstep. In obsim serve tour --sync free only those near the slow one wait: simulators are up to ${AHEAD} ms ahead. On two ranks, mpirun -n 2 obsim run tour --duration ${END}, the end has the same hash, ${kept(this.name)}.`);
	}

	// Tells the figures of an act.
	end(s) {
		const { act } = this, seconds = performance.now() / 1000 - act.began;
		const before = kept(this.name); // the hash after an act before, maybe in another run
		act.done = true;
		this.most = Math.max(this.most, 1000 * act.most);
		const figures = [s.deaths && count(s.deaths, 'death'), act.rate && `${(END / seconds).toFixed(1)} simulated seconds a second`,
			this.free ? `at most ${(1000 * act.most).toFixed(0)} ms ahead` : `hash at ${END} s: ${s.hash}${before ? before === s.hash ? ', the same as before' : ', another than before' : ''}`];
		this.walk.say(`${act.text} ${figures.filter((f) => f).join('; ')}.`);
		if (!this.free)
			kept(this.name, s.hash);
	}
}
