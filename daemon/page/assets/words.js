// Numbers and values as short words.

/** A number with about three digits. */
export function number(value) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e6) return String(value);
  if (size >= 1e6) return `${(value / 1e6).toFixed(1)}M`;
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : 2);
}

/** A span of time given in milliseconds. */
export function span(ms) {
  if (typeof ms !== "number" || !Number.isFinite(ms)) return "–";
  if (ms < 1) return `${number(Math.round(ms * 1000))} µs`;
  if (ms < 1000) return `${ms < 10 ? +ms.toFixed(1) : Math.round(ms)} ms`;
  const seconds = ms / 1000;
  if (seconds < 120) return `${+seconds.toFixed(seconds < 10 ? 1 : 0)} s`;
  return seconds < 7200 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

/** A moment since the start, as 1:02:03.4. */
export function moment(seconds) {
  if (typeof seconds !== "number" || !Number.isFinite(seconds)) return "";
  const tenths = Math.max(0, Math.floor(seconds * 10));
  const whole = Math.floor(tenths / 10);
  const two = (part) => String(part).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  const tail = `${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}.${tenths % 10}`;
  return hours > 0 ? `${hours}:${tail}` : tail;
}

/** What a wire carries, on one line. */
export function value(carried) {
  if (carried === null || carried === undefined) return "–";
  if (typeof carried === "number") return number(carried);
  if (typeof carried === "boolean") return carried ? "yes" : "no";
  if (Array.isArray(carried)) return carried.map(value).join("  ");
  if (typeof carried === "object") {
    return Object.entries(carried).map(([name, part]) => `${name} ${value(part)}`).join(", ");
  }
  return String(carried);
}

/** `list` if it is one, else an empty one. */
export function listed(list) {
  return Array.isArray(list) ? list : [];
}

/** Sets an element's text only when it differs, so that nothing is drawn twice. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
