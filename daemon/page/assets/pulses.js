// Pulses: a message is a short bright stroke that runs along its wire.

const NS = "http://www.w3.org/2000/svg";
const LENGTH = 12;
const SPEED = 420; // of the drawing's units a second
const SHORTEST_MS = 250;
const LONGEST_MS = 900;
const still = matchMedia("(prefers-reduced-motion: reduce)");

/** Gives each branch of a wire the stroke that will run along it. */
export function layPulses(group) {
  for (const line of group.querySelectorAll(".line")) {
    const pulse = document.createElementNS(NS, "path");
    pulse.setAttribute("d", line.getAttribute("d"));
    pulse.setAttribute("class", "pulse");
    line.after(pulse);
  }
}

/** Lets a message run along every branch on which none runs yet. */
export function runPulses(group) {
  if (still.matches || document.hidden) return;
  for (const pulse of group.querySelectorAll(".pulse")) {
    if (pulse.getAnimations().length > 0) continue;
    const way = pulse.getTotalLength();
    if (!(way > 0) || pulse.getBoundingClientRect().width + pulse.getBoundingClientRect().height === 0) continue;
    pulse.setAttribute("stroke-dasharray", `${LENGTH} ${way + LENGTH}`);
    const duration = Math.min(LONGEST_MS, Math.max(SHORTEST_MS, (way / SPEED) * 1000));
    pulse.animate(
      [{ strokeDashoffset: LENGTH, opacity: 1 }, { strokeDashoffset: -way, opacity: 1 }],
      { duration, easing: "linear" },
    );
  }
}
