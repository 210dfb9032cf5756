// Questions to the server. Of each lane one is under way; the newest that waits is asked next.

const TAB = Array.from(crypto.getRandomValues(new Uint8Array(9)), byte => byte.toString(36)).join("");
let counted = 0;

export async function ask(lane, body, signal) {
  const response = await fetch(lane, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ tab: TAB, number: ++counted, ...body }),
    signal,
  });
  const answer = await response.json();
  if (response.status === 409) return null;
  if (!response.ok) throw new Error(answer.error ?? `the server answered ${response.status}`);
  return answer;
}

// A lane asks `question()` when it is told to, `delay` after the last word; `take(answer, body)`
// gets the answer, unless a newer question made it old and `keep` is false.
export function makeLane(name, { question, take, fail, delay = 0, keep = false }) {
  let timer = null, waiting = false, busy = false, version = 0, abort = null;
  async function run() {
    if (busy) { waiting = true; return; }
    busy = true;
    waiting = false;
    const mine = version, body = question();
    abort = new AbortController();
    try {
      const answer = body === null ? null : await ask(name, body, abort.signal);
      if (answer && (keep || mine === version)) take(answer, body);
    } catch (error) {
      if (error.name !== "AbortError" && mine === version) fail(error);
    } finally {
      busy = false;
      abort = null;
      if (waiting) run();
    }
  }
  return {
    go() {
      version++;
      clearTimeout(timer);
      if (!keep && abort) abort.abort();
      if (delay) timer = setTimeout(run, delay);
      else run();
    },
    stop() { version++; clearTimeout(timer); waiting = false; if (abort) abort.abort(); },
  };
}
