// Resolution of the picture. Without a GPU a picture that changes has as many pixels as its pace allows; one that stands has
// all.
const SHARES = [1, 0.84, 0.71, 0.6, 0.5]; // width and height, relative to the full ones
const SLOW = 1 / 28, FAST = 1 / 50;       // s a frame, from which on the share falls, or grows
const FRAMES = 8;                         // between two changes

export class Sharpness {
	constructor() {
		this.index = this.frames = 0;
		this.seconds = 0;
	}

	// Share of the full resolution for the coming frame. seconds: since the frame before; changes: the picture does.
	next(seconds, changes) {
		if (!changes)
			return 1;
		this.seconds += seconds;
		if (++this.frames >= FRAMES) {
			const each = this.seconds / this.frames;
			if (each > SLOW && this.index < SHARES.length - 1)
				this.index++;
			else if (each < FAST && this.index > 0)
				this.index--;
			this.frames = this.seconds = 0;
		}
		return SHARES[this.index];
	}
}
