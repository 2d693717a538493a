// KeepPanel: recordings, states, the picture, and what was done as Python.

export const KeepPanel = {
  props: ["session", "robot", "ask", "picture"],
  template: `
    <div class="live-panel">
      <div class="live-caption">Recording</div>
      <template v-if="session?.recording"><div class="q-mb-sm">Recording to <span class="live-mono">{{ session.recording }}</span></div>
        <q-btn outline no-caps icon="stop" label="End the recording" @click="record(null)" data-test="end-recording" /></template>
      <template v-else>
        <q-input dense outlined v-model="name" label="Name" :placeholder="session?.free_name" :hint="'An MCAP bag of all topics from here on, in ' + session?.folder" hide-bottom-space :error="!!errors.record" :error-message="errors.record" data-test="recording-name" />
        <q-btn class="q-mt-sm" outline no-caps icon="fiber_manual_record" label="Record from here on" @click="record(name || session.free_name)" data-test="record" />
        <div v-if="saved" class="live-soft q-mt-sm">Saved as <span class="live-mono">{{ saved }}</span></div>
      </template>
      <div class="live-caption">States</div>
      <q-input dense outlined v-model="state" label="Name" :placeholder="freeState" hide-bottom-space hint="The whole simulation as it is now, to come back to" :error="!!errors.state" :error-message="errors.state" data-test="state-name" />
      <q-btn class="q-mt-sm" outline no-caps icon="bookmark_add" label="Save the state" @click="save" data-test="save-state" />
      <q-list v-if="Object.keys(session?.states ?? {}).length" bordered separator class="q-mt-sm">
        <q-item v-for="(time, each) in session.states" :key="each" clickable @click="act('state', { kind: 'restore_state', name: each })" :data-state="each">
          <q-item-section>{{ each }}<q-item-label caption>at {{ time.toFixed(2) }} s</q-item-label></q-item-section><q-item-section side><q-icon name="restore" /></q-item-section><q-tooltip>Go back to this state</q-tooltip>
        </q-item>
      </q-list>
      <div class="live-caption">What was done</div>
      <div class="live-row">
        <q-btn outline no-caps icon="code" label="Copy as Python" @click="show('copy_as_python')" data-test="copy-as-python" />
        <q-btn outline no-caps icon="table_rows" label="Commands" @click="show('copy_commands')" data-test="copy-commands" />
      </div>
      <div class="live-caption">Picture</div>
      <q-btn outline no-caps icon="photo_camera" label="Save the picture" @click="picture" data-test="picture" />
      <q-dialog v-model="open">
        <q-card style="width: 760px; max-width: 92vw">
          <q-card-section class="row items-center no-wrap"><div>{{ about }}</div></q-card-section>
          <q-card-section class="q-py-none"><pre class="live-script" data-test="script">{{ text }}</pre></q-card-section>
          <q-card-actions align="right"><q-btn flat no-caps icon="content_copy" :label="copied ? 'Copied' : 'Copy'" @click="copy" /><q-btn flat no-caps icon="download" label="Save" @click="download" data-test="download" /><q-btn flat no-caps label="Close" v-close-popup /></q-card-actions>
        </q-card>
      </q-dialog>
    </div>`,
  data: () => ({ name: "", state: "", saved: "", errors: {}, open: false, text: "", about: "", file: "", copied: false }),
  computed: { freeState() { let n = 1; while (`state ${n}` in (this.session?.states ?? {})) n++; return `state ${n}`; } },
  methods: {
    async act(field, input) {
      this.errors[field] = "";
      try { return await this.ask(input); } catch (error) { this.errors[field] = error.message; }
    },
    async record(name) {
      const path = await this.act("record", { kind: "record", name });
      if (name === null && path) { this.saved = path; this.name = ""; }
    },
    async save() { await this.act("state", { kind: "save_state", name: this.state || this.freeState }); this.state = ""; },
    async show(kind) {
      const python = kind === "copy_as_python";
      const text = await this.act("script", python ? { kind } : { kind, robot: this.robot });
      if (text === undefined) return;
      Object.assign(this, { text, open: true, copied: false, file: python ? "repeat.py" : "commands.csv" });
      this.about = python ? "This script makes the same calls at the same simulated times. The messages are the same, byte for byte." : "The commands of the robot, for: mobile-robot-simulator run --commands commands.csv";
      if (python) this.copy();
    },
    async copy() { try { await navigator.clipboard.writeText(this.text); this.copied = true; } catch { this.copied = false; } },
    download() { saveFile(new Blob([this.text], { type: "text/plain" }), this.file); },
  },
};

/** Lets the browser save a file. */
export function saveFile(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
