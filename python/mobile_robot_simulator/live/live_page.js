// The page of a live view.
import { Camera, drawScene, FaultsPanel, isTyping, KeepPanel, Link, LOOKS, lookName, MapImage, Pad, ParametersPanel, saveFile, Steering, styled, Tools, TOOLS, VelocityPlot } from "live";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 50];
const LAYERS = { points: "Scan", area: "Seen area", path: "Path", odometry: "What odometry believes", contacts: "Contacts", velocity: "Velocity of obstacles" };
const fixed = (value) => (Math.abs(value) < 0.005 ? "0.00" : value.toFixed(2)); // not -0.00
const TEXTS_EVERY = 100; // ms; texts that change faster cannot be read

export default {
  components: { FaultsPanel, KeepPanel, Pad, ParametersPanel },
  props: { viewer: String },
  template: `
  <div class="live" :class="{ 'live-with-panel': panel && !replay, 'live-replay': replay }">
    <canvas ref="canvas" class="live-canvas" :data-tool="tool" data-test="map"></canvas>

    <div class="live-bar">
      <q-btn flat dense :icon="session?.paused ? 'play_arrow' : 'pause'" @click="ask({ kind: 'pause', paused: !session.paused })" data-test="pause"><q-tooltip>{{ session?.paused ? "Let time run" : "Stop the time" }} (space)</q-tooltip></q-btn>
      <q-btn flat dense icon="skip_next" @click="ask({ kind: 'step', seconds: 0.1 })" data-test="step"><q-tooltip>Run 0.1 s, then stop the time (.)</q-tooltip></q-btn>
      <q-select dense borderless options-dense class="live-speed" :options="speeds" emit-value map-options :model-value="session?.speed ?? 1" @update:model-value="(factor) => ask({ kind: 'speed', factor })" data-test="speed"><q-tooltip>Simulated seconds per second</q-tooltip></q-select>
      <div class="live-time" data-test="time"><b>{{ shown.time }}</b> s <span class="live-soft">{{ session?.paused ? "paused" : shown.rate + " × real time" }}</span></div>
      <q-separator v-if="!replay" vertical inset />
      <q-btn v-if="!replay" flat dense icon="restart_alt" @click="ask({ kind: 'reset' })" data-test="reset"><q-tooltip>Put all robots back to their start poses</q-tooltip></q-btn>
      <q-btn v-if="!replay" flat dense icon="casino" data-test="seed"><q-tooltip>Seed of the noise</q-tooltip>
        <q-menu><div class="live-menu"><q-input dense outlined v-model="seed" type="number" label="Seed of all noise from now on" :error="!!seedError" :error-message="seedError" hide-bottom-space @keydown.enter="setSeed" data-test="seed-value" /><q-btn outline no-caps label="Use this seed" @click="setSeed" /></div></q-menu></q-btn>
      <q-space />
      <q-select v-if="robots.length > 1" dense borderless options-dense :options="robots" :model-value="robot" @update:model-value="choose" class="live-robot" data-test="robot"><template #prepend><q-icon name="smart_toy" /></template></q-select>
      <q-btn v-if="!replay" flat dense :icon="pilot === 'wander' ? 'stop' : 'explore'" @click="ask({ kind: 'autopilot', robot, driver: pilot === 'wander' ? null : 'wander' })" data-test="wander"><q-tooltip>{{ pilot === "wander" ? "Stop the driver" : "Let the robot wander" }}</q-tooltip></q-btn>
      <q-btn flat dense icon="layers"><q-tooltip>What is shown</q-tooltip><q-menu><div class="live-menu"><q-toggle v-for="(title, name) in titles" :key="name" dense v-model="layers[name]" :label="title" @update:model-value="redraw" /></div></q-menu></q-btn>
      <q-btn flat dense icon="dark_mode" @click="toggleDark" data-test="dark"><q-tooltip>Light or dark</q-tooltip></q-btn>
      <q-btn flat dense icon="help_outline" @click="help = true" data-test="help"><q-tooltip>What keys do (?)</q-tooltip></q-btn>
      <q-btn v-if="!replay" flat dense icon="menu_open" @click="panel = !panel" data-test="panel"><q-tooltip>Parameters, faults, recordings</q-tooltip></q-btn>
    </div>

    <div class="live-tools">
      <q-btn v-for="each in replay ? [] : tools" :key="each.name" flat dense :icon="each.icon" :class="{ 'live-chosen': tool === each.name }" :aria-label="each.help" @click="use(each.name)" :data-tool-name="each.name"><q-tooltip anchor="center right" self="center left">{{ each.help }} ({{ each.key }})</q-tooltip></q-btn>
      <q-separator v-if="!replay" />
      <q-btn flat dense icon="add" @click="zoom(1.4)"><q-tooltip anchor="center right" self="center left">Zoom in (+)</q-tooltip></q-btn>
      <q-btn flat dense icon="remove" @click="zoom(1 / 1.4)"><q-tooltip anchor="center right" self="center left">Zoom out (−)</q-tooltip></q-btn>
      <q-btn flat dense icon="fit_screen" @click="fit"><q-tooltip anchor="center right" self="center left">Show the whole map (f)</q-tooltip></q-btn>
      <q-btn flat dense icon="my_location" :class="{ 'live-chosen': follows }" @click="follow"><q-tooltip anchor="center right" self="center left">Follow the robot (c)</q-tooltip></q-btn>
    </div>

    <div v-if="hint" class="live-hint" data-test="hint">{{ hint }}</div>
    <div v-if="!open" class="live-lost" data-test="lost"><q-spinner v-if="began" /> {{ began ? "The connection is lost. This page connects again as soon as the simulator runs." : "Connecting" }}</div>
    <div v-if="open && viewers.count > 1" class="live-viewers" data-test="viewers">{{ viewers.count }} viewers · {{ viewers.holds ? "you hold the controls" : viewers.free ? "nobody holds the controls" : "another holds the controls" }} <q-btn v-if="!viewers.holds && !viewers.free" dense outline no-caps size="sm" label="Take the controls" @click="link().send({ kind: 'take_controls' })" data-test="take-controls" /></div>

    <div class="live-corner">
      <div class="live-plot"><div class="live-legend"><span><i class="live-v"></i>speed {{ shown.v }} m/s</span><span><i class="live-w"></i>turn {{ shown.w }} rad/s</span></div><canvas ref="plot"></canvas></div>
      <div class="live-line"><span class="live-scale" :style="{ width: bar.pixels + 'px' }"></span><span data-test="scale">{{ bar.text }}</span><span class="live-cursor" data-test="cursor">{{ shown.cursor }}</span></div>
    </div>

    <div v-if="replay" class="live-timeline" data-test="timeline">
      <span>{{ clock(scrub ?? at) }}</span>
      <q-slider :min="0" :max="replay.duration" :step="0" :model-value="scrub ?? at" aria-label="Time in the recording" @update:model-value="seek" @change="scrub = null" data-test="time-line" />
      <span>{{ clock(replay.duration) }}</span>
    </div>

    <div v-if="!replay" class="live-drive">
      <pad :steering="() => steering" />
      <div class="live-top"><span class="live-soft">top speed</span><q-slider v-model="top" :min="0.1" :max="3" :step="0.1" dense /><span>{{ top.toFixed(1) }} m/s</span></div>
    </div>

    <div v-if="panel && !replay" class="live-side" data-test="side">
      <q-tabs v-model="tab" dense no-caps align="justify"><q-tab name="parameters" label="Parameters" /><q-tab name="faults" label="Faults" /><q-tab name="keep" label="Keep" /></q-tabs>
      <q-separator />
      <q-tab-panels v-model="tab" keep-alive class="live-panels">
        <q-tab-panel name="parameters"><parameters-panel :choices="choices" :settings="settings" :robot="robot" :ask="tell" /></q-tab-panel>
        <q-tab-panel name="faults"><faults-panel :session="session" :settings="settings" :ask="tell" /></q-tab-panel>
        <q-tab-panel name="keep"><keep-panel :session="session" :robot="robot" :ask="tell" :picture="picture" /></q-tab-panel>
      </q-tab-panels>
    </div>

    <div class="live-notes" role="status"><transition-group name="live-note"><div v-for="note in notes" :key="note.key" class="live-note" data-test="note">{{ note.text }}</div></transition-group></div>

    <q-dialog v-model="help"><q-card style="max-width: 560px"><q-card-section>
      <div class="text-h6">{{ replay ? "Recording" : "Live view" }}</div>
      <p v-if="!replay">Drive with the arrow keys, with w a s d, with a gamepad, or with the pad at the lower right. q and e move sideways.</p>
      <table class="live-keys"><tr v-if="replay"><td><kbd>←</kbd> <kbd>→</kbd></td><td>Go back or on by a second</td></tr><tr v-for="each in replay ? [] : tools" :key="each.key"><td><kbd>{{ each.key }}</kbd></td><td>{{ each.help }}</td></tr>
        <tr><td><kbd>space</kbd> <kbd>.</kbd></td><td>Stop the time or let it run; run 0.1 s</td></tr>
        <tr><td><kbd>f</kbd> <kbd>c</kbd> <kbd>+</kbd> <kbd>−</kbd></td><td>Show the whole map, follow the robot, zoom</td></tr>
        <tr><td><kbd>esc</kbd></td><td>Back to looking</td></tr></table>
      <p class="live-soft">The filled shape is where the robot is. The dashed outline and the dashed line are where its odometry believes it is and was. Crosses are contacts.</p>
    </q-card-section><q-card-actions align="right"><q-btn flat no-caps label="Close" v-close-popup /></q-card-actions></q-card></q-dialog>
  </div>`,
  data: () => ({
    open: false, began: false, session: null, settings: null, choices: null, viewers: { count: 1, holds: true, free: true }, replay: null, at: 0, scrub: null, robots: [], robot: "",
    shown: { time: "0.00", rate: "1", cursor: "", v: "0.00", w: "0.00" }, bar: { pixels: 100, text: "" },
    tool: "look", tools: TOOLS, titles: LAYERS, layers: Object.fromEntries(Object.keys(LAYERS).map((name) => [name, true])),
    panel: innerWidth > 1100, tab: "parameters", help: false, follows: false, top: 0.8, notes: [], seed: "", seedError: "",
  }),
  computed: {
    speeds() { return [...new Set([...SPEEDS, this.session?.speed ?? 1])].sort((a, b) => a - b).map((value) => ({ value, label: `${value}×` })); },
    hint() { return this.tool === "look" ? "" : TOOLS.find((each) => each.name === this.tool).help; },
    pilot() { return this.session?.pilots[this.robot]?.title; },
  },
  watch: { panel() { this.$nextTick(() => this.resize()); } },
  mounted() {
    // What changes with each frame stays out of Vue, which would look for changes in thousands of numbers.
    Object.assign(this, { camera: new Camera(), plotter: new VelocityPlot(), cursor: null, sketch: null, mapImage: null, cells: null, framed: false, dirty: false, textsAt: 0, drawCount: 0 });
    const connection = new Link(this.viewer, (names) => this.take(names));
    this.link = () => connection;
    this.steering = new Steering((v, side, w) => this.drive(v, side, w));
    const page = this;
    new Tools(this.$refs.canvas, {
      get link() { return connection; }, get camera() { return page.camera; }, get tool() { return page.tool; }, get robot() { return page.robot; },
      get cursor() { return page.cursor; }, set cursor(place) { page.cursor = place; }, get sketch() { return page.sketch; }, set sketch(sketch) { page.sketch = sketch; },
      ask: (input) => this.ask(input), choose: (name) => this.choose(name), redraw: () => this.redraw(), say: (text) => this.say(text),
    });
    this.keydown = (event) => this.key(event);
    addEventListener("keydown", this.keydown, true);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.$refs.canvas);
    this.themes = new MutationObserver(() => { this.paint(); this.redraw(); });
    this.themes.observe(document.body, { attributes: true, attributeFilter: ["class"] });
    window.liveView = this;
  },
  unmounted() { this.steering.close(); this.link().close(); removeEventListener("keydown", this.keydown, true); this.observer.disconnect(); this.themes.disconnect(); },
  methods: {
    // --- what comes from the simulation ---
    take(names) {
      const connection = this.link(), { parts } = connection;
      this.open = connection.open;
      this.began ||= this.open;
      for (const name of ["session", "settings", "choices", "viewers", "replay"]) if (names.has(name)) this[name] = Object.freeze(parts[name]);
      for (const text of connection.notes.splice(0)) this.say(text);
      if (names.has("map")) this.loadMap(parts.map);
      if (names.has("now")) {
        const robots = Object.keys(parts.now.robots);
        if (robots.join() !== this.robots.join()) { this.robots = robots; if (!robots.includes(this.robot)) this.robot = robots[0] ?? ""; }
        const own = parts.now.robots[this.robot];
        if (this.replay && Math.abs(parts.now.time - this.lastTime) > Math.max(0.5, this.session.speed)) this.plotter.rows = []; // it was moved on the time line
        this.lastTime = parts.now.time;
        if (own) this.plotter.add(this.robot, parts.now.time, own.velocity);
        if (this.camera.follows && own) [this.camera.x, this.camera.y] = own.pose;
      }
      if (this.open) this.redraw(true);
    },
    async loadMap(map) {
      [this.cells] = await Promise.all([this.link().cells(), styled]);
      this.paint();
      if (!this.framed) { this.framed = true; this.resize(); this.fit(); }
      this.redraw();
    },
    paint() { if (this.cells) this.mapImage = new MapImage(this.link().parts.map, this.cells, LOOKS[lookName()]); },

    // --- what is drawn ---
    /** Draws with the next frame of the screen. @param tells Tell the simulator then, which sends more only when its last frames are drawn. */
    redraw(tells = false) {
      this.tells = (this.tells ?? 0) + (tells === true ? 1 : 0);
      if (this.dirty) return;
      this.dirty = true;
      requestAnimationFrame(() => { this.dirty = false; this.draw(); });
    },
    draw() {
      const canvas = this.$refs.canvas, connection = this.link(), look = LOOKS[lookName()];
      if (!canvas) return;
      drawScene(canvas.getContext("2d"), { link: connection, camera: this.camera, look, mapImage: this.mapImage, layers: this.layers, robot: this.robot, sketch: this.sketch, ratio: devicePixelRatio });
      for (; this.tells > 0; this.tells--) connection.send({ kind: "drawn" });
      this.drawCount++;
      this.drawnScan = connection.scanCount;
      this.drawnAt = performance.now();
      if (this.drawnAt - this.textsAt > TEXTS_EVERY) this.write(look);
      else { clearTimeout(this.later); this.later = setTimeout(() => this.write(LOOKS[lookName()]), TEXTS_EVERY); }
    },
    write(look) {
      this.textsAt = performance.now();
      const { parts } = this.link(), now = parts.now, metres = this.camera.barLength(140);
      this.bar = { pixels: metres * this.camera.scale, text: metres >= 1000 ? `${metres / 1000} km` : metres >= 1 ? `${metres} m` : `${+(100 * metres).toPrecision(3)} cm` };
      this.follows = this.camera.follows;
      if (!now) return;
      this.at = now.time;
      const [vx, vy, wz] = now.robots[this.robot]?.velocity ?? [0, 0, 0], speed = Math.abs(vy) > Math.abs(vx) ? vy : vx;
      this.shown = { time: now.time.toFixed(2), rate: now.rate.toFixed(now.rate < 10 ? 2 : 0), cursor: this.cursor ? this.describe(this.cursor) : "", v: fixed(speed), w: fixed(wz) };
      if (this.$refs.plot) this.plotter.draw(this.$refs.plot, look);
    },
    describe([x, y]) {
      const map = this.link().parts.map, text = `x ${x.toFixed(2)} m, y ${y.toFixed(2)} m`;
      if (!map || !this.cells) return text;
      const [ox, oy, yaw] = map.origin, cos = Math.cos(yaw), sin = Math.sin(yaw);
      const column = Math.floor((cos * (x - ox) + sin * (y - oy)) / map.resolution), row = Math.floor((-sin * (x - ox) + cos * (y - oy)) / map.resolution);
      if (row < 0 || column < 0 || row >= map.rows || column >= map.columns) return `${text} · off the map`;
      const value = this.cells[row * map.columns + column];
      return `${text} · row ${row}, column ${column} · ${value < 0 ? "unknown" : value >= map.threshold ? `occupied (${value})` : `free (${value})`}`;
    },
    resize() {
      const canvas = this.$refs.canvas;
      if (!canvas) return;
      const { clientWidth: width, clientHeight: height } = canvas;
      Object.assign(this.camera, { width, height });
      Object.assign(canvas, { width: Math.round(width * devicePixelRatio), height: Math.round(height * devicePixelRatio) });
      this.draw();
    },
    fit() { this.camera.follows = false; if (this.link().parts.map) this.camera.fit(this.link().parts.map, [64, 60, 20, 40]); this.redraw(); },
    zoom(factor) { this.camera.zoom(factor, [this.camera.width / 2, this.camera.height / 2]); this.redraw(); },
    follow() { this.camera.follows = this.follows = !this.camera.follows; this.redraw(); },
    picture() { this.draw(); this.$refs.canvas.toBlob((blob) => saveFile(blob, `live-${this.shown.time}s.png`)); },
    toggleDark() { this.$q.dark.toggle(); },

    // --- what goes to the simulation ---
    /** Sends an input. Shows the reason if it is refused. */
    ask(input) { return this.tell(input).catch((error) => this.say(error.message)); },
    /** Sends an input. Rejects with the reason if it is refused. */
    tell(input) { return this.link().ask(input); },
    /** Goes to a time of a recording [s], at most every 50 ms while the time line is dragged. */
    seek(wanted) {
      const time = this.scrub = Math.max(0, Math.min(wanted, this.replay.duration));
      this.seeking ||= setTimeout(() => { this.seeking = 0; this.ask({ kind: "seek", time: this.wantedTime }); }, 50);
      Object.assign(this, { wantedTime: time, soughtAt: performance.now() }); // what comes from the simulator is older for a moment
    },
    clock(time) { const tenths = Math.round(time * 10); return `${Math.floor(tenths / 600)}:${((tenths % 600) / 10).toFixed(1).padStart(4, "0")}`; },
    drive(v, side, w) {
      if (this.replay) return;
      if ((v || side || w) && this.session?.paused) this.say("Time stands still. Press space to let it run.");
      this.ask({ kind: "drive", robot: this.robot, vx: v * this.top, vy: side * this.top, wz: w * Math.max(1, 1.25 * this.top) });
    },
    async setSeed() {
      try { await this.tell({ kind: "seed", seed: Number(this.seed) }); this.seedError = ""; this.say(`The noise has the seed ${this.seed} from now on.`); } catch (error) { this.seedError = error.message; }
    },
    choose(name) { this.robot = name; this.steering.blur(); this.redraw(); },
    use(tool) { this.tool = tool; this.sketch = null; this.redraw(); },
    say(text) {
      if (this.notes.some((note) => note.text === text)) return;
      const note = { text, key: performance.now() };
      this.notes.push(note);
      setTimeout(() => { this.notes = this.notes.filter((each) => each.key !== note.key); }, 5000);
    },
    key(event) {
      if (isTyping() || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      const tool = this.replay ? null : TOOLS.find((each) => each.key === event.key.toLowerCase()), skip = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (this.replay && skip) { this.seek((performance.now() - this.soughtAt < 300 ? this.wantedTime : this.link().parts.now.time) + skip); this.scrub = null; }
      const actions = {
        " ": () => this.ask({ kind: "pause", paused: !this.session?.paused }), ".": () => this.ask({ kind: "step", seconds: 0.1 }), "?": () => { this.help = true; },
        "+": () => this.zoom(1.4), "-": () => this.zoom(1 / 1.4), f: () => this.fit(), c: () => this.follow(), Escape: () => this.use("look"),
      };
      const action = tool ? () => this.use(tool.name) : actions[event.key];
      if (!action) return;
      event.preventDefault();
      event.stopPropagation();
      action();
    },
  },
};
