// Matrices as {n, m, d}: n rows, m columns, column-major, as CasADi writes them.
"use strict";
const mat = (n, m) => ({ n, m, d: new Float64Array(n * m) });
const eye = (n) => { const r = mat(n, n); for (let i = 0; i < n; i++) r.d[i * n + i] = 1; return r; };
function mul(a, b) {
  const r = mat(a.n, b.m), n = a.n, x = a.d, y = r.d;
  for (let j = 0; j < b.m; j++) for (let k = 0; k < a.m; k++) {
    const s = b.d[j * b.n + k];
    if (s !== 0) for (let i = 0; i < n; i++) y[j * n + i] += x[k * n + i] * s;
  }
  return r;
}
function sum(a, b, s = 1) { const r = mat(a.n, a.m); for (let i = 0; i < r.d.length; i++) r.d[i] = a.d[i] + s * b.d[i]; return r; }
function scale(a, s) { const r = mat(a.n, a.m); for (let i = 0; i < r.d.length; i++) r.d[i] = a.d[i] * s; return r; }
// a larger matrix from blocks, each row a list; null is zero of the size that its neighbours give
function blocks(rows, heights, widths) {
  const total = (l) => l.reduce((s, v) => s + v, 0), r = mat(total(heights), total(widths));
  let top = 0;
  rows.forEach((row, i) => {
    let left = 0;
    row.forEach((b, j) => {
      if (b) for (let q = 0; q < b.m; q++) for (let p = 0; p < b.n; p++) r.d[(left + q) * r.n + top + p] = b.d[q * b.n + p];
      left += widths[j];
    });
    top += heights[i];
  });
  return r;
}
function part(a, r0, rows, c0, columns) {
  const r = mat(rows, columns);
  for (let j = 0; j < columns; j++) for (let i = 0; i < rows; i++) r.d[j * rows + i] = a.d[(c0 + j) * a.n + r0 + i];
  return r;
}
const take = (a, rows) => { const r = mat(rows.length, a.m); for (let j = 0; j < a.m; j++) rows.forEach((k, i) => { r.d[j * r.n + i] = a.d[j * a.n + k]; }); return r; };
// A X = B by elimination with the largest pivot
function solve(a, b) {
  const n = a.n, l = Float64Array.from(a.d), r = mat(n, b.m);
  r.d.set(b.d);
  for (let k = 0; k < n; k++) {
    let p = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(l[k * n + i]) > Math.abs(l[k * n + p])) p = i;
    if (p !== k) {
      for (let j = 0; j < n; j++) { const t = l[j * n + k]; l[j * n + k] = l[j * n + p]; l[j * n + p] = t; }
      for (let j = 0; j < b.m; j++) { const t = r.d[j * n + k]; r.d[j * n + k] = r.d[j * n + p]; r.d[j * n + p] = t; }
    }
    for (let i = k + 1; i < n; i++) {
      const s = l[k * n + i] / l[k * n + k];
      if (s === 0) continue;
      for (let j = k + 1; j < n; j++) l[j * n + i] -= s * l[j * n + k];
      for (let j = 0; j < b.m; j++) r.d[j * n + i] -= s * r.d[j * n + k];
    }
  }
  for (let j = 0; j < b.m; j++) for (let i = n - 1; i >= 0; i--) {
    let s = r.d[j * n + i];
    for (let k = i + 1; k < n; k++) s -= l[k * n + i] * r.d[j * n + k];
    r.d[j * n + i] = s / l[i * n + i];
  }
  return r;
}
// D^-1 A D with rows and columns of like size, D of powers of two (Parlett, Reinsch, Numer. Math. 13 (1969) 293)
function balanced(a) {
  const n = a.n, b = mat(n, n), d = new Float64Array(n).fill(1);
  b.d.set(a.d);
  for (let sweep = 0, moved = true; moved && sweep < 30; sweep++) {
    moved = false;
    for (let i = 0; i < n; i++) {
      let c = 0, r = 0;
      for (let j = 0; j < n; j++) if (j !== i) { c += Math.abs(b.d[i * n + j]); r += Math.abs(b.d[j * n + i]); }
      if (!c || !r) continue;
      const f = Math.pow(2, Math.round(Math.log2(r / c) / 2));
      if (f === 1) continue;
      moved = true; d[i] *= f;
      for (let j = 0; j < n; j++) { b.d[i * n + j] *= f; b.d[j * n + i] /= f; }
    }
  }
  return { b, d };
}
// exp(A): a diagonal Pade approximation of order 8, squared back (Golub, Van Loan, Matrix Computations, 9.3.1)
function expm(a) {
  const n = a.n, { b, d } = balanced(a);
  let norm = 0;
  for (let j = 0; j < n; j++) { let s = 0; for (let i = 0; i < n; i++) s += Math.abs(b.d[j * n + i]); norm = Math.max(norm, s); }
  const half = Math.max(0, Math.ceil(Math.log2(norm / 0.5)));
  const x = scale(b, Math.pow(2, -half)), q = 8;
  let power = eye(n), num = eye(n), den = eye(n), c = 1;
  for (let k = 1; k <= q; k++) {
    c *= (q - k + 1) / (k * (2 * q - k + 1));
    power = mul(x, power);
    num = sum(num, power, c); den = sum(den, power, k % 2 ? -c : c);
  }
  let r = solve(den, num);
  for (let k = 0; k < half; k++) r = mul(r, r);
  for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) r.d[j * n + i] *= d[i] / d[j];
  return r;
}
// C (z - A)^-1 b at many z: A is brought to Hessenberg form once by reflections, each z is one elimination
function hessenberg(a, b, c) {
  const n = a.n, even = balanced(a), h = even.b.d, g = b.d.map((v, i) => v / even.d[i]), o = mat(c.n, c.m);
  for (let j = 0; j < n; j++) for (let i = 0; i < c.n; i++) o.d[j * c.n + i] = c.d[j * c.n + i] * even.d[j];
  for (let k = 0; k < n - 2; k++) {
    let s = 0;
    for (let i = k + 1; i < n; i++) s += h[k * n + i] * h[k * n + i];
    s = Math.sqrt(s);
    if (s === 0) continue;
    const v = new Float64Array(n);
    for (let i = k + 1; i < n; i++) v[i] = h[k * n + i];
    v[k + 1] += v[k + 1] < 0 ? -s : s;
    let w = 0;
    for (let i = k + 1; i < n; i++) w += v[i] * v[i];
    if (w === 0) continue;
    const left = (x, off) => { let t = 0; for (let i = k + 1; i < n; i++) t += v[i] * x[off + i]; t *= 2 / w; for (let i = k + 1; i < n; i++) x[off + i] -= t * v[i]; };
    for (let j = 0; j < n; j++) left(h, j * n);
    left(g, 0);
    const right = (x, rows) => { for (let i = 0; i < rows; i++) { let t = 0; for (let j = k + 1; j < n; j++) t += x[j * rows + i] * v[j]; t *= 2 / w; for (let j = k + 1; j < n; j++) x[j * rows + i] -= t * v[j]; } };
    right(h, n); right(o.d, o.n);
  }
  return { n, h, g, c: o };
}
// values of every output, re and im, at angles w T of z = exp(i w T)
function responses(f, angles) {
  const n = f.n, N = angles.length, outs = f.c.n, re = [], im = [];
  for (let o = 0; o < outs; o++) { re.push(new Float64Array(N)); im.push(new Float64Array(N)); }
  const ur = new Float64Array(n * n), ui = new Float64Array(n * n), xr = new Float64Array(n), xi = new Float64Array(n);
  for (let p = 0; p < N; p++) {
    const zr = Math.cos(angles[p]), zi = Math.sin(angles[p]);
    for (let i = 0; i < n; i++) { xr[i] = f.g[i]; xi[i] = 0; }
    // column-major copies of z - H, upper part and one below
    for (let j = 0; j < n; j++) for (let i = 0; i <= Math.min(j + 1, n - 1); i++) { ur[j * n + i] = (i === j ? zr : 0) - f.h[j * n + i]; ui[j * n + i] = i === j ? zi : 0; }
    for (let k = 0; k < n - 1; k++) {
      const kk = k * n + k, lr = ur[kk + 1], li = ui[kk + 1];
      if (Math.abs(ur[kk]) + Math.abs(ui[kk]) < Math.abs(lr) + Math.abs(li)) {
        for (let j = k; j < n; j++) { const q = j * n + k; let t = ur[q]; ur[q] = ur[q + 1]; ur[q + 1] = t; t = ui[q]; ui[q] = ui[q + 1]; ui[q + 1] = t; }
        let t = xr[k]; xr[k] = xr[k + 1]; xr[k + 1] = t; t = xi[k]; xi[k] = xi[k + 1]; xi[k + 1] = t;
      }
      const dr = ur[kk], di = ui[kk], dd = dr * dr + di * di, er = ur[kk + 1], ei = ui[kk + 1];
      if (er === 0 && ei === 0) continue;
      const sr = (er * dr + ei * di) / dd, si = (ei * dr - er * di) / dd;
      for (let j = k + 1; j < n; j++) { const q = j * n + k; ur[q + 1] -= sr * ur[q] - si * ui[q]; ui[q + 1] -= sr * ui[q] + si * ur[q]; }
      xr[k + 1] -= sr * xr[k] - si * xi[k]; xi[k + 1] -= sr * xi[k] + si * xr[k];
    }
    for (let i = n - 1; i >= 0; i--) {
      let ar = xr[i], ai = xi[i];
      for (let j = i + 1; j < n; j++) { const q = j * n + i; ar -= ur[q] * xr[j] - ui[q] * xi[j]; ai -= ur[q] * xi[j] + ui[q] * xr[j]; }
      const q = i * n + i, dr = ur[q], di = ui[q], dd = dr * dr + di * di;
      xr[i] = (ar * dr + ai * di) / dd; xi[i] = (ai * dr - ar * di) / dd;
    }
    for (let o = 0; o < outs; o++) {
      let ar = 0, ai = 0;
      for (let j = 0; j < n; j++) { const s = f.c.d[j * outs + o]; ar += s * xr[j]; ai += s * xi[j]; }
      re[o][p] = ar; im[o][p] = ai;
    }
  }
  return { re, im };
}
// the largest absolute eigenvalue, by squaring: |A^(2^k)|^(1/2^k)
function radius(a) {
  let x = a, log = 0;
  for (let k = 0; k < 24; k++) {
    let s = 0;
    for (let i = 0; i < x.d.length; i++) s = Math.max(s, Math.abs(x.d[i]));
    if (!(s > 0) || !isFinite(s)) return s > 0 ? Infinity : 0;
    x = scale(x, 1 / s); log += Math.log(s) / Math.pow(2, k);
    if (k < 23) x = mul(x, x);
  }
  return Math.exp(log);
}
