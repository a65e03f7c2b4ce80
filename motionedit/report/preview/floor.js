// The floor: a grid in the file's units with labels, shadows of the bodies, and plumb lines.

function niceStep(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [1, 2, 5, 10].map((n) => n * power).find((step) => step >= 0.99 * length);
}

function gridOf(list) {
  const low = [0, 2].map((a) => Math.min(...list.map((c) => c.low[a])));
  const high = [0, 2].map((a) => Math.max(...list.map((c) => c.high[a])));
  const span = Math.max(high[0] - low[0], high[1] - low[1]);
  const step = niceStep(Math.max((0.5 * unitSize) / reference.scale, span / reference.scale / 24)) * reference.scale;
  const edge = (v, a, round) => step * round(v / step);
  return {
    step,
    low: low.map((v, a) => edge(v - 0.3 * step, a, Math.floor)),
    high: high.map((v, a) => edge(v + 0.3 * step, a, Math.ceil)),
  };
}

function drawGrid(ctx, eye, grid, colors) {
  const { step, low, high } = grid;
  const margin = 3;
  const a = [0, 0, 0, 0], b = [0, 0, 0, 0];
  const buckets = [new Path2D(), new Path2D(), new Path2D(), new Path2D()];
  const strong = new Path2D();
  // How many steps outside the clips' own ground: lines fade there, one bucket a step.
  const outside = (v, k) => Math.max(0, Math.round((low[k] - v) / step), Math.round((v - high[k]) / step));
  const cells = (k, line) => {
    const m = 1 - k;
    for (let v = low[m] - margin * step; v < high[m] + (margin - 0.5) * step; v += step) {
      const p = k ? [v, line] : [line, v], q = k ? [v + step, line] : [line, v + step];
      if (!eye.project(p[0], floorHeight, p[1], a) || !eye.project(q[0], floorHeight, q[1], b)) continue;
      const far = Math.max(outside(line, k), outside(v, m), outside(v + step, m));
      if (far > margin) continue;
      const path = far === 0 && Math.abs(line) < 1e-3 * step ? strong : buckets[far];
      path.moveTo(a[0], a[1]);
      path.lineTo(b[0], b[1]);
    }
  };
  for (const k of [0, 1]) {
    for (let v = low[k] - margin * step; v < high[k] + (margin + 0.5) * step; v += step) cells(k, v);
  }
  ctx.lineWidth = 1;
  ctx.strokeStyle = colors.grid;
  buckets.forEach((path, i) => {
    ctx.globalAlpha = [0.55, 0.36, 0.2, 0.09][i];
    ctx.stroke(path);
  });
  ctx.globalAlpha = 0.95;
  ctx.stroke(strong);
  ctx.globalAlpha = 1;
}

// Numbers of the file's own axes along two edges of the clips' ground: the near ones, or the far ones where those
// show more of them.
function labelGrid(ctx, eye, view, grid, colors) {
  const { step, low, high } = grid;
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.fillStyle = colors.quiet;
  for (const k of [0, 1]) {
    const m = 1 - k;
    const edges = [low[m] - 0.4 * step, high[m] + 0.4 * step];
    if (eye.back[2 * m] > 0) edges.reverse();
    const rows = edges.map((edge) => labelRow(eye, view, grid, k, edge));
    const row = rows[0].length > 2 || rows[0].length >= rows[1].length ? rows[0] : rows[1];
    for (const [text, x, y] of row) {
      const name = text.length === 1 && text > "9";
      ctx.font = name ? "italic 600 14px system-ui, sans-serif" : "11px system-ui, sans-serif";
      ctx.fillText(text, x, y);
    }
  }
}

// [text, x, y] of the labels that fall into the view; the axis' letter stands at its larger end.
function labelRow(eye, view, { step, low, high }, k, edge) {
  const at = [0, 0, 0, 0], next = [0, 0, 0, 0], row = [];
  const axis = reference.axes[2 * k], sign = axis[0] === "-" ? -1 : 1;
  const place = (v, out) => eye.project(k ? edge : v, floorHeight, k ? v : edge, out);
  const inside = () => at[0] > view.x + 14 && at[0] < view.x + view.width - 14
    && at[1] > view.y + 14 && at[1] < view.y + view.height - 10
    // The note on the scale stands in the lower left corner.
    && (view.x > 0 || at[0] > 340 || at[1] < view.y + view.height - 44);
  for (let v = low[k]; v < high[k] + 0.5 * step; v += step) {
    const count = Math.round(v / step);
    if (!place(v, at) || !place(v + step, next)) continue;
    const gap = Math.hypot(next[0] - at[0], next[1] - at[1]);
    const every = [1, 2, 5, 10, 20].find((n) => n * gap > 40) || 50;
    if (count % every === 0 && inside()) row.push([short((sign * count * step) / reference.scale), at[0], at[1]]);
  }
  if (row.length && place(sign > 0 ? high[k] + 0.6 * step : low[k] - 0.6 * step, at) && inside()) {
    row.push([axis.slice(-1), at[0], at[1]]);
  }
  return row;
}

function short(value) {
  return String(Number(value.toPrecision(6))).replace("-", "\u2212");
}

const ROUND = Array.from({ length: 7 }, (_, i) => [Math.cos((i * Math.PI) / 6), Math.sin((i * Math.PI) / 6)]);

// A limb's outline on the floor, straight below it, always the same way round: their union fills evenly.
function addShadow(path, eye, ax, az, bx, bz, ra, rb) {
  const out = [0, 0, 0, 0];
  let dx = bx - ax, dz = bz - az;
  const length = Math.hypot(dx, dz);
  if (length < 1e-9) [dx, dz] = [1, 0]; else { dx /= length; dz /= length; }
  let begun = false;
  const to = (x, z) => {
    if (!eye.project(x, floorHeight, z, out)) return false;
    if (begun) path.lineTo(out[0], out[1]); else path.moveTo(out[0], out[1]);
    return (begun = true);
  };
  for (const [c, s] of ROUND) if (!to(bx + rb * (s * dx - c * dz), bz + rb * (s * dz + c * dx))) return;
  for (const [c, s] of ROUND) if (!to(ax - ra * (s * dx - c * dz), az - ra * (s * dz + c * dx))) return;
  path.closePath();
}

function drawShadow(ctx, eye, clip, color) {
  const P = clip.pose;
  const low = 0.14 * clip.size;
  // Wider and fainter outlines make a soft edge; what is near the floor is darker.
  for (const [spread, contact, alpha] of [[2.4, false, 0.05], [1.7, false, 0.06], [1, false, 0.09], [1.3, true, 0.14]]) {
    const path = new Path2D();
    for (const [start, end, ra, rb] of clip.limbs) {
      const i = 3 * start, j = 3 * end;
      if (contact && Math.min(P[i + 1], P[j + 1]) - floorHeight > low) continue;
      addShadow(path, eye, P[i], P[i + 2], P[j], P[j + 2], spread * ra, spread * rb);
    }
    if (!contact) {
      for (const [p, r, part] of clip.balls) {
        if (part === "head") addShadow(path, eye, P[3 * p], P[3 * p + 2], P[3 * p], P[3 * p + 2], spread * r, spread * r);
      }
    }
    ctx.globalAlpha = (colors.dark ? 2.2 : 1) * alpha;
    ctx.fillStyle = color;
    ctx.fill(path);
  }
  ctx.globalAlpha = 1;
}

function drawPlumb(ctx, eye, clip, point, color) {
  const P = clip.pose, i = 3 * point;
  const a = [0, 0, 0, 0], b = [0, 0, 0, 0];
  if (!eye.project(P[i], P[i + 1], P[i + 2], a) || !eye.project(P[i], floorHeight, P[i + 2], b)) return;
  ctx.strokeStyle = color;
  ctx.globalAlpha = 0.6;
  ctx.lineWidth = 1;
  ctx.setLineDash([3, 3]);
  ctx.beginPath();
  ctx.moveTo(a[0], a[1]);
  ctx.lineTo(b[0], b[1]);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.ellipse(b[0], b[1], 4, 4 * Math.max(0.25, Math.abs(eye.back[1])), 0, 0, 2 * Math.PI);
  ctx.stroke();
  ctx.globalAlpha = 1;
}
