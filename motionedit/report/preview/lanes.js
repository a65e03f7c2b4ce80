// The lanes under the time line: a bar for each goal or constraint, the most important on top, and its errors.

const BAR = 8; // its height in pixels

function buildLanes() {
  const list = byId("lanes");
  byId("goals").hidden = !marks.length;
  document.body.classList.toggle("edited", edits.length > 0);
  for (const edit of edits) {
    const head = document.createElement("li");
    head.className = `head ${edit.missed ? "missed" : "met"}`;
    head.innerHTML = "<span class='status'></span><span class='told'></span><span class='units'>error now, worst</span>";
    head.querySelector(".status").textContent = edits.length > 1 ? `${clips[edit.clip].label}: ${statusText(edit)}` : statusText(edit);
    head.querySelector(".told").textContent = edit.message;
    head.querySelector(".told").title = edit.message;
    if (edit.unit) head.querySelector(".units").textContent += ` (${edit.unit})`;
    list.append(head);
    for (const mark of edit.marks) list.append(laneOf(mark));
  }
}

function statusText(edit) {
  const words = { ok: "all goals met", far: "met, far from the database", rough: "met, but seen" };
  return edit.marks.length ? words[edit.status] || edit.status.replaceAll("_", " ") : "no constraints";
}

function laneOf(mark) {
  const item = document.createElement("li"), button = document.createElement("button");
  const canvas = document.createElement("canvas"), value = document.createElement("output");
  item.className = mark.missed ? "missed" : "met";
  button.innerHTML = "<span class='priority'></span><span class='name'></span>";
  button.querySelector(".priority").textContent = mark.priority;
  button.querySelector(".name").textContent = mark.name;
  button.title = laneTitle(mark);
  button.setAttribute("aria-pressed", "false");
  button.addEventListener("click", () => choose(state.chosen === mark ? null : mark));
  canvas.setAttribute("aria-hidden", "true");
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    seekOn(canvas, e);
  });
  canvas.addEventListener("pointermove", (e) => { if (e.buttons) seekOn(canvas, e); });
  Object.assign(mark, { item, button, canvas, value });
  item.append(button, canvas, value);
  return item;
}

function laneTitle(mark) {
  const when = mark.first === mark.last ? `frame ${mark.first}` : `frames ${mark.first} to ${mark.last}`;
  const gave = mark.gaveWayTo.length ? `; gave way to ${mark.gaveWayTo.join(", ")}` : "";
  return `${mark.kind} ${mark.name}, priority ${mark.priority}, ${when}: ${mark.status.replaceAll("_", " ")}${gave}`;
}

function seekOn(element, e) {
  play(false);
  const box = element.getBoundingClientRect();
  setFrame(Math.round(timeAt(e.clientX - box.left, box.width) / reference.frameTime));
}

// One mark by itself, with its errors enlarged; null: all of them.
function choose(mark) {
  state.chosen = mark;
  for (const each of marks) {
    each.button.setAttribute("aria-pressed", each === mark);
    each.item.classList.toggle("chosen", each === mark);
  }
  redraw();
}

function chooseNext(by) {
  const i = marks.indexOf(state.chosen);
  const next = i < 0 ? (by > 0 ? 0 : marks.length - 1) : i + by;
  choose(marks[next] || null);
  if (state.chosen) state.chosen.item.scrollIntoView({ block: "nearest" });
}

function setGoals(on) {
  state.goals = on && marks.length > 0;
  byId("goals").setAttribute("aria-pressed", state.goals);
  document.body.classList.toggle("edited", state.goals);
  redraw();
}

// To the next frame at which a goal begins, or the one before.
function toGoal(by) {
  const now = frameNow();
  const list = state.chosen ? [state.chosen] : marks;
  const starts = list.flatMap((mark) => (mark.spans.length ? mark.spans.map(([, a]) => a) : [mark.first])
    .map((f) => Math.round((f * mark.clip.frameTime) / reference.frameTime)));
  const frames = [...new Set(starts)].sort((a, b) => a - b);
  const found = by > 0 ? frames.find((f) => f > now) : frames.reverse().find((f) => f < now);
  play(false);
  if (found !== undefined) setFrame(found);
}

function drawLanes() {
  if (!state.goals) return;
  for (const mark of marks) {
    drawLane(mark);
    const now = errorsAt(mark, state.time / mark.clip.frameTime);
    const text = [mark.lengths, mark.angles].map((curve, k) => {
      if (!curve) return "";
      const degree = k ? "\u00b0" : "";
      return `${now[k] === null || Number.isNaN(now[k]) ? "\u2013" : amount(now[k]) + degree}, ${amount(curve.max)}${degree}`;
    });
    mark.value.textContent = text.filter(Boolean).join("\n");
    mark.value.classList.toggle("off", isMissedAt(mark, state.time / mark.clip.frameTime));
  }
}

function drawLane(mark) {
  const ctx = prepare(mark.canvas), width = mark.canvas.clientWidth, height = mark.canvas.clientHeight;
  // All but the head of time is drawn once for a size and a colour scheme.
  const look = [mark.canvas.width, mark.canvas.height, colors.dark, state.chosen === mark].join();
  if (mark.look !== look) {
    mark.look = look;
    mark.layer = mark.layer || document.createElement("canvas");
    mark.layer.width = mark.canvas.width;
    mark.layer.height = mark.canvas.height;
    const own = mark.layer.getContext("2d");
    own.setTransform(ctx.getTransform());
    drawStill(own, mark, width, height);
  }
  ctx.save();
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  if (mark.layer.width && mark.layer.height) ctx.drawImage(mark.layer, 0, 0);
  ctx.restore();
  ctx.globalAlpha = 0.8;
  ctx.fillStyle = colors.ink;
  ctx.fillRect(Math.round(timeX(state.time, width)) - 0.5, 0, 1, height);
  ctx.globalAlpha = 1;
}

function drawStill(ctx, mark, width, height) {
  const dt = mark.clip.frameTime, x = (frame) => timeX(frame * dt, width);
  const color = markColor(mark), base = height - BAR - 5;
  ctx.fillStyle = colors.line;
  ctx.fillRect(0, height - 1, width, 1);
  drawBar(ctx, mark, x, height, color);
  [mark.lengths, mark.angles].forEach((curve, k) => { if (curve) drawCurve(ctx, mark, curve, k, x, base); });
}

// Thin where it eases in and out; solid where it stands still, striped where it rides, a diamond for an instant.
function drawBar(ctx, mark, x, height, color) {
  const y = height - BAR - 3, middle = y + BAR / 2;
  const left = x(mark.first), right = Math.max(x(mark.last), left + 1);
  ctx.fillStyle = ctx.strokeStyle = color;
  ctx.globalAlpha = 0.5;
  ctx.fillRect(left, middle - 1, right - left, 2);
  ctx.globalAlpha = 1;
  const spans = mark.spans.length ? mark.spans : [["during", mark.first, mark.last]];
  for (const [mode, first, last] of spans) {
    const a = x(first), b = x(last);
    if (mode === "at" || b - a < 3) {
      diamond(ctx, (a + b) / 2, middle, BAR / 2 + 1);
      ctx.fill();
    } else if (mode === "hold") {
      ctx.fillRect(a, y, b - a, BAR);
    } else {
      stripes(ctx, a, b, y, color);
    }
  }
}

function stripes(ctx, a, b, y, color) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(a, y, b - a, BAR);
  ctx.clip();
  ctx.globalAlpha = 0.16;
  ctx.fillRect(a, y, b - a, BAR);
  ctx.globalAlpha = 0.85;
  ctx.strokeStyle = color;
  ctx.lineWidth = 1.2;
  ctx.beginPath();
  for (let at = a - BAR; at < b; at += 6) {
    ctx.moveTo(at, y + BAR);
    ctx.lineTo(at + BAR, y);
  }
  ctx.stroke();
  ctx.restore();
}

// The error over the interval, against its tolerance (dashed); angles are dashed lines of their own scale.
function drawCurve(ctx, mark, curve, k, x, base) {
  const chosen = state.chosen === mark, room = base - 3 - (chosen ? 10 : 0);
  const top = Math.max(curve.max, 1.3 * (curve.tolerance || 0), k ? 1e-3 : (1e-5 * unitSize) / reference.scale);
  const y = (value) => base - (room * value) / top;
  const missedFrom = curve.tolerance === null ? Infinity : curve.tolerance;
  if (curve.tolerance !== null && !(k && mark.lengths)) {
    ctx.strokeStyle = colors.quiet;
    ctx.globalAlpha = 0.7;
    ctx.lineWidth = 1;
    ctx.setLineDash([3, 3]);
    ctx.beginPath();
    ctx.moveTo(x(mark.first) - 4, y(curve.tolerance));
    ctx.lineTo(x(mark.last) + 4, y(curve.tolerance));
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }
  const values = curve.values, dashes = k && mark.lengths ? [4, 3] : [];
  if (values.length === 1) {
    stem(ctx, x(mark.first) + 4 * k, y(values[0]), base, values[0] > missedFrom ? colors.miss : colors.goal);
  } else {
    ctx.lineWidth = chosen ? 2 : 1.5;
    ctx.setLineDash(dashes);
    for (const [color, wanted] of [[colors.quiet, false], [colors.miss, true]]) {
      ctx.strokeStyle = ctx.fillStyle = color;
      ctx.beginPath();
      for (let i = 1; i < values.length; i++) {
        if (Math.max(values[i - 1], values[i]) > missedFrom !== wanted) continue;
        ctx.moveTo(x(mark.first + i - 1), y(values[i - 1]));
        ctx.lineTo(x(mark.first + i), y(values[i]));
      }
      ctx.stroke();
    }
    ctx.setLineDash([]);
  }
  if (chosen && !(k && mark.lengths)) labelCurve(ctx, mark, curve, k ? "\u00b0" : "", x, y, top);
}

function stem(ctx, x, y, base, color) {
  ctx.strokeStyle = ctx.fillStyle = color;
  ctx.lineWidth = 2;
  ctx.beginPath();
  ctx.moveTo(x, base);
  ctx.lineTo(x, y);
  ctx.stroke();
  ctx.beginPath();
  ctx.arc(x, y, 3, 0, 2 * Math.PI);
  ctx.fill();
}

function labelCurve(ctx, mark, curve, unit, x, y, top) {
  ctx.font = "11px system-ui, sans-serif";
  ctx.fillStyle = colors.quiet;
  ctx.textBaseline = "bottom";
  ctx.textAlign = "left";
  const left = Math.max(2, x(mark.first) + 2);
  ctx.fillText(`${amount(top)}${unit}`, left, y(top));
  if (curve.tolerance !== null && curve.tolerance < 0.8 * top) ctx.fillText(`tolerance ${amount(curve.tolerance)}${unit}`, left, y(curve.tolerance));
}
