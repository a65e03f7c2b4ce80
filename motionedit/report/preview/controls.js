// What the viewer touches: time line, buttons, legend, pointer, keys, and the state in the address.

const byId = (id) => document.getElementById(id);
const scrub = byId("scrub");
const SPEEDS = [0.1, 0.25, 0.5, 1, 2];
const SHOWS = ["solid", "ghost", "hidden"];
let dirty = true;

function redraw() {
  dirty = true;
}

function frameNow() {
  return Math.round(state.time / reference.frameTime);
}

function setFrame(frame) {
  state.time = Math.min(lastFrame, Math.max(0, frame)) * reference.frameTime;
  redraw();
}

function step(count) {
  play(false);
  setFrame(frameNow() + count);
}

function play(on) {
  // From the end, play starts again, after the rest pose.
  if (on && frameNow() >= lastFrame) state.time = startTime;
  if (!on) setFrame(frameNow());
  state.playing = on && lastFrame > 0;
  document.body.classList.toggle("playing", state.playing);
  byId("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  redraw();
}

const startTime = Math.min(duration, Math.max(...clips.map((clip) => clip.first * clip.frameTime)));

function setSpeed(speed) {
  state.speed = speed;
  byId("speed").value = String(speed);
}

function changeSpeed(by) {
  setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(state.speed) + by))]);
}

function setLoop(on) {
  state.loop = on;
  byId("loop").setAttribute("aria-pressed", on);
}

function setView(preset, snap) {
  look(preset, views(), snap);
  byId("follow").setAttribute("aria-pressed", camera.follow);
  redraw();
}

function setApart(on) {
  state.apart = on && clips.length > 1;
  byId("layout").setAttribute("aria-pressed", state.apart);
  setView(camera.preset || "fit", true);
}

function setTrail(name) {
  state.trail = name;
  byId("trail").value = name;
  redraw();
}

function setShow(clip, show) {
  clip.show = show;
  clip.button.dataset.show = show;
  clip.button.setAttribute("aria-label", `${clip.label}: ${show}`);
  clip.button.title = `${show}; press for ${SHOWS[(SHOWS.indexOf(show) + 1) % 3]}`;
  if (state.apart) setView(camera.preset || "fit", true);
  redraw();
}

function buildLegend() {
  byId("legend").classList.toggle("many", clips.length > 4);
  for (const clip of clips) {
    const item = document.createElement("li"), button = document.createElement("button");
    button.innerHTML = '<span class="swatch"></span><span><span class="name"></span><div class="where"></div></span>';
    button.querySelector(".name").textContent = clip.label;
    clip.button = button;
    clip.where = button.querySelector(".where");
    button.addEventListener("click", () => setShow(clip, SHOWS[(SHOWS.indexOf(clip.show) + 1) % 3]));
    item.append(button);
    byId("legend").append(item);
    setShow(clip, clip.show);
  }
}

function buildTrails() {
  const names = [...new Set(clips.flatMap((clip) => clip.names))].filter((name) => name);
  const autos = [...new Set(clips.flatMap((clip) => clip.trails.map((p) => clip.names[p])))];
  const options = [["auto", marks.length ? "goals' effectors" : autos.join(", ") || "none"], ["", "none"], ...names.map((name) => [name, name])];
  for (const [value, text] of options) byId("trail").append(new Option(text, value));
}

function applyTheme() {
  readColors(matchMedia("(prefers-color-scheme: dark)").matches);
  for (const clip of clips) clip.button.style.setProperty("--clip", clip.colors.base);
  const { l, m, r } = clips[0].colors;
  const sides = byId("sides").style;
  [["--pale", l[0]], ["--mid", m[1]], ["--deep", r[0]], ["--deep-edge", r[1]]].forEach(([name, c]) => sides.setProperty(name, css(c)));
  redraw();
}

// Where a clip's first trail point is, in the file's own axes and unit.
function whereText(clip) {
  const at = frameAt(clip, state.time), frame = Math.round(at);
  const ended = state.time > clip.duration + 1e-6 ? " (end)" : "";
  const [point] = trailPoints(clip);
  if (point === undefined) return `frame ${frame}${ended}`;
  const digits = Math.max(0, Math.ceil(2.5 - Math.log10(clip.size / clip.scale)));
  const file = {};
  clip.axes.forEach((name, a) => {
    file[name.slice(-1)] = ((name[0] === "-" ? -1 : 1) * clip.pose[3 * point + a]) / clip.scale;
  });
  const values = [file.x, file.y, file.z].map((v) => v.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "\u2212"));
  return `frame ${frame}${ended} · ${pointName(clip, point)} ${values.join(", ")}`;
}

function drawTexts() {
  const frame = frameNow();
  byId("now").innerHTML = `frame <b>${frame}</b> / ${lastFrame} · ${state.time.toFixed(2)} s`;
  scrub.value = String(frame);
  scrub.setAttribute("aria-valuetext", `frame ${frame}, ${state.time.toFixed(2)} seconds`);
  for (const clip of clips) clip.where.textContent = whereText(clip);
  const step = gridOf(views()[0].clips).step / reference.scale;
  const metres = (0.85 * step * reference.scale) / reference.size;
  const lines = [`grid ${short(step)} units, about ${metres < 1 ? `${Math.round(100 * metres)} cm` : `${metres.toFixed(1)} m`} at a leg of 0.85 m`];
  if (floorHeight) lines.push(`floor drawn at ${short(Number((floorHeight / reference.scale).toPrecision(3)))}`);
  clips.forEach((clip) => { if (clip.scale !== 1) lines.push(`${clip.label} shown at ${short(clip.scale)} of its size`); });
  byId("scale").textContent = lines.join("\n");
}

// Where a time is on a time line of that width, and the other way.
const KNOB = 8;

function timeX(time, width) {
  return KNOB + ((width - 2 * KNOB) * time) / (duration || 1);
}

function timeAt(x, width) {
  return ((x - KNOB) / Math.max(1, width - 2 * KNOB)) * duration;
}

// Seconds above, a bar for each clip, the head of time through all.
function drawRuler() {
  const element = byId("ruler"), ctx = prepare(element);
  const width = element.clientWidth, height = element.clientHeight;
  const x = (time) => timeX(time, width);
  const tick = niceStep(Math.max(duration / Math.max(2, width / 70), 1e-3));
  ctx.font = "11px system-ui, sans-serif";
  ctx.textBaseline = "top";
  ctx.textAlign = "center";
  for (let i = 0; i * tick <= duration + 1e-9; i++) {
    const at = x(i * tick);
    ctx.fillStyle = colors.line;
    ctx.fillRect(Math.round(at), 14, 1, height - 14);
    ctx.fillStyle = colors.quiet;
    ctx.fillText(`${short(Number((i * tick).toPrecision(6)))} s`, Math.max(12, Math.min(width - 14, at)), 0);
  }
  const band = Math.min(9, (height - 18) / clips.length);
  const top = 16 + (height - 18 - band * clips.length) / 2;
  clips.forEach((clip, i) => {
    const y = top + i * band + 1, h = Math.max(1.5, band - 2);
    ctx.fillStyle = clip.colors.base;
    ctx.globalAlpha = clip.show === "hidden" ? 0.12 : 0.3;
    ctx.fillRect(x(0), y, x(clip.duration) - x(0), h);
    ctx.globalAlpha = clip.show === "hidden" ? 0.2 : 1;
    ctx.fillRect(x(0), y, x(Math.min(state.time, clip.duration)) - x(0), h);
    ctx.globalAlpha = 1;
  });
  const head = x(state.time);
  ctx.fillStyle = colors.ink;
  ctx.fillRect(head - 1, 14, 2, height - 14);
  ctx.beginPath();
  ctx.arc(head, 15, 5, 0, 2 * Math.PI);
  ctx.fill();
}

function listen() {
  const press = (id, action) => byId(id).addEventListener("click", action);
  press("play", () => play(!state.playing));
  press("back", () => step(-1));
  press("next", () => step(1));
  press("loop", () => setLoop(!state.loop));
  press("goals", () => setGoals(!state.goals));
  press("layout", () => setApart(!state.apart));
  press("help", () => byId("keys").showModal());
  for (const preset of Object.keys(ANGLES)) press(preset, () => setView(preset));
  byId("speed").addEventListener("change", (e) => setSpeed(Number(e.target.value)));
  byId("trail").addEventListener("change", (e) => setTrail(e.target.value));
  scrub.addEventListener("input", () => { play(false); setFrame(Number(scrub.value)); });
  // After a click the keys belong to the scene again; who walks by tab keeps the focus.
  document.addEventListener("click", (e) => {
    if (e.detail > 0 && e.target.closest("button") && !e.target.closest("dialog")) document.activeElement.blur();
  });
  document.addEventListener("change", (e) => { if (e.target.tagName === "SELECT") e.target.blur(); });
  document.addEventListener("keydown", onKey);
  canvas.addEventListener("pointerdown", onPointer);
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("dblclick", () => setView("fit"));
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    zoom(Math.exp(e.deltaY * (e.deltaMode ? 0.05 : 0.0012)));
    redraw();
  }, { passive: false });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", applyTheme);
  const observer = new ResizeObserver(resized);
  for (const element of [canvas, byId("ruler")]) observer.observe(element);
  addEventListener("hashchange", applyAddress);
}

function onKey(e) {
  if (e.ctrlKey || e.metaKey || e.altKey || byId("keys").open || e.target.tagName === "SELECT") return;
  // A focused button takes space and enter itself.
  if (e.target.tagName === "BUTTON" && (e.key === " " || e.key === "Enter")) return;
  const far = e.shiftKey ? 10 : 1;
  const move = (x, y) => (e.shiftKey ? pan(-40 * x, -40 * y, canvas.clientHeight) : orbit(0.1 * x, 0.08 * y));
  const actions = {
    " ": () => play(!state.playing), arrowleft: () => step(-far), arrowright: () => step(far),
    home: () => step(-1e9), end: () => step(1e9), "[": () => changeSpeed(-1), "]": () => changeSpeed(1),
    "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1.1), _: () => zoom(1.1),
    1: () => setView("front"), 2: () => setView("side"), 3: () => setView("top"), 4: () => setView("follow"), 0: () => setView("fit"),
    a: () => move(-1, 0), d: () => move(1, 0), w: () => move(0, 1), s: () => move(0, -1),
    l: () => setLoop(!state.loop), o: () => setApart(!state.apart), t: () => setTrail(state.trail === "" ? "auto" : ""),
    g: () => setGoals(!state.goals), n: () => toGoal(1), p: () => toGoal(-1),
    arrowup: () => chooseNext(-1), arrowdown: () => chooseNext(1), escape: () => choose(null),
    "?": () => byId("keys").showModal(),
  };
  const action = actions[e.key.toLowerCase()];
  if (!action) return;
  e.preventDefault();
  action();
  redraw();
}

const pointers = new Map();

// One pointer turns the scene, or moves it with the right button or shift; two move and zoom.
function onPointer(e) {
  canvas.setPointerCapture(e.pointerId);
  pointers.set(e.pointerId, [e.clientX, e.clientY]);
  const moving = e.button === 2 || e.button === 1 || e.shiftKey;
  const height = views()[0].height;
  const onMove = (m) => {
    if (m.pointerId !== e.pointerId) return;
    const [x, y] = pointers.get(m.pointerId);
    const dx = m.clientX - x, dy = m.clientY - y;
    if (pointers.size === 2) {
      const [other] = [...pointers].filter(([id]) => id !== m.pointerId).map(([, at]) => at);
      const before = Math.hypot(x - other[0], y - other[1]);
      zoom(before / Math.max(1, Math.hypot(m.clientX - other[0], m.clientY - other[1])));
      pan(dx / 2, dy / 2, height);
    } else if (moving) pan(dx, dy, height);
    else orbit(-0.008 * dx, 0.008 * dy);
    pointers.set(m.pointerId, [m.clientX, m.clientY]);
    redraw();
  };
  const onUp = (u) => {
    if (u.pointerId !== e.pointerId) return;
    pointers.delete(e.pointerId);
    for (const [name, handler] of Object.entries(handlers)) canvas.removeEventListener(name, handler);
  };
  const handlers = { pointermove: onMove, pointerup: onUp, pointercancel: onUp };
  for (const [name, handler] of Object.entries(handlers)) canvas.addEventListener(name, handler);
}

// #frame=58&view=side&layout=side&trail=RightHand&speed=0.5&goal=hand&play=1 opens the page in that state.
function applyAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const speed = Number(given.get("speed"));
  if (SPEEDS.includes(speed)) setSpeed(speed);
  if (given.has("trail") && [...byId("trail").options].some((o) => o.value === given.get("trail"))) setTrail(given.get("trail"));
  if (given.has("layout")) setApart(given.get("layout") === "side");
  if (Object.hasOwn(ANGLES, given.get("view"))) setView(given.get("view"), true);
  const frame = Number(given.get("frame"));
  if (given.has("frame") && Number.isFinite(frame)) step(frame - frameNow());
  if (given.has("goal")) choose(marks.find((mark) => mark.name === given.get("goal")) || null);
  if (given.has("play")) play(given.get("play") === "1");
}

let before = 0;

function tick(now) {
  const seconds = Math.min(0.1, (now - before) / 1000);
  before = now;
  if (state.playing) {
    state.time += seconds * state.speed;
    if (state.time > duration) {
      if (state.loop) state.time = startTime + ((state.time - duration) % Math.max(duration - startTime, 1e-6));
      else { state.time = duration; play(false); }
    }
    redraw();
  }
  if (glide(seconds)) redraw();
  if (dirty) draw();
  requestAnimationFrame(tick);
}

function draw() {
  dirty = false;
  drawScene();
  drawRuler();
  drawLanes();
  drawTexts();
}

// At once: until the next tick the browser would stretch the pictures of the old size over the new one.
function resized() {
  if (camera.preset) setView(camera.preset, true);
  draw();
}

buildLegend();
buildLanes();
setGoals(state.goals);
buildTrails();
scrub.max = String(lastFrame);
byId("layout").hidden = clips.length < 2;
applyTheme();
state.time = startTime;
listen();
// A clip that travels far would be small in one picture of the whole way.
const way = Math.hypot(...[0, 2].map((a) => reference.high[a] - reference.low[a]));
setView(way > 4.5 * reference.size ? "follow" : "fit", true);
play(!calm.matches);
applyAddress();
requestAnimationFrame(tick);
