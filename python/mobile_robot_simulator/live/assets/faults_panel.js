// FaultsPanel: faults that act, and new ones.

export const FaultsPanel = {
  props: ["session", "settings", "ask"],
  template: `
    <div class="live-panel">
      <div class="live-caption">Add a fault</div>
      <q-select dense options-dense outlined label="Example" :options="settings?.examples ?? []" :model-value="null" @update:model-value="(value) => { text = value; error = '' }" data-test="examples" />
      <q-input dense outlined v-model="text" label="Fault" class="q-mt-sm" hint="As with --fault. The times start and end are simulated seconds." hide-bottom-space
        :error="!!error" :error-message="error" @keydown.enter="add" data-test="fault" />
      <q-btn class="q-mt-sm" outline no-caps icon="add" label="Add the fault" :disable="!text" @click="add" data-test="add-fault" />
      <div class="live-caption">Faults</div>
      <div v-if="!session?.faults.length" class="live-soft">None. Faults lose or delay messages, let wheels slip, or stop a node.</div>
      <q-list v-else bordered separator>
        <q-item v-for="(fault, number) in session.faults" :key="number" :class="{ 'live-soft': fault.stopped }">
          <q-item-section><q-item-label class="live-mono">{{ fault.text }}</q-item-label><q-item-label caption>{{ fault.stopped ? "stopped" : fault.acts ? "acts now" : "does not act now" }}</q-item-label></q-item-section>
          <q-item-section side><q-toggle :model-value="!fault.stopped" :disable="fault.stopped" @update:model-value="ask({ kind: 'stop_fault', number }).catch(say)"><q-tooltip>Turn the fault off</q-tooltip></q-toggle></q-item-section>
        </q-item>
      </q-list>
    </div>`,
  data: () => ({ text: "", error: "" }),
  methods: {
    say(error) { this.error = error.message; },
    async add() {
      try { await this.ask({ kind: "add_fault", text: this.text }); this.text = this.error = ""; } catch (error) { this.say(error); }
    },
  },
};
