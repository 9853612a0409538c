// What the page computes from its settings: loops with margins, the step, the circle. No picture is made here.
"use strict";
const bench = { kept: new Map(), key: "" };

function valuesOf(E, settings) {
  const values = Float64Array.from(E.values);
  values[E.payload] = settings.payload;
  for (const [place, value] of Object.entries(settings.values || {})) values[place] = value;
  return values;
}
// natural frequencies of resonances are where margins turn quickly: peaks of the response on the page's grid
function peaks(frequency, v) {
  const size = Array.from(v.re, (r, i) => Math.hypot(r, v.im[i])), found = [];
  for (let i = 1; i < size.length - 1; i++) if ((size[i] > size[i - 1] && size[i] > size[i + 1]) || (size[i] < size[i - 1] && size[i] < size[i + 1])) found.push(frequency[i]);
  return found;
}
function computeLoops(E, settings) {
  const values = valuesOf(E, settings), parameters = parametersOf(E, settings);
  const plant = sampledPlant(E, values, settings.moving === false ? 0 : E.velocity, settings.position, E.tick);
  if (!plant) return null;
  const velocity = openVelocity(E, plant, parameters), position = closedPosition(E, plant, parameters);
  const growth = Math.log(radius(position.a)) / (E.tick * E.divider), inner = Math.log(radius(velocity.closed())) / E.tick;
  const tell = (loop, outer) => {
    const frequency = E.frequency[outer ? 1 : 0], v = responseOf(loop, frequency, outer);
    return { frequency, re: v.re, im: v.im, margins: marginsOf(E, loop, outer, peaks(frequency, v)) };
  };
  return { velocity: tell(velocity, false), position: tell(position, true), stable: growth < E.growth && inner < E.growth, growth };
}
function machineOf(E, values) { // constants are kept as long as the machine is the same
  const key = Array.from(values).join();
  if (key !== bench.key) { bench.key = key; bench.kept = new Map(); }
  return bench.kept;
}
function computeStep(E, settings) {
  const values = valuesOf(E, settings), s = E.step, start = settings.position;
  const side = E.stroke && start > E.stroke[1] - s.height ? -1 : 1;
  const ref = { position: s.ref.position.map((v) => side * v), velocity: s.ref.velocity, acceleration: s.ref.acceleration };
  const ran = simulate(E, values, parametersOf(E, settings), start, start, ref, s.ticks, machineOf(E, values));
  return ran && { ...ran, figures: stepFigures(E, ran.table, s.at), start, side };
}
// rise, overshoot, settling (metrology/response.py)
function stepFigures(E, y, at) {
  const first = Math.ceil(at / E.tick - 1e-9), count = y.length - first, tail = Math.max(1, Math.floor(count / 20));
  let final = 0;
  for (let i = y.length - tail; i < y.length; i++) final += y[i] / tail;
  const start = y[first - 1], height = final - start;
  if (!(Math.abs(height) > 0)) return null;
  let low = -1, high = -1, last = -1, largest = -Infinity;
  for (let i = 0; i < count; i++) {
    const share = (y[first + i] - start) / height;
    if (low < 0 && share >= 0.1) low = i;
    if (high < 0 && share >= 0.9) high = i;
    if (Math.abs(share - 1) > 0.02) last = i;
    largest = Math.max(largest, share);
  }
  const settling = last < 0 ? 0 : (first + last) * E.tick - at; // null: not settled
  return { final, rise: (high - low) * E.tick, overshoot: Math.max(0, largest - 1), settling: settling > E.settled_by * ((y.length - 1) * E.tick - at) ? null : settling };
}
function centreOf(E, position) {
  if (!E.stroke) return position;
  const room = Math.min(E.circle.radius, (E.stroke[1] - E.stroke[0]) / 2);
  return Math.min(Math.max(position, E.stroke[0] + room), E.stroke[1] - room);
}
function computeCircle(E, settings) {
  const values = valuesOf(E, settings), c = E.circle, centre = centreOf(E, settings.position);
  const ran = simulate(E, values, parametersOf(E, settings), centre, centre, c.ref, c.ticks, machineOf(E, values));
  return ran && { ...ran, ...circleFigures(E, ran.table) };
}
// deviation and glitches about the fundamental (metrology/circular.py)
function circleFigures(E, table) {
  const { angle, first, radius: R, span } = E.circle, n = angle.length, normal = mat(3, 3), right = mat(3, 1);
  const sine = angle.map(Math.sin), cosine = angle.map(Math.cos);
  for (let i = 0; i < n; i++) {
    const row = [1, sine[i], cosine[i]], y = table[first + i] - table[first];
    for (let p = 0; p < 3; p++) { right.d[p] += row[p] * y; for (let q = 0; q < 3; q++) normal.d[q * 3 + p] += row[p] * row[q]; }
  }
  const [middle, a, b] = solve(normal, right).d, lead = Math.atan2(b, a), radial = new Float64Array(n), glitches = [0, 0];
  for (let i = 0; i < n; i++) {
    const x = table[first + i] - table[first] - middle, rest = x - a * sine[i] - b * cosine[i];
    radial[i] = Math.hypot(x, a * cosine[i] - b * sine[i]) - R;
    [1, -1].forEach((side, k) => {
      let after = (angle[i] + lead - side * Math.PI / 2) % (2 * Math.PI);
      if (after < 0) after += 2 * Math.PI;
      if (after < span && Math.abs(rest) > Math.abs(glitches[k])) glitches[k] = side * rest;
    });
  }
  let low = Infinity, high = -Infinity;
  for (const r of radial) { low = Math.min(low, r); high = Math.max(high, r); }
  return { radial, deviation: high - low, gain: Math.hypot(a, b) / R, lag: -lead, glitch: glitches };
}
