// Pad: a stick on the screen. Up drives forward, left and right turn.

export const Pad = {
  props: ["steering"],
  template: `
    <div class="live-pad" ref="pad" data-test="pad" @pointerdown="down" @pointermove="move" @pointerup="up" @pointercancel="up">
      <q-icon name="keyboard_arrow_up" class="live-pad-up" /><q-icon name="keyboard_arrow_down" class="live-pad-down" />
      <q-icon name="keyboard_arrow_left" class="live-pad-left" /><q-icon name="keyboard_arrow_right" class="live-pad-right" />
      <div class="live-knob" :style="{ transform: 'translate(' + -50 * place[1] + 'px,' + -50 * place[0] + 'px)' }"></div>
    </div>`,
  data: () => ({ place: [0, 0], held: false }),
  methods: {
    down(event) { this.$refs.pad.setPointerCapture(event.pointerId); this.held = true; this.move(event); },
    up() { this.held = false; this.place = [0, 0]; this.steering().setPad(null); },
    move(event) {
      if (!this.held) return;
      const box = this.$refs.pad.getBoundingClientRect(), half = box.width / 2;
      const [x, y] = [(event.clientX - box.left - half) / half, (event.clientY - box.top - half) / half], length = Math.max(1, Math.hypot(x, y));
      this.place = [-y / length, -x / length];
      this.steering().setPad(this.place);
    },
  },
};
