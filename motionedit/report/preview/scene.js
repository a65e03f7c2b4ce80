// One picture: the floor, shadows, trails and bodies of every view.

const canvas = document.getElementById("scene");
const state = { time: 0, playing: false, speed: 1, loop: true, apart: false, trail: "auto", goals: marks.length > 0, chosen: null };

function shown() {
  return clips.filter((clip) => clip.show !== "hidden");
}

// Overlaid: one view of all; side by side: one for each clip, in the grid that leaves them largest.
function viewsOf(width, height) {
  const list = shown();
  if (!state.apart || list.length < 2) return [{ x: 0, y: 0, width, height, clips: list.length ? list : clips }];
  const size = (n) => Math.min(width / n, (1.25 * height) / Math.ceil(list.length / n));
  const columns = list.map((_, i) => i + 1).reduce((best, n) => (size(n) > size(best) ? n : best));
  const rows = Math.ceil(list.length / columns);
  return list.map((clip, i) => ({
    x: ((i % columns) * width) / columns, y: (Math.floor(i / columns) * height) / rows,
    width: width / columns, height: height / rows, clips: [clip],
  }));
}

function views() {
  return viewsOf(canvas.clientWidth, canvas.clientHeight);
}

function trailPoints(clip) {
  if (state.trail === "auto") {
    const points = markPoints(clip);
    return points.length ? points : clip.trails;
  }
  const point = clip.names.indexOf(state.trail);
  return point < 0 || state.trail === "" ? [] : [point];
}

// A canvas sized in device pixels, drawn in CSS pixels.
function prepare(element) {
  const ratio = devicePixelRatio || 1;
  const width = element.clientWidth, height = element.clientHeight;
  if (element.width !== Math.round(width * ratio) || element.height !== Math.round(height * ratio)) {
    element.width = Math.round(width * ratio);
    element.height = Math.round(height * ratio);
  }
  const ctx = element.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  return ctx;
}

function drawScene() {
  const ctx = prepare(canvas);
  for (const clip of clips) mixFrames(clip.positions, 3 * clip.points, frameAt(clip, state.time), clip.pose);
  const list = views();
  for (const view of list) drawView(ctx, view, list.length > 1);
}

function drawView(ctx, view, named) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(view.x, view.y, view.width, view.height);
  ctx.clip();
  const sky = ctx.createLinearGradient(0, view.y, 0, view.y + view.height);
  sky.addColorStop(0, colors.sky);
  sky.addColorStop(0.7, css(colors.paper));
  ctx.fillStyle = sky;
  ctx.fillRect(view.x, view.y, view.width, view.height);
  const eye = lens(view, state.time);
  const grid = gridOf(view.clips);
  drawGrid(ctx, eye, grid, colors);
  labelGrid(ctx, eye, view, grid, colors);
  const list = view.clips.filter((clip) => clip.show !== "hidden");
  for (const clip of list) drawShadow(ctx, eye, clip, clip.colors.shadow);
  for (const clip of list) {
    for (const point of trailPoints(clip)) {
      drawTrail(ctx, eye, clip, point, frameAt(clip, state.time));
      drawPlumb(ctx, eye, clip, point, clip.colors.base);
    }
  }
  for (const clip of list) if (clip.show === "ghost") drawGhost(ctx, eye, clip);
  const parts = list.filter((clip) => clip.show === "solid").flatMap((clip) => figureParts(ctx, clip, eye));
  parts.sort((a, b) => b.depth - a.depth).forEach((part) => part.draw());
  drawGoals(ctx, eye, view);
  if (named) {
    ctx.font = "600 13px system-ui, sans-serif";
    ctx.textAlign = "left";
    ctx.textBaseline = "top";
    ctx.fillStyle = view.clips[0].colors.base;
    ctx.fillText(view.clips[0].label, view.x + 12, view.y + 10);
    ctx.strokeStyle = colors.line;
    ctx.lineWidth = 1;
    ctx.strokeRect(view.x - 0.5, view.y - 0.5, view.width, view.height);
  }
  ctx.restore();
}

// A ghost is drawn as a whole and laid on thinly, so that its own limbs do not shine through each other.
function drawGhost(ctx, eye, clip) {
  const layer = drawGhost.layer || (drawGhost.layer = document.createElement("canvas"));
  layer.width = canvas.width;
  layer.height = canvas.height;
  const own = layer.getContext("2d");
  own.setTransform(ctx.getTransform());
  figureParts(own, clip, eye).sort((a, b) => b.depth - a.depth).forEach((part) => part.draw());
  ctx.save();
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.globalAlpha = 0.3;
  ctx.drawImage(layer, 0, 0);
  ctx.restore();
}
