// ParametersPanel: the parameters of the chosen robot and of its scanners. A refused value stays in its field, with the reason.

export const ParametersPanel = {
  props: ["choices", "settings", "robot", "ask"],
  template: `
    <div class="live-panel">
      <q-input v-model="filter" dense outlined clearable placeholder="Find a parameter, such as frequency" class="q-mb-sm" data-test="filter">
        <template #prepend><q-icon name="search" /></template>
      </q-input>
      <template v-for="node in nodes" :key="node.scanner">
        <div class="live-caption">{{ node.title }}</div>
        <div v-for="field in shown(node)" :key="field.name" class="live-field" :data-parameter="field.name">
          <q-select v-if="field.choices" dense options-dense outlined :label="field.name" :options="field.choices" :model-value="node.values[field.name]"
            :error="!!errors[node.key + field.name]" :error-message="errors[node.key + field.name]" hide-bottom-space @update:model-value="(value) => set(node, field, value)">
            <q-tooltip anchor="center left" self="center right" max-width="280px" :delay="400">{{ field.help }}</q-tooltip>
          </q-select>
          <q-input v-else dense outlined :label="field.name" :suffix="field.unit" :hint="field.limits || undefined" hide-bottom-space
            :model-value="drafts[node.key + field.name] ?? node.values[field.name]" :error="!!errors[node.key + field.name]" :error-message="errors[node.key + field.name]"
            @update:model-value="(value) => (drafts[node.key + field.name] = value)" @keydown.enter="$event.target.blur()" @keydown.esc="forget(node, field)" @blur="set(node, field, drafts[node.key + field.name])">
            <q-tooltip anchor="center left" self="center right" max-width="280px" :delay="400">{{ field.help }}</q-tooltip>
          </q-input>
        </div>
      </template>
      <q-toggle v-if="!filter" v-model="names" dense label="Also rates, topics and frames" class="q-mt-sm" />
      <div v-if="!count" class="live-soft">No parameter has “{{ filter }}” in its name or description.</div>
    </div>`,
  data: () => ({ filter: "", names: false, drafts: {}, errors: {} }),
  watch: { robot() { this.drafts = {}; this.errors = {}; } },
  computed: {
    nodes() {
      const own = (this.settings?.nodes ?? []).filter((each) => each.robot === this.robot);
      const title = (each) => (each.scanner === null ? "Robot" : each.scanner ? `Scanner ${each.scanner}` : "Scanner");
      return own.map((each) => ({ ...each, key: `${each.robot}/${each.scanner}/`, title: title(each), fields: this.choices?.fields[each.scanner === null ? "robot" : "scanner"] ?? [] }));
    },
    count() { return this.nodes.reduce((sum, node) => sum + this.shown(node).length, 0); },
  },
  methods: {
    shown(node) {
      const words = (this.filter ?? "").toLowerCase().split(/\s+/).filter(Boolean);
      if (!words.length) return node.fields.filter((field) => this.names || !field.is_seldom);
      return node.fields.filter((field) => words.every((word) => field.name.includes(word) || field.help.toLowerCase().includes(word)));
    },
    forget(node, field) { delete this.drafts[node.key + field.name]; delete this.errors[node.key + field.name]; },
    async set(node, field, value) {
      const key = node.key + field.name;
      if (value === undefined) return;
      if (value === node.values[field.name]) return this.forget(node, field);
      try {
        await this.ask({ kind: "set_parameter", robot: node.robot, scanner: node.scanner, name: field.name, value: String(value ?? "") });
        this.forget(node, field);
      } catch (error) { this.errors[key] = error.message; }
    },
  },
};
