// What an edit asked for, in the scene: goals at their places, the ways between them, gaps that are left.

const NEAR = 0.3; // seconds before and after an instant over which its goal lights up

function markColor(mark) {
  return mark.missed ? colors.miss : colors.goal;
}

// How much a mark is in force at a frame: 1 inside its points, less near them and while it eases, 0 outside.
function force(mark, at) {
  const f = Math.round(at);
  const gap = Math.min(Infinity, ...mark.spans.map(([, a, b]) => Math.max(0, a - at, at - b) * mark.clip.frameTime));
  const near = Math.max(0, 1 - gap / NEAR);
  if (f < mark.first || f > mark.last) return mark.instant ? near : 0;
  return mark.spans.length ? Math.max(0.35, near) : 1;
}

// The errors at a frame, [length, angle], null where there are none.
function errorsAt(mark, at) {
  const i = Math.round(at) - mark.first;
  return [mark.lengths, mark.angles].map((curve) => (curve && i in curve.values ? curve.values[i] : null));
}

function isMissedAt(mark, at) {
  return [mark.lengths, mark.angles].some((curve, k) => curve && curve.tolerance !== null && errorsAt(mark, at)[k] > curve.tolerance);
}

function chosenMarks() {
  if (!state.goals) return [];
  return state.chosen ? [state.chosen] : marks;
}

const TRAILS = 4; // more paths at once tell nothing

// The marks whose effectors' paths tell most: the chosen one, else those that ask for something else than the input.
function markPoints(clip) {
  const chosen = chosenMarks();
  const asking = state.chosen ? chosen : chosen.filter((mark) => mark.spans.length && mark.places);
  const list = (asking.length ? asking : chosen).slice(0, TRAILS);
  return [...new Set(list.flatMap((mark) => mark.points.filter(([c]) => c === clip.index).map(([, p]) => p)))];
}

function pointName(clip, point) {
  const mark = marks.find((m) => m.points.some(([c, p]) => c === clip.index && p === point));
  return clip.names[point] || (mark ? mark.name : "");
}

function placeAt(mark, at, out) {
  const i = Math.min(mark.last, Math.max(mark.first, at)) - mark.first;
  return mixFrames(mark.places, 3, i, out);
}

function effectorAt(mark, out) {
  const found = mark.points.find(([c]) => c === mark.clip.index);
  if (!found) return null;
  for (let a = 0; a < 3; a++) out[a] = mark.clip.pose[3 * found[1] + a];
  return out;
}

function drawGoals(ctx, eye, view) {
  const list = chosenMarks().filter((mark) => view.clips.some((clip) => mark.seenWith.has(clip.index) && clip.show !== "hidden"));
  const labels = [];
  ctx.lineJoin = ctx.lineCap = "round";
  for (const mark of list) if (mark.places && mark.spans.length && !mark.looks) drawWay(ctx, eye, mark);
  for (const mark of list) if (mark.places) drawStations(ctx, eye, mark);
  // The most important last, on top.
  for (const mark of [...list].reverse()) drawNow(ctx, eye, mark, view, labels);
  for (const [text, x, y, color] of labels.reverse()) placeLabel(ctx, view, text, x, y, color, labels);
  ctx.globalAlpha = 1;
}

// The way of the goal over the whole interval, dotted; of long clips as much as their trails show.
function drawWay(ctx, eye, mark) {
  const out = [0, 0, 0, 0];
  const now = Math.round(state.time / mark.clip.frameTime) - mark.first, reach = trailReach(mark.clip);
  const to = Math.min(mark.last - mark.first, now + reach);
  ctx.beginPath();
  let begun = false;
  for (let i = Math.max(0, now - reach); i <= to; i++) {
    if (!eye.project(mark.places[3 * i], mark.places[3 * i + 1], mark.places[3 * i + 2], out)) { begun = false; continue; }
    if (begun) ctx.lineTo(out[0], out[1]); else ctx.moveTo(out[0], out[1]);
    begun = true;
  }
  ctx.strokeStyle = markColor(mark);
  ctx.globalAlpha = state.chosen ? 0.9 : 0.45;
  ctx.lineWidth = 1.5;
  ctx.setLineDash([1, 5]);
  ctx.stroke();
  ctx.setLineDash([]);
}

// Where it stands still, or is for an instant: a diamond for each.
function drawStations(ctx, eye, mark) {
  const out = [0, 0, 0, 0], place = [0, 0, 0];
  for (const [mode, first] of mark.spans) {
    if (mode === "during") continue;
    placeAt(mark, first, place);
    if (!eye.project(place[0], place[1], place[2], out)) continue;
    const r = Math.min(9, Math.max(3.5, 0.028 * unitSize * out[3]));
    ctx.globalAlpha = 0.9;
    ctx.fillStyle = css(colors.paper);
    ctx.strokeStyle = markColor(mark);
    ctx.lineWidth = 1.6;
    diamond(ctx, out[0], out[1], r);
    ctx.fill();
    ctx.stroke();
  }
}

function diamond(ctx, x, y, r) {
  ctx.beginPath();
  ctx.moveTo(x, y - r);
  ctx.lineTo(x + r, y);
  ctx.lineTo(x, y + r);
  ctx.lineTo(x - r, y);
  ctx.closePath();
}

// The goal of this frame, the gap to its effector, and its name while it is in force.
function drawNow(ctx, eye, mark, view, labels) {
  const at = state.time / mark.clip.frameTime, strength = force(mark, at);
  const always = mark.instant;
  if (!strength && !always) return;
  const goal = [0, 0, 0, 0], tip = [0, 0, 0, 0], world = [0, 0, 0], hand = effectorAt(mark, [0, 0, 0]);
  const seen = hand && eye.project(hand[0], hand[1], hand[2], tip);
  if (mark.places) placeAt(mark, at, world);
  else if (hand) world.splice(0, 3, ...hand);
  else return;
  if (!eye.project(world[0], world[1], world[2], goal)) return;
  const missed = isMissedAt(mark, at), color = missed ? colors.miss : colors.goal;
  const weight = mark.spans.length || state.chosen ? 1 : 0.6;
  ctx.strokeStyle = color;
  if (mark.places && seen && (missed || mark.looks) && strength) {
    ctx.globalAlpha = mark.looks ? 0.5 : 0.95;
    ctx.lineWidth = missed ? 2.4 : 1.4;
    ctx.setLineDash(missed ? [6, 4] : [2, 5]);
    ctx.beginPath();
    ctx.moveTo(tip[0], tip[1]);
    ctx.lineTo(goal[0], goal[1]);
    ctx.stroke();
    ctx.setLineDash([]);
  }
  const r = weight * (0.75 + 0.25 * strength) * Math.min(20, Math.max(8, 0.06 * unitSize * goal[3]));
  ctx.globalAlpha = (always ? 0.55 : 0.2) + (always ? 0.45 : 0.75) * strength * weight;
  drawSymbol(ctx, mark.symbol, goal[0], goal[1], r, missed, color);
  // Names where something stands still or is for an instant; what rides along would be named all the time.
  const told = state.chosen || always || missed || mark.spans.some(([mode, a, b]) => mode !== "during"
    && Math.max(0, a - at, at - b) * mark.clip.frameTime < 0.5 * NEAR);
  if (told) {
    const [length, angle] = errorsAt(mark, at);
    const gap = missed ? `: ${[length !== null && amount(length), angle !== null && `${amount(angle)}\u00b0`].filter(Boolean).join(", ")} off` : "";
    labels.push([mark.name + gap, goal[0] + r + 5, goal[1], color]);
  }
}

// How places are marked. A ring with a cross: where a point is wanted; a quartered ball: the center of mass; an arc: how a
// joint is turned. Each is strokes, and what is filled over them.
const SYMBOLS = {
  ring: {
    strokes(ctx, x, y, r, missed) {
      arc(ctx, x, y, r, 0, 2 * Math.PI);
      for (const [dx, dy] of missed ? [[0.7, 0.7], [0.7, -0.7]] : [[1, 0], [0, 1]]) {
        for (const sign of [-1, 1]) {
          ctx.beginPath();
          ctx.moveTo(x + 0.45 * sign * r * dx, y + 0.45 * sign * r * dy);
          ctx.lineTo(x + 1.3 * sign * r * dx, y + 1.3 * sign * r * dy);
          ctx.stroke();
        }
      }
    },
    fill() {},
  },
  ball: {
    strokes(ctx, x, y, r) {
      arc(ctx, x, y, r, 0, 2 * Math.PI);
    },
    fill(ctx, x, y, r) {
      for (const start of [0, Math.PI]) {
        ctx.beginPath();
        ctx.moveTo(x, y);
        ctx.arc(x, y, r, start, start + Math.PI / 2);
        ctx.fill();
      }
    },
  },
  arc: {
    strokes(ctx, x, y, r) {
      arc(ctx, x, y, r, 0.75 * Math.PI, 1.75 * Math.PI);
      arc(ctx, x, y, 0.55 * r, 0.75 * Math.PI, 1.75 * Math.PI);
    },
    fill() {},
  },
};

function arc(ctx, x, y, radius, from, to) {
  ctx.beginPath();
  ctx.arc(x, y, radius, from, to);
  ctx.stroke();
}

function drawSymbol(ctx, name, x, y, r, missed, color) {
  const symbol = SYMBOLS[name];
  // A halo of the paper under it, so that it is seen on any limb.
  ctx.strokeStyle = css(colors.paper);
  ctx.lineWidth = 4.5;
  symbol.strokes(ctx, x, y, r, missed);
  ctx.strokeStyle = ctx.fillStyle = color;
  ctx.lineWidth = 2;
  symbol.strokes(ctx, x, y, r, missed);
  symbol.fill(ctx, x, y, r);
}

// A name beside its goal, moved down until it stands free of those before it.
function placeLabel(ctx, view, text, x, y, color, labels) {
  ctx.font = "600 12px system-ui, sans-serif";
  const width = ctx.measureText(text).width;
  const left = Math.max(view.x + 4, Math.min(x, view.x + view.width - width - 6));
  labels.placed = labels.placed || [];
  let top = y - 8;
  for (let tries = 0; tries < 12; tries++) {
    const hit = labels.placed.find(([l, t, w]) => left < l + w && l < left + width && Math.abs(top - t) < 15);
    if (!hit) break;
    top = hit[1] + 15;
  }
  labels.placed.push([left, top, width]);
  ctx.globalAlpha = 1;
  ctx.textAlign = "left";
  ctx.textBaseline = "top";
  ctx.lineWidth = 4;
  ctx.strokeStyle = css(colors.paper);
  ctx.strokeText(text, left, top);
  ctx.fillStyle = color;
  ctx.fillText(text, left, top);
}

// Four digits, as the table on the terminal has them.
function amount(value) {
  if (value === 0 || value >= 1e-3) return String(Number(value.toPrecision(value >= 1000 ? Math.ceil(Math.log10(value)) : 3)));
  return value.toExponential(0).replace("-", "\u2212");
}
