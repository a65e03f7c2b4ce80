// The camera: an orbit round a target, presets, and the perspective of one viewport.

const FOCAL = 2.0; // focal length in viewport heights: a long lens, so that limbs keep their proportions
const QUARTER = Math.PI / 2;
const heading = Math.atan2(reference.forward[0], reference.forward[2]);
const ANGLES = {
  fit: [heading - 0.65, 0.2], front: [heading, 0.1], side: [heading - QUARTER, 0.1],
  top: [heading + Math.PI, QUARTER - 1e-3], follow: [heading - 0.65, 0.2],
};
const calm = matchMedia("(prefers-reduced-motion: reduce)");

// `now` moves towards `goal`; both hold azimuth, elevation, distance and the pan from the base target.
const camera = {
  now: { az: 0, el: 0, dist: 1, x: 0, y: 0, z: 0 }, goal: { az: 0, el: 0, dist: 1, x: 0, y: 0, z: 0 },
  follow: false, preset: "fit",
};

function center(list) {
  return [0, 1, 2].map((a) =>
    0.5 * (Math.min(...list.map((c) => c.low[a])) + Math.max(...list.map((c) => c.high[a]))));
}

// Where a view of these clips looks, before panning.
function baseTarget(list, time) {
  if (!camera.follow) return center(list);
  // The middle of all: an edited clip may go another way than its input.
  const ways = list.map((clip) => mixFrames(clip.centers, 3, frameAt(clip, time), [0, 0, 0]));
  return [0, 1, 2].map((a) => ways.reduce((sum, way) => sum + way[a], 0) / ways.length);
}

function axesOf(az, el) {
  const ca = Math.cos(az), sa = Math.sin(az), ce = Math.cos(el), se = Math.sin(el);
  return { right: [ca, 0, -sa], up: [-sa * se, ce, -ca * se], back: [sa * ce, se, ca * ce] };
}

// The distance from which every frame of the clips fits into a viewport of that shape.
function fitDistance(list, az, el, width, height) {
  const { right, up, back } = axesOf(az, el);
  const tanX = (0.44 * width) / (FOCAL * height), tanY = 0.42 / FOCAL;
  let dist = 0;
  const take = (point, t) => {
    const d = [0, 1, 2].map((a) => point[a] - t[a]);
    const x = Math.abs(dot(right, d)), y = Math.abs(dot(up, d)), z = dot(back, d);
    dist = Math.max(dist, z + x / tanX, z + y / tanY);
  };
  const still = center(list);
  for (const clip of list) {
    const stride = Math.max(1, Math.floor(clip.frames / 200));
    for (let f = clip.first; f < clip.frames; f += stride) {
      const t = camera.follow ? baseTarget(list, f * clip.frameTime) : still;
      for (let p = 0; p < clip.points; p++) {
        const i = 3 * (f * clip.points + p);
        take(clip.positions.subarray(i, i + 3), t);
      }
    }
    if (!camera.follow) for (const goal of clip.goals) take(goal, still);
  }
  return dist + 0.1 * unitSize;
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function look(preset, views, snap) {
  const [az, el] = ANGLES[preset];
  camera.preset = preset;
  camera.follow = preset === "follow";
  // The short way round.
  const turn = az - camera.now.az;
  const near = camera.now.az + Math.atan2(Math.sin(turn), Math.cos(turn));
  const dist = Math.max(...views.map((v) => fitDistance(v.clips, az, el, v.width, v.height)));
  Object.assign(camera.goal, { az: near, el, dist, x: 0, y: 0, z: 0 });
  if (snap || calm.matches) Object.assign(camera.now, camera.goal);
}

function orbit(dAz, dEl) {
  const g = camera.goal;
  g.az += dAz;
  g.el = Math.min(QUARTER - 1e-3, Math.max(-0.35, g.el + dEl));
  camera.preset = "";
  settle();
}

function zoom(factor) {
  camera.goal.dist = Math.min(400 * unitSize, Math.max(0.5 * unitSize, camera.goal.dist * factor));
  settle();
}

// Moves the target by pixels of a viewport.
function pan(dx, dy, height) {
  const { right, up } = axesOf(camera.goal.az, camera.goal.el);
  const k = camera.goal.dist / (FOCAL * height);
  "xyz".split("").forEach((name, a) => { camera.goal[name] += k * (-dx * right[a] + dy * up[a]); });
  settle();
}

// What the hand moves must not lag behind it.
function settle() {
  Object.assign(camera.now, camera.goal);
}

// One step of the way to the goal; true while still moving.
function glide(seconds) {
  const k = 1 - Math.exp(-12 * seconds);
  let moving = false;
  for (const name of Object.keys(camera.goal)) {
    const gap = camera.goal[name] - camera.now[name];
    const small = Math.abs(gap) < 1e-3 * (name === "az" || name === "el" ? 1 : unitSize);
    camera.now[name] = small ? camera.goal[name] : camera.now[name] + k * gap;
    moving = moving || !small;
  }
  return moving;
}

// A projection: world point (x, y, z) to out[0..3] = screen x, screen y, depth, pixels per unit. False: too near.
function lens(view, time) {
  const { az, el, dist, x, y, z } = camera.now;
  const { right, up, back } = axesOf(az, el);
  const base = baseTarget(view.clips, time);
  const tx = base[0] + x, ty = base[1] + y, tz = base[2] + z;
  const cx = view.x + view.width / 2, cy = view.y + view.height / 2, f = FOCAL * view.height;
  const near = 0.08 * unitSize;
  const project = (px, py, pz, out) => {
    const dx = px - tx, dy = py - ty, dz = pz - tz;
    const depth = dist - (back[0] * dx + back[1] * dy + back[2] * dz);
    if (depth < near) return false;
    const s = f / depth;
    out[0] = cx + s * (right[0] * dx + right[1] * dy + right[2] * dz);
    out[1] = cy - s * (up[0] * dx + up[1] * dy + up[2] * dz);
    out[2] = depth;
    out[3] = s;
    return true;
  };
  return { project, back, target: [tx, ty, tz], dist };
}
