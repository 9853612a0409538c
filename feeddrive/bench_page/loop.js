// The loops about a moving point, as feeddrive/servo/linear_loop.py and sampled_plant.py make them.
"use strict";
const MOST_NEWTON = 30;

function chainAt(E, values, position) {
  const n = E.n, M = mat(n, n), C = mat(n, n), K = mat(n, n), motor = mat(n, 1), table = mat(n, 1), rigid = mat(n, 1);
  chain(values, [position], M.d, C.d, K.d, motor.d, table.d, rigid.d);
  return { M, C, K, motor, table, rigid };
}
// state and torque of a motion at constant velocity, by Newton's method from a flank of the free play
function steadyState(E, values, velocity, position) {
  const n = E.n, size = n + E.bristles, c = chainAt(E, values, position);
  let stiffest = 0;
  for (let i = 0; i < c.K.d.length; i++) stiffest = Math.max(stiffest, Math.abs(c.K.d[i]));
  for (const flank of velocity < 0 ? [-1, 1] : [1, -1]) {
    const u = new Float64Array(size), error = mat(size, 1), slope = mat(size, size), x = new Float64Array(2 * n + E.bristles);
    const travelled = position + flank * (0.5 * E.free_play + 1e-6);
    for (let i = 0; i < n - 1; i++) u[i] = travelled * c.rigid.d[i];
    for (let step = 0; step < MOST_NEWTON; step++) {
      steady(u, values, [velocity, position], error.d, slope.d, x);
      let largest = 0, moved = 0;
      for (let i = 0; i < size; i++) largest = Math.max(largest, Math.abs(error.d[i]));
      for (let i = 0; i < size - 1; i++) moved = Math.max(moved, Math.abs(u[i]));
      if (!isFinite(largest)) break;
      if (largest <= 1e-9 + 1e-12 * stiffest * (moved * E.lead_radius + 1e-3)) return { x, torque: u[n - 1] };
      for (let j = 0; j < size; j++) { // columns of like size
        let s = 0;
        for (let i = 0; i < size; i++) s = Math.max(s, Math.abs(slope.d[j * size + i]));
        c.s = c.s || new Float64Array(size); c.s[j] = s || 1;
        for (let i = 0; i < size; i++) slope.d[j * size + i] /= c.s[j];
      }
      const better = solve(slope, error);
      for (let i = 0; i < size; i++) u[i] -= better.d[i] / c.s[i];
    }
  }
  return null;
}
// A, B, C per tick from the held torque to the readings; dead time in whole ticks and the rest
function sampledPlant(E, values, velocity, position, tick) {
  const at = steadyState(E, values, velocity, position);
  if (!at) return null;
  const n = 2 * E.n + E.bristles;
  let a = mat(n, n), b = mat(n, 2), c = mat(4, n), d = mat(4, 2);
  jacobians(at.x, [at.torque, 0], values, a.d, b.d, c.d, d.d);
  let size = n;
  if (E.lag) {
    const first = part(b, 0, n, 0, 1), lag = mat(1, 1), fed = mat(1, 1);
    lag.d[0] = -1 / E.lag; fed.d[0] = 1 / E.lag;
    a = blocks([[a, first], [null, lag]], [n, 1], [n, 1]);
    b = blocks([[null, part(b, 0, n, 1, 1)], [fed, null]], [n, 1], [1, 1]);
    c = blocks([[c, null]], [4], [n, 1]);
    size = n + 1;
  }
  const sampled = (span, inputs) => {
    const joined = expm(blocks([[scale(a, span), scale(inputs, span)], [null, null]], [size, inputs.m], [size, inputs.m]));
    return [part(joined, 0, size, 0, size), part(joined, 0, size, size, inputs.m)];
  };
  const dead = E.dead / tick, late = Math.floor(dead + 1e-9), rest = dead - late > 1e-9 ? dead - late : 0;
  const [whole, held] = sampled(tick, b), torque = part(held, 0, size, 0, 1);
  let torques = [torque];
  if (rest) { const newest = sampled((1 - rest) * tick, part(b, 0, size, 0, 1))[1]; torques = [sum(torque, newest, -1), newest]; }
  const waiting = late + torques.length - 1, all = size + waiting, A = mat(all, all), B = mat(all, 1);
  for (let j = 0; j < size; j++) for (let i = 0; i < size; i++) A.d[j * all + i] = whole.d[j * size + i];
  torques.forEach((t, k) => { for (let i = 0; i < size; i++) if (k < waiting) A.d[(size + k) * all + i] += t.d[i]; else B.d[i] += t.d[i]; });
  for (let k = 0; k < waiting - 1; k++) A.d[(size + k + 1) * all + size + k] = 1;
  if (waiting) B.d[all - 1] = 1;
  return { a: A, b: B, c: blocks([[c, null]], [4], [size, waiting]) };
}
function cascadeLinear(E, parameters, tick) {
  const s = E.controller_states, r = E.references.length, m = E.measured.length, g = E.signals.length;
  const shape = [[s, s], [s, r], [s, m], [1, s], [1, r], [1, m], [g, s], [g, r], [g, m]].map(([p, q]) => mat(p, q));
  cascade_linear([tick], parameters, ...shape.map((x) => x.d));
  const [a, byReference, byReading, torque, torqueByReference, torqueByReading] = shape;
  return { a, byReference, byReading, torque, torqueByReference, torqueByReading };
}
function wholeTick(E, plant, k) {
  const readings = take(plant.c, E.measured), p = plant.a.n, s = k.a.n, r = E.references.length;
  return {
    a: blocks([[sum(plant.a, mul(mul(plant.b, k.torqueByReading), readings)), mul(plant.b, k.torque)], [mul(k.byReading, readings), k.a]], [p, s], [p, s]),
    b: blocks([[mul(plant.b, k.torqueByReference)], [k.byReference]], [p, s], [r]), readings,
  };
}
const parametersOf = (E, cascade) => { // of the page's settings, in the order of the cascade's function
  const p = Float64Array.from(E.parameters), at = (name) => E.parameter_names.indexOf(name), first = E.parameter_names.length;
  p[at("position_gain")] = cascade.position_gain; p[at("velocity_gain")] = cascade.velocity_gain;
  p[at("integral_gain")] = isFinite(cascade.reset_time) ? cascade.velocity_gain / cascade.reset_time : 0;
  p[at("tracking_rate")] = isFinite(cascade.reset_time) ? 1 / (E.tracking || cascade.reset_time) : 0;
  p[at("speed_share")] = cascade.speed_share;
  p[at("torque_per_acceleration")] = cascade.torque_share * E.inertia / E.radius;
  cascade.filters.forEach((f, i) => discrete(f, E.tick).forEach((c, k) => { p[first + 5 * i + k] = c; }));
  return p;
};
// coefficients of a filter, the bilinear map exact at its frequency (servo/filters.py)
function discrete(f, tick) {
  if (f.kind === "none") return [1, 0, 0, 0, 0];
  const w = 2 * Math.PI * f.frequency, wide = 2 * w * f.damping;
  const b = f.kind === "PT2" ? [0, 0, 1] : [1, wide * Math.pow(10, -f.depth / 20), w * w];
  const a = f.kind === "PT2" ? [1 / (w * w), wide / (w * w), 1] : [1, wide, w * w];
  const s = 2 * Math.PI * f.frequency / Math.tan(Math.PI * f.frequency * tick);
  const map = (p) => [p[0] * s * s + p[1] * s + p[2], 2 * (p[2] - p[0] * s * s), p[0] * s * s - p[1] * s + p[2]];
  const x = map(b), y = map(a);
  return [x[0] / y[0], x[1] / y[0], x[2] / y[0], y[1] / y[0], y[2] / y[0]];
}
// open velocity loop, cut at the torque command, the position loop open
function openVelocity(E, plant, parameters) {
  const alone = Float64Array.from(parameters);
  alone[E.parameter_names.indexOf("position_gain")] = 0;
  const k = cascadeLinear(E, alone, E.divider + 1), readings = take(plant.c, E.measured), p = plant.a.n, s = k.a.n;
  const a = blocks([[plant.a, null], [mul(k.byReading, readings), k.a]], [p, s], [p, s]);
  const b = blocks([[plant.b], [null]], [p, s], [1]);
  const c = blocks([[scale(mul(k.torqueByReading, readings), -1), scale(k.torque, -1)]], [1], [p, s]);
  return { f: hessenberg(a, b, c), tick: E.tick, closed: () => sum(a, mul(b, c), -1) };
}
// from the position set-point to the measured position, without feed-forward, at the position ticks
function closedPosition(E, plant, parameters) {
  const bare = Float64Array.from(parameters);
  for (const name of ["speed_share", "torque_per_acceleration", "friction_torque", "viscous"]) bare[E.parameter_names.indexOf(name)] = 0;
  bare[E.parameter_names.indexOf("balancing_share")] = 1;
  const whole = wholeTick(E, plant, cascadeLinear(E, bare, E.divider)), step = wholeTick(E, plant, cascadeLinear(E, bare, E.divider + 1));
  let a = whole.a, b = part(whole.b, 0, whole.b.n, 0, 1);
  const held = part(step.b, 0, step.b.n, 0, 1);
  for (let k = 1; k < E.divider; k++) { b = sum(mul(step.a, b), held); a = mul(step.a, a); }
  const row = part(plant.c, E.feedback === "motor" ? 0 : 2, 1, 0, plant.c.m);
  const c = blocks([[E.feedback === "motor" ? scale(row, E.radius) : row, null]], [1], [plant.a.n, a.n - plant.a.n]);
  return { f: hessenberg(a, b, c), a, tick: E.tick * E.divider };
}
function responseOf(loop, frequency, position) {
  const angles = frequency.map((f) => 2 * Math.PI * f * loop.tick), v = responses(loop.f, angles), re = v.re[0], im = v.im[0];
  if (position) for (let i = 0; i < re.length; i++) { // L = T / (1 - T)
    const dr = 1 - re[i], di = -im[i], dd = dr * dr + di * di, r = re[i];
    re[i] = (r * dr + im[i] * di) / dd; im[i] = (im[i] * dr - r * di) / dd;
  }
  return { re, im };
}
// margins as servo/margins.py has them: crossings between neighbours of the grid of `points` from 0.1 Hz to half the rate.
// Where to look is found on every fourteenth of its frequencies and about peaks; the values are those of the neighbours themselves.
function marginsOf(E, loop, position, sharp) {
  const points = 20000, top = 0.5 / loop.tick, ratio = Math.log(top / 0.1) / (points - 1), grid = (i) => i === points - 1 ? top : 0.1 * Math.exp(ratio * i);
  const wanted = new Set();
  for (let i = 0; i < points; i += 14) wanted.add(i);
  wanted.add(points - 1);
  for (const f of sharp) {
    const at = Math.round(Math.log(f / 0.1) / ratio);
    for (let i = Math.max(0, at - 28); i <= Math.min(points - 1, at + 28); i += 2) wanted.add(i);
  }
  const first = Array.from(wanted).sort((p, q) => p - q);
  const at = (list) => { const v = responseOf(loop, Float64Array.from(list, grid), position); return list.map((i, k) => ({ i, f: grid(i), size: 0.5 * Math.log(v.re[k] ** 2 + v.im[k] ** 2), from: Math.atan2(-v.im[k], -v.re[k]), peak: 1 / Math.hypot(1 + v.re[k], v.im[k]) })); };
  let rows = at(first);
  const crosses = (p, q) => (p.size < 0) !== (q.size < 0) || ((p.from < 0) !== (q.from < 0) && Math.abs(q.from - p.from) < Math.PI);
  const more = [];
  for (let k = 1; k < rows.length; k++) if (rows[k].i - rows[k - 1].i > 1 && crosses(rows[k - 1], rows[k])) for (let i = rows[k - 1].i + 1; i < rows[k].i; i++) more.push(i);
  if (more.length) rows = rows.concat(at(more)).sort((p, q) => p.i - q.i);
  // the largest |1 / (1 + L)| may lie between two that were looked at, at any of its peaks that come near the largest
  const worst = 0.8 * rows.reduce((p, q) => Math.max(p, q.peak), 0), seen = new Set(rows.map((r) => r.i)), near = new Set();
  rows.forEach((r, k) => {
    if (r.peak < worst || (rows[k - 1] || r).peak > r.peak || (rows[k + 1] || r).peak > r.peak) return;
    for (let i = Math.max(0, r.i - 14); i <= Math.min(points - 1, r.i + 14); i++) if (!seen.has(i)) near.add(i);
  });
  rows = rows.concat(at(Array.from(near))).sort((p, q) => p.i - q.i);
  let gain = [Infinity, NaN], phase = [Infinity, NaN], peak = 0;
  for (let k = 0; k < rows.length; k++) {
    peak = Math.max(peak, rows[k].peak);
    if (!k) continue;
    const p = rows[k - 1], q = rows[k];
    if ((p.from < 0) !== (q.from < 0) && Math.abs(q.from - p.from) < Math.PI) {
      const s = -p.from / (q.from - p.from), v = p.size + s * (q.size - p.size);
      if (v < 0 && -v < gain[0]) gain = [-v, p.f + s * (q.f - p.f)];
    }
    if ((p.size < 0) !== (q.size < 0)) {
      const s = -p.size / (q.size - p.size);
      let turn = q.from - p.from;
      turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
      let m = p.from + s * turn;
      m = Math.abs(m - 2 * Math.PI * Math.round(m / (2 * Math.PI)));
      if (m < phase[0]) phase = [m, p.f + s * (q.f - p.f)];
    }
  }
  return { gain: 20 * gain[0] / Math.LN10, gain_frequency: gain[1], phase: phase[0] * 180 / Math.PI, phase_frequency: phase[1], sensitivity: peak };
}
