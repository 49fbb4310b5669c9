"use strict";
// The run of the page, computed by the core as a module of WebAssembly; its samples become those that the page plays.
const MANY = 4; // curves of a plot of which those that are zero are not shown
async function startRun() {
  const live = data.run, names = Object.keys(live.columns);
  const nothing = new Proxy({}, { get: () => () => 0 }); // functions of a system that the core does not call
  const made = await WebAssembly.instantiate(bytes(live.module), new Proxy({}, { get: () => nothing }));
  const core = made.instance.exports;
  if (core._initialize) core._initialize();
  const rows = live.rows, bodies = data.bodies.length, column = {};
  function look() { // the memory may have moved
    names.forEach((name, k) => {
      const width = live.columns[name], kind = live.integers.includes(name) ? Int32Array : Float64Array;
      column[name] = new kind(core.memory.buffer, core.page_column(k), rows * width);
    });
  }
  look();
  const text = document.querySelector("#title span"), chosen = {}, wanted = {};
  let code = live.goes_on, ends = live.until, message = "", filled = 0, ramping = [];

  function fillTimes() {
    for (let k = 0; k < rows; k++) column.t[k] = k * (ends / (rows - 1));
    column.t[rows - 1] = ends;
  }
  // which set of values of the parameters is chosen (export/slider_tables.py)
  const row = () => live.parameters.reduce((found, each) => found * each.values.length + chosen[each.name], 0);
  function writeNumbers() {
    if (!live.numbers) return;
    const { place, offset } = live.numbers, first = row() * place.length;
    place.forEach((array, i) => new Float64Array(core.memory.buffer, core.page_number(array) + 8 * offset[i], 1)[0] = numbers[first + i]);
  }
  const numbers = live.numbers ? new Float64Array(bytes(live.numbers.table)) : null;
  function showShapes() {
    for (const k in live.meshes) {
      const body = data.bodies[k], mesh = live.meshes[k][row()];
      body.vertices = floats(mesh.vertices); body.lines = floats(mesh.lines); body.normals = new Int8Array(bytes(mesh.normals));
      body.triangles = new (mesh.triangles.bytes === 2 ? Uint16Array : Uint32Array)(bytes(mesh.triangles.values));
      loadMesh(body);
    }
  }
  function begin() {
    message = ""; filled = 0; data.events.length = 0; ramping = [];
    core.page_init(); look(); fillTimes(); writeNumbers();
    live.inputs.forEach((input, k) => core.page_set_input(k, wanted[input.name]));
    const refused = core.page_begin();
    code = refused ? refused : live.goes_on;
    if (refused) message = `the start is refused: ${outcome(refused)}`;
    takeEvents();
    if (!refused) { code = core.page_advance(0, 0); if (code === 0) code = live.goes_on; takeEvents(); }
    end = ends; start = 0; now = 0; last = null;
    takeSamples(); chooseSpeed(); showEvents(); playing = !refused && !asked;
    if (asked) { // page.html#t=0.35
      const wished = +asked[1];
      while (goesOn() && reached() < wished) goTo(wished);
      now = Math.min(wished, reached()); asked = null;
    }
    play.textContent = playing ? "pause" : "play";
    refresh();
  }
  const outcome = number => live.outcomes[number] || `outcome ${number}`;
  const goesOn = () => code === live.goes_on || code === live.list_full;
  // the name of a contact; of a support point of a face, that of its pair
  const touching = (contact, pair) => live.contact_names[contact] || live.face_names[Math.floor((pair - live.feature_pairs) / live.support_points)] || "";
  const named = (kind, contact, pair) => (kind === live.load_switch ? live.switching_loads[contact] : touching(contact, pair));
  function takeEvents() {
    const count = core.page_events(), all = core.memory.buffer;
    if (!count) return;
    const [t, kind, contact, speed, pair] = [Float64Array, Int32Array, Int32Array, Float64Array, Int32Array].map((type, k) => new type(all, core.page_event(k), count));
    for (let k = 0; k < count; k++)
      data.events.push({ t: t[k], kind: live.event_kinds[kind[k]], contact: named(live.event_kinds[kind[k]], contact[k], pair[k]), speed: speed[k] });
    showEvents();
  }
  // computes until there is a sample at `target`, s, or the time for one picture is over
  function goTo(target) {
    const stop = performance.now() + 40;
    steer();
    while (goesOn() && sampled() < target && performance.now() < stop) {
      const until = ramping.length ? Math.min(ends, ...ramping.map(each => each.until)) : ends;
      code = core.page_advance(until, 1);
      takeEvents();
      if (code === 0 && until < ends) code = live.goes_on, settle();
    }
    takeSamples();
  }
  // inputs that change along a line reach what is wanted within the time of one picture
  function steer() {
    live.inputs.forEach((input, k) => {
      const value = core.page_input(k);
      if (value === wanted[input.name] || ramping.some(each => each.k === k)) return;
      if (!input.linear) { core.page_set_input(k, wanted[input.name]); return; }
      const span = Math.max(+speed.value / 30, 1e-6);
      core.page_set_rate(k, (wanted[input.name] - value) / span); ramping.push({ k, until: core.page_time() + span });
    });
  }
  function settle() {
    const there = ramping.filter(each => each.until <= core.page_time());
    for (const { k } of there) core.page_set_rate(k, 0);
    ramping = ramping.filter(each => !there.includes(each));
  }

  const sampled = () => { const count = core.page_samples(); return count ? column.t[count - 1] : 0; };
  // from the samples of the core to those of the page
  function takeSamples() {
    const count = core.page_samples();
    times = Float32Array.from(column.t.subarray(0, count));
    for (; filled < count; filled++) takeSample(filled);
    data.bodies.forEach(body => { body.p = body.places.subarray(0, 3 * count); body.q = body.turns.subarray(0, 4 * count); });
    for (const each of [...data.contacts, ...data.patches])
      for (const name in each.samples) each[name] = each.samples[name].subarray(0, each.widths[name] * count);
    measureForces();
    plots.forEach((plot, p) => {
      plot.curves = plotted[p].map(curve => curve.subarray(0, count));
      if (plot.curves.length > MANY) plot.labels.forEach((label, k) => { // of many, those that are something
        label.hidden = !plot.curves[k].some(x => x && isFinite(x));
        plot.idle[label.hidden ? "add" : "delete"](k);
      });
      plot.range();
    });
    tell(count);
  }
  const room = (owner, widths) => {
    owner.widths = widths; owner.samples = {};
    for (const name in widths) owner.samples[name] = new Float32Array(rows * widths[name]);
  };
  for (const body of data.bodies) body.places = new Float32Array(3 * rows), body.turns = new Float32Array(4 * rows);
  for (const contact of data.contacts) room(contact, { force: 1, gap: 1, point: 3, point_o: 3, normal: 3, friction: 3, on_o: 3, on_f: 3 });
  for (const patch of data.patches) room(patch, { force: 1, point: 3, friction: 3, curve: 3, on_other: 3 });
  const part = (name, width, k, index) => column[name].subarray((k * live.columns[name]) + width * index, (k * live.columns[name]) + width * (index + 1));
  const put = (owner, name, k, value) => owner.samples[name].set(value, k * owner.widths[name]);
  const nowhere = [NaN, NaN, NaN];
  function inAxes(k, body, point) {
    const pose = part("pose", 12, k, body), d = sub(point, pose), R = pose.subarray(3);
    return [dot(d, R), dot(d, R.subarray(3)), dot(d, R.subarray(6))];
  }
  function takeSample(k) {
    for (let b = 0; b < bodies; b++) {
      const pose = part("pose", 12, k, b);
      data.bodies[b].places.set(pose.subarray(0, 3), 3 * k); data.bodies[b].turns.set(quaternion(pose.subarray(3)), 4 * k);
    }
    data.contacts.forEach((contact, c) => {
      const index = contact.index, force = part("force", 1, k, index)[0], presses = force > 0;
      const ends = { o: part("point_o", 3, k, index), f: part("point_f", 3, k, index) };
      put(contact, "force", k, [force]); put(contact, "gap", k, part("gap", 1, k, index)); put(contact, "normal", k, part("normal", 3, k, index));
      put(contact, "friction", k, part("friction", 3, k, index)); put(contact, "point", k, ends.f); put(contact, "point_o", k, ends.o);
      for (const side of "of") put(contact, `on_${side}`, k, presses ? inAxes(k, contact[side], ends[side]) : nowhere);
    });
    data.patches.forEach(patch => {
      const slot = slotOf(patch.index, k);
      const pressure = slot < 0 ? [0, NaN, NaN, NaN] : part("pressure", 4, k, slot), point = Array.from(pressure).slice(1);
      put(patch, "force", k, [pressure[0]]); put(patch, "point", k, point);
      put(patch, "friction", k, slot < 0 ? [0, 0, 0] : part("patch_friction", 8, k, slot).subarray(0, 3));
      put(patch, "curve", k, slot < 0 ? nowhere : inAxes(k, patch.body, point));
      if (patch.other >= 0) put(patch, "on_other", k, slot < 0 ? nowhere : inAxes(k, patch.other, point));
    });
    data.plots.forEach((plot, p) => plot.sources.forEach((source, c) => plotted[p][c][k] = shownValue(source, k, plotted[p][c][k - 1])));
  }
  const plotted = data.plots.map(plot => plot.sources.map(() => new Float32Array(rows)));
  // an entry of a column, the length of three, an angle with whole turns counted, or what work does not explain of the
  // energy (view/plots.py); 0 of a patch that does not rest
  function shownValue([what, name, at, count], k, before) {
    if (what === "unexplained") return column.energy[k] - column.energy[0] - column.work[k];
    let first = at;
    if (what.endsWith("of patch")) {
      const slot = slotOf(at, k), width = live.columns[name] / live.columns.patch;
      if (slot < 0) return 0;
      first = slot * width + count;
    }
    const values = column[name].subarray(k * live.columns[name] + first, k * live.columns[name] + first + 3);
    if (what.startsWith("length")) return Math.hypot(...values);
    if (what === "angle" && isFinite(before)) return values[0] + 2 * Math.PI * Math.round((before - values[0]) / (2 * Math.PI));
    return values[0];
  }
  function slotOf(patch, k) {
    for (let slot = 0; slot < live.columns.patch; slot++) if (part("patch", 1, k, slot)[0] === patch) return slot;
    return -1;
  }
  function quaternion(R) { // of a matrix by columns
    const trace = R[0] + R[4] + R[8];
    const w = 1 + trace, x = 1 + R[0] - R[4] - R[8], y = 1 - R[0] + R[4] - R[8], z = 1 - R[0] - R[4] + R[8], most = Math.max(w, x, y, z);
    const q = most === w ? [w, R[5] - R[7], R[6] - R[2], R[1] - R[3]] : most === x ? [R[5] - R[7], x, R[1] + R[3], R[6] + R[2]]
      : most === y ? [R[6] - R[2], R[1] + R[3], y, R[5] + R[7]] : [R[1] - R[3], R[6] + R[2], R[5] + R[7], z];
    const n = Math.hypot(...q);
    return q.map(each => each / n);
  }
  function doubtsOf(code) { // in words
    const found = core.page_doubts(code), told = [];
    for (let doubt = 1; doubt <= found; doubt *= 2) if (found & doubt) told.push(textAt(core.page_doubt_text(doubt)));
    return told;
  }
  function textAt(place) {
    const bytes = new Uint8Array(core.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(place, bytes.indexOf(0, place)));
  }
  function tell(count) {
    const failed = core.page_failed_contact(), whose = live.contact_names[failed] ? ` (${live.contact_names[failed]})` : "";
    text.textContent = message || (goesOn() ? `computed up to t = ${core.page_time().toPrecision(6)} s, ${live.accuracy}`
      : code === 0 ? `done at t = ${core.page_time().toPrecision(6)} s, ${live.accuracy}`
      : `ended at t = ${core.page_time().toPrecision(6)} s: ${outcome(code)}${whose}`);
    const doubts = message || goesOn() ? [] : doubtsOf(code);
    if (doubts.length) text.textContent += `; not trusted: ${doubts.join("; ")}`;
    document.body.dataset.state = goesOn() ? "running" : "ended";
  }

  // controls
  const panel = document.createElement("section"); panel.id = "controls";
  document.getElementById("plots").prepend(panel);
  function control(name, label, given, changed) {
    const row = document.createElement("label"), head = document.createElement("span"), shownNumber = document.createElement("b"), box = document.createElement("input");
    Object.assign(box, { type: "range", min: given.low, max: given.high, step: given.step || "any", value: given.value }); box.dataset.name = name;
    head.textContent = label; const told = value => (given.told ? given.told(value) : value).toPrecision(4);
    shownNumber.textContent = told(+given.value); head.append(shownNumber); row.append(head, box); panel.append(row);
    box.oninput = () => { shownNumber.textContent = told(+box.value); changed(+box.value); };
  }
  const labelled = each => each.unit ? `${each.name} [${each.unit}] ` : `${each.name} `;
  for (const input of live.inputs) {
    wanted[input.name] = input.value;
    control(input.name, labelled(input), input, value => {
      wanted[input.name] = value;
      if (now < reached()) now = reached();
      if (!playing && goesOn()) play.click();
    });
  }
  for (const parameter of live.parameters) {
    const { name, own, values } = parameter;
    chosen[name] = own;
    control(name, labelled(parameter), { low: 0, high: values.length - 1, value: own, step: 1, told: k => values[k] },
      position => { chosen[name] = position; showShapes(); begin(); });
  }
  const reset = document.createElement("button"); reset.id = "reset"; reset.type = "button"; reset.textContent = "reset";
  reset.onclick = begin; document.getElementById("bar").prepend(reset);

  const reached = () => (times.length ? times[times.length - 1] : 0);
  run = { reached, goesOn, goTo, core, column };
  begin();
}
startRun().catch(error => { document.querySelector("#title span").textContent = `the run does not start: ${error.message}`; throw error; });
