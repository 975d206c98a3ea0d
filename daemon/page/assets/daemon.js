// Talking to the daemon: JSON in, JSON out, and never waiting for long.

const PATIENCE_MS = 2000;

async function ask(path, method) {
  const limit = new AbortController();
  const timer = setTimeout(() => limit.abort(), PATIENCE_MS);
  try {
    return await fetch(path, { method, signal: limit.signal, cache: "no-store" });
  } finally {
    clearTimeout(timer);
  }
}

/** The JSON at `path`; throws when the daemon does not answer. */
export async function get(path) {
  const answer = await ask(path, "GET");
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer.json();
}

/** Presses a button of the daemon. Returns nothing, or the words of its refusal. */
export async function press(path) {
  let answer;
  try {
    answer = await ask(path, "POST");
  } catch {
    return "the daemon does not answer";
  }
  if (answer.ok) return null;
  try {
    return (await answer.json()).error || `refused (${answer.status})`;
  } catch {
    return `refused (${answer.status})`;
  }
}
