// Pictures on canvas: axes, curves, the circle. Sizes in CSS pixels.
"use strict";
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
function surface(id) {
  const canvas = document.getElementById(id), ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = "12px system-ui, sans-serif";
  return { g, w, h };
}
// round steps of 1, 2, 5 over a range
function ticks(low, high, about) {
  const raw = (high - low) / about, power = Math.pow(10, Math.floor(Math.log10(raw))), step = [1, 2, 5, 10].find((s) => s * power >= raw) * power, found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}
const plain = (v) => String(Math.abs(v) < 1e-12 ? 0 : +v.toPrecision(6)).replace("-", "\u2212");
// a frame with scales; x may be logarithmic; returns how to draw in it
function frame(s, box, x, y) {
  const { g } = s, { left, top, width, height } = box;
  const fx = x.log ? (v) => left + width * Math.log(v / x.low) / Math.log(x.high / x.low) : (v) => left + width * (v - x.low) / (x.high - x.low);
  const fy = (v) => top + height * (y.high - v) / (y.high - y.low);
  g.lineWidth = 1; g.strokeStyle = colour("line"); g.fillStyle = colour("soft");
  const line = (x0, y0, x1, y1) => { g.beginPath(); g.moveTo(x0, y0); g.lineTo(x1, y1); g.stroke(); };
  const across = x.ticks || (x.log ? [1, 3, 10, 30, 100, 300, 1000, 3000].filter((f) => f >= x.low && f <= x.high) : ticks(x.low, x.high, Math.max(2, width / 65)));
  g.textAlign = "center"; g.textBaseline = "top";
  for (const v of across) { line(fx(v), top, fx(v), top + height); if (x.label) g.fillText(plain(v), fx(v), top + height + 4); }
  g.textAlign = "right"; g.textBaseline = "middle";
  for (const v of y.ticks || ticks(y.low, y.high, Math.max(2, height / 42))) { line(left, fy(v), left + width, fy(v)); g.fillText(plain(v), left - 6, fy(v)); }
  if (x.label) { g.textAlign = "right"; g.textBaseline = "top"; g.fillText(x.label, left + width, top + height + 20); }
  g.save(); g.translate(12, top + height / 2); g.rotate(-Math.PI / 2); g.textAlign = "center"; g.textBaseline = "middle"; g.fillText(y.label, 0, 0); g.restore();
  const numbers = []; // places of the numbers of margins: where two would lie on each other, the later stands lower
  const within = (draw) => { g.save(); g.beginPath(); g.rect(left, top, width, height); g.clip(); draw(); g.restore(); };
  return {
    curve(xs, ys, name, wide = 1.8, jump = Infinity) {
      within(() => {
        g.strokeStyle = colour(name); g.lineWidth = wide; g.lineJoin = "round"; g.beginPath();
        for (let i = 0; i < xs.length; i++) { const p = fx(xs[i]), q = fy(ys[i]); if (!i || Math.abs(ys[i] - ys[i - 1]) > jump) g.moveTo(p, q); else g.lineTo(p, q); }
        g.stroke();
      });
    },
    level(v, name, dash = [5, 4]) { within(() => { g.strokeStyle = colour(name); g.setLineDash(dash); line(left, fy(v), left + width, fy(v)); g.setLineDash([]); }); },
    span(at, from, to, name, text) { // a margin: a thick line with its number
      if (!(at >= x.low && at <= x.high)) return;
      within(() => {
        g.strokeStyle = colour(name); g.lineWidth = 3; line(fx(at), fy(from), fx(at), fy(to)); g.lineWidth = 1;
        g.fillStyle = colour(name); g.font = "600 12px system-ui, sans-serif"; g.textBaseline = "middle";
        const wide = g.measureText(text).width, right = fx(at) > left + width - wide - 12; g.textAlign = right ? "right" : "left";
        const px = fx(at) + (right ? -7 : 7), begin = right ? px - wide : px;
        let py = Math.min(top + height - 9, Math.max(top + 9, (fy(from) + fy(to)) / 2));
        for (const n of numbers) if (Math.abs(n.py - py) < 16 && begin < n.end + 6 && n.begin < begin + wide + 6) py = n.py + (n.py + 25 < top + height ? 16 : -16);
        numbers.push({ py, begin, end: begin + wide });
        g.globalAlpha = 0.85; g.fillStyle = colour("paper"); g.fillRect(px - (right ? wide + 2 : 2), py - 8, wide + 4, 16); g.globalAlpha = 1;
        g.fillStyle = colour(name); g.fillText(text, px, py); g.font = "12px system-ui, sans-serif";
      });
    },
  };
}
const decibels = (v) => Array.from(v.re, (r, i) => 10 * Math.log10(r * r + v.im[i] * v.im[i]));
const phases = (v) => Array.from(v.re, (r, i) => Math.atan2(v.im[i], r) * 180 / Math.PI);
function drawBode(now, ghost) {
  const s = surface("bode"), left = 58, width = s.w - left - 10, upper = Math.round((s.h - 58) * 0.58), lower = s.h - 58 - upper;
  const x = { log: true, low: 1, high: 4000 };
  const size = frame(s, { left, top: 6, width, height: upper }, x, { low: -60, high: 60, label: "magnitude [dB]", ticks: [-60, -40, -20, 0, 20, 40, 60] });
  const turn = frame(s, { left, top: upper + 18, width, height: lower }, { ...x, label: "frequency [Hz]" }, { low: -185, high: 185, label: "phase [°]", ticks: [-180, -90, 0, 90, 180] });
  size.level(0, "soft"); turn.level(-180, "soft"); turn.level(180, "soft");
  for (const [one, faint] of [[ghost, true], [now, false]]) {
    if (!one) continue;
    for (const [loop, name] of [["position", "p"], ["velocity", "v"]]) {
      const v = one[loop], look = faint ? "ghost" : name, wide = faint ? 1.2 : 1.8;
      size.curve(v.frequency, decibels(v), look, wide); turn.curve(v.frequency, phases(v), look, wide, 180);
    }
  }
  if (!now) return;
  for (const [loop, name] of [["position", "p"], ["velocity", "v"]]) {
    const m = now[loop].margins;
    size.span(m.gain_frequency, 0, -m.gain, name, m.gain.toFixed(1) + " dB");
    turn.span(m.phase_frequency, -180, -180 + m.phase, name, m.phase.toFixed(0) + "°");
  }
}
function drawStep(E, now, ghost) {
  const s = surface("step"), runs = [ghost, now].filter(Boolean), shown = (r) => Array.from(r.table, (v) => 1e6 * r.side * (v - r.start));
  const times = Array.from({ length: E.step.ticks }, (_, i) => 1e3 * i * E.tick);
  let high = 25, low = -2;
  for (const r of runs) for (const v of shown(r)) { high = Math.min(60, Math.max(high, v + 1)); low = Math.max(-20, Math.min(low, v - 1)); }
  const f = frame(s, { left: 58, top: 8, width: s.w - 68, height: s.h - 52 }, { low: 0, high: times[times.length - 1], label: "time [ms]" }, { low, high, label: "table position [µm]" });
  f.level(1e6 * E.step.height, "soft");
  if (ghost) f.curve(times, shown(ghost), "ghost", 1.2);
  if (now) f.curve(times, shown(now), "v");
}
function drawCircle(E, now, ghost) {
  const s = surface("circle"), { g } = s, cx = s.w / 2, cy = s.h / 2, R = Math.min(s.w, s.h) / 2 - 22, ring = 0.62 * R;
  let most = 0.5e-6;
  for (const r of [ghost, now]) if (r) for (const v of r.radial) most = Math.max(most, Math.abs(v));
  const steps = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 5000], unit = steps.find((v) => 1e6 * most <= 2 * v) || 1e4, room = (R - ring) / 2;
  g.strokeStyle = colour("line"); g.fillStyle = colour("soft"); g.lineWidth = 1;
  for (const k of [-2, -1, 0, 1, 2]) {
    g.setLineDash(k ? [] : [5, 4]); g.strokeStyle = colour(k ? "line" : "soft"); g.beginPath(); g.arc(cx, cy, ring + k * room, 0, 2 * Math.PI); g.stroke();
    if (k) { g.textAlign = "center"; g.textBaseline = "middle"; g.fillText((k > 0 ? "+" : "\u2212") + plain(Math.abs(k) * unit) + (k === 2 ? " µm" : ""), cx, cy - ring - k * room); }
  }
  g.setLineDash([]);
  for (const [one, name, wide] of [[ghost, "ghost", 1.2], [now, "v", 1.8]]) {
    if (!one) continue;
    g.strokeStyle = colour(name); g.lineWidth = wide; g.beginPath();
    const last = E.circle.angle[E.circle.angle.length - 1], from = E.circle.angle.findIndex((a) => a >= last - 2 * Math.PI);
    one.radial.forEach((v, i) => { if (i < from) return; const a = E.circle.angle[i], r = ring + 1e6 * v / unit * room, x = cx + r * Math.sin(a), y = cy - r * Math.cos(a); if (i > from) g.lineTo(x, y); else g.moveTo(x, y); });
    g.stroke();
  }
  g.fillStyle = colour("soft"); g.textBaseline = "middle";
  g.textAlign = "left"; g.fillText("axis reverses", Math.min(cx + R + 4, s.w - 78), cy - 10);
  if (!now) { g.textAlign = "center"; g.fillText("no motion", cx, cy); }
}
