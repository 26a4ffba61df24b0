/** Shows the shapes of a report: at rest, deformed, both, and along the steps of the motion. */
function showReport(root) {
  const told = JSON.parse(root.querySelector("script").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const words = (text) => new Uint16Array(bytes(text).buffer);
  const centre = told.rest.low.map((x, k) => x + told.rest.size[k] / 2);
  const positionsOf = (shape) =>
    Float32Array.from(words(shape.positions), (x, i) => shape.low[i % 3] - centre[i % 3] + (x / 65535) * shape.size[i % 3]);
  const corners = [told.rest, ...told.shapes].flatMap(({ low, size }) =>
    Array.from({ length: 24 }, (_, i) => low[i % 3] - centre[i % 3] + (Math.floor(i / 3) >> (i % 3) & 1) * size[i % 3]));
  const palette = bytes(told.palette), rest = positionsOf(told.rest), paint = bytes(told.rest.paint);
  const cache = new Map();
  const shapeAt = (k) => {
    if (!cache.has(k)) {
      const shades = bytes(told.shapes[k].shades), colors = new Uint8Array(3 * shades.length);
      shades.forEach((shade, v) => colors.set(palette.subarray(3 * shade, 3 * shade + 3), 3 * v));
      cache.set(k, { positions: positionsOf(told.shapes[k]), colors });
    }
    return cache.get(k);
  };
  const stage = root.querySelector(".stage"), section = root.parentElement;
  section.classList.add("viewed"); // gives the stage its size
  const first = shapeAt(told.current);
  const view = createMeshView(stage, {
    ...first,
    triangles: told.wide ? new Uint32Array(bytes(told.triangles).buffer) : Uint32Array.from(words(told.triangles)),
    label: root.getAttribute("aria-label"), direction: told.direction, up: told.up,
    extent: Float32Array.from(corners), // the camera stays along the motion
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
