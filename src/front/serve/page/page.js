// Elements of the page, words for numbers, and what the page remembers from one visit to the next.
export const $ = (selector) => document.querySelector(selector);

export function element(name, properties, ...children) {
	const e = Object.assign(document.createElement(name), properties);
	e.append(...children);
	return e;
}

export const token = new URLSearchParams(location.hash.slice(1)).get('token');
// Address of a content, or of a connection, that may need the token.
export const addressOf = (path) => (token ? `${path}${path.includes('?') ? '&' : '?'}token=${encodeURIComponent(token)}` : path);

export const count = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;

// Value that was kept under a name, after a new one was, if given. Browsers may refuse to keep anything.
export function kept(name, value) {
	try {
		if (value !== undefined)
			localStorage.setItem(`obsim.${name}`, JSON.stringify(value));
		return JSON.parse(localStorage.getItem(`obsim.${name}`)) ?? undefined;
	} catch {
		return value;
	}
}

// Calls down and up while a button is held, by pointer or by keyboard.
export function onHold(button, down, up) {
	const key = (act) => (e) => {
		if ([' ', 'Enter'].includes(e.key) && !e.repeat) {
			e.preventDefault();
			act();
		}
	};
	for (const [event, act] of Object.entries({ pointerdown: down, pointerup: up, pointerleave: up, blur: up, keydown: key(down), keyup: key(up) }))
		button.addEventListener(event, act);
}
