// Draws bodies made of surfaces with WebGL; the camera turns about a point.
"use strict";

(function () {
  const { add, subtract, scaled, dot, cross, unit, rotate, rotation } = globalThis.eurdf.algebra;

  const AROUND = 36; // vertices on a circle
  const QUARTER = 9; // and on a quarter of one
  const FIELD = 0.5; // of view, from top to bottom, rad
  const UPRIGHT = [1, 0, 0, 0, 1, 0, 0, 0, 1];

  /** A surface: positions and normals of the corners of its triangles, three numbers each. */
  function surface(triangles) {
    const [positions, normals] = [[], []];
    for (const corners of triangles) {
      const across = cross(subtract(corners[1].p, corners[0].p), subtract(corners[2].p, corners[0].p));
      if (dot(across, across) === 0) continue;
      for (const { p, n } of corners) {
        positions.push(...p);
        normals.push(...(n || unit(across)));
      }
    }
    return { positions, normals };
  }

  /** Profiles, each a list of {r, z, n: [outward, up]}, upward outside, turned about z. */
  function revolved(profiles) {
    const triangles = [];
    const point = ({ r, z, n }, k) => {
      const [c, s] = [Math.cos((2 * Math.PI * k) / AROUND), Math.sin((2 * Math.PI * k) / AROUND)];
      return { p: [r * c, r * s, z], n: [n[0] * c, n[0] * s, n[1]] };
    };
    for (const profile of profiles)
      for (let level = 1; level < profile.length; level++)
        for (let k = 0; k < AROUND; k++) {
          const [a, b] = [point(profile[level - 1], k), point(profile[level - 1], k + 1)];
          const [c, d] = [point(profile[level], k + 1), point(profile[level], k)];
          triangles.push([a, b, c], [a, c, d]);
        }
    return surface(triangles);
  }

  const arc = (r, from, to, z) =>
    Array.from({ length: QUARTER }, (_, k) => {
      const angle = from + ((to - from) * k) / (QUARTER - 1);
      return { r: r * Math.cos(angle), z: z + r * Math.sin(angle), n: [Math.cos(angle), Math.sin(angle)] };
    });

  const SURFACES = {
    box: ({ size }) => {
      const triangles = [];
      for (let axis = 0; axis < 3; axis++)
        for (const side of [-1, 1]) {
          const corner = (u, v) => {
            const p = [0, 0, 0];
            [p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]] = [side, u * side, v];
            return { p: p.map((each, i) => (each * size[i]) / 2) };
          };
          const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
          triangles.push(corners.slice(0, 3), [corners[0], corners[2], corners[3]]);
        }
      return surface(triangles);
    },
    cylinder: ({ size: [r, length] }) => {
      const h = length / 2;
      const rim = (z, n) => ({ r, z, n });
      const middle = (z, n) => ({ r: 0, z, n });
      return revolved([
        [middle(-h, [0, -1]), rim(-h, [0, -1])],
        [rim(-h, [1, 0]), rim(h, [1, 0])],
        [rim(h, [0, 1]), middle(h, [0, 1])],
      ]);
    },
    sphere: ({ size: [r] }) => revolved([[...arc(r, -Math.PI / 2, 0, 0), ...arc(r, 0, Math.PI / 2, 0)]]),
    capsule: ({ size: [r, length] }) =>
      revolved([[...arc(r, -Math.PI / 2, 0, -length / 2), ...arc(r, 0, Math.PI / 2, length / 2)]]),
    mesh: ({ vertices, triangles }) => {
      const corner = (index) => ({ p: vertices.slice(3 * index, 3 * index + 3) });
      const found = [];
      for (let i = 0; i < triangles.length; i += 3) found.push(triangles.slice(i, i + 3).map(corner));
      return surface(found);
    },
  };

  const VERTEX = `#version 300 es
    in vec3 position; in vec3 normal; in vec4 color;
    uniform mat4 model; uniform mat4 view; uniform mat4 projection; uniform float dark;
    out vec3 towards; out vec4 shade; out vec3 at;
    vec3 lightened(vec3 color) { // a luminance y below dark becomes (y + dark) / 2
      vec3 light = pow(color, vec3(2.2));
      float luminance = dot(light, vec3(0.2126, 0.7152, 0.0722));
      if (luminance >= dark) return color;
      return pow(mix(light, vec3(1.0), 0.5 * (dark - luminance) / (1.0 - luminance)), vec3(1.0 / 2.2));
    }
    void main() {
      vec4 seen = view * model * vec4(position, 1.0);
      towards = mat3(view) * mat3(model) * normal; at = seen.xyz; shade = vec4(lightened(color.rgb), color.a);
      gl_Position = projection * seen;
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 towards; in vec4 shade; in vec3 at; uniform float opacity; uniform float lit;
    out vec4 color;
    void main() {
      vec3 n = normalize(towards);
      if (dot(n, at) > 0.0) n = -n;
      vec3 light = normalize(vec3(-0.4, 0.5, 0.9)), other = normalize(vec3(0.9, -0.3, 0.5));
      float bright = 0.36 + 0.58 * max(dot(n, light), 0.0) + 0.18 * max(dot(n, other), 0.0);
      float shine = 0.12 * pow(max(dot(reflect(-light, n), normalize(-at)), 0.0), 24.0);
      float alpha = shade.a * opacity;
      color = vec4(mix(shade.rgb, shade.rgb * bright + shine, lit) * alpha, alpha);
    }`;

  /** A 4 by 4 matrix for WebGL, by columns, of a pose and factors along its axes. */
  function matrixOf({ R, p }, [x, y, z] = [1, 1, 1]) {
    return [R[0] * x, R[3] * x, R[6] * x, 0, R[1] * y, R[4] * y, R[7] * y, 0, R[2] * z, R[5] * z, R[8] * z, 0, ...p, 1];
  }

  class Drawing {
    /**
     * @param canvas Where to draw.
     * @param shapes What `live_robot` writes: surfaces fixed to bodies, with their colours.
     * @param look Where to look at: center (3), size, and lowest height of the robot, m.
     */
    constructor(canvas, shapes, look) {
      this.canvas = canvas;
      const gl = (this.gl = canvas.getContext("webgl2", { antialias: true, premultipliedAlpha: true }));
      if (!gl) throw new Error("this browser has no WebGL 2");
      this.look = look;
      const distance = (0.54 * look.size) / Math.tan(FIELD / 2);
      this.camera = { azimuth: -0.65, elevation: 0.35, distance, at: look.center };
      const program = (this.program = gl.createProgram());
      for (const [type, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
      }
      gl.linkProgram(program);
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      this.places = {};
      for (const name of ["model", "view", "projection", "opacity", "lit", "dark"])
        this.places[name] = gl.getUniformLocation(program, name);
      const found = new Map(); // of each body, opaque and translucent shapes apart
      for (const shape of shapes) {
        const key = `${shape.body}/${shape.color[3] < 1}`;
        if (!found.has(key)) found.set(key, { body: shape.body, clear: shape.color[3] < 1, vertices: [] });
        appendTo(found.get(key).vertices, SURFACES[shape.kind](shape), shape.color, shape.pose);
      }
      this.parts = [...found.values()].map((part) => ({ ...part, mesh: this._mesh(part.vertices) }));
      this.rod = this._mesh(appendTo([], SURFACES.cylinder({ size: [1, 1] }), [1, 1, 1, 1]));
      this.ball = this._mesh(appendTo([], SURFACES.sphere({ size: [1] }), [1, 1, 1, 1]));
      this.ground = this._mesh(grid(look));
    }

    /**
     * Draw everything.
     *
     * @param poses Of the bodies, in the world.
     * @param opacity Of the shapes.
     * @param marks {lines: [{from, to, color, radius}], dots: [{at, color, radius}]}, in the world, m.
     */
    draw(poses, opacity, marks) {
      const { gl, canvas, places } = this;
      const ratio = Math.min(globalThis.devicePixelRatio || 1, 2);
      const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
      if (!width || !height) return;
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.useProgram(this.program);
      const { right, up, toward, eye } = this._frame();
      const R = [...right, ...up, ...toward];
      gl.uniformMatrix4fv(places.view, false, matrixOf({ R, p: rotate(R, scaled(-1, eye)) }));
      gl.uniformMatrix4fv(places.projection, false, this._projection(width / height));
      gl.uniform1f(places.dark, Number(getComputedStyle(canvas).getPropertyValue("--eu-live-dark")));
      gl.uniform1f(places.opacity, 1);
      gl.uniform1f(places.lit, 0);
      gl.uniformMatrix4fv(places.model, false, matrixOf({ R: UPRIGHT, p: [0, 0, 0] }));
      this._drawMesh(this.ground, gl.LINES);
      gl.uniform1f(places.lit, 1);
      for (const clear of [false, true]) {
        gl.uniform1f(places.opacity, opacity);
        gl.depthMask(!clear && opacity === 1);
        for (const part of this.parts)
          if (part.clear === clear) {
            gl.uniformMatrix4fv(places.model, false, matrixOf(poses[part.body]));
            this._drawMesh(part.mesh, gl.TRIANGLES);
          }
      }
      gl.depthMask(true);
      gl.disable(gl.DEPTH_TEST); // marks are seen through what is in front of them
      gl.uniform1f(places.opacity, 1);
      gl.uniform1f(places.lit, 0);
      for (const line of marks.lines) this._line(line);
      for (const { at, radius, color } of marks.dots)
        this._mark(this.ball, { R: UPRIGHT, p: at }, [radius, radius, radius], color);
    }

    /** Turn the camera, rad. */
    turn(azimuth, elevation) {
      this.camera.azimuth += azimuth;
      this.camera.elevation = Math.min(Math.max(this.camera.elevation + elevation, -1.55), 1.55);
    }

    /** Move the camera nearer (factor below 1) or away. */
    zoom(factor) {
      const { size } = this.look;
      this.camera.distance = Math.min(Math.max(this.camera.distance * factor, 0.2 * size), 20 * size);
    }

    /** Move what the camera looks at, in parts of the height of the picture. */
    shift(x, y) {
      const { right, up } = this._frame();
      const height = 2 * this.camera.distance * Math.tan(FIELD / 2);
      this.camera.at = add(this.camera.at, add(scaled(-x * height, right), scaled(y * height, up)));
    }

    _frame() {
      const { azimuth, elevation, distance, at } = this.camera;
      const [ca, sa, ce, se] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(elevation), Math.sin(elevation)];
      const [toward, right] = [[ce * ca, ce * sa, se], [-sa, ca, 0]];
      return { right, toward, up: cross(toward, right), eye: add(at, scaled(distance, toward)) };
    }

    _projection(aspect) {
      const { size } = this.look;
      const { distance } = this.camera;
      const [near, far] = [Math.max(distance - 2 * size, 0.02 * size), distance + 6 * size];
      // A narrow picture shows as much from left to right as a square one.
      const f = Math.min(1, aspect) / Math.tan(FIELD / 2);
      const [a, b] = [(far + near) / (near - far), (2 * far * near) / (near - far)];
      return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, a, -1, 0, 0, b, 0];
    }

    _line({ from, to, color, radius }) {
      const along = subtract(to, from);
      const length = Math.hypot(...along);
      if (length < 1e-9 * this.look.size) return;
      const z = scaled(1 / length, along);
      const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
      const y = cross(z, x);
      const R = [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
      this._mark(this.rod, { R, p: scaled(0.5, add(from, to)) }, [radius, radius, length], color);
    }

    _mark(mesh, pose, factors, color) {
      const { gl, places } = this;
      gl.uniformMatrix4fv(places.model, false, matrixOf(pose, factors));
      gl.bindVertexArray(mesh.array);
      gl.disableVertexAttribArray(mesh.color);
      gl.vertexAttrib4fv(mesh.color, [...color, 1]);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
      gl.enableVertexAttribArray(mesh.color);
    }

    _drawMesh({ array, count }, mode) {
      this.gl.bindVertexArray(array);
      this.gl.drawArrays(mode, 0, count);
    }

    /** Vertices of 10 numbers: position, normal, colour. */
    _mesh(vertices) {
      const { gl, program } = this;
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
      for (const [name, count, first] of [["position", 3, 0], ["normal", 3, 3], ["color", 4, 6]]) {
        const place = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, count, gl.FLOAT, false, 40, 4 * first);
      }
      return { array, count: vertices.length / 10, color: gl.getAttribLocation(program, "color") };
    }
  }

  /** Append the vertices of a surface, moved by a pose (x y z, quaternion). */
  function appendTo(vertices, { positions, normals }, color, [x, y, z, ...q] = [0, 0, 0, 0, 0, 0, 1]) {
    const R = rotation(q);
    for (let i = 0; i < positions.length; i += 3)
      vertices.push(
        ...add(rotate(R, positions.slice(i, i + 3)), [x, y, z]),
        ...rotate(R, normals.slice(i, i + 3)),
        ...color,
      );
    return vertices;
  }

  /** Lines on the ground, a power of ten of metres apart. */
  function grid({ center, size, lowest }) {
    const apart = 10 ** Math.round(Math.log10(0.25 * size));
    const reach = Math.ceil((0.9 * size) / apart);
    const [x, y] = [Math.round(center[0] / apart), Math.round(center[1] / apart)];
    const vertices = [];
    const point = (i, j) => vertices.push((x + i) * apart, (y + j) * apart, lowest, 0, 0, 1, 0.5, 0.5, 0.5, 0.35);
    for (let i = -reach; i <= reach; i++) {
      point(i, -reach);
      point(i, reach);
      point(-reach, i);
      point(reach, i);
    }
    return vertices;
  }

  globalThis.eurdf.Drawing = Drawing;
})();
