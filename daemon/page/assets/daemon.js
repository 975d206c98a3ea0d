// Talking to the daemon: JSON in, JSON out, and never waiting for long.

const PATIENCE_MS = 2000;

const KEY = "subsumed-token";
const form = document.getElementById("token-form");

/** The daemon is on another machine and wants the token. */
export class TokenWanted extends Error {}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  sessionStorage.setItem(KEY, document.getElementById("token").value.trim());
  form.hidden = true;
});

async function ask(path, method) {
  const limit = new AbortController();
  const timer = setTimeout(() => limit.abort(), PATIENCE_MS);
  const token = sessionStorage.getItem(KEY);
  const headers = token ? { Authorization: `Bearer ${token}` } : {};
  try {
    const answer = await fetch(path, { method, headers, signal: limit.signal, cache: "no-store" });
    form.hidden = answer.status !== 401;
    return answer;
  } finally {
    clearTimeout(timer);
  }
}

/** The JSON at `path`; throws when the daemon does not answer. */
export async function get(path) {
  const answer = await ask(path, "GET");
  if (answer.status === 401) throw new TokenWanted("the daemon wants its token");
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
