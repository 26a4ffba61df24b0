/**
 * Page of the notebook's widget: buttons, mesh_view.js and a line of readings. Asks for the next shape only
 * when one has come, with the newest drag; the kernel keeps all that counts.
 */
const STYLE = `
  .apd { display: flex; flex-direction: column; font: 13px/1.4 system-ui, sans-serif; color: inherit; max-width: 100%;
    --line: color-mix(in srgb, currentColor 22%, transparent); --soft: color-mix(in srgb, currentColor 9%, transparent); }
  .apd-bar { display: flex; flex-wrap: wrap; align-items: center; gap: 6px; padding: 4px 0 6px; }
  .apd-tools { display: inline-flex; flex-wrap: wrap; border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
  .apd button { all: unset; box-sizing: border-box; display: inline-flex; align-items: center; gap: 6px; padding: 4px 10px;
    min-height: 28px; cursor: pointer; color: inherit; white-space: nowrap; }
  .apd-tools button + button { border-left: 1px solid var(--line); }
  .apd-end button { border: 1px solid var(--line); border-radius: 8px; }
  .apd button:hover { background: var(--soft); }
  .apd button[aria-pressed="true"] { background: color-mix(in srgb, currentColor 17%, transparent); font-weight: 600; }
  .apd button:focus-visible { outline: 2px solid; outline-offset: -2px; }
  .apd button:disabled { opacity: 0.4; cursor: default; background: none; }
  .apd-dot { width: 10px; height: 10px; border-radius: 50%; box-shadow: 0 0 0 1px var(--line); }
  .apd-size { display: inline-flex; align-items: center; gap: 6px; opacity: 0.9; }
  .apd-size input { width: 90px; accent-color: currentColor; }
  .apd-end { display: inline-flex; gap: 6px; margin-left: auto; }
  .apd-view { position: relative; height: 480px; border: 1px solid var(--line); border-radius: 8px; overflow: hidden; }
  .apd-brush { position: absolute; pointer-events: none; border: 1.5px solid; border-radius: 50%; box-sizing: border-box;
    translate: -50% -50%; box-shadow: 0 0 0 1px color-mix(in srgb, Canvas 60%, transparent); display: none; }
  .apd-line { display: flex; flex-wrap: wrap; gap: 2px 14px; padding: 6px 2px 2px; min-height: 1.4em;
    font-variant-numeric: tabular-nums; }
  .apd-line b { font-weight: 600; }
  .apd-quiet { opacity: 0.72; }
  .apd-problem { color: #c8372d; }
  .apd-dark .apd-problem { color: #ff9186; }`;

const LEGIBLE = 250; // milliseconds between readings, which change the layout of the page
const BASE = 0, FREE = 1, HANDLE = 2, MOST_HANDLES = 8;

function render({ model, el }) {
  const make = (name, parent, tag = "div") => {
    const made = document.createElement(tag);
    made.className = name;
    parent.append(made);
    return made;
  };
  const root = make("apd", el);
  make("", root, "style").textContent = STYLE;
  const bar = make("apd-bar", root), box = make("apd-view", root), line = make("apd-line", root);
  const name = String(Math.random());
  let view = null, texts, colors, labels, positions, triangles, told = {};
  let tool = -1, active = HANDLE, size = 28; // -1 drags, else the label that the brush paints
  let waiting = 0, wanted = null, drag = null, stroke = null, saying = 0;
  const queue = []; // strokes and the like, which all count

  // Two requests at a time, so that the way to the kernel and back costs no shapes; of drags only the newest

  function ask() {
    if (waiting > 1 || !view) return;
    const next = queue.shift() ?? (wanted && { ...wanted, op: "drag" }) ?? (told.isAtWork && { op: "next" });
    if (!next) return;
    if (next.op === "drag") wanted = null;
    waiting += 1;
    const { bytes, ...message } = next;
    model.send({ ...message, view: name, number: told.number ?? 0 }, undefined, bytes ? [bytes.buffer] : []);
    ask();
  }

  function take(message, buffers) {
    if (message.wake) { told.isAtWork = true; return ask(); }
    if (message.hello && message.view !== name) return;
    const arrays = buffers.map((b) => b.buffer.slice(b.byteOffset, b.byteOffset + b.byteLength));
    if (message.view === name && !message.hello) waiting = Math.max(waiting - 1, 0);
    told = message;
    if (!message.hello) ask(); // before anything is drawn
    if (message.labels) {
      labels = new Uint8Array(arrays[0]);
      positions = new Float32Array(arrays[1]);
      if (message.hello) begin(message, arrays);
      if (!view) return;
      view.setPositions(positions);
      paintColors();
      buttons();
    } else if (arrays.length && view) {
      positions = new Float32Array(arrays[0]);
      view.setPositions(positions);
    }
    if (!drag) gizmo();
    saying ||= setTimeout(say, told.isAtWork ? LEGIBLE : 0);
    ask();
  }

  function begin(message, arrays) {
    ({ texts, colors } = message);
    triangles = new Uint32Array(arrays[3]);
    view?.dispose();
    view = createMeshView(box, { positions: new Float32Array(arrays[2]), triangles, label: texts.view, margin: 1.45 });
    if (!view) { line.textContent = texts.noView; return; }
    view.onPress = press;
    box.meshView = view; // for scripts of the page
    tool = Object.keys(message.places).length && !message.hint ? -1 : BASE;
  }

  // Handles

  function gizmo() {
    const place = tool < 0 ? told.places[active] ?? Object.values(told.places)[0] : null;
    if (place && !told.places[active]) active = Number(Object.keys(told.places)[0]);
    if (!place || told.hint) return view.setGizmo(null);
    view.setGizmo(place, (matrix, state) => {
      if (state === "start") { drag = { label: active, begins: true }; return; }
      if (state === "move") {
        wanted = { label: drag.label, matrix: [...matrix], begins: drag.begins || (wanted?.begins ?? false) };
        drag.begins = false;
        ask();
      } else {
        drag = null;
      }
    });
  }

  // Brush: the stroke is coloured here, and becomes a message when it ends

  function press(x, y) {
    if (tool < 0) {
      const hit = view.pick(x, y), label = hit ? labels[hit.vertex] : FREE;
      if (label >= HANDLE && label !== active) { active = label; gizmo(); buttons(); return { move() {}, end() {} }; }
      return null;
    }
    if (!view.pick(x, y)) return null; // beside the mesh the view turns
    stroke = new Set();
    dab(x, y);
    let [px, py] = [x, y];
    return {
      move(nx, ny) {
        const steps = Math.max(1, Math.ceil(Math.hypot(nx - px, ny - py) / Math.max(size / 3, 3)));
        for (let k = 1; k <= steps; k++) dab(px + (nx - px) * k / steps, py + (ny - py) * k / steps);
        [px, py] = [nx, ny];
      },
      end() {
        if (stroke?.size) queue.push({ op: "paint", label: tool, bytes: Uint32Array.from(stroke) });
        stroke = null;
        ask();
      },
    };
  }

  function dab(x, y) {
    const hit = view.pick(x, y);
    if (!hit) return;
    const radius = size * hit.unitsPerPixel, [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * hit.triangle + k]);
    const P = positions, normal = cross3(P, a, b, c), [cx, cy, cz] = hit.point;
    stroke.add(hit.vertex);
    for (let t = 0; t < triangles.length; t += 3) { // triangles that face the same way: not the wall's other side
      for (let k = 0; k < 3; k++) {
        const v = triangles[t + k], i = 3 * v;
        if (stroke.has(v) || (P[i] - cx) ** 2 + (P[i + 1] - cy) ** 2 + (P[i + 2] - cz) ** 2 > radius * radius) continue;
        const n = cross3(P, 3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]);
        if (n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2] > 0) stroke.add(v);
      }
    }
    for (const v of stroke) labels[v] = tool;
    paintColors();
  }

  function cross3(P, a, b, c) {
    const u = [0, 1, 2].map((k) => P[b + k] - P[a + k]), v = [0, 1, 2].map((k) => P[c + k] - P[a + k]);
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  }

  function paintColors() {
    const rgb = new Uint8Array(3 * labels.length);
    labels.forEach((label, v) => rgb.set(colors[label], 3 * v));
    view.setColors(rgb);
  }

  // Buttons and readings

  function buttons() {
    const used = Object.keys(told.places).map(Number), isDrag = tool < 0;
    const more = Math.min(Math.max(HANDLE - 1, ...used) + 1, HANDLE + MOST_HANDLES - 1);
    const parts = [...new Set([...used, more])].sort((a, b) => a - b);
    bar.replaceChildren();
    const tools = make("apd-tools", bar);
    const button = (parent, text, click, color) => {
      const made = make("", parent, "button");
      made.type = "button";
      if (color) make("apd-dot", made, "span").style.background = `rgb(${color})`;
      made.append(text);
      made.addEventListener("click", click);
      return made;
    };
    const choose = (label, text, color) => {
      const made = button(tools, text, () => { tool = label; if (label >= HANDLE) active = label; buttons(); gizmo(); }, color);
      made.setAttribute("aria-pressed", tool === label);
    };
    choose(-1, texts.drag);
    choose(BASE, texts.base, colors[BASE]);
    for (const label of parts) choose(label, texts.handle.replace("{k}", label - HANDLE + 1), colors[label]);
    choose(FREE, texts.erase, colors[FREE]);
    if (!isDrag) {
      const label = make("apd-size", bar, "label"), input = make("", label, "input");
      label.prepend(texts.size);
      Object.assign(input, { type: "range", min: 4, max: 90, value: size });
      input.addEventListener("input", () => { size = Number(input.value); });
    }
    const end = make("apd-end", bar);
    button(end, texts.undo, () => { queue.push({ op: "undo" }); ask(); }).disabled = !told.canUndo;
    button(end, texts.fit, () => view.fit());
    view.cursor = isDrag ? "grab" : "crosshair";
    brush.style.display = "none";
  }

  function say() {
    saying = 0;
    root.classList.toggle("apd-dark", parseInt(getComputedStyle(root).color.match(/\d+/)[0]) > 140);
    const undo = bar.querySelector(".apd-end button");
    if (undo) undo.disabled = !told.canUndo;
    line.replaceChildren();
    if (told.problem) { make("apd-problem", line, "span").textContent = told.problem; return; }
    if (told.hint) { line.append(told.hint); return; }
    if (told.area) {
      const area = make("", line, "span");
      area.append(texts.area + " ");
      make("", area, "b").textContent = told.area;
    }
    make("apd-quiet", line, "span").textContent = told.method;
    make("apd-quiet", line, "span").textContent = told.state;
  }

  const brush = make("apd-brush", box);
  box.addEventListener("pointermove", (event) => {
    const { left, top } = box.getBoundingClientRect();
    const isShown = tool >= 0 && event.pointerType !== "touch";
    Object.assign(brush.style, {
      display: isShown ? "block" : "none", left: `${event.clientX - left}px`, top: `${event.clientY - top}px`,
      width: `${2 * size}px`, height: `${2 * size}px`,
    });
  });
  box.addEventListener("pointerleave", () => { brush.style.display = "none"; });

  model.on("msg:custom", take);
  model.send({ op: "hello", view: name });
  return () => { model.off("msg:custom", take); view?.dispose(); };
}

export default { render };
