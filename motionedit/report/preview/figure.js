// Bodies and trails: shaded limbs drawn from far to near, pale on the left side and deep on the right.

// Blue and orange stay apart for every kind of colour vision; so do the others in lightness. [light, dark]
const HUES = [
  ["#2a78bd", "#4f9fe3"], ["#dc5f00", "#ef8a3a"], ["#16936f", "#35bd95"], ["#ad4f8d", "#d888bb"],
  ["#a98000", "#dcb93a"], ["#5a5f66", "#b4bac2"], ["#6a51b5", "#a792ea"], ["#a8323e", "#ef7f87"],
];
let colors = {};

function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
}

function mix(a, b, t) {
  return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])];
}

function css(c) {
  return `rgb(${c[0] | 0},${c[1] | 0},${c[2] | 0})`;
}

function readColors(dark) {
  const style = getComputedStyle(document.documentElement);
  const value = (name) => style.getPropertyValue(name).trim();
  colors = {
    dark, paper: rgb(value("--paper")), sky: value("--sky"), grid: value("--grid"), quiet: value("--quiet"),
    ink: value("--ink"), accent: value("--accent"), line: value("--line"),
    goal: value("--goal"), miss: value("--miss"),
  };
  const white = [255, 255, 255], black = [8, 12, 18];
  clips.forEach((clip, i) => {
    const base = rgb(HUES[i % HUES.length][dark ? 1 : 0]);
    const deep = mix(base, black, dark ? 0.42 : 0.34);
    clip.colors = {
      base: css(base),
      shadow: css(dark ? black : mix(base, [40, 50, 65], 0.75)),
      // [fill, edge] by side: left, middle, right
      l: [mix(base, white, dark ? 0.74 : 0.68), mix(base, black, dark ? 0.15 : 0.05)],
      m: [mix(base, white, dark ? 0.12 : 0.18), mix(base, black, dark ? 0.4 : 0.3)],
      r: [deep, dark ? mix(base, white, 0.12) : mix(deep, black, 0.4)],
    };
  });
}

// The outline of a tapered limb: two circles and their common tangents.
function limbPath(ctx, x1, y1, r1, x2, y2, r2) {
  const dx = x2 - x1, dy = y2 - y1, d = Math.hypot(dx, dy);
  ctx.beginPath();
  if (d <= Math.abs(r1 - r2) + 1e-3) {
    const big = r1 > r2;
    ctx.arc(big ? x1 : x2, big ? y1 : y2, Math.max(r1, r2), 0, 2 * Math.PI);
    return;
  }
  const a = Math.atan2(dy, dx), b = Math.acos((r1 - r2) / d);
  ctx.arc(x1, y1, r1, a + b, a - b + 2 * Math.PI);
  ctx.arc(x2, y2, r2, a - b, a + b);
  ctx.closePath();
}

// The convex hull of circles, as a path; each is [x, y, r].
function hullPath(ctx, circles) {
  const points = [];
  for (const [x, y, r] of circles) {
    for (let i = 0; i < 20; i++) points.push([x + r * Math.cos(i * Math.PI / 10), y + r * Math.sin(i * Math.PI / 10)]);
  }
  points.sort((p, q) => p[0] - q[0] || p[1] - q[1]);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1) {
        const [o, q] = chain.slice(-2);
        if ((q[0] - o[0]) * (p[1] - o[1]) - (q[1] - o[1]) * (p[0] - o[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain;
  };
  ctx.beginPath();
  [...half(points), ...half(points.reverse())].forEach((p, i) => (i ? ctx.lineTo(p[0], p[1]) : ctx.moveTo(p[0], p[1])));
  ctx.closePath();
}

// Light falls from the upper left: a ramp across a limb, from its lit edge to the other.
function ramp(ctx, fill, x1, y1, x2, y2, r) {
  let nx = -(y2 - y1), ny = x2 - x1;
  const n = Math.hypot(nx, ny);
  if (n < 1e-3) { nx = -0.6; ny = -0.8; } else { nx /= n; ny /= n; }
  if (-0.5 * nx - 0.86 * ny < 0) { nx = -nx; ny = -ny; }
  const x = (x1 + x2) / 2, y = (y1 + y2) / 2;
  const gradient = ctx.createLinearGradient(x + r * nx, y + r * ny, x - r * nx, y - r * ny);
  gradient.addColorStop(0, css(mix(fill, [255, 255, 255], 0.26)));
  gradient.addColorStop(0.42, css(fill));
  gradient.addColorStop(1, css(mix(fill, [6, 10, 20], 0.26)));
  return gradient;
}

function projectPose(clip, eye) {
  const out = [0, 0, 0, 0];
  clip.screen = clip.screen || new Float32Array(4 * clip.points);
  for (let p = 0; p < clip.points; p++) {
    const P = clip.pose;
    if (!eye.project(P[3 * p], P[3 * p + 1], P[3 * p + 2], out)) return false;
    clip.screen.set(out, 4 * p);
  }
  return true;
}

// Everything of a clip that is drawn in order of depth: {depth, draw}.
function figureParts(ctx, clip, eye) {
  const parts = [];
  // Where clips coincide the later one is seen, and the earlier one only where it differs.
  const order = 0.07 * clip.size * clip.index;
  if (!projectPose(clip, eye)) return parts;
  const S = clip.screen;
  let near = Infinity, far = -Infinity;
  for (let p = 0; p < clip.points; p++) {
    near = Math.min(near, S[4 * p + 2]);
    far = Math.max(far, S[4 * p + 2]);
  }
  // What is farther than the body's middle fades towards the paper.
  const haze = (depth) => 0.3 * Math.max(0, (depth - near) / Math.max(far - near, 1.2 * clip.size) - 0.25);
  const paint = (side, depth, thick, shape, gradient) => {
    const t = haze(depth), [fill, edge] = clip.colors[side];
    shape();
    ctx.lineJoin = "round";
    if (thick > 2) {
      ctx.strokeStyle = css(mix(edge, colors.paper, t));
      ctx.lineWidth = 2.2;
      ctx.stroke();
    }
    ctx.fillStyle = thick > 2 ? gradient(mix(fill, colors.paper, t)) : css(mix(edge, colors.paper, t));
    ctx.fill();
  };
  for (const [start, end, ra, rb, side] of clip.limbs) {
    const i = 4 * start, j = 4 * end;
    const depth = (S[i + 2] + S[j + 2]) / 2;
    const r1 = Math.max(0.9, ra * S[i + 3]), r2 = Math.max(0.9, rb * S[j + 3]);
    const ends = [S[i], S[i + 1], r1, S[j], S[j + 1], r2];
    parts.push({ depth: depth - order, draw: () => paint(side, depth, r1, () => limbPath(ctx, ...ends),
      (fill) => ramp(ctx, fill, ends[0], ends[1], ends[3], ends[4], Math.max(r1, r2))) });
  }
  for (const [points, radii] of clip.hulls) {
    const circles = points.map((p, n) => [S[4 * p], S[4 * p + 1], radii[n] * S[4 * p + 3]]);
    // Pushed back a little: an arm at the side lies before the chest.
    const depth = points.reduce((sum, p) => sum + S[4 * p + 2], 0) / points.length + 0.03 * clip.size;
    const xs = circles.map((c) => c[0]), r = 0.5 * (Math.max(...xs) - Math.min(...xs)) + circles[0][2];
    const x = 0.5 * (Math.max(...xs) + Math.min(...xs)), y = circles[0][1];
    parts.push({ depth: depth - order, draw: () => paint("m", depth, 9, () => hullPath(ctx, circles),
      (fill) => ramp(ctx, fill, x, y, x, y, r)) });
  }
  for (const [p, radius, part] of clip.balls) {
    const [x, y, depth, s] = S.subarray(4 * p, 4 * p + 4);
    parts.push({ depth: depth - order, draw: () => paint(part === "nose" ? "r" : "m", depth, 9, () => {
      ctx.beginPath();
      ctx.arc(x, y, radius * s, 0, 2 * Math.PI);
    }, (fill) => ball(ctx, fill, x, y, radius * s)) });
  }
  return parts;
}

function ball(ctx, fill, x, y, r) {
  const gradient = ctx.createRadialGradient(x - 0.35 * r, y - 0.45 * r, 0.1 * r, x, y, r);
  gradient.addColorStop(0, css(mix(fill, [255, 255, 255], 0.34)));
  gradient.addColorStop(0.55, css(fill));
  gradient.addColorStop(1, css(mix(fill, [6, 10, 20], 0.24)));
  return gradient;
}

// How many frames before and after this one a path is drawn.
function trailReach(clip) {
  return clip.frames > 700 ? Math.round(2 / clip.frameTime) : clip.frames;
}

// The path of a point: what has been in full, what comes thin; long clips show four seconds.
function drawTrail(ctx, eye, clip, point, at) {
  const reach = trailReach(clip);
  const from = Math.max(clip.first, Math.floor(at) - reach), to = Math.min(clip.frames - 1, Math.ceil(at) + reach);
  const out = [0, 0, 0, 0], now = Math.floor(at);
  const P = clip.positions, width = 3 * clip.points;
  const line = (a, b, alpha, thickness, tip) => {
    ctx.beginPath();
    let begun = false;
    for (let f = a; f <= b; f++) {
      const i = f * width + 3 * point;
      if (!eye.project(P[i], P[i + 1], P[i + 2], out)) { begun = false; continue; }
      if (begun) ctx.lineTo(out[0], out[1]); else ctx.moveTo(out[0], out[1]);
      begun = true;
    }
    const i = 3 * point;
    if (tip && eye.project(clip.pose[i], clip.pose[i + 1], clip.pose[i + 2], out)) ctx.lineTo(out[0], out[1]);
    ctx.globalAlpha = alpha;
    ctx.lineWidth = thickness;
    ctx.stroke();
  };
  ctx.strokeStyle = clip.colors.base;
  ctx.lineJoin = ctx.lineCap = "round";
  line(Math.max(from, now), to, 0.35, 1.2, false);
  line(from, now, 0.85, 2.2, true);
  ctx.globalAlpha = 1;
}
