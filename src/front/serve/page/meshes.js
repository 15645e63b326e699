// Meshes of the shapes, as in src/run/render/mesh.h: a vertex is a corner of the core and the normal along which the ball that
// thickens it is added.
const LEVELS = [12, 24, 48]; // segments round the axis

export const BOX_MESH = 0, PATTERNED_BOX_MESH = 1, ROUND_MESH = 2, CYLINDER_MESH = 5, MESHES = 8;

class Builder {
	constructor() {
		this.vertices = [];
		this.indices = [];
		this.meshes = [];
	}
	vertex(corner, normal) {
		this.vertices.push(...corner, ...normal);
		return this.vertices.length / 6 - 1;
	}
	quad(a, b, c, d) { this.indices.push(a, b, c, a, c, d); }
	belt(low, high, n) {
		for (let i = 0; i < n; i++)
			this.quad(low + i, low + i + 1, high + i + 1, high + i);
	}
	begin() { this.meshes.push({ first: this.indices.length, count: 0 }); }
	end() {
		const m = this.meshes[this.meshes.length - 1];
		m.count = this.indices.length - m.first;
	}

	box() {
		const first = this.vertices.length / 6, at = (corner, axis) => first + 3 * corner + axis;
		for (let corner = 0; corner < 8; corner++) {
			const c = [0, 1, 2].map((k) => (corner >> k & 1 ? 1 : -1));
			for (let axis = 0; axis < 3; axis++)
				this.vertex(c, c.map((x, k) => (k === axis ? x : 0)));
		}
		for (let axis = 0; axis < 3; axis++) {
			const u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, up = 1 << axis;
			this.quad(at(up, axis), at(up | u, axis), at(up | u | v, axis), at(up | v, axis));
			this.quad(at(0, axis), at(v, axis), at(u | v, axis), at(u, axis));
		}
	}

	ring(n, vertex) {
		const first = this.vertices.length / 6;
		for (let i = 0; i <= n; i++) {
			const turn = 2 * Math.PI * (i % n) / n;
			vertex(Math.cos(turn), Math.sin(turn));
		}
		return first;
	}

	// The ball, cut at its equator: each half belongs to an end of the core.
	round(n) {
		const quarter = n / 4;
		const ring = (latitude, end) => this.ring(n, (c, s) => this.vertex([0, 0, end],
			[Math.cos(latitude) * c, Math.cos(latitude) * s, Math.sin(latitude)]));
		let last = ring(-Math.PI / 2, -1);
		for (let i = 1; i <= 2 * quarter + 1; i++) {
			const step = i <= quarter ? i : i - 1;
			const next = ring(Math.PI / 2 * (step - quarter) / quarter, i <= quarter ? -1 : 1);
			this.belt(last, next, n);
			last = next;
		}
	}

	cylinder(n) {
		const ring = (z, nz) => this.ring(n, (c, s) => this.vertex([c, s, z], nz ? [0, 0, nz] : [c, s, 0]));
		const bottom = ring(-1, -1), low = ring(-1, 0), high = ring(1, 0), top = ring(1, 1);
		this.belt(bottom, low, n);
		this.belt(low, high, n);
		this.belt(high, top, n);
		for (let i = 1; i + 1 < n; i++)
			this.indices.push(bottom, bottom + i + 1, bottom + i, top, top + i, top + i + 1);
	}
}

// { vertices, indices, meshes: [{ first, count }] }, the meshes in the order of the constants above, coarse to fine.
export function buildMeshes() {
	const b = new Builder();
	const one = (make) => {
		b.begin();
		make();
		b.end();
	};
	one(() => b.box());
	b.meshes.push(b.meshes[BOX_MESH]);
	for (const n of LEVELS)
		one(() => b.round(n));
	for (const n of LEVELS)
		one(() => b.cylinder(n));
	return { vertices: new Float32Array(b.vertices), indices: new Uint16Array(b.indices), meshes: b.meshes };
}

// The faces of a hull, or of a compound's parts, as triangles, a corner and a normal a vertex, in metres.
export function hullVertices(hull) {
	return new Float32Array((hull.parts.length ? hull.parts : [hull]).flatMap(triangles));
}

function triangles(hull) {
	const out = [];
	for (const face of hull.faces) {
		const [a, b, c] = face.slice(0, 3).map((k) => hull.corners[k]);
		const u = b.map((x, k) => x - a[k]), v = c.map((x, k) => x - a[k]);
		const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], l = Math.hypot(...n);
		for (let k = 1; k + 1 < face.length; k++)
			for (const corner of [face[0], face[k], face[k + 1]])
				out.push(...hull.corners[corner], ...n.map((x) => x / l));
	}
	return out;
}
