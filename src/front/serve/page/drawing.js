// Draws a universe with WebGL 2, by the renderer's own shaders and passes (src/run/render/passes.c, frame.c): shadow map,
// occlusion map, bodies, planes, sky, overlays.
import { isEndless, isHulled, outlineOf } from './shapes.js';
import { BOX_MESH, CYLINDER_MESH, MESHES, PATTERNED_BOX_MESH, ROUND_MESH, buildMeshes, hullVertices } from './meshes.js';
import { turned } from './motion.js';
import { SHADERS } from './shaders.js';

const SAMPLES = 4, SHADOW_TEXELS = 1280, SKY_TEXELS = 512, OCCLUSION_TEXELS = 128, MARGIN = 4; // texels; MARGIN: border for the
                                                                                  // filter
const SKY_MAPS = 12; // as in light.glsl
const UNIT_SHADOW = 0, UNIT_OCCLUSION = 1, UNIT_SOURCE = 2, UNIT_PLAIN = 3, UNIT_SKY = 4, UNIT_COLOUR_IMAGE = 5, UNIT_SURFACE_IMAGE = 6;
const OCCLUSION_HEIGHT = 0.8; // m above the ground, up to which a body occludes it
const REACH_RANGES = 3.5, FOG_RANGES = 9, FOG_LEAST = 150; // camera ranges; m
const SUNSHINE = [1.95, 1.82, 1.6], FROM_SKY = 0.52, FROM_GROUND = 0.45, SUN_RADIUS = 0.025, GOLDEN = 2.39996322972865332;
const ROUGH = 0.75; // texels of the shadow map along a side where a pixel has one sample, as while the picture changes without a GPU
const SENSOR_SHARE = 0.35; // a sensor's share of the light, before what is behind it
const BEVEL_SHARE = 0.1, BEVEL_MOST = 0.05, MEDIUM_PX = 7, FINE_PX = 45;
const GRID_PERIOD = 10, PATTERN_PERIOD = 768; // m; as in shaders/pattern.glsl
const INSTANCE = 16, SEGMENT = 11, MESH_VERTEX = 12; // floats
const EDGE = { awake: [1, 0.86, 0.25, 1], flying: [0.45, 0.95, 1, 1], standing: [0.62, 0.66, 0.74, 1], fixed: [0.35, 0.37, 0.42, 1], frozen: [0.6, 0.85, 1, 1] };
const JOINT = { line: [0.35, 0.85, 1, 1], axis: [1, 0.45, 0.9, 1], rim: [0.08, 0.02, 0.05, 0.85] };
const APART = 6, AXES = new Set([1, 2]); // kinds of joints (<ob/joint.h>): no joint to be seen; hinge, slider

const PROGRAMS = {
	body: ['body.vert', 'body.frag'], mesh: ['body.vert', 'body.frag', '#define OB_SOFT\n'], textured: ['body.vert', 'body.frag', '#define OB_TEXTURED\n#define OB_SOFT\n'], patterned: ['body.vert', 'body.frag', '#define OB_PATTERNED\n'], shadow: ['shadow.vert', 'shadow.frag'],
	skyShadow: ['sky_shadow.vert', 'shadow.frag'], occlusion: ['occlusion.vert', 'occlusion.frag'],
	blur: ['sky.vert', 'blur.frag'], plane: ['plane.vert', 'plane.frag'],
	farPlane: ['plane.vert', 'plane.frag', '#define OB_FAR\n'], patternedPlane: ['plane.vert', 'plane.frag', '#define OB_PATTERNED\n'],
	farPatternedPlane: ['plane.vert', 'plane.frag', '#define OB_FAR\n#define OB_PATTERNED\n'], sky: ['sky.vert', 'sky.frag'],
	segment: ['segment.vert', 'segment.frag'],
};

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const unit = (a) => scale(a, 1 / Math.hypot(...a));

// Begins to compile a shader. Their text is written for OpenGL 3.3; with another first line it is GLSL ES 3.00.
function compile(gl, kind, source, defines) {
	const shader = gl.createShader(kind);
	const head = '#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2DShadow;\n' + defines;
	gl.shaderSource(shader, head + source.slice(source.indexOf('\n') + 1));
	gl.compileShader(shader);
	return shader;
}

// ---- the orthographic projection of a map (ob_ortho)

function include(r, x, y, reach) {
	r.lowX = Math.min(r.lowX, x - reach);
	r.lowY = Math.min(r.lowY, y - reach);
	r.highX = Math.max(r.highX, x + reach);
	r.highY = Math.max(r.highY, y + reach);
}
const nothing = () => ({ lowX: Infinity, lowY: Infinity, highX: -Infinity, highY: -Infinity });

function steppedSize(need, texels) {
	const half = Math.max(need, 0.05) * texels / (texels - 2 * MARGIN - 2);
	return 2 ** (Math.ceil(6 * Math.log2(half)) / 6);
}

function inFrustum(v, p, radius) {
	const d = sub(p, v.eye), z = dot(d, v.forward);
	return z >= -radius && z <= v.far + radius &&
		Math.abs(dot(d, v.right)) - z * v.tanX <= radius * Math.hypot(1, v.tanX) &&
		Math.abs(dot(d, v.up)) - z * v.tanY <= radius * Math.hypot(1, v.tanY);
}

function fitOrtho(z, bodies, v, texels) {
	const x = Math.abs(z[2]) > 0.999 ? [1, 0, 0] : unit(cross([0, 0, 1], z)), y = cross(z, x);
	let depth = v.range, low = Infinity, high = -Infinity;
	for (const b of bodies) {
		const d = dot(sub(b.p, v.eye), v.forward) + b.radius;
		if (d > depth && inFrustum(v, b.p, b.radius))
			depth = d;
	}
	depth = Math.min(1.5 * depth, REACH_RANGES * v.range);
	const frustum = nothing();
	let cast = nothing();
	include(frustum, dot(v.eye, x), dot(v.eye, y), 0);
	for (let corner = 0; corner < 4; corner++) {
		let p = add(v.eye, v.forward, depth);
		p = add(add(p, v.right, (corner & 1 ? 1 : -1) * depth * v.tanX), v.up, (corner & 2 ? 1 : -1) * depth * v.tanY);
		include(frustum, dot(p, x), dot(p, y), 0);
	}
	for (const b of bodies) {
		const bx = dot(b.p, x), by = dot(b.p, y), up = dot(b.p, z), r = b.radius;
		if (bx + r < frustum.lowX || bx - r > frustum.highX || by + r < frustum.lowY || by - r > frustum.highY)
			continue;
		include(cast, bx, by, r);
		low = Math.min(low, up - r);
		high = Math.max(high, up + r);
	}
	if (low > high)
		[cast, low, high] = [frustum, -1, 1];
	const lowX = Math.max(cast.lowX, frustum.lowX), highX = Math.min(cast.highX, frustum.highX);
	const lowY = Math.max(cast.lowY, frustum.lowY), highY = Math.min(cast.highY, frustum.highY);
	const halfX = steppedSize((highX - lowX) / 2, texels), halfY = steppedSize((highY - lowY) / 2, texels);
	const whole = (centre, half) => 2 * half / texels * Math.round(centre / (2 * half / texels));
	return { x, y, z, halfX, halfY, centreX: whole((lowX + highX) / 2, halfX), centreY: whole((lowY + highY) / 2, halfY), low, high };
}

const contains = (m, b) => Math.abs(dot(b.p, m.x) - m.centreX) <= m.halfX + b.radius &&
	Math.abs(dot(b.p, m.y) - m.centreY) <= m.halfY + b.radius;

function orthoMatrix(m, eye) {
	const deep = m.high - m.low, x = scale(m.x, 0.5 / m.halfX), y = scale(m.y, 0.5 / m.halfY), z = scale(m.z, -1 / deep);
	return [
		x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0,
		(dot(eye, m.x) - m.centreX) * 0.5 / m.halfX + 0.5, (dot(eye, m.y) - m.centreY) * 0.5 / m.halfY + 0.5,
		(m.high - dot(eye, m.z)) / deep, 1,
	];
}

// Bounds of possible shadows in a plane: low x, low y, high x, high y, m from the foot along the plane's axes.
function patchEnds(f, foot, x, y, n) {
	const m = f.shadow, reach = f.view.far, slope = dot(m.z, n);
	if (slope < 0.02)
		return [-reach, -reach, reach, reach];
	const corners = [0, 1, 2, 3].map((corner) => {
		let p = add(scale(m.x, m.centreX + (corner & 1 ? 1 : -1) * m.halfX), m.y, m.centreY + (corner & 2 ? 1 : -1) * m.halfY);
		p = sub(p, add(f.view.eye, foot));
		p = add(p, m.z, -dot(p, n) / slope);
		return [dot(p, x), dot(p, y)].map((at) => Math.max(-reach, Math.min(reach, at)));
	});
	const ends = (pick, k) => pick(...corners.map((c) => c[k]));
	return [ends(Math.min, 0), ends(Math.min, 1), ends(Math.max, 0), ends(Math.max, 1)];
}

// Directions spread evenly over the sky.
function skyRays() {
	return Array.from({ length: SKY_MAPS }, (_, i) => {
		const up = 0.06 + 0.92 * (i + 0.5) / SKY_MAPS, out = Math.sqrt(1 - up * up);
		return [out * Math.cos(GOLDEN * i), out * Math.sin(GOLDEN * i), up];
	});
}

function projection(v) {
	const { near: n, far: f } = v, x = scale(v.right, 1 / v.tanX), y = scale(v.up, 1 / v.tanY), d = v.forward;
	const z = scale(d, (f + n) / (f - n));
	return [x[0], y[0], z[0], d[0], x[1], y[1], z[1], d[1], x[2], y[2], z[2], d[2], 0, 0, -2 * f * n / (f - n), 0];
}

// ---- instances

function meshOf(body, v, height) {
	const o = outlineOf(body.shape, body.size);
	if (!o.rim && !o.ball)
		return body.pattern ? PATTERNED_BOX_MESH : BOX_MESH;
	const distance = Math.max(Math.hypot(...sub(body.p, v.eye)), v.near);
	const px = 0.5 * height * body.size[0] / (v.tanY * distance), level = px < MEDIUM_PX ? 0 : px < FINE_PX ? 1 : 2;
	return (o.rim ? CYLINDER_MESH : ROUND_MESH) + level;
}

function putInstance(out, at, body, eye) {
	const bevel = (smallest) => Math.min(BEVEL_SHARE * smallest, BEVEL_MOST);
	const o = body.mesh ? null : outlineOf(body.shape, body.size); // a mesh's and a hull's vertices are in metres
	let r = o?.ball ?? 0, core = o?.half ?? [1, 1, 1], rounding = 0;
	if (body.mesh)
		rounding = -(body.meshColour ? 1 : 0) - (body.meshSurface ? 2 : 0);
	else if (o?.rim) {
		r = bevel(Math.min(o.rim, core[2]));
		core = [o.rim - r, o.rim - r, core[2] - r];
	} else if (o && !r)
		rounding = bevel(Math.min(...core));
	const q = body.q, c = body.shown, surface = Math.round(15 * body.metal) + Math.min(body.roughness, 0.99) + (rounding > 0 ? 16 * body.pattern : 0);
	out.set([body.p[0] - eye[0], body.p[1] - eye[1], body.p[2] - eye[2], r, q[1], q[2], q[3], q[0], ...core, rounding, ...c, surface], at);
}

export class Drawing {
	// light: "draft" is cheap, "whole" has soft shadows and the sky's light; by default chosen by the browser's
	// renderer.
	constructor(canvas, light) {
		this.canvas = canvas;
		const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: true });
		if (!gl)
			throw new Error('this browser has no WebGL 2, which the viewer draws with');
		this.gl = gl;
		const info = gl.getExtension('WEBGL_debug_renderer_info');
		this.renderer = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER);
		this.software = /llvmpipe|softpipe|swiftshader/i.test(this.renderer);
		this.draft = light ? light === 'draft' : this.software;
		this.createBuffers();
		this.createMaps();
		this.gl.depthFunc(this.gl.LEQUAL);
		this.program = {};
		// Without a GPU each takes 10 ms and more. Those of nearly all scenes are begun now, before a scene has arrived, and waited
		// for at their first use; others are begun then.
		const usual = new Set(['body', 'plane', 'farPlane', 'sky', 'shadow', ...this.draft ? ['occlusion', 'blur'] : ['skyShadow']]);
		for (const name of Object.keys(PROGRAMS)) {
			const begun = usual.has(name) && this.begin(name);
			let linked;
			Object.defineProperty(this.program, name, { get: () => (linked ??= this.link(name, begun || this.begin(name))) });
		}
	}

	begin(name) {
		const gl = this.gl, id = gl.createProgram(), [vertex, fragment, define = ''] = PROGRAMS[name], defines = define + (this.draft ? '#define OB_DRAFT\n' : '');
		const shaders = [compile(gl, gl.VERTEX_SHADER, SHADERS[vertex], defines), compile(gl, gl.FRAGMENT_SHADER, SHADERS[fragment], defines)];
		shaders.forEach((shader) => gl.attachShader(id, shader));
		gl.linkProgram(id);
		return { id, shaders };
	}

	link(name, { id, shaders }) {
		const gl = this.gl, at = {};
		if (!gl.getProgramParameter(id, gl.LINK_STATUS))
			throw new Error(`shader ${name}: ${[...shaders.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(id)].join(' ')}`);
		const block = gl.getUniformBlockIndex(id, 'Frame');
		if (block !== gl.INVALID_INDEX)
			gl.uniformBlockBinding(id, block, 0);
		gl.useProgram(id);
		for (const [sampler, number] of [['shadow_depth', UNIT_SHADOW], ['occlusion', UNIT_OCCLUSION], ['source', UNIT_SOURCE],
			['shadow_plain', UNIT_PLAIN], ['sky_depth', UNIT_SKY], ['colour_image', UNIT_COLOUR_IMAGE], ['surface_image', UNIT_SURFACE_IMAGE]])
			gl.uniform1i(gl.getUniformLocation(id, sampler), number);
		const uniform = (u) => (at[u] === undefined ? (at[u] = gl.getUniformLocation(id, u)) : at[u]);
		return { id, uniform };
	}

	createBuffers() {
		const gl = this.gl, set = buildMeshes();
		this.meshes = set.meshes;
		this.hulls = new Map(); // number -> { array, count }
		this.looks = new Map(); // number -> { array, count, radius, buffers, parts, textures }: meshes of the scene
		this.white = this.createImage({ width: 1, height: 1, bytes: new Uint8Array(4).fill(255) }, gl.RGBA8); // for
		                                                                                                      // no
		                                                                                                      // image
		this.frameBlock = gl.createBuffer();
		this.instances = gl.createBuffer();
		this.segments = gl.createBuffer();
		this.bodyArray = gl.createVertexArray();
		gl.bindVertexArray(this.bodyArray);
		gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ARRAY_BUFFER, set.vertices, gl.STATIC_DRAW);
		this.attribute(0, 3, 6, 0, 0);
		this.attribute(1, 3, 6, 3, 0);
		gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, set.indices, gl.STATIC_DRAW);
		this.segmentArray = gl.createVertexArray();
		gl.bindVertexArray(this.segmentArray);
		gl.bindBuffer(gl.ARRAY_BUFFER, this.segments);
		[[0, 3, 0], [1, 3, 3], [2, 4, 6], [3, 1, 10]].forEach(([i, size, offset]) => this.attribute(i, size, SEGMENT, offset, 1));
		this.emptyArray = gl.createVertexArray();
	}

	attribute(index, size, stride, offset, divisor) {
		const gl = this.gl;
		gl.enableVertexAttribArray(index);
		gl.vertexAttribPointer(index, size, gl.FLOAT, false, 4 * stride, 4 * offset);
		gl.vertexAttribDivisor(index, divisor);
	}

	createMaps() {
		const gl = this.gl;
		const map = (attachment, inner, format, type, texels) => {
			const framebuffer = gl.createFramebuffer(), texture = gl.createTexture();
			gl.bindTexture(gl.TEXTURE_2D, texture);
			gl.texImage2D(gl.TEXTURE_2D, 0, inner, texels, texels, 0, format, type, null);
			for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
				gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
			for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
				gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
			gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
			gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, texture, 0);
			return { framebuffer, texture };
		};
		this.shadow = map(gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT16, gl.DEPTH_COMPONENT, gl.UNSIGNED_SHORT, SHADOW_TEXELS);
		this.shadow.texels = SHADOW_TEXELS;
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
		gl.drawBuffers([gl.NONE]);
		if (!this.draft)
			this.createSkyMaps();
		this.occlusion = [0, 1].map(() => map(gl.COLOR_ATTACHMENT0, gl.R8, gl.RED, gl.UNSIGNED_BYTE, OCCLUSION_TEXELS));
	}

	sizeShadowMap(texels) {
		const gl = this.gl;
		if (this.shadow.texels === texels)
			return;
		this.shadow.texels = texels;
		gl.activeTexture(gl.TEXTURE0 + UNIT_SHADOW);
		gl.bindTexture(gl.TEXTURE_2D, this.shadow.texture);
		gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT16, texels, texels, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_SHORT, null);
		gl.bindTexture(gl.TEXTURE_2D, null); // it will be the target
	}

	createSkyMaps() {
		const gl = this.gl;
		this.plain = gl.createSampler(); // reads the shadow map without comparison
		for (const [what, value] of [[gl.TEXTURE_COMPARE_MODE, gl.NONE], [gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
			[gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
			gl.samplerParameteri(this.plain, what, value);
		this.skyTexture = gl.createTexture();
		gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.skyTexture);
		gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.DEPTH_COMPONENT16, SKY_TEXELS, SKY_TEXELS, SKY_MAPS, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_SHORT, null);
		for (const [what, value] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
			[gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE], [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE], [gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL]])
			gl.texParameteri(gl.TEXTURE_2D_ARRAY, what, value);
		gl.bindTexture(gl.TEXTURE_2D_ARRAY, null);
		this.skyFramebuffers = Array.from({ length: SKY_MAPS }, (_, layer) => {
			const framebuffer = gl.createFramebuffer();
			gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
			gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, this.skyTexture, 0, layer);
			gl.drawBuffers([gl.NONE]);
			return framebuffer;
		});
	}

	// ---- a frame

	// bodies: { shape, size, p, q, radius, shown: linear RGB; mesh: one of looks, if it has one }; look: the
	// scene's (welcome). overlay: see drawSegments. smooth: with several samples a pixel. share: of the full resolution,
	// for the shadow map, too.
	draw(bodies, view, look, overlay, smooth = true, share = 1) {
		const gl = this.gl, width = this.canvas.width, height = this.canvas.height;
		const shown = bodies.filter((b) => !b.hidden), opaque = shown.filter((b) => !b.sensor);
		const solid = opaque.filter((b) => !isEndless(b.shape)), planes = opaque.filter((b) => isEndless(b.shape));
		const ground = planes.find((b) => turned(b.q, [0, 0, 1])[2] > 0.999);
		this.sizeShadowMap(64 * Math.round(SHADOW_TEXELS * share * (smooth ? 1 : ROUGH) / 64));
		const sun = Math.hypot(...look.sun) > 0 ? unit(look.sun) : [0, 0, 1];
		const f = { view, ground, shadow: fitOrtho(sun, solid, view, this.shadow.texels) };
		const up = ground ? turned(ground.q, [0, 0, 1]) : [0, 0, 1];
		f.level = ground ? dot(ground.p, up) : 0;
		f.occlusion = fitOrtho(up, solid, view, OCCLUSION_TEXELS);
		f.shadowMap = orthoMatrix(f.shadow, view.eye);
		f.occlusionMap = orthoMatrix(f.occlusion, view.eye);
		[f.occlusionMap[2], f.occlusionMap[6], f.occlusionMap[10]] = up;
		f.occlusionMap[14] = dot(view.eye, up) - f.level;
		f.sky = this.draft ? [] : skyRays().map((ray) => ({ ray, map: fitOrtho(ray, solid, view, SKY_TEXELS) }));
		this.setBlock(f, sun, look, width, height);
		gl.enable(gl.CULL_FACE);
		gl.depthMask(true);
		gl.disable(gl.BLEND);
		// The first picture has no shadows in the cheap light: without a GPU their passes take longest when they are new.
		const shades = !this.draft || this.begun;
		this.begun = true;
		this.drawShadowMap(shades ? solid.filter((b) => contains(f.shadow, b)) : [], view, height);
		f.sky.forEach(({ map }, i) => this.drawSkyMap(i, solid.filter((b) => contains(map, b)), view, height));
		if (ground && this.draft && shades)
			this.drawOcclusionMap(solid.filter((b) => dot(b.p, up) - b.radius < f.level + OCCLUSION_HEIGHT &&
				contains(f.occlusion, b)), view, height);
		this.target(smooth ? this.samples(width, height) : null, width, height);
		this.drawColour(solid, planes, f, look, width, height);
		this.drawThrough(shown.filter((b) => b.sensor && !isEndless(b.shape) && inFrustum(view, b.p, b.radius)), view, height);
		this.unbindMaps();
		if (overlay.length)
			this.drawSegments(overlay, view);
		if (!smooth)
			return;
		gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.multi.framebuffer);
		gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
		gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
	}

	// A target of this size with several samples a pixel.
	samples(width, height) {
		const gl = this.gl, count = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
		this.multi ??= { framebuffer: gl.createFramebuffer(), buffers: [gl.createRenderbuffer(), gl.createRenderbuffer()] };
		if (this.multi.width === width && this.multi.height === height)
			return this.multi.framebuffer;
		Object.assign(this.multi, { width, height });
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.multi.framebuffer);
		[[gl.COLOR_ATTACHMENT0, gl.RGB8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]].forEach(([attachment, form], i) => {
			gl.bindRenderbuffer(gl.RENDERBUFFER, this.multi.buffers[i]);
			gl.renderbufferStorageMultisample(gl.RENDERBUFFER, count, form, width, height);
			gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, this.multi.buffers[i]);
		});
		return this.multi.framebuffer;
	}

	setBlock(f, sun, look, width, height) {
		const gl = this.gl, v = f.view, fog = Math.max(FOG_LEAST, FOG_RANGES * v.range);
		const top = look.sky_top, horizon = look.sky_horizon, below = f.ground ? look.ground : horizon;
		const sky = add(scale(top, 0.35), horizon, 0.65), texel = 2 * Math.max(f.shadow.halfX, f.shadow.halfY) / this.shadow.texels;
		const shines = f.ground ? SUNSHINE[1] * Math.max(sun[2], 0) + FROM_SKY : 0.6, deep = SUN_RADIUS * (f.shadow.high - f.shadow.low) / 2;
		const unused = new Array(SKY_MAPS - f.sky.length), none = new Array(16).fill(0);
		const block = new Float32Array([
			...projection(v), ...f.shadowMap, ...f.occlusionMap,
			...scale(v.right, v.tanX), 0, ...scale(v.up, v.tanY), 0, ...v.forward, 0,
			...sun, texel, ...SUNSHINE, 0, ...top, 1 / (fog * fog), ...horizon, f.ground ? 1 : 0,
			...scale(sky, FROM_SKY), 0, ...scale(add(scale(below, 0.8), sky, 0.2), FROM_GROUND), 0,
			...scale(below, 0.75 * shines), 0,
			width, height, 1 / width, 1 / height, 1 / this.shadow.texels, 1 / this.shadow.texels, deep / f.shadow.halfX, deep / f.shadow.halfY,
			...f.sky.flatMap(({ map }) => orthoMatrix(map, v.eye)), ...unused.fill(none).flat(),
			...f.sky.flatMap(({ ray, map }) => [...ray, 2 * Math.max(map.halfX, map.halfY) / SKY_TEXELS]), ...unused.fill(none.slice(12)).flat(),
		]);
		gl.bindBuffer(gl.UNIFORM_BUFFER, this.frameBlock);
		gl.bufferData(gl.UNIFORM_BUFFER, block, gl.DYNAMIC_DRAW);
		gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, this.frameBlock);
	}

	// The mesh of a hull, made at its first use.
	hullMesh(hull) {
		const gl = this.gl;
		let mesh = this.hulls.get(hull.number);
		if (mesh)
			return mesh;
		const vertices = hullVertices(hull);
		mesh = { array: gl.createVertexArray(), count: vertices.length / 6 };
		gl.bindVertexArray(mesh.array);
		gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
		gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
		this.attribute(0, 3, 6, 0, 0);
		this.attribute(1, 3, 6, 3, 0);
		this.hulls.set(hull.number, mesh);
		return mesh;
	}

	// form: SRGB8_ALPHA8 or RGBA8.
	createImage({ width, height, bytes }, form) {
		const gl = this.gl, id = gl.createTexture();
		gl.activeTexture(gl.TEXTURE0 + UNIT_COLOUR_IMAGE);
		gl.bindTexture(gl.TEXTURE_2D, id);
		gl.texImage2D(gl.TEXTURE_2D, 0, form, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
		gl.generateMipmap(gl.TEXTURE_2D);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
		return id;
	}

	// Adds a mesh of the scene, in the message's form.
	addMesh({ number, vertices, indices, parts, images }) {
		const gl = this.gl, look = { array: gl.createVertexArray(), count: indices.length, radius: 0, buffers: [gl.createBuffer(), gl.createBuffer()], parts, textures: [] };
		for (const { colour, surface } of parts) {
			if (colour)
				look.textures[colour - 1] ??= this.createImage(images[colour - 1], gl.SRGB8_ALPHA8);
			if (surface)
				look.textures[surface - 1] ??= this.createImage(images[surface - 1], gl.RGBA8);
		}
		for (let i = 0; i < vertices.length; i += MESH_VERTEX)
			look.radius = Math.max(look.radius, Math.hypot(vertices[i], vertices[i + 1], vertices[i + 2]));
		gl.bindVertexArray(look.array);
		gl.bindBuffer(gl.ARRAY_BUFFER, look.buffers[0]);
		gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
		[[0, 3, 0], [1, 3, 3], [6, 4, 6], [7, 2, 10]].forEach(([i, size, offset]) => this.attribute(i, size, MESH_VERTEX, offset, 0));
		gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, look.buffers[1]);
		gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
		gl.bindVertexArray(null);
		this.looks.set(number, look);
	}

	forgetMeshes() {
		for (const look of this.looks.values()) {
			this.gl.deleteVertexArray(look.array);
			look.buffers.forEach((b) => this.gl.deleteBuffer(b));
			look.textures.forEach((t) => this.gl.deleteTexture(t));
		}
		this.looks.clear();
	}

	bindImage(unit, image, wrap) {
		const gl = this.gl, modes = [gl.REPEAT, gl.MIRRORED_REPEAT, gl.CLAMP_TO_EDGE];
		gl.activeTexture(gl.TEXTURE0 + unit);
		gl.bindTexture(gl.TEXTURE_2D, image);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, modes[wrap[0]]);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, modes[wrap[1]]);
	}

	// The parts of a mesh with images, each with its own.
	drawTextured(look, count) {
		const gl = this.gl;
		let first = 0;
		gl.useProgram(this.program.textured.id);
		for (const { indices, colour, surface, wrap } of look.parts) {
			this.bindImage(UNIT_COLOUR_IMAGE, colour ? look.textures[colour - 1] : this.white, wrap);
			this.bindImage(UNIT_SURFACE_IMAGE, surface ? look.textures[surface - 1] : this.white, wrap);
			gl.drawElementsInstanced(gl.TRIANGLES, indices, gl.UNSIGNED_INT, 4 * first, count);
			first += indices;
		}
	}

	// inColour: with the programs for bodies, for the picture; else with the present one.
	drawInstances(bodies, view, height, inColour = false) {
		const gl = this.gl, groups = Array.from({ length: MESHES }, () => []), others = new Map(); // hulls and meshes
		for (const b of bodies) {
			const own = b.mesh ?? (isHulled(b.shape) ? this.hullMesh(b.hull) : null);
			if (!own)
				groups[meshOf(b, view, height)].push(b);
			else if (others.has(own))
				others.get(own).push(b);
			else
				others.set(own, [b]);
		}
		const meshes = [...others.keys()];
		groups.push(...others.values());
		const data = new Float32Array(INSTANCE * bodies.length);
		groups.flat().forEach((b, i) => putInstance(data, INSTANCE * i, b, view.eye));
		gl.bindVertexArray(this.bodyArray);
		gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
		gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
		let first = 0;
		groups.forEach((group, k) => {
			if (!group.length)
				return;
			const own = k < MESHES ? null : meshes[k - MESHES];
			if (own) {
				gl.bindVertexArray(own.array);
				gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
			}
			for (let i = 0; i < 4; i++)
				this.attribute(2 + i, 4, INSTANCE, INSTANCE * first + 4 * i, 1);
			if (inColour)
				gl.useProgram((k === PATTERNED_BOX_MESH ? this.program.patterned : own?.buffers ? this.program.mesh : this.program.body).id);
			if (inColour && own?.parts?.length)
				this.drawTextured(own, group.length);
			else if (own?.buffers)
				gl.drawElementsInstanced(gl.TRIANGLES, own.count, gl.UNSIGNED_INT, 0, group.length);
			else if (own)
				gl.drawArraysInstanced(gl.TRIANGLES, 0, own.count, group.length);
			else
				gl.drawElementsInstanced(gl.TRIANGLES, this.meshes[k].count, gl.UNSIGNED_SHORT, 2 * this.meshes[k].first, group.length);
			first += group.length;
		});
	}

	target(framebuffer, width, height) {
		this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, framebuffer);
		this.gl.viewport(0, 0, width, height);
	}

	drawShadowMap(casters, view, height) {
		this.target(this.shadow.framebuffer, this.shadow.texels, this.shadow.texels);
		this.gl.useProgram(this.program.shadow.id);
		this.drawDepth(casters, view, height);
	}

	drawSkyMap(layer, casters, view, height) {
		const { id, uniform } = this.program.skyShadow;
		this.target(this.skyFramebuffers[layer], SKY_TEXELS, SKY_TEXELS);
		this.gl.useProgram(id);
		this.gl.uniform1i(uniform('layer'), layer);
		this.drawDepth(casters, view, height);
	}

	drawDepth(casters, view, height) {
		const gl = this.gl;
		gl.enable(gl.DEPTH_TEST);
		gl.frontFace(gl.CCW);
		gl.clear(gl.DEPTH_BUFFER_BIT);
		gl.enable(gl.POLYGON_OFFSET_FILL);
		gl.polygonOffset(1.6, 2);
		this.drawInstances(casters, view, height);
		gl.disable(gl.POLYGON_OFFSET_FILL);
	}

	drawOcclusionMap(low, view, height) {
		const gl = this.gl;
		this.target(this.occlusion[0].framebuffer, OCCLUSION_TEXELS, OCCLUSION_TEXELS);
		gl.disable(gl.DEPTH_TEST);
		gl.clearColor(0, 0, 0, 0);
		gl.clear(gl.COLOR_BUFFER_BIT);
		gl.enable(gl.BLEND);
		gl.blendEquation(gl.MAX);
		gl.frontFace(gl.CW); // undersides
		gl.useProgram(this.program.occlusion.id);
		this.drawInstances(low, view, height);
		gl.blendEquation(gl.FUNC_ADD);
		gl.disable(gl.BLEND);
		gl.disable(gl.CULL_FACE);
		gl.bindVertexArray(this.emptyArray);
		const { id, uniform } = this.program.blur;
		gl.useProgram(id);
		for (const [from, x, y] of [[0, 1, 0], [1, 0, 1]]) {
			this.target(this.occlusion[1 - from].framebuffer, OCCLUSION_TEXELS, OCCLUSION_TEXELS);
			gl.activeTexture(gl.TEXTURE0 + UNIT_OCCLUSION);
			gl.bindTexture(gl.TEXTURE_2D, null); // it is the target
			gl.activeTexture(gl.TEXTURE0 + UNIT_SOURCE);
			gl.bindTexture(gl.TEXTURE_2D, this.occlusion[from].texture);
			gl.uniform2f(uniform('direction'), 0.5 * x / OCCLUSION_TEXELS, 0.5 * y / OCCLUSION_TEXELS);
			gl.drawArrays(gl.TRIANGLES, 0, 3);
		}
		gl.bindTexture(gl.TEXTURE_2D, null);
		gl.enable(gl.CULL_FACE);
	}

	drawColour(solid, planes, f, look, width, height) {
		const gl = this.gl;
		gl.enable(gl.DEPTH_TEST);
		gl.frontFace(gl.CCW);
		gl.clear(gl.DEPTH_BUFFER_BIT);
		gl.activeTexture(gl.TEXTURE0 + UNIT_SHADOW);
		gl.bindTexture(gl.TEXTURE_2D, this.shadow.texture);
		gl.activeTexture(gl.TEXTURE0 + UNIT_OCCLUSION);
		gl.bindTexture(gl.TEXTURE_2D, this.occlusion[0].texture);
		if (!this.draft) {
			gl.activeTexture(gl.TEXTURE0 + UNIT_PLAIN);
			gl.bindTexture(gl.TEXTURE_2D, this.shadow.texture);
			gl.bindSampler(UNIT_PLAIN, this.plain);
			gl.activeTexture(gl.TEXTURE0 + UNIT_SKY);
			gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.skyTexture);
		}
		const seen = solid.filter((b) => inFrustum(f.view, b.p, b.radius));
		for (const b of seen)
			b.away = Math.hypot(...sub(b.p, f.view.eye));
		this.drawInstances(seen.sort((a, b) => a.away - b.away), f.view, height, true); // the nearest first: it hides others
		gl.disable(gl.CULL_FACE);
		gl.bindVertexArray(this.emptyArray);
		for (const b of planes) {
			this.drawPlane(b, f, look, b.pattern ? this.program.patternedPlane : this.program.plane, 4);
			this.drawPlane(b, f, look, b.pattern ? this.program.farPatternedPlane : this.program.farPlane, 10);
		}
		this.drawSky(f, width, height);
	}

	// Takes the maps off their units: they will be targets.
	unbindMaps() {
		const gl = this.gl;
		for (const [number, kind] of [[UNIT_SHADOW, gl.TEXTURE_2D], [UNIT_PLAIN, gl.TEXTURE_2D], [UNIT_SKY, gl.TEXTURE_2D_ARRAY]]) {
			gl.activeTexture(gl.TEXTURE0 + number);
			gl.bindTexture(kind, null);
		}
	}

	// Draws sensors, which are seen through and cast no shadow.
	drawThrough(sensors, view, height) {
		const gl = this.gl;
		if (!sensors.length)
			return;
		gl.enable(gl.CULL_FACE);
		gl.enable(gl.BLEND);
		gl.blendColor(0, 0, 0, SENSOR_SHARE);
		gl.blendFunc(gl.CONSTANT_ALPHA, gl.ONE_MINUS_CONSTANT_ALPHA);
		gl.depthMask(false);
		this.drawInstances(sensors, view, height, true);
		gl.depthMask(true);
		gl.disable(gl.BLEND);
		gl.disable(gl.CULL_FACE);
	}

	// Draws the sky, over a level ground only from its horizon on: software rendering shades hidden pixels, too.
	drawSky(f, width, height) {
		const gl = this.gl, v = f.view, over = f.ground ? v.eye[2] - f.ground.p[2] : 0;
		let first = 0;
		if (over > 0) {
			const lowest = -1.1 * Math.hypot(1, v.tanX, v.tanY) * over / v.far;
			first = Math.max(0, Math.min(height, Math.floor(0.5 * height * (1 + (lowest - v.forward[2]) / (v.up[2] * v.tanY)))));
		}
		gl.enable(gl.SCISSOR_TEST);
		gl.scissor(0, first, width, height - first);
		gl.useProgram(this.program.sky.id);
		gl.drawArrays(gl.TRIANGLES, 0, 3);
		gl.disable(gl.SCISSOR_TEST);
	}

	drawPlane(b, f, look, { id, uniform }, vertices) {
		const gl = this.gl, isGround = b === f.ground;
		const [x, y, n] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => turned(b.q, axis));
		const d = sub(b.p, f.view.eye), height = -dot(d, n);
		if (height <= 0)
			return; // nothing is visible from below
		const foot = scale(n, -height), onPlane = sub(foot, d), colour = isGround ? look.ground : b.shown;
		const period = b.pattern ? PATTERN_PERIOD : GRID_PERIOD, cell = (a) => a - period * Math.round(a / period);
		const toMap = (m) => [x, y, foot].flatMap((v, column) => [0, 1, 2].map((row) =>
			m[row] * v[0] + m[4 + row] * v[1] + m[8 + row] * v[2] + (column === 2 ? m[12 + row] : 0)));
		gl.useProgram(id);
		gl.uniform4fv(uniform('patch_ends'), patchEnds(f, foot, x, y, n));
		gl.uniform3fv(uniform('foot'), foot);
		gl.uniform3fv(uniform('normal'), n);
		gl.uniform3fv(uniform('axis_x'), x);
		gl.uniform3fv(uniform('axis_y'), y);
		gl.uniformMatrix3fv(uniform('shadow_of'), false, toMap(f.shadowMap));
		gl.uniformMatrix3fv(uniform('occlusion_of'), false, toMap(f.occlusionMap));
		gl.uniform1f(uniform('reach'), f.view.far);
		gl.uniform2f(uniform('grid_foot'), cell(dot(onPlane, x)), cell(dot(onPlane, y)));
		gl.uniform4f(uniform('colour'), ...colour, b.pattern || (isGround && look.grid ? 1 : 0));
		gl.uniform1f(uniform('occlusion_share'), isGround ? 0.75 : 0);
		gl.drawArrays(gl.TRIANGLE_STRIP, 0, vertices);
	}

	// overlay: { from, to (m, world), colour (sRGB, alpha), width (px), over: true: bodies do not hide it }
	drawSegments(overlay, view) {
		const over = overlay.filter((s) => s.over);
		this.drawSegmentsOf(over.length ? overlay.filter((s) => !s.over) : overlay, view);
		this.gl.disable(this.gl.DEPTH_TEST);
		this.drawSegmentsOf(over, view);
		this.gl.enable(this.gl.DEPTH_TEST);
	}

	drawSegmentsOf(overlay, view) {
		const gl = this.gl, data = new Float32Array(SEGMENT * overlay.length);
		overlay.forEach((s, i) => data.set([...sub(s.from, view.eye), ...sub(s.to, view.eye), ...s.colour, s.width], SEGMENT * i));
		gl.bindVertexArray(this.segmentArray);
		gl.bindBuffer(gl.ARRAY_BUFFER, this.segments);
		gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
		gl.depthMask(false);
		gl.enable(gl.BLEND);
		gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
		gl.useProgram(this.program.segment.id);
		gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, overlay.length);
		gl.depthMask(true);
		gl.disable(gl.BLEND);
	}
}

// ---- overlays

// Half extents, along the world's axes, of the box around a body.
export function halfBounds(b) {
	if (isHulled(b.shape)) { // around its centre of mass, as wide as the wider side
		const turnedCorners = b.hull.corners.map((c) => turned(b.q, c));
		return [0, 1, 2].map((k) => Math.max(...turnedCorners.map((c) => Math.abs(c[k]))));
	}
	const o = outlineOf(b.shape, b.size), columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => turned(b.q, axis));
	return [0, 1, 2].map((k) => {
		const along = columns.map((c) => Math.abs(c[k]));
		return dot(along, o.half) + o.rim * Math.sqrt(Math.max(0, 1 - along[2] * along[2])) + o.ball;
	});
}

export function boxSegments(b, colour, width = 1.5) {
	const h = halfBounds(b), out = [];
	const corner = (which) => [0, 1, 2].map((k) => b.p[k] + (which >> k & 1 ? h[k] : -h[k]));
	for (let from = 0; from < 8; from++)
		for (const axis of [1, 2, 4])
			if (!(from & axis))
				out.push({ from: corner(from), to: corner(from | axis), colour, width });
	return out;
}

export function edgeColour(b) {
	return b.frozen ? EDGE.frozen : b.fixed ? EDGE.fixed : b.kind === 0 ? EDGE.standing : b.kind === 2 ? EDGE.flying : EDGE.awake;
}

export function contactSegments(contacts, view, height) {
	const metresAPixel = 2 * view.tanY / height;
	return contacts.flatMap((c) => {
		const tip = add(c.p, c.n, 26 * metresAPixel * Math.hypot(...sub(c.p, view.eye)));
		return [
			{ from: c.p, to: tip, colour: [1, 0.95, 0.55, 1], width: 2 },
			{ from: c.p, to: c.p, colour: [0.08, 0.02, 0.05, 0.85], width: 8.5 },
			{ from: c.p, to: c.p, colour: [1, 0.3, 0.2, 1], width: 6 },
		];
	});
}

// Lines from the centres of both objects to the joint, its axis if it has one, and a dot.
export function jointSegments(joints, bodies, view, height) {
	const metresAPixel = 2 * view.tanY / height, byId = new Map(bodies.map((b) => [b.id, b]));
	return joints.filter((j) => j.kind !== APART).flatMap(({ kind, ends }) => {
		const [a, b] = ends.map(({ id, p, axis }) => {
			const body = byId.get(id);
			const at = body ? add(body.p, turned(body.q, p)) : p;
			return { at, centre: body ? body.p : at, axis: body ? turned(body.q, axis) : axis };
		});
		const line = (from, to, colour, width) => ({ from, to, colour, width, over: true });
		const length = 26 * metresAPixel * Math.hypot(...sub(b.at, view.eye));
		const axis = AXES.has(kind) ? [line(add(b.at, b.axis, -length), add(b.at, b.axis, length), JOINT.axis, 2)] : [];
		return [line(a.centre, a.at, JOINT.line, 1.5), line(b.centre, b.at, JOINT.line, 1.5), line(a.at, b.at, JOINT.line, 1.5),
			...axis, line(b.at, b.at, JOINT.rim, 8.5), line(b.at, b.at, JOINT.line, 6)];
	});
}
