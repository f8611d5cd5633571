"use strict";
// Shows a plan: cloud, boxes by level, faces, ranked grasps with the closing hand. The data is PLAN, or, where that is null, what the
// server at api/ has.
(function () {
  const BOX_COLOURS = [0x1f77b4, 0xff7f0e, 0x2ca02c, 0x9467bd, 0x8c564b, 0xe377c2, 0xbcbd22, 0x17becf, 0xd62728, 0x646464];
  const FINGER_COLOURS = { "-1": 0x707780, 0: 0x3b7dd8, 1: 0x39a275, 2: 0xd8843b };
  const MEASURES = [
    ["q1", "grasp triangle size", "m²"], ["q2", "point arrangement", ""], ["q3", "force line", "rad"], ["q4", "finger extension", "m"],
    ["q5", "finger spread", "rad"], ["q6", "focus deviation", "m"], ["q7", "2D force focus", "m"], ["q8", "finger depth difference", "m²"],
    ["q9", "3D force focus", "m"]];
  const $ = (id) => document.getElementById(id);
  const dark = window.matchMedia("(prefers-color-scheme: dark)").matches;
  let plan = null, view = null, selected = -1, playing = null;

  // --- small helpers

  function element(tag, text, attributes) {
    const node = document.createElement(tag);
    if (text !== undefined) node.textContent = text;
    for (const [name, value] of Object.entries(attributes || {})) node.setAttribute(name, value);
    return node;
  }
  function row(cells, tag) {
    const tr = element("tr");
    for (const cell of cells) tr.append(element(tag || "td", cell, typeof cell === "string" && /[a-z]{3}/.test(cell) ? { class: "words" } : {}));
    return tr;
  }
  function fill(table, head, rows) {
    const thead = element("thead"), tbody = element("tbody");
    if (head) thead.append(row(head, "th"));
    tbody.append(...rows);
    table.replaceChildren(thead, tbody);
  }
  const number = (x, digits) => (x === null || x === undefined ? "–" : x.toFixed(digits));
  const degrees = (x) => number(x === null ? null : (x * 180) / Math.PI, 0) + "°";
  function bytes(text) {
    const raw = atob(text), out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
    return out;
  }

  // --- the 3D view

  function poseMatrix(pose) {
    const [w, x, y, z] = pose.quaternion_wxyz;
    return new THREE.Matrix4().compose(new THREE.Vector3(...pose.position_m), new THREE.Quaternion(x, y, z, w), new THREE.Vector3(1, 1, 1));
  }
  function posed(object, pose) {
    object.matrixAutoUpdate = false;
    object.matrix.copy(poseMatrix(pose));
    return object;
  }
  function makeView() {
    let renderer;
    try {
      renderer = new THREE.WebGLRenderer({ canvas: $("view"), antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch (error) {
      $("no-webgl").hidden = false;
      return null;
    }
    renderer.setPixelRatio(window.devicePixelRatio || 1);
    const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1, 0.01, 50);
    const controls = new THREE.OrbitControls(camera, renderer.domElement);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x667788, 0.9));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    camera.add(lamp);
    scene.add(camera);
    const groups = {};
    for (const name of ["scene", "cloud", "boxes", "faces", "grasps", "hand"]) scene.add((groups[name] = new THREE.Group()));
    const made = { renderer, scene, camera, controls, groups };
    made.draw = () => {
      const { clientWidth: width, clientHeight: height } = renderer.domElement.parentElement;
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
    };
    controls.addEventListener("change", made.draw);
    window.addEventListener("resize", made.draw);
    return made;
  }
  function clear(group) {
    for (const child of [...group.children]) {
      child.traverse((node) => {
        if (node.geometry) node.geometry.dispose();
        if (node.material) node.material.dispose();
      });
      group.remove(child);
    }
  }
  function points(cloud, colourOf, size) {
    const geometry = new THREE.BufferGeometry(), xyz = new Float32Array(bytes(cloud.xyz_float32).buffer);
    geometry.setAttribute("position", new THREE.BufferAttribute(xyz, 3));
    const colours = new Float32Array(xyz.length), colour = new THREE.Color();
    for (let i = 0; i < xyz.length / 3; ++i) colour.set(colourOf(i)).toArray(colours, 3 * i);
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    return new THREE.Points(geometry, new THREE.PointsMaterial({ size, sizeAttenuation: true, vertexColors: THREE.VertexColors }));
  }
  function boxLines(box, colour) {
    const geometry = new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(...box.extents_m));
    return posed(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: colour })), box);
  }
  function faceQuad(face, colour, opacity) {
    const quad = new THREE.Mesh(new THREE.PlaneBufferGeometry(...face.size_m),
      new THREE.MeshBasicMaterial({ color: colour, opacity, transparent: true, side: THREE.DoubleSide, depthWrite: false }));
    return posed(quad, face);
  }
  // A rod between two points with round ends.
  function capsule(a, b, radius, material) {
    const from = new THREE.Vector3(...a), to = new THREE.Vector3(...b), along = to.clone().sub(from), group = new THREE.Group();
    const rod = new THREE.Mesh(new THREE.CylinderBufferGeometry(radius, radius, Math.max(1e-6, along.length()), 16, 1, true), material);
    rod.position.copy(from).addScaledVector(along, 0.5);
    if (along.length() > 1e-9) rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.clone().normalize());
    group.add(rod);
    for (const end of [from, to]) {
      const ball = new THREE.Mesh(new THREE.SphereBufferGeometry(radius, 16, 12), material);
      ball.position.copy(end);
      group.add(ball);
    }
    return group;
  }
  const material = (colour, opacity) => new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity: opacity || 0.92 });

  // The hand at a share of its way: the first part of it the approach, the rest closing.
  function showHand(share) {
    clear(view.groups.hand);
    const grasp = plan.grasps[selected];
    if (!grasp) return view.draw();
    const approach = 0.4, close = Math.max(0, (share - approach) / (1 - approach));
    const step = Math.round(close * (grasp.closing.length - 1));
    const back = plan.retreat_m * Math.max(0, 1 - share / approach);
    const hand = new THREE.Group();
    for (const [finger, a, b, radius] of grasp.closing[step]) hand.add(capsule(a, b, radius, material(FINGER_COLOURS[finger])));
    const { palm_radius_m: radius, palm_thickness_m: thickness } = plan.hand;
    const palm = new THREE.Mesh(new THREE.CylinderBufferGeometry(radius, radius, thickness, 32), material(FINGER_COLOURS[-1], 0.6));
    palm.rotation.x = Math.PI / 2;
    palm.position.z = -thickness / 2;
    hand.add(palm);
    posed(hand, grasp.palm_pose);
    hand.matrix.multiply(new THREE.Matrix4().makeTranslation(0, 0, -back));
    view.groups.hand.add(hand);
    for (const contact of grasp.contacts) {
      const at = new THREE.Vector3(...contact.position_m), normal = new THREE.Vector3(...contact.normal);
      view.groups.hand.add(new THREE.ArrowHelper(normal, at.clone().addScaledVector(normal, -0.025), 0.025, contact.seen ? 0xd01818 : 0xd0a018, 0.009, 0.006));
    }
    view.draw();
  }
  function graspMark(grasp, colour) {
    const at = new THREE.Vector3(...grasp.palm_pose.position_m);
    return new THREE.ArrowHelper(new THREE.Vector3(...grasp.approach), at, 0.03, colour, 0.01, 0.007);
  }
  function showLevel(level) {
    clear(view.groups.boxes);
    for (const object of plan.objects) {
      let leaves = 0;
      const number_of = object.boxes.map((box) => (box.leaf ? leaves++ : -1));
      object.boxes.forEach((box, i) => {
        const shown = box.level === level || (box.leaf && box.level < level);
        if (shown) view.groups.boxes.add(boxLines(box, box.leaf ? BOX_COLOURS[number_of[i] % BOX_COLOURS.length] : dark ? 0xffffff : 0x000000));
      });
    }
    view.draw();
  }
  function showFaces(chosen) {
    clear(view.groups.faces);
    if ($("layer-faces").checked) for (const face of plan.faces) view.groups.faces.add(faceQuad(face, face.rejection ? 0xa8261c : 0x2ca02c, 0.12));
    if (chosen) view.groups.faces.add(faceQuad(chosen, 0x0b63ce, 0.5));
    view.draw();
  }
  function lookAtAll() {
    const box = new THREE.Box3();
    for (const object of plan.objects)
      for (const node of object.boxes.slice(0, 1)) {
        const half = new THREE.Vector3(...node.extents_m).multiplyScalar(0.5);
        box.union(new THREE.Box3(half.clone().negate(), half).applyMatrix4(poseMatrix(node)));
      }
    if (box.isEmpty()) box.setFromCenterAndSize(new THREE.Vector3(), new THREE.Vector3(0.3, 0.3, 0.3));
    const size = Math.max(0.25, box.getSize(new THREE.Vector3()).length()), up = new THREE.Vector3(...plan.up);
    const side = new THREE.Vector3(1, 0, 0).cross(up).length() > 0.1 ? new THREE.Vector3(1, 0, 0) : new THREE.Vector3(0, 1, 0);
    const front = side.clone().cross(up).normalize();
    box.getCenter(view.controls.target);
    view.camera.up.copy(up);
    view.camera.position.copy(view.controls.target).addScaledVector(front, 1.35 * size).addScaledVector(side, 0.9 * size).addScaledVector(up, 0.8 * size);
    view.controls.update();
  }

  // From the side of the hand, a little from behind the palm.
  function lookAtGrasp(grasp) {
    const turn = new THREE.Matrix4().extractRotation(poseMatrix(grasp.palm_pose)), target = view.controls.target;
    const back = new THREE.Vector3(0.85, 0.3, -0.55).applyMatrix4(turn).normalize();
    const distance = view.camera.position.distanceTo(target);
    view.camera.position.copy(target).addScaledVector(back, distance);
    view.controls.update();
  }

  // --- panels

  function select(index) {
    selected = index;
    const grasp = plan.grasps[index];
    for (const tr of $("grasps").querySelectorAll("tbody tr")) tr.setAttribute("aria-selected", String(Number(tr.dataset.index) === index));
    $("selected").hidden = $("closing").hidden = !grasp;
    if (grasp) {
      $("selected-title").textContent = `Grasp ${index + 1}: score ${number(grasp.score, 3)}`;
      const joints = grasp.joints_rad, p = grasp.palm_pose.position_m;
      fill($("measures"), ["measure", "value", ""], [
        ...MEASURES.map(([name, words, unit], i) => row([`${name} ${words}`, number(grasp.quality[i], 5), unit])),
        row(["palm position", p.map((x) => number(x, 4)).join(", "), "m"]),
        row(["spread; F1, F2, F3", [joints.spread, joints.f1, joints.f2, joints.f3].map(degrees).join(" "), ""]),
        row(["box, face", `${grasp.box}, ${grasp.face}`, ""])]);
    }
    $("motion").value = 1;
    if (view && grasp) lookAtGrasp(grasp);
    if (view) showHand(1);
  }
  function play() {
    cancelAnimationFrame(playing);
    const start = performance.now(), duration = 2500;
    const step = (now) => {
      const share = Math.min(1, (now - start) / duration);
      $("motion").value = share;
      showHand(share);
      if (share < 1) playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  }
  function graspRow(grasp, i) {
    const tr = row([String(i + 1), number(grasp.score, 3), degrees(grasp.joints_rad.spread), String(grasp.box), String(grasp.face)]);
    tr.dataset.index = i;
    tr.tabIndex = 0;
    tr.addEventListener("click", () => select(i));
    tr.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); select(i); } });
    return tr;
  }
  function layer(name, text, checked) {
    const label = element("label"), input = element("input", undefined, { type: "checkbox", id: `layer-${name}` });
    input.checked = checked;
    label.append(input, text);
    input.addEventListener("change", () => {
      if (name === "faces") return showFaces(null);
      view.groups[name].visible = input.checked;
      view.draw();
    });
    return label;
  }
  function showLayers() {
    const levels = Math.max(0, ...plan.objects.flatMap((object) => object.boxes.map((box) => box.level)));
    const label = element("label", "level "), slider = element("input", undefined, { type: "range", id: "level", min: 0, max: levels, value: levels });
    slider.addEventListener("input", () => showLevel(Number(slider.value)));
    label.append(slider);
    const shown = [["cloud", "cloud", true], ["scene", "surroundings", true], ["boxes", "boxes", true], ["faces", "faces", false], ["grasps", "all grasps", true], ["hand", "hand", true]];
    $("layers").replaceChildren(...shown.map((entry) => layer(...entry)), label);
    for (const [name] of shown) if (view && name !== "faces") view.groups[name].visible = true;
    showLevel(levels);
  }
  function showGallery() {
    $("faces").replaceChildren(...plan.faces.filter((face) => face.image_png).map((face) => {
      const button = element("button", undefined, { type: "button", "aria-pressed": "false" });
      button.append(element("img", undefined, { src: `data:image/png;base64,${face.image_png}`, alt: `depth image of ${face.name}` }),
        element("div", `${face.name}: ${face.regions} regions, ${face.triplets} triplets, ${face.clear} clear`));
      button.addEventListener("click", () => {
        for (const other of $("faces").children) other.setAttribute("aria-pressed", String(other === button));
        if (view) showFaces(face);
        $("stage").scrollIntoView({ behavior: "smooth", block: "nearest" });
      });
      return button;
    }));
  }
  function showFunnel() {
    const { stages, rejected, notes } = plan.report;
    fill($("stages"), ["stage", "in", "out", "ms"], stages.map((stage) => row([stage.name, String(stage.in), String(stage.out), number(1000 * stage.time_s, 1)])));
    const reasons = Object.entries(rejected).sort((a, b) => b[1] - a[1]);
    fill($("rejected"), reasons.length ? ["rejected because", "candidates"] : null, reasons.map(([reason, count]) => row([reason, String(count)])));
    $("notes").replaceChildren(...notes.map((note) => element("li", note)));
  }
  function showScene() {
    for (const group of Object.values(view.groups)) clear(group);
    const pale = BOX_COLOURS.map((colour) => new THREE.Color(colour).lerp(new THREE.Color(dark ? 0x16181b : 0xffffff), 0.65));
    view.groups.scene.add(points(plan.scene, () => (dark ? 0x5a626c : 0xb4b9c0), 0.0015));
    for (const object of plan.objects) {
      const leaf = bytes(object.cloud.leaf_uint8), { drawn, points: all } = object.cloud;
      const seen = drawn * (1 - object.guessed / all);  // the guessed ones come last, and are drawn paler
      view.groups.cloud.add(points(object.cloud, (i) => (i < seen ? BOX_COLOURS : pale)[leaf[i] % BOX_COLOURS.length], 0.0025));
    }
    const best = Math.max(...plan.grasps.map((grasp) => grasp.score)), worst = Math.min(...plan.grasps.map((grasp) => grasp.score));
    for (const grasp of plan.grasps) {
      const share = best > worst ? (grasp.score - worst) / (best - worst) : 1;
      view.groups.grasps.add(graspMark(grasp, new THREE.Color().setHSL(share / 3, 0.75, 0.42)));
    }
    lookAtAll();
  }
  function show(next) {
    plan = next;
    $("title").textContent = plan.title ? `Boxgrasp: ${plan.title}` : "Boxgrasp";
    document.title = $("title").textContent;
    $("message").textContent = `${plan.message} (model ${plan.model_version}, ${number(plan.report.time_s, 2)} s)`;
    $("message").classList.toggle("bad", plan.outcome !== "grasps");
    fill($("grasps"), ["#", "score", "spread", "box", "face"], plan.grasps.map(graspRow));
    showFunnel();
    showGallery();
    if (view) {
      showScene();
      showLayers();
    }
    select(plan.grasps.length ? 0 : -1);
    document.body.dataset.ready = "true";
  }

  // --- the server's latest requests

  const milliseconds = (x) => (x === null ? "–" : `${(1000 * x).toFixed(0)} ms`);
  const percent = (share) => `${Math.round(100 * share)} %`;
  function uptime(s) {
    if (s < 120) return `${s.toFixed(0)} s`;
    return s < 7200 ? `${(s / 60).toFixed(0)} min` : s < 172800 ? `${(s / 3600).toFixed(1)} h` : `${(s / 86400).toFixed(1)} days`;
  }
  function fact(name, value, warning) {
    const div = element("div", undefined, warning ? { class: "fact warning" } : { class: "fact" });
    div.append(element("span", name), element("b", value));
    return div;
  }
  function bar(share, text) {
    const meter = element("progress", undefined, { max: 1, "aria-label": text });
    if (share !== null) meter.value = share;
    return meter;
  }
  function showTraining(training) {
    const idle = !training || training.state === "idle";
    $("training").replaceChildren(element("h2", "Training"));
    if (!training) return $("training").append(element("p", "No worker is heard.", { class: "hint" }));
    if (!idle) $("training").append(bar(training.progress, "training"), element("p",
      `${training.state}: ${training.stage || training.cause}` + (training.progress === null ? "" : `, ${percent(training.progress)}`) +
      (training.remaining_s === null ? "" : `, about ${uptime(training.remaining_s)} left`)));
    else $("training").append(element("p", `Idle; ${training.outcomes_waiting} outcomes wait. ${training.message}`, { class: "hint" }));
  }
  function showStatus(status) {
    const answered = Object.values(status.outcomes).reduce((a, b) => a + b, 0);
    $("status").replaceChildren(
      fact("running", `${status.running} of ${status.workers}`),
      fact("waiting", `${status.queue_length} of ${status.queue_capacity}`, status.overloaded),
      fact("half within", milliseconds(status.latency_s.p50)),
      fact("99 % within", milliseconds(status.latency_s.p99)),
      fact("answered", String(answered)),
      fact("with grasps", answered ? percent(status.outcomes.grasps / answered) : "–"),
      fact("model", status.model_version),
      fact("hand", status.hand),
      ...(status.training && status.training.progress !== null ? [fact("training", percent(status.training.progress))] : []),
      fact("server", `${status.version}, up ${uptime(status.uptime_s)}`));
    fill($("models"), ["model", "state", "created", "name"], status.models.map((model) => {
      const tr = row([model.version, model.state + (model.pinned ? ", pinned" : ""), model.created.slice(0, 10), model.name]);
      if (model.serving) tr.className = "serving";
      return tr;
    }));
    showTraining(status.training);
  }
  async function json(path) {
    const answer = await fetch(path, { cache: "no-store" });
    if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
    return answer.json();
  }
  function describe(entry) {
    return entry.outcome === "grasps" ? `${entry.num_grasps} grasp${entry.num_grasps === 1 ? "" : "s"}` : entry.outcome.replace("_", " ");
  }
  function follow() {
    $("live").hidden = false;
    let current = null, following = true;
    function mark() {
      for (const button of $("requests").children) button.setAttribute("aria-pressed", String(Number(button.dataset.id) === current));
      $("follow").checked = following;
    }
    async function open(id) {
      const scene = await json(`api/plans/${id}`);
      current = id;
      show(scene);
      mark();
    }
    // A plan may be gone by the time that it is asked for.
    const tryToOpen = (id) => open(id).catch((error) => complain(`That plan is no longer kept (${error.message}).`));
    function complain(words) {
      $("message").textContent = words;
      $("message").classList.add("bad");
    }
    function requestButton(entry) {
      const button = element("button", undefined, { type: "button", "data-id": entry.id, title: `${entry.request_id}: ${entry.message}`, class: entry.outcome === "grasps" ? "" : "none" });
      button.append(element("b", describe(entry)), element("span", entry.request_id), element("span", `${new Date(entry.utime / 1000).toLocaleTimeString()} · ${milliseconds(entry.time_s)}`));
      button.addEventListener("click", () => { following = false; tryToOpen(entry.id); });
      return button;
    }
    let listed = "";
    async function refresh() {
      try {
        showStatus(await json("api/status"));
        const { plans } = await json("api/plans"), ids = plans.map((entry) => entry.id).join();
        if (ids !== listed) $("requests").replaceChildren(...plans.map(requestButton));
        listed = ids;
        mark();
        if (!plans.length && !plan) $("message").textContent = "No request yet. This page shows each as it is answered.";
        if (plans.length && following && plans[0].id !== current) await open(plans[0].id);
        $("lost").hidden = true;
      } catch (error) {
        $("lost").textContent = `The server does not answer (${error.message}); trying again.`;
        $("lost").hidden = false;
      }
      setTimeout(refresh, 1000);
    }
    $("follow").addEventListener("change", (event) => { following = event.target.checked; });
    refresh();
  }

  $("motion").addEventListener("input", (event) => { if (view) showHand(Number(event.target.value)); });
  $("play").addEventListener("click", () => { if (view) play(); });
  view = makeView();
  if (PLAN) show(PLAN);
  else follow();
})();
