// Steps that a visitor is led through: each a sentence, and the part of the page that it is about.
import { $ } from './page.js';

export class Walk {
	constructor() {
		this.steps = [];
		this.at = 0;
	}

	// steps: { text, about: selector, begin, end }; the last two may be left out. leave: called after the last, or when skipped.
	start(steps, leave) {
		this.end();
		Object.assign(this, { steps, leave, at: 0 });
		this.show();
	}

	show() {
		const step = this.steps[this.at];
		this.say(step.text);
		$('#walk span').textContent = `${this.at + 1} of ${this.steps.length}`;
		$('[data-do=next]').textContent = this.at + 1 < this.steps.length ? 'Next' : 'Done';
		$('#walk').hidden = false;
		$(step.about ?? '#walk').classList.toggle('shown', step.about !== undefined);
		step.begin?.();
	}

	say(text) { $('#walk p').textContent = text; }

	next() {
		this.finish();
		if (++this.at < this.steps.length)
			this.show();
		else
			this.end();
	}

	finish() {
		const step = this.steps[this.at];
		$(step?.about ?? '#walk').classList.remove('shown');
		step?.end?.();
	}

	end() {
		if (this.at < this.steps.length)
			this.finish();
		this.at = this.steps.length;
		$('#walk').hidden = true;
		this.leave?.();
		this.leave = null;
	}
}
