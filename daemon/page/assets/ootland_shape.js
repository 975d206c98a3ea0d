// Shapes of the pictures of OOTland, and the colours of its trucks.

const SPACE = "http://www.w3.org/2000/svg";

/** A new picture of a size, with a name for those who do not see it. */
export function picture(wide, high, label) {
  const made = document.createElementNS(SPACE, "svg");
  made.setAttribute("viewBox", `0 0 ${wide} ${high}`);
  made.setAttribute("role", "img");
  made.setAttribute("aria-label", label);
  return made;
}

/** Puts a new SVG element into `parent`. */
export function shape(tag, properties, parent, text) {
  const made = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(properties)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

/** Gives a shape the colour of a truck; the page's policy allows no style in attributes. */
export function paint(made, seat) {
  made.style.setProperty("--truck", `var(--truck-${seat % 8})`);
}
