// Shapes, as in src/universe/shape: an entry each, by the number that the server sends (ob_shape). An outline is the sum of a box with
// these half sizes, a disc with the radius rim across z, and a ball; all else follows from it. sizes: m, see ob_shape.
const SHAPES = [
	{ outline: () => ({ half: [0, 0, 0], rim: 0, ball: 0 }) }, // none
	{
		name: 'sphere',
		outline: (s) => ({ half: [0, 0, 0], rim: 0, ball: s[0] }),
		make: (wide) => ({ size: [wide / 2, 0, 0], volume: Math.PI / 6 * wide ** 3 }),
	},
	{
		name: 'box',
		outline: (s) => ({ half: s, rim: 0, ball: 0 }),
		make: (wide) => ({ size: [wide / 2, wide / 2, wide / 2], volume: wide ** 3 }),
	},
	{ name: 'plane', endless: true },
	{
		name: 'capsule',
		outline: (s) => ({ half: [0, 0, s[1]], rim: 0, ball: s[0] }),
		make: (wide) => ({ size: [wide / 4, wide / 4, 0], volume: Math.PI * (wide / 4) ** 2 * wide / 2 + 4 / 3 * Math.PI * (wide / 4) ** 3 }),
	},
	{
		name: 'cylinder',
		outline: (s) => ({ half: [0, 0, s[1]], rim: s[0], ball: 0 }),
		make: (wide) => ({ size: [wide / 2, wide / 2, 0], volume: Math.PI / 4 * wide ** 3 }),
	},
	{ name: 'hull', hulled: true },
	{ name: 'terrain', outline: (s) => ({ half: [s[0], s[1], 0], rim: 0, ball: 0 }) }, // until its mesh has come
];

const kindOf = (shape) => SHAPES[shape] ?? SHAPES[0]; // an unknown shape is none

export const isEndless = (shape) => !!kindOf(shape).endless;
export const isHulled = (shape) => !!kindOf(shape).hulled;

// Null for planes and hulls.
export const outlineOf = (shape, size) => kindOf(shape).outline?.(size) ?? null;

// Size (m) and volume (m^3) of a body of this name as high as wide.
export const makeShape = (name, wide) => SHAPES.find((s) => s.name === name).make(wide);

// Radius of the bounding ball.
export function radiusOf(shape, size) {
	const o = outlineOf(shape, size);
	if (o)
		return o.ball + Math.hypot(o.half[0] + o.rim, o.half[1], o.half[2]);
	return isHulled(shape) ? size[0] : Infinity;
}
