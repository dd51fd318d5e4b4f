// Colours of the page: node families, false colour, and the way from linear light to the screen.

const hues = {
  vector: 210, transform: 205, project: 200, clip: 190, cull: 180, scene: 130, light: 48, texture: 35, shade: 22, rasterize: 265,
  visibility: 280, trace: 300, radiosity: 320, supersample: 240, filter: 225, color: 340, image: 355, curve: 160, surface: 150,
  subdivide: 145, mesh: 170, io: 90, check: 75,
};

export function familyColor(family) {
  let hue = hues[family];
  if (hue === undefined) hue = [...family].reduce((h, c) => (h * 31 + c.charCodeAt(0)) % 360, 7);
  return `hsl(${hue} 52% 52%)`;
}

// Google's Turbo by a polynomial (Mikhailov 2019), 0 to 1; within 1/255 of a step of its table nearly everywhere.
export function turbo(t) {
  const poly = (c) => c.reduceRight((sum, k) => sum * t + k, 0);
  return [poly([0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943]),
          poly([0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604]),
          poly([0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973])]
      .map((v) => Math.round(255 * Math.min(1, Math.max(0, v))));
}

// A colour for a number that names something: neighbouring numbers get far hues.
export function idColor(id) {
  const h = Math.imul(id + 1, 2654435761) >>> 0;
  return [90 + (h & 127), 90 + (h >>> 8 & 127), 90 + (h >>> 16 & 127)];
}

// IEC 61966-2-1, both ways, by tables for speed: 4096 steps over [0, 1] are finer than 8 bits everywhere but in the toe, which
// is linear and computed.
const encodeTable = Uint8Array.from({length: 4097}, (_, i) => Math.round(255 * encode(i / 4096)));
function encode(v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055; }
export function srgbByte(linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  return linear < 0.01 ? Math.round(255 * encode(linear)) : encodeTable[Math.round(linear * 4096)];
}
export function srgbLinear(v) { return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }

// The light of a checkerboard behind a picture, so that transparent is told from black: greys 153 and 204. A large picture has
// some 48 squares along its longer side, a small one a square a pixel.
const squares = [srgbLinear(153 / 255), srgbLinear(204 / 255)];

// (pixel, gain) => bytes [r, g, b] of a view's colour over a checkerboard; `rgb` and `alpha` are planes of numbers, `display` says
// that they are encoded for a screen. Encoded values were multiplied by alpha as they are.
export function overCheckerboard(view, rgb, alpha, display) {
  const size = Math.ceil(Math.max(view.width, view.height) / 48), straight = view.alpha === "straight";
  const decoded = display ? (v) => srgbLinear(Math.max(0, v)) : (v) => v;
  const light = straight ? (v, a) => decoded(v) * a : display ? (v, a) => (a > 0 ? decoded(v / a) * a : decoded(v)) : decoded;
  return (i, gain) => {
    const a = alpha[i], square = Math.floor(i % view.width / size) + Math.floor(i / view.width / size) & 1;
    const back = a < 1 ? (1 - Math.max(0, a)) * squares[square] : 0;
    return rgb.map((p) => srgbByte(gain * light(p[i], a) + back));
  };
}
