// Sliders, what they change, and the controller file. A change is drawn in the next frame; the circle after it where slow.
"use strict";
function startPage() {
  const E = JSON.parse(document.getElementById("data").textContent);
  E.inertia = E.inertia || 0;
  for (const p of Object.keys(E)) if (E[p] === null && p === "torque_limit") E[p] = Infinity;
  const S = JSON.parse(JSON.stringify(E.start)), first = JSON.parse(JSON.stringify(E.start));
  const state = document.getElementById("state"), controls = document.getElementById("controls"), rows = [];
  let ghost = null, waiting = false, slow = 0, later = 0;

  const show = (v) => (Math.abs(v) >= 1e4 || (Math.abs(v) < 1e-3 && v !== 0) ? v.toExponential(3) : String(+v.toPrecision(4)));
  function group(title, parent = controls, folded = false) {
    const box = document.createElement(folded ? "details" : "fieldset"), head = document.createElement(folded ? "summary" : "legend");
    head.textContent = title; box.append(head); parent.append(box);
    return box;
  }
  // one value: a slider, logarithmic where `log`, and the number, which may be typed
  function slider(box, name, unit, per, low, high, get, set, log = false) {
    unit = unit === "1" ? "" : unit;
    const label = document.createElement("label"), text = document.createElement("span"), right = document.createElement("span"), typed = document.createElement("input"), range = document.createElement("input"), u = document.createElement("span");
    text.textContent = name; u.textContent = unit; u.className = "unit"; typed.className = "typed"; typed.inputMode = "decimal"; typed.setAttribute("aria-label", name + " " + unit);
    range.type = "range"; range.min = 0; range.max = 1000; range.step = 1; range.setAttribute("aria-label", name);
    right.append(typed, u); label.append(text, right, range); box.append(label);
    const value = (k) => (log ? low * Math.pow(high / low, k / 1000) : low + (high - low) * k / 1000);
    const place = (v) => Math.round(1000 * (log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low)));
    const refresh = () => { range.value = place(get()); if (document.activeElement !== typed) typed.value = show(get() * per); };
    range.addEventListener("input", () => { set(+(value(+range.value)).toPrecision(4)); typed.value = show(get() * per); changed(); });
    typed.addEventListener("change", () => { const v = parseFloat(typed.value.replace(",", ".")) / per; if (isFinite(v) && (!log || v > 0)) { set(v); changed(); } refresh(); });
    rows.push(refresh); refresh();
    return label;
  }
  function build() {
    const gains = group("Gains"), wide = (v) => [v / 8, v * 4];
    slider(gains, "K_p", "N m s/rad", 1, ...wide(first.velocity_gain), () => S.velocity_gain, (v) => { S.velocity_gain = v; }, true);
    slider(gains, "T_n", "ms", 1e3, ...wide(Math.min(first.reset_time, 0.1)), () => S.reset_time, (v) => { S.reset_time = v; }, true);
    slider(gains, "K_v", "(m/min)/mm", 0.06, ...wide(first.position_gain), () => S.position_gain, (v) => { S.position_gain = v; }, true);
    slider(gains, "speed feed-forward", "%", 100, 0, 1.2, () => S.speed_share, (v) => { S.speed_share = v; });
    slider(gains, "torque feed-forward", "%", 100, 0, 1.2, () => S.torque_share, (v) => { S.torque_share = v; });
    S.filters.forEach((f, i) => {
      const box = group("Torque filter " + (i + 1)), pick = document.createElement("select");
      pick.setAttribute("aria-label", "kind of filter " + (i + 1));
      for (const [kind, name] of [["none", "none"], ["notch", "notch"], ["PT2", "low-pass PT2"]]) { const o = document.createElement("option"); o.value = kind; o.textContent = name; pick.append(o); }
      box.append(pick);
      const parts = [
        slider(box, "frequency", "Hz", 1, 20, 0.4 / E.tick, () => f.frequency, (v) => { f.frequency = v; }, true),
        slider(box, "damping", "1", 1, 0.01, 1.5, () => f.damping, (v) => { f.damping = v; }, true),
        slider(box, "depth", "dB", 1, 1, 60, () => f.depth, (v) => { f.depth = v; }, true),
      ];
      const shown = () => { pick.value = f.kind; parts.forEach((p, k) => p.classList.toggle("off", f.kind === "none" || (k === 2 && f.kind === "PT2"))); };
      pick.addEventListener("change", () => { f.kind = pick.value; shown(); changed(); });
      rows.push(shown); shown();
    });
    const machine = group("Machine");
    if (E.stroke) slider(machine, "table position", "mm", 1e3, E.stroke[0], E.stroke[1], () => S.position, (v) => { S.position = v; });
    slider(machine, "payload", "kg", 1, 0, E.most_payload, () => S.payload, (v) => { S.payload = v; });
    const found = E.effects.filter((e) => e.found), declared = E.effects.filter((e) => !e.found);
    for (const [title, list, folded] of [["Effects found", found, false], ["Declared effects", declared, found.length > 0]]) {
      if (!list.length) continue;
      const outer = folded ? group(title, controls, true) : group(title);
      for (const e of list) {
        const box = group(e.label, outer, true);
        box.open = e.found;
        for (const one of e.sliders) {
          const start = E.values[one.place];
          slider(box, one.key.replace(/_/g, " "), one.unit, one.per, Math.min(0, 2 * start), Math.max(0, 2 * start), () => (one.place in S.values ? S.values[one.place] : start), (v) => { S.values[one.place] = v; });
        }
      }
    }
    const last = group("Settings"), button = (text, act, main) => { const b = document.createElement("button"); b.type = "button"; b.textContent = text; if (main) b.className = "main"; b.addEventListener("click", act); last.append(b); };
    button("Save controller.toml", save, true);
    button("Back to the start", () => { Object.assign(S, JSON.parse(JSON.stringify(first)), { filters: S.filters }); S.filters.forEach((f, i) => Object.assign(f, first.filters[i])); rows.forEach((r) => r()); changed(); });
  }
  function save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([controllerText(E, S)], { type: "text/plain" }));
    link.download = "controller.toml"; link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  function changed() { if (!waiting) { waiting = true; requestAnimationFrame(draw); } }
  function draw(atOnce) {
    waiting = false;
    const begin = performance.now();
    let loops = null, step = null;
    try { loops = computeLoops(E, S); if (loops && loops.stable) step = computeStep(E, S); } catch (error) { loops = null; }
    drawBode(loops, ghost && ghost.loops); drawStep(E, step, ghost && ghost.step);
    const circle = () => {
      const ran = loops && loops.stable ? computeCircle(E, S) : null, start = performance.now();
      drawCircle(E, ran, ghost && ghost.circle); tell(loops, step, ran);
      if (!ghost) ghost = { loops, step, circle: ran };
      return start;
    };
    clearTimeout(later);
    if (slow > 25 && atOnce !== true) later = setTimeout(() => { const t = performance.now(); circle(); slow = performance.now() - t; }, 0);
    else { const t = performance.now(); circle(); slow = performance.now() - t; }
    bench.took = performance.now() - begin;
  }
  function tell(loops, step, circle) {
    state.className = !loops || !loops.stable ? "bad" : "";
    state.textContent = !loops ? "No steady motion with these settings." : !loops.stable ? "The loop is unstable: nothing is run." : step && circle ? "" : "The motion did not end.";
    const table = document.getElementById("numbers"), um = (v) => (1e6 * v).toFixed(2) + " µm";
    const now = [loops, step && step.figures, circle], old = ghost ? [ghost.loops, ghost.step && ghost.step.figures, ghost.circle] : [null, null, null];
    const line = ([l, s, c]) => [
      l ? l.velocity.margins.phase.toFixed(1) + "°" : "–", l ? l.velocity.margins.gain.toFixed(1) + " dB" : "–",
      l ? l.position.margins.phase.toFixed(1) + "°" : "–", l ? l.position.margins.gain.toFixed(1) + " dB" : "–",
      s ? (s.settling === null ? "not settled" : (1e3 * s.settling).toFixed(1) + " ms") : "–", c ? um(c.deviation) : "–", c ? um(Math.max(...c.glitch.map(Math.abs))) : "–"];
    const heads = ["", ["velocity loop", 2], ["position loop", 2], "settling", "circle", "glitch"];
    table.replaceChildren();
    const add = (cells, tag, mark) => { const tr = document.createElement("tr"); cells.forEach((t, i) => { const td = document.createElement(tag); if (Array.isArray(t)) { td.colSpan = t[1]; td.textContent = t[0]; } else td.textContent = t; if (mark && mark(i)) td.className = "bad"; tr.append(td); }); table.append(tr); };
    add(heads, "th");
    const low = loops ? [loops.velocity.margins.phase < 30, loops.velocity.margins.gain < 6, loops.position.margins.phase < 30, loops.position.margins.gain < 6] : [];
    add(["now", ...line(now)], "td", (i) => low[i - 1]);
    if (old[0]) add(["at the start", ...line(old)], "td");
  }
  bench.E = E; bench.S = S; bench.changed = changed; bench.draw = draw;
  build();
  draw();
  window.addEventListener("resize", changed);
  if (window.matchMedia) window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
// the controller file that holds the settings (simulate/scenario_controller.py)
function controllerText(E, S) {
  const number = (v) => String(+v.toPrecision(12));
  const lines = [
    'format = "feeddrive-controller/1"', "name = " + JSON.stringify("from the bench of " + E.name).replace(/[\u007f-\uffff]/g, (c) => "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0")),
    ...E.controller, `position_gain = "${number(S.position_gain)} 1/s"`, `velocity_gain = "${number(S.velocity_gain)} N m s/rad"`,
    `reset_time = "${number(1e3 * S.reset_time)} ms"`, "", "[feed_forward]", `speed = ${S.speed_share.toFixed(6)}`, `torque = ${S.torque_share.toFixed(6)}`, `inertia = "${number(E.inertia)} kg m^2"`, ...E.feed_forward,
  ];
  for (const f of S.filters) {
    if (f.kind === "none") continue;
    lines.push("", "[[filter]]", 'at = "torque"', `kind = "${f.kind}"`, `frequency = "${number(f.frequency)} Hz"`);
    if (f.kind === "PT2") lines.push(`damping = "${number(f.damping)}"`);
    else lines.push(`bandwidth = "${number(2 * f.damping * f.frequency)} Hz"`, `depth = "${number(f.depth)} dB"`);
  }
  return lines.join("\n") + "\n";
}
if (typeof document !== "undefined") startPage();
