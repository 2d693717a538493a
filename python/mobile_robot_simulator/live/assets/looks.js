// Colours for light and dark. Those of things that must be told apart are Okabe and Ito's, which people tell apart who do not
// see red and green (jfly.uni-koeln.de/color). Lines also differ in their dashes, and marks in their shapes.
const ROBOTS = {
  light: ["#0072b2", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9"],
  dark: ["#56b4e9", "#2fd0a5", "#e39bc4", "#f0e442", "#8ab8ff"],
};

export const LOOKS = {
  light: {
    back: "#eceff3", free: 255, wall: 46, unknown: 222, ink: "#20242c", soft: "#20242c99", panel: "#ffffffe6", halo: "#ffffff",
    scan: "#d55e00", area: "#d55e0014", thing: "#e69f00", thingEdge: "#7a5200", goal: "#cc79a7", robots: ROBOTS.light,
  },
  dark: {
    back: "#0e1116", free: 30, wall: 205, unknown: 52, ink: "#e8ebf0", soft: "#e8ebf099", panel: "#1a1f27e6", halo: "#0e1116",
    scan: "#ff9a4d", area: "#ff9a4d17", thing: "#e6b84d", thingEdge: "#fff0c4", goal: "#e39bc4", robots: ROBOTS.dark,
  },
};

/** The look of the page now: "light" or "dark". */
export const lookName = () => (document.body.classList.contains("body--dark") ? "dark" : "light");
