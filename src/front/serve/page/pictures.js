// Pictures of cameras that the scene has fixed to objects: each again as soon as the last one is there.
import { $, addressOf, element } from './page.js';

const interval = 200; // ms

export class Pictures {
	welcome({ pictures = [] }) {
		$('#pictures')?.remove();
		const title = element('summary', { textContent: 'Cameras' });
		if (pictures.length)
			$('#workers').before(element('details', { id: 'pictures', className: 'panel', open: true }, title, ...pictures.map((p) => this.figure(p))));
	}

	figure({ sensor, name }) {
		const image = element('img', { alt: `What the camera ${name} sees` });
		let n = 0;
		const next = () => {
			if (image.isConnected)
				image.src = addressOf(`pictures/${sensor}?n=${n++}`);
		};
		image.onload = () => setTimeout(next, interval);
		image.onerror = () => setTimeout(next, 5 * interval);
		setTimeout(next);
		return element('figure', {}, image, element('figcaption', { textContent: name }));
	}
}
