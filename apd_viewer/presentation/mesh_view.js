/**
 * View of one triangle mesh by WebGL2: no dependencies, no requests. Serves the notebook's widget and the HTML
 * report; it works in a shadow DOM, and as an inline <script type="module"> of a page opened from disk.
 *
 *   const view = createMeshView(container, { positions, triangles, colors });
 *
 * container: element with a size of its own; the view fills it and follows its size. Its text colour says whether
 *   the page is light or dark; the background is transparent.
 * positions: Float32Array (3n), best around the origin. triangles: Uint32Array (3m).
 * colors: Uint8Array (3n), RGB of each vertex, or null for grey.
 * label: name for screen readers. direction, up: from the mesh to the viewer, and upwards. margin: beside what
 *   `fit` shows, 1 for none.
 *
 * Returns null where there is no WebGL2, or else an object:
 *   canvas                    the element
 *   setPositions(positions)   moves the vertices; normals follow, the camera stays
 *   setColors(colors)         as above
 *   setGhost(positions)       a second, translucent shape of the same triangles; null for none
 *   setGizmo(place, drag)     arrows, rings and a ball at a place [x, y, z]; null removes them. `drag` is called
 *                             with (matrix, state): the motion since the drag began, 16 numbers row by row, and
 *                             "start", "move" or "end". The gizmo moves along by itself.
 *   fit()                     shows all of the shapes
 *   pick(x, y)                what is seen at a pixel of the canvas (CSS pixels): { triangle, vertex, point,
 *                             unitsPerPixel } or null; the vertex is the nearest of the triangle's
 *   project(point)            its pixel [x, y]
 *   gizmoPixel(axis)          pixel of the middle of the gizmo's arrow along axis 0, 1 or 2, or null
 *   picture()                 data URL of a PNG of the view, without the gizmo
 *   onPress = (x, y, event)   may return { move(x, y), end() } to take a gesture over, or null to turn the view
 *   dispose()                 removes canvas, listeners and buffers
 *
 * Mouse: drag turns, Shift or another button moves, the wheel zooms once the view has the focus (before, the page
 * scrolls), a double click fits. Touch: one finger turns, two move and zoom. Keys: arrows, Shift with arrows,
 * plus, minus, and Home to fit. Nothing is drawn unless something has changed.
 */
export function createMeshView(container, {
  positions, triangles, colors = null, label = "", direction = [0.55, 0.28, 1], up = [0, 1, 0], margin = 1.1,
}) {
  const FIELD = Math.tan(Math.PI / 12); // tangent of half the field of view, which is 30 degrees
  const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

  const canvas = document.createElement("canvas");
  canvas.style.cssText = "display:block;width:100%;height:100%;touch-action:none;cursor:grab;border-radius:inherit";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", label);
  // Without a graphics processor drawing takes the cores that a solver needs: while things move there are half as
  // many pixels each way, and smooth edges come once the view is at rest, by twice as many.
  const isSlow = hasNoGraphicsProcessor();
  const gl = canvas.getContext("webgl2", { antialias: !isSlow });
  if (!gl) return null;
  container.append(canvas);

  function hasNoGraphicsProcessor() {
    const probe = document.createElement("canvas").getContext("webgl2");
    const info = probe?.getExtension("WEBGL_debug_renderer_info");
    const name = info ? probe.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
    probe?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(name);
  }

  // Shapes: positions, normals, and the vertices that triangles use

  const used = new Uint8Array(positions.length / 3);
  for (const vertex of triangles) used[vertex] = 1;

  function normalsOf(P) {
    const N = new Float32Array(P.length), T = triangles;
    for (let t = 0; t < T.length; t += 3) {
      const a = 3 * T[t], b = 3 * T[t + 1], c = 3 * T[t + 2];
      const ux = P[b] - P[a], uy = P[b + 1] - P[a + 1], uz = P[b + 2] - P[a + 2];
      const vx = P[c] - P[a], vy = P[c + 1] - P[a + 1], vz = P[c + 2] - P[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx; // weighted by area
      N[a] += x; N[a + 1] += y; N[a + 2] += z;
      N[b] += x; N[b + 1] += y; N[b + 2] += z;
      N[c] += x; N[c + 1] += y; N[c + 2] += z;
    }
    for (let i = 0; i < N.length; i += 3) { // floats of tiny triangles squared would vanish
      const l = Math.hypot(N[i], N[i + 1], N[i + 2]) || 1;
      N[i] /= l; N[i + 1] /= l; N[i + 2] /= l;
    }
    return N;
  }

  function bounds() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const P of ghost ? [positions, ghost] : [positions]) {
      for (let i = 0; i < P.length; i++) {
        if (!used[(i / 3) | 0]) continue;
        const k = i % 3;
        if (P[i] < low[k]) low[k] = P[i];
        if (P[i] > high[k]) high[k] = P[i];
      }
    }
    const centre = low.map((x, k) => (x + high[k]) / 2);
    return { centre, radius: Math.hypot(...add(high, centre, -1)) || 1 };
  }

  // Camera: turns about `up` and tilts, at a distance from a target

  const [north, east] = [unit(up), unit(cross(up, direction))];
  const south = cross(east, north), away = unit(direction);
  const camera = { turn: 0, tilt: Math.asin(clamp(dot(away, north), -1, 1)), target: [0, 0, 0], distance: 1 };
  let ghost = null, box = bounds(), isFitted = true, lens = null;

  function axes() {
    const { turn, tilt, target, distance } = camera;
    const level = add(east.map((x) => x * Math.sin(turn)), south, Math.cos(turn));
    const toward = add(north.map((x) => x * Math.sin(tilt)), level, Math.cos(tilt));
    const right = unit(cross(north, level));
    return { right, up: cross(toward, right), toward, eye: add(target, toward, distance) };
  }

  function sizes() {
    return [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
  }

  function fit() {
    const { right, up: top, toward } = axes(), [width, height] = sizes();
    box = bounds();
    camera.target = box.centre;
    let distance = 1e-3 * box.radius;
    for (const P of ghost ? [positions, ghost] : [positions]) {
      for (let i = 0; i < P.length; i += 3) {
        if (!used[i / 3]) continue;
        const q = [P[i] - box.centre[0], P[i + 1] - box.centre[1], P[i + 2] - box.centre[2]];
        const across = Math.max(Math.abs(dot(q, top)), Math.abs(dot(q, right)) * height / width);
        distance = Math.max(distance, margin * across / FIELD + dot(q, toward));
      }
    }
    camera.distance = distance;
    isFitted = true;
    redraw();
  }

  function project(point) {
    const { right, up: top, toward, eye } = axes(), [width, height] = sizes(), q = add(point, eye, -1);
    const scale = height / 2 / FIELD / Math.max(-dot(q, toward), 1e-12);
    return [width / 2 + scale * dot(q, right), height / 2 - scale * dot(q, top)];
  }

  function unitsPerPixel(point) {
    const { toward, eye } = axes();
    return 2 * FIELD * Math.max(dot(add(eye, point, -1), toward), 1e-12) / sizes()[1];
  }

  function pick(x, y) {
    const { right, up: top, toward, eye } = axes(), [width, height] = sizes(), T = triangles, P = positions;
    const across = add(right.map((r) => r * (2 * x - width) / height * FIELD), top, (1 - 2 * y / height) * FIELD);
    const [dx, dy, dz] = add(across, toward, -1), [ex, ey, ez] = eye;
    let nearest = Infinity, found = null;
    for (let t = 0; t < T.length; t += 3) { // Möller and Trumbore
      const a = 3 * T[t], b = 3 * T[t + 1], c = 3 * T[t + 2];
      const ux = P[b] - P[a], uy = P[b + 1] - P[a + 1], uz = P[b + 2] - P[a + 2];
      const vx = P[c] - P[a], vy = P[c + 1] - P[a + 1], vz = P[c + 2] - P[a + 2];
      const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
      const det = ux * px + uy * py + uz * pz;
      if (det === 0) continue;
      const sx = ex - P[a], sy = ey - P[a + 1], sz = ez - P[a + 2], u = (sx * px + sy * py + sz * pz) / det;
      if (u < 0 || u > 1) continue;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
      const v = (dx * qx + dy * qy + dz * qz) / det, s = (vx * qx + vy * qy + vz * qz) / det;
      if (v < 0 || u + v > 1 || s <= 0 || s >= nearest) continue;
      nearest = s;
      found = [t / 3, T[1 - u - v > Math.max(u, v) ? t : u > v ? t + 1 : t + 2]];
    }
    if (!found) return null;
    const point = [ex + nearest * dx, ey + nearest * dy, ez + nearest * dz];
    return { triangle: found[0], vertex: found[1], point, unitsPerPixel: unitsPerPixel(point) };
  }

  // Gizmo: three arrows, three rings and a ball, of one size on the screen; parts 0-2, 3-5 and 6

  const GIZMO = [[214, 62, 62], [62, 150, 62], [58, 110, 216], [214, 62, 62], [62, 150, 62], [58, 110, 216], [150, 150, 150]];
  const RING = 0.72, AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  let gizmo = null, hot = -1; // { place, drag }, and the part under the pointer

  function gizmoShape() {
    const points = [], normals = [], corners = [], parts = [];
    const tube = (stations) => { // of { at, u, v, r }
      const start = corners.length, sides = 8, first = points.length / 3;
      stations.forEach(({ at, u, v, r }, k) => {
        for (let i = 0; i < sides; i++) {
          const n = add(u.map((x) => x * Math.cos(2 * Math.PI * i / sides)), v, Math.sin(2 * Math.PI * i / sides));
          points.push(...add(at, n, r));
          normals.push(...n);
          const a = first + k * sides + i, b = first + k * sides + (i + 1) % sides;
          if (k + 1 < stations.length) corners.push(a, b, a + sides, b, b + sides, a + sides);
        }
      });
      parts.push([start, corners.length - start]);
    };
    const along = (k, pairs) => pairs.map(([s, r]) => (
      { at: AXES[k].map((x) => x * s), u: AXES[(k + 1) % 3], v: AXES[(k + 2) % 3], r }));
    for (const k of [0, 1, 2]) tube(along(k, [[0.14, 0.014], [0.84, 0.014], [0.84, 0.05], [1.04, 0.001]]));
    for (const k of [0, 1, 2]) {
      tube(Array.from({ length: 49 }, (_, i) => ringPoint(k, i / 24 * Math.PI)).map((u) => (
        { at: u.map((x) => x * RING), u, v: AXES[k], r: 0.012 })));
    }
    const angles = Array.from({ length: 9 }, (_, i) => Math.PI * i / 8);
    tube(along(1, angles.map((t) => [-0.07 * Math.cos(t), 0.07 * Math.sin(t)])));
    return { points: new Float32Array(points), normals: new Float32Array(normals), corners: new Uint32Array(corners), parts };
  }

  function ringPoint(k, angle) {
    return add(AXES[(k + 1) % 3].map((x) => x * Math.cos(angle)), AXES[(k + 2) % 3], Math.sin(angle));
  }

  function gizmoScale() {
    return Math.min(92, 0.2 * Math.min(...sizes())) * unitsPerPixel(gizmo.place);
  }

  function gizmoPixel(k) {
    return gizmo && project(add(gizmo.place, AXES[k], 0.6 * gizmoScale()));
  }

  /** Part at a pixel, the nearest within `reach`; of rings only the half that faces the viewer. */
  function partAt(x, y, reach) {
    if (!gizmo) return null;
    const size = gizmoScale(), { place } = gizmo, { eye } = axes(), toEye = add(eye, place, -1);
    let best = null, least = reach;
    const look = (part, offset, angle, weight = 1) => {
      const [px, py] = project(add(place, offset, size)), far = weight * Math.hypot(px - x, py - y);
      if (far < least) [least, best] = [far, { part, angle }];
    };
    look(6, [0, 0, 0], 0, 0.8);
    for (const k of [0, 1, 2]) {
      for (let s = 0.2; s <= 1.06; s += 0.04) look(k, AXES[k].map((c) => c * s), 0);
      for (let a = 0; a < 2 * Math.PI; a += Math.PI / 36) {
        const u = ringPoint(k, a);
        if (dot(u, toEye) > 0) look(3 + k, u.map((c) => c * RING), a, 1.2);
      }
    }
    return best;
  }

  /** Gesture that drags a part: each step moves it as far as the pointer goes along its way on the screen. */
  function partGesture({ part, angle }, x, y) {
    const from = gizmo.place, k = part % 3, size = gizmoScale();
    let turned = 0, matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    const { drag } = gizmo;
    drag(matrix, "start");
    return {
      part,
      move(nx, ny) {
        if (!gizmo) return;
        const steps = Math.max(1, Math.ceil(Math.hypot(nx - x, ny - y) / 8)); // along a ring the way bends
        for (let n = 0; n < steps; n++) step((nx - x) / steps, (ny - y) / steps);
        [x, y] = [nx, ny];
        const c = Math.cos(turned), s = Math.sin(turned), [a, b] = [(k + 1) % 3, (k + 2) % 3];
        const R = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
        R[k][k] = 1; R[a][a] = R[b][b] = c; R[b][a] = s; R[a][b] = -s;
        const t = R.map((row, i) => gizmo.place[i] - dot(row, from));
        matrix = [...R[0], t[0], ...R[1], t[1], ...R[2], t[2], 0, 0, 0, 1];
        drag(matrix, "move");
        if (isSlow) later ||= setTimeout(redraw, 200); // unless a new shape has it drawn before
        else redraw();
      },
      end() { drag(matrix, "end"); redraw(); },
    };
    function step(dx, dy) {
      if (part === 6) {
        const { right, up: top } = axes(), scale = unitsPerPixel(gizmo.place);
        gizmo.place = add(add(gizmo.place, right, dx * scale), top, -dy * scale);
        return;
      }
      const isRing = part > 2, at = isRing ? add(gizmo.place, ringPoint(k, angle + turned), RING * size) : gizmo.place;
      const way = isRing ? ringPoint(k, angle + turned + Math.PI / 2) : AXES[k], small = 0.01 * size;
      const [p, q] = [project(at), project(add(at, way, small))], full = 0.01 * size / unitsPerPixel(at);
      const [wx, wy] = [q[0] - p[0], q[1] - p[1]]; // pixels for `small`; at most `full`, where it is seen across
      const moved = small * (dx * wx + dy * wy) / Math.max(wx * wx + wy * wy, 0.09 * full * full);
      if (isRing) turned += moved / (RING * size);
      else gizmo.place = add(gizmo.place, way, moved);
    }
  }

  // Drawing

  const VERTEX = `#version 300 es
    uniform mat4 view, lens; uniform vec4 shift; // centre and size, of the gizmo
    in vec3 place, normal, color; out vec3 p, n, c;
    void main() {
      vec4 q = view * vec4(shift.xyz + shift.w * place, 1.0);
      p = q.xyz; n = mat3(view) * normal; c = color; gl_Position = lens * q;
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    uniform int kind; uniform vec3 heart; // 0 mesh, 1 ghost, 2 gizmo, 3 ring; centre of the gizmo
    in vec3 p, n, c; out vec4 pixel;
    void main() {
      vec3 eye = normalize(-p), m = normalize(gl_FrontFacing || kind > 1 ? n : -n);
      vec3 key = normalize(vec3(-0.35, 0.45, 1.0)), fill = normalize(vec3(0.7, -0.35, 0.5));
      float light = 0.36 + 0.56 * max(dot(m, key), 0.0) + 0.16 * max(dot(m, fill), 0.0);
      float shine = 0.10 * pow(max(dot(m, normalize(key + eye)), 0.0), 32.0);
      float alpha = kind == 1 ? mix(0.10, 0.55, pow(1.0 - abs(dot(m, eye)), 2.0)) : 1.0;
      if (kind == 1) { light = 1.0; shine = 0.0; }
      if (kind > 1) { light = 0.72 + 0.28 * max(dot(m, key), 0.0); shine = 0.0; }
      if (kind == 3 && dot(p - heart, heart) > 0.0) alpha = 0.22;
      pixel = vec4(min(c * light + shine, 1.0) * alpha, alpha);
    }`;
  const GREY = [205, 203, 198];
  const STILL = 400; // milliseconds after which a view is at rest
  let program, where, mesh, double, tool, isFilled, pending = 0, fence = null, still = 0, later = 0;

  function begin() { // again after the context was lost
    fence = null;
    program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    ["place", "normal", "color"].forEach((name, k) => gl.bindAttribLocation(program, k, name));
    gl.linkProgram(program);
    where = Object.fromEntries(["view", "lens", "shift", "kind", "heart"].map((name) => [name, gl.getUniformLocation(program, name)]));
    mesh = buffers(triangles);
    double = buffers(triangles);
    const shape = gizmoShape();
    tool = { ...buffers(shape.corners), parts: shape.parts };
    fill(tool, shape.points, shape.normals);
    isFilled = false;
    if (ghost) fill(double, ghost, normalsOf(ghost));
    setColors(colors);
  }

  function buffers(corners) {
    const made = { array: gl.createVertexArray(), place: gl.createBuffer(), normal: gl.createBuffer(), color: gl.createBuffer(), corners: gl.createBuffer() };
    gl.bindVertexArray(made.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made.corners);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    [made.place, made.normal].forEach((buffer, k) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 0, 0);
    });
    return made;
  }

  function fill(shape, P, N) {
    for (const [buffer, data] of [[shape.place, P], [shape.normal, N]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    }
  }

  function setPositions(P) {
    positions = P;
    isFilled = false; // shapes may come faster than they are drawn
    redraw();
  }

  function setGhost(P) {
    ghost = P;
    if (P) fill(double, P, normalsOf(P));
    if (isFitted) fit();
    redraw();
  }

  function setColors(C) {
    colors = C;
    gl.bindVertexArray(mesh.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.color);
    if (C) {
      gl.bufferData(gl.ARRAY_BUFFER, C, gl.DYNAMIC_DRAW);
      gl.vertexAttribPointer(2, 3, gl.UNSIGNED_BYTE, true, 0, 0);
      gl.enableVertexAttribArray(2);
    } else {
      gl.disableVertexAttribArray(2);
    }
    redraw();
  }

  function setGizmo(place, drag = () => {}) {
    gizmo = place && { place: [...place], drag };
    hot = -1;
    redraw();
  }

  function isDark() {
    const [r, g, b] = getComputedStyle(container).color.match(/[\d.]+/g).map(Number);
    return 0.3 * r + 0.6 * g + 0.1 * b > 140;
  }

  /** Draw soon, but not before the last frame is seen: frames that wait for each other would come late. */
  function redraw() {
    clearTimeout(still);
    pending ||= requestAnimationFrame(function next() {
      if (fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.UNSIGNALED) {
        pending = requestAnimationFrame(next);
        return;
      }
      gl.deleteSync(fence);
      draw(true, isSlow ? 0.5 : 1);
      fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      if (isSlow) still = setTimeout(draw, STILL, true, 2);
    });
  }

  /** Draw now, by `fineness` pixels each way for one of the screen. */
  function draw(hasGizmo, fineness) {
    cancelAnimationFrame(pending);
    clearTimeout(later);
    pending = later = 0;
    const [width, height] = sizes(), ratio = (window.devicePixelRatio || 1) * fineness;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const { right, up: top, toward, eye } = axes(), R = [right, top, toward];
    if (!isFilled) fill(mesh, positions, normalsOf(positions));
    isFilled = true;
    box = bounds();
    const depth = dot(add(eye, box.centre, -1), toward), reach = 1.05 * box.radius;
    const far = Math.max(depth + reach, 1e-6 * reach), near = Math.max(depth - reach, far / 1000);
    const view = [0, 1, 2].flatMap((k) => [R[0][k], R[1][k], R[2][k], 0]).concat(R.map((r) => -dot(r, eye)), 1);
    lens = [height / width / FIELD, 0, 0, 0, 0, 1 / FIELD, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(program);
    gl.uniformMatrix4fv(where.view, false, view);
    gl.uniformMatrix4fv(where.lens, false, lens);
    const show = (shape, kind, color, start = 0, count = triangles.length) => {
      gl.bindVertexArray(shape.array);
      gl.uniform1i(where.kind, kind);
      gl.vertexAttrib3f(2, ...color.map((x) => x / 255));
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * start);
    };
    gl.uniform4f(where.shift, 0, 0, 0, 1);
    show(mesh, 0, GREY);
    if (ghost) { // its nearest layer only, and behind the mesh where they coincide
      const color = isDark() ? [176, 200, 236] : [52, 74, 112];
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 2);
      gl.colorMask(false, false, false, false);
      show(double, 1, color);
      gl.colorMask(true, true, true, true);
      show(double, 1, color);
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }
    if (!gizmo || !hasGizmo) return;
    gl.clear(gl.DEPTH_BUFFER_BIT); // it is seen through the mesh
    const size = gizmoScale(), heart = R.map((r) => dot(r, add(gizmo.place, eye, -1)));
    // A range of depths of its own, since it may be anywhere.
    const [n, f] = [Math.max(-heart[2] - 1.2 * size, size / 100), Math.max(-heart[2] + 1.2 * size, size)];
    lens[10] = (f + n) / (n - f);
    lens[14] = 2 * f * n / (n - f);
    gl.uniformMatrix4fv(where.lens, false, lens);
    gl.uniform4f(where.shift, ...gizmo.place, size);
    gl.uniform3f(where.heart, ...heart);
    const lit = isDark() ? [255, 224, 130] : [250, 180, 20];
    tool.parts.forEach(([start, count], k) => {
      if ((gesture?.part ?? k) !== k) return; // the others are in the way of a drag
      show(tool, k > 2 && k < 6 ? 3 : 2, k === hot ? lit : GIZMO[k], start, count);
    });
  }

  // Mouse, touch and keys

  const api = {
    canvas, setPositions, setColors, setGhost, setGizmo, fit, pick, project, gizmoPixel, picture, dispose, onPress: null,
  };
  const pointers = new Map();
  let gesture = null;

  function place(event) {
    const { left, top } = canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  function orbit(dx, dy) {
    camera.turn -= 0.008 * dx;
    camera.tilt = clamp(camera.tilt + 0.008 * dy, -1.55, 1.55);
    moved();
  }

  function pan(dx, dy) {
    const { right, up: top } = axes(), scale = unitsPerPixel(camera.target);
    camera.target = add(add(camera.target, right, -dx * scale), top, dy * scale);
    moved();
  }

  function zoom(factor) {
    camera.distance = clamp(camera.distance * factor, 0.02 * box.radius, 100 * box.radius);
    moved();
  }

  function moved() {
    isFitted = false;
    redraw();
  }

  function following(step, x, y) {
    return { move(nx, ny) { step(nx - x, ny - y); [x, y] = [nx, ny]; }, end() {} };
  }

  function pinch() {
    const state = () => {
      const [a, b] = [...pointers.values()];
      return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, Math.hypot(a[0] - b[0], a[1] - b[1]) || 1];
    };
    let before = state();
    return {
      move() {
        if (pointers.size !== 2) return;
        const now = state();
        pan(now[0] - before[0], now[1] - before[1]);
        zoom(before[2] / now[2]);
        before = now;
      },
      end() {},
    };
  }

  const listeners = {
    pointerdown(event) {
      const [x, y] = place(event);
      canvas.focus({ preventScroll: true });
      try { canvas.setPointerCapture(event.pointerId); } catch { /* a pointer that has gone already */ }
      pointers.set(event.pointerId, [x, y]);
      gesture?.end();
      const isPlain = event.button === 0 && !event.shiftKey;
      const part = isPlain && pointers.size === 1 && partAt(x, y, event.pointerType === "touch" ? 22 : 10);
      if (pointers.size === 2) gesture = pinch();
      else if (part) gesture = partGesture(part, x, y);
      else gesture = (isPlain && api.onPress?.(x, y, event)) || following(isPlain ? orbit : pan, x, y);
      hot = gesture.part ?? -1;
      canvas.style.cursor = "grabbing";
      event.preventDefault();
      redraw();
    },
    pointermove(event) {
      const [x, y] = place(event);
      if (pointers.has(event.pointerId)) pointers.set(event.pointerId, [x, y]);
      if (gesture) return gesture.move(x, y);
      const part = event.pointerType === "touch" ? -1 : partAt(x, y, 10)?.part ?? -1;
      canvas.style.cursor = part < 0 ? api.cursor ?? "grab" : "pointer";
      if (part !== hot) { hot = part; redraw(); }
    },
    pointerup(event) {
      pointers.delete(event.pointerId);
      gesture?.end();
      gesture = null;
      canvas.style.cursor = api.cursor ?? "grab";
    },
    pointercancel(event) { listeners.pointerup(event); },
    wheel(event) {
      if (!event.ctrlKey && !canvas.matches(":focus")) return; // the page scrolls
      event.preventDefault();
      zoom(Math.exp(clamp(event.deltaY * (event.deltaMode ? 16 : 1), -120, 120) * (event.ctrlKey ? 0.008 : 0.0015)));
    },
    dblclick() { if (!api.onPress) fit(); },
    contextmenu(event) { event.preventDefault(); },
    keydown(event) {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (by) (event.shiftKey ? pan : orbit)(20 * by[0], 20 * by[1]);
      else if (event.key === "+" || event.key === "=") zoom(1 / 1.15);
      else if (event.key === "-") zoom(1.15);
      else if (event.key === "Home") fit();
      else return;
      event.preventDefault();
      event.stopPropagation(); // notebooks have keys of their own
    },
    webglcontextlost(event) { event.preventDefault(); },
    webglcontextrestored() { begin(); },
  };
  for (const [name, listener] of Object.entries(listeners)) canvas.addEventListener(name, listener, { passive: false });
  const watcher = new ResizeObserver(() => (isFitted ? fit() : redraw()));
  watcher.observe(container);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", redraw);

  function picture() {
    draw(false, isSlow ? 2 : 1);
    const url = canvas.toDataURL("image/png");
    redraw();
    return url;
  }

  function dispose() {
    cancelAnimationFrame(pending);
    clearTimeout(still);
    clearTimeout(later);
    watcher.disconnect();
    dark.removeEventListener("change", redraw);
    gl.getExtension("WEBGL_lose_context")?.loseContext();
    canvas.remove();
  }

  begin();
  fit();
  return api;
}
