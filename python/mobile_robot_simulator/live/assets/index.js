// What the page live_page.js is made of.
export { Camera } from "live/camera.js";
export { FaultsPanel } from "live/faults_panel.js";
export { KeepPanel, saveFile } from "live/keep_panel.js";
export { Link } from "live/link.js";
export { LOOKS, lookName } from "live/looks.js";
export { MapImage } from "live/map_image.js";
export { Pad } from "live/pad.js";
export { ParametersPanel } from "live/parameters_panel.js";
export { drawScene } from "live/scene.js";
export { isTyping, Steering } from "live/steering.js";
export { Tools, TOOLS } from "live/tools.js";
export { VelocityPlot } from "live/velocity_plot.js";

const style = document.createElement("link");
Object.assign(style, { rel: "stylesheet", href: new URL("live.css", import.meta.url).href });
/** Resolves when the style is there. Before, nothing on the page has its size. */
export const styled = new Promise((resolve) => style.addEventListener("load", resolve));
document.head.append(style);
