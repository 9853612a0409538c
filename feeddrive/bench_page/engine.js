// Runs the axis tick by tick, as feeddrive/simulate/driver.c does: steps of its own choice, refused where the error is large.
"use strict";
const SWEEPS = 12, COARSER = 0.02, CURVE = [1, -4, 3];

// constants of a step at a cell and level (simulate/step_constants.py)
function stepConstants(E, values, cell, level, share) {
  const n = E.n, reference = E.varies ? E.cell * cell : 0, c = chainAt(E, values, reference), span = E.tick * E.parts[share] / 2 ** level;
  const inverse = solve(c.M, eye(n)), forced = E.forced.length, S = E.sizes.N_STATES;
  const columns = mat(n, 2);
  for (let i = 0; i < n; i++) { columns.d[i] = c.motor.d[i]; columns.d[n + i] = c.table.d[i]; }
  let a = blocks([[null, eye(n)], [scale(mul(inverse, c.K), -1), scale(mul(inverse, c.C), -1)]], [n, n], [n, n]);
  const onForce = mat(n, forced);
  E.forced.forEach((i, k) => { for (let r = 0; r < n; r++) onForce.d[k * n + r] = inverse.d[i * n + r]; });
  const given = mul(inverse, columns);
  let g = blocks([[null], [onForce]], [n, n], [forced]), b = blocks([[null], [given]], [n, n], [2]);
  if (E.lagging) {
    const lag = mat(1, 1), fed = mat(1, 2);
    lag.d[0] = -1 / E.lag; fed.d[0] = 1 / E.lag;
    a = blocks([[a, part(b, 0, 2 * n, 0, 1)], [null, lag]], [2 * n, 1], [2 * n, 1]);
    for (let i = 0; i < 2 * n; i++) b.d[i] = 0;
    b = blocks([[b], [fed]], [2 * n, 1], [2]); g = blocks([[g], [null]], [2 * n, 1], [forced]);
  }
  // exponential of the chain with the monomials 1, tau, tau^2 of forces and inputs
  const both = blocks([[g, b]], [S], [forced, 2]), m = forced + 2, size = S + 3 * m, gen = mat(size, size);
  for (let j = 0; j < S; j++) for (let i = 0; i < S; i++) gen.d[j * size + i] = span * a.d[j * S + i];
  for (let j = 0; j < m; j++) for (let i = 0; i < S; i++) gen.d[(S + j) * size + i] = span * both.d[j * S + i];
  for (let k = 1; k < 3; k++) for (let j = 0; j < m; j++) gen.d[(S + k * m + j) * size + S + (k - 1) * m + j] = k;
  const third = expm(scale(gen, 1 / 3)), maps = [third, mul(third, mul(third, third))];
  const out = [];
  let curved = null;
  for (const full of maps) {
    const P = [0, 1, 2].map((k) => part(full, 0, S, S + k * m, m)), f = (k) => part(P[k], 0, S, 0, forced);
    out.push(part(full, 0, S, 0, S), part(P[0], 0, S, forced, 2), sum(scale(f(0), 1.5), scale(f(1), -1.5)), sum(scale(f(0), -0.5), scale(f(1), 1.5)));
    curved = sum(sum(scale(f(0), CURVE[0]), scale(f(1), CURVE[1])), scale(f(2), CURVE[2]));
  }
  let felt = 0;
  for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) felt += c.table.d[i] * inverse.d[j * n + i] * c.table.d[j];
  felt = 1 / felt;
  const norm = (from, k) => { let s = 0; for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) s += curved.d[k * S + from + i] * c.M.d[j * n + i] * curved.d[k * S + from + j]; return Math.sqrt(s / felt); };
  const own = E.forced.map((i) => Math.sqrt(felt / inverse.d[i * n + i]));
  const scales = own.map((v) => E.converged * E.full_scale * v);
  while (scales.length < E.sizes.N_SOLVED) scales.push(0);
  const fixed = [];
  out.forEach((x) => fixed.push(...x.d));
  fixed.push(span, 0.5 ** level, reference, ...scales);
  E.forced.forEach((_, k) => fixed.push((norm(0, k) + norm(n, k) / E.forgetting) / E.tolerance));
  own.forEach((v) => fixed.push(span / 36 / v / E.forgetting / E.tolerance));
  return Float64Array.from(fixed);
}
// coordinates and rates with the table at a position and no stretch anywhere (simulate/held_torque.py)
function atRest(E, values, position) {
  const n = E.n, c = chainAt(E, values, position), memory = new Float64Array(E.sizes.N_MEMORY), r = E.lead_radius;
  let angle = position / r;
  if (E.travel) for (let k = 0; k < 20; k++) { const d = [0]; travel([angle], [position], values, d, [0], [0]); angle = (position - d[0]) / r; }
  for (let i = 0; i < n - 1; i++) memory[i] = r * angle * c.rigid.d[i];
  memory[n - 1] = position;
  return memory;
}
// The run of a reference: `offsets` are position, velocity, acceleration at the position ticks; returns series per tick.
function simulate(E, values, parameters, start, centre, ref, ticks, cache) {
  const z = E.sizes, S = z.N_STATES, U = z.N_UNKNOWN, F = z.N_FORCED, Z = z.N_BRISTLES, W = z.N_WATCHED, H = z.N_HELD, R = z.N_READ;
  const node = S * S + S * (H + 2 * F), SPAN = 2 * node, CURVATURE = SPAN + 3 + z.N_SOLVED, CHANGE = CURVATURE + W;
  const BR = S, VALUE = S + Z, CURV = VALUE + W, SLOPE = CURV + W;
  const settings = new Float64Array(z.N_SETTINGS);
  settings.set(parameters); E.resolutions.forEach((v, i) => { settings[parameters.length + i] = v; });
  settings[z.N_SETTINGS - 1] = E.torque_limit;
  let memory = atRest(E, values, start), after = new Float64Array(z.N_MEMORY), own = new Float64Array(z.N_OWN), next = new Float64Array(z.N_OWN);
  own.set(E.initial);
  const fed = new Float64Array(z.N_FED), held = new Float64Array(z.N_PARTS * H), seen = new Float64Array(z.N_BEFORE), base = new Float64Array(z.N_BASE);
  let guess = new Float64Array(U), other = new Float64Array(U);
  const change = [0], end = new Float64Array(S), input = new Float64Array(H), place = [0], now = [0];
  const command = new Float64Array(ticks), torque = new Float64Array(ticks), angle = new Float64Array(ticks), table = new Float64Array(ticks);
  const refs = E.references.length, whole = 1 << E.deepest;
  let level = 0, cell = null, refused = 0, steps = 0;
  const constants = (k, l, p) => { const key = (k * 2 + p) * 16 + l; if (!cache.has(key)) cache.set(key, stepConstants(E, values, k, l, p)); return cache.get(key); };
  for (let t = 0; t < ticks; t++) {
    const i = Math.floor(t / E.divider);
    fed[0] = centre + ref.position[i]; fed[1] = ref.velocity[i]; fed[2] = ref.acceleration[i];
    fed[refs + 1] = t; fed[refs + 2] = t * E.tick;
    before(memory, own, fed, settings, values, next, held, seen);
    command[t] = seen[0]; torque[t] = seen[1]; angle[t] = seen[2]; table[t] = seen[4];
    let begin = fed[refs + 2];
    for (let p = 0; p < z.N_PARTS; p++) {
      for (let k = 0; k < H; k++) input[k] = held[p * H + k];
      let at = 0;
      while (at < whole) {
        const length = whole >> level, share = at / whole;
        place[0] = share; now[0] = begin + share * E.tick * E.parts[p];
        const k = E.varies ? Math.floor(memory[E.sizes.TABLE] / E.cell + 0.5) : 0;
        const fixed = constants(k, level, p);
        if (cell !== k) { watch(memory, input, place, now, fixed, values, after); const q = memory; memory = after; after = q; cell = k; }
        // begin: states without node forces, the parabola of the last step
        const h = fixed[SPAN];
        for (let r = 0; r < S; r++) end[r] = 0;
        for (let q = 0; q < S; q++) { const s = memory[q]; if (s !== 0) for (let r = 0; r < S; r++) end[r] += fixed[node + r + S * q] * s; }
        for (let q = 0; q < H; q++) { const s = input[q]; if (s !== 0) for (let r = 0; r < S; r++) end[r] += fixed[node + S * S + r + S * q] * s; }
        for (let q = 0; q < R; q++) {
          const row = E.read[q];
          if (row < S) { let s = 0; for (let j = 0; j < S; j++) s += fixed[row + S * j] * memory[j]; for (let j = 0; j < H; j++) s += fixed[S * S + row + S * j] * input[j]; base[q] = s; base[R + q] = end[row]; }
          else { base[q] = input[row - S]; base[R + q] = input[row - S]; }
        }
        for (let m = 0; m < 2; m++) {
          const time = (m ? 1 : 1 / 3) * h;
          for (let j = 0; j < F; j++) guess[m * F + j] = memory[VALUE + j] + time * (memory[SLOPE + j] + 3 * time * memory[CURV + j]);
          for (let j = 0; j < Z; j++) guess[2 * F + m * Z + j] = memory[BR + j];
        }
        let solved = U === 0, old = 1e300;
        for (let s = 0; s < SWEEPS && U; s++) {
          iterate(memory, base, guess, now, fixed, values, other, change);
          const q = guess; guess = other; other = q;
          if (change[0] < 1) { solved = true; break; }
          if (!(change[0] < 1e290) || (s > 3 && change[0] > old)) break;
          old = change[0];
        }
        let error = -1;
        if (solved) {
          error = 0;
          for (let r = 0; r < S; r++) after[r] = end[r];
          for (let j = 0; j < 2 * F; j++) { const s = guess[j], off = node + S * S + S * H + S * j; for (let r = 0; r < S; r++) after[r] += fixed[off + r] * s; }
          for (let j = 0; j < Z; j++) after[BR + j] = guess[2 * F + Z + j];
          for (let j = 0; j < W; j++) {
            let one, two;
            if (F) { one = guess[j]; two = guess[F + j]; }
            else { const p1 = guess[j] - memory[BR + j], p2 = guess[Z + j] - memory[BR + j]; one = (1.5 * p1 + 0.5 * p2) / h; two = (2.5 * p2 - 4.5 * p1) / h; }
            const missed = memory[VALUE + j] - 1.5 * one + 0.5 * two;
            error += fixed[CURVATURE + j] * Math.abs(missed) + fixed[CHANGE + j] * Math.abs(missed - memory[CURV + j] * h * h);
            after[VALUE + j] = two; after[CURV + j] = missed / (h * h); after[SLOPE + j] = (1.5 * (two - one) + 2 * missed) / h;
          }
        }
        if (!(error >= 0 && error <= 1) && level < E.deepest) { level++; refused++; continue; }
        if (!(error >= 0)) return null;
        const q = memory; memory = after; after = q;
        at += length; steps++;
        if (level > 0 && error < COARSER && at % (2 * length) === 0) level--;
      }
      begin += E.tick * E.parts[p];
    }
    const q = own; own = next; next = q;
    if (!isFinite(memory[0])) return null;
  }
  return { command, torque, angle, table, steps, refused };
}
