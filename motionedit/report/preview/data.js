// The clips: packed text to world positions, and a clip's pose at a time.

function unpack(text, Type) {
  return new Type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

function readClip(record, index) {
  const centers = unpack(record.centers, Float32Array);
  const steps = unpack(record.steps, Int16Array);
  const points = record.names.length;
  const positions = new Float32Array(steps.length);
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let f = 0, i = 0; f < record.frames; f++) {
    for (let p = 0; p < points; p++) {
      for (let a = 0; a < 3; a++, i++) {
        const value = centers[3 * f + a] + record.step * steps[i];
        positions[i] = value;
        if (f >= record.first) {
          low[a] = Math.min(low[a], value);
          high[a] = Math.max(high[a], value);
        }
      }
    }
  }
  return {
    ...record, index, points, positions, low, high,
    centers: smoothed(centers, record.first, record.frames, Math.round(0.25 / record.frameTime)),
    duration: (record.frames - 1) * record.frameTime,
    pose: new Float32Array(3 * points),
    show: "solid", goals: [],
  };
}

// The mean over a window of 2 k + 1 frames: a camera that follows must not shake with each step. A rest pose in
// front of the take stands elsewhere and has no part in it.
function smoothed(track, start, frames, k) {
  const out = track.slice();
  for (let a = 0; a < 3; a++) {
    let sum = 0, first = start, last = start - 1;
    for (let f = start; f < frames; f++) {
      for (; last < Math.min(frames - 1, f + k); ) sum += track[3 * ++last + a];
      for (; first < f - k; first++) sum -= track[3 * first + a];
      out[3 * f + a] = sum / (last - first + 1);
    }
  }
  return out;
}

// A clip that has ended stands at its last frame.
function frameAt(clip, time) {
  return Math.min(clip.frames - 1, Math.max(0, time / clip.frameTime));
}

function mixFrames(track, width, at, out) {
  const f = Math.floor(at + 1e-6), w = at - f > 1e-4 ? at - f : 0;
  const a = f * width, b = w ? a + width : a;
  for (let i = 0; i < width; i++) out[i] = track[a + i] + w * (track[b + i] - track[a + i]);
  return out;
}

// An edit: what was asked of a clip, mark by mark.
function readEdit(record) {
  const clip = clips[record.clip];
  const curve = (found) => {
    if (!found) return null;
    const values = unpack(found.values, Float32Array);
    return { values, tolerance: found.tolerance, max: values.reduce((most, value) => Math.max(most, value), 0) };
  };
  const list = record.marks.map((mark) => ({
    ...mark, clip,
    places: mark.places && unpack(mark.places, Float32Array),
    lengths: curve(mark.lengths), angles: curve(mark.angles),
    missed: mark.status !== "ok",
    seenWith: new Set([record.clip, ...mark.points.map(([c]) => c)]),
  }));
  for (const mark of list) keepInView(mark);
  return { ...record, marks: list, missed: !["ok", "far"].includes(record.status) };
}

// A goal that is not too far from its clip belongs into the picture of the whole.
function keepInView(mark) {
  if (!mark.places || mark.looks) return;
  for (const [, first] of mark.spans) {
    const place = mark.places.subarray(3 * (first - mark.first), 3 * (first - mark.first) + 3);
    const gap = Math.max(...[0, 1, 2].map((a) => Math.max(mark.clip.low[a] - place[a], place[a] - mark.clip.high[a])));
    if (gap < 1.5 * mark.clip.size) mark.clip.goals.push([...place]);
  }
}

const clips = JSON.parse(document.getElementById("clips").textContent).map(readClip);
const reference = clips[0];
const duration = Math.max(...clips.map((clip) => clip.duration));
const lastFrame = Math.round(duration / reference.frameTime);
const unitSize = reference.size;
const edits = JSON.parse(document.getElementById("edits").textContent).map(readEdit);
const marks = edits.flatMap((edit) => edit.marks);
const floorHeight = Math.min(...clips.map((clip) => clip.floor));
