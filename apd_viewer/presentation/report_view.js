/** Shows the shapes of a report: at rest, deformed, both, and along the steps of the motion. */
function showReport(root) {
  const told = JSON.parse(root.querySelector("script").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const words = (text) => new Uint16Array(bytes(text).buffer);
  const centre = told.rest.low.map((x, k) => x + told.rest.size[k] / 2);
  // Outermost points of all shapes, in triangles that cannot be seen: the camera leaves room for the motion.
  const corners = told.extent.map((x, i) => x - centre[i % 3]);
  const positionsOf = ({ positions, low, size }) => {
    const levels = words(positions), found = new Float32Array(levels.length + corners.length);
    levels.forEach((x, i) => { found[i] = low[i % 3] - centre[i % 3] + (x / 65535) * size[i % 3]; });
    found.set(corners, levels.length);
    return found;
  };
  const rest = positionsOf(told.rest), palette = bytes(told.palette), paint = new Uint8Array(rest.length);
  paint.set(bytes(told.rest.paint));
  const given = bytes(told.triangles), seen = told.wide ? new Uint32Array(given.buffer) : new Uint16Array(given.buffer);
  const triangles = new Uint32Array(seen.length + corners.length);
  triangles.set(seen);
  corners.forEach((_, i) => { triangles[seen.length + i] = (rest.length - corners.length) / 3 + Math.floor(i / 3); });
  const cache = new Map();
  const shapeAt = (k) => {
    if (!cache.has(k)) {
      const colors = new Uint8Array(rest.length);
      bytes(told.shapes[k].shades).forEach((shade, v) => colors.set(palette.subarray(3 * shade, 3 * shade + 3), 3 * v));
      cache.set(k, { positions: positionsOf(told.shapes[k]), colors });
    }
    return cache.get(k);
  };
  const stage = root.querySelector(".stage"), section = root.parentElement;
  section.classList.add("viewed"); // gives the stage its size
  const first = shapeAt(told.current);
  const view = createMeshView(stage, {
    ...first,
    triangles, label: root.getAttribute("aria-label"), direction: told.direction, up: told.up,
  });
  if (!view) {
    section.classList.remove("viewed");
    return;
  }
  const slider = root.querySelector("input[type=range]"), button = root.querySelector("button");
  const name = root.querySelector("output");
  const choice = () => root.querySelector("input[type=radio]:checked").value;
  const show = () => {
    const isRest = choice() === "rest", shape = shapeAt(slider ? Number(slider.value) : told.current);
    view.setPositions(isRest ? rest : shape.positions);
    view.setColors(isRest ? paint : shape.colors);
    view.setGhost(choice() === "overlay" ? rest : null);
    section.classList.toggle("at-rest", isRest);
    if (!slider) return;
    slider.disabled = button.disabled = isRest;
    name.textContent = told.shapes[slider.value].name;
    slider.setAttribute("aria-valuetext", name.textContent);
  };
  let timer = 0;
  const play = button?.textContent;
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    button.textContent = play;
  };
  for (const each of root.querySelectorAll("input[type=radio]")) {
    each.addEventListener("change", () => {
      if (timer) stop();
      show();
    });
  }
  if (slider) {
    slider.max = told.shapes.length - 1;
    slider.value = told.current;
    slider.addEventListener("input", () => {
      if (timer) stop();
      show();
    });
    button.addEventListener("click", () => {
      if (timer) return stop();
      if (Number(slider.value) === told.shapes.length - 1) slider.value = 0;
      button.textContent = told.pause;
      show();
      timer = setInterval(() => {
        slider.value = Number(slider.value) + 1;
        show();
        if (Number(slider.value) === told.shapes.length - 1) stop();
      }, Math.min(400, Math.max(60, 3000 / told.shapes.length)));
    });
  }
  show();
}
for (const root of document.querySelectorAll(".view")) showReport(root);
