// What was done: undo, redo, and the state as a link.

export function makeHistory(changed) {
  let done = [], undone = [], now = null;
  const copy = state => JSON.parse(JSON.stringify(state));
  return {
    begin(state) { done = []; undone = []; now = JSON.stringify(state); },
    ways: () => ({ back: done.length > 0, forth: undone.length > 0 }),
    // Keep a state; drags and letters in between are one step.
    commit(state) {
      const text = JSON.stringify(state);
      if (text === now) return false;
      done.push(now);
      if (done.length > 200) done.shift();
      undone = [];
      now = text;
      changed();
      return true;
    },
    undo() { return this.step(done, undone); },
    redo() { return this.step(undone, done); },
    step(from, to) {
      if (!from.length) return null;
      to.push(now);
      now = from.pop();
      changed();
      return copy(JSON.parse(now));
    },
  };
}

export function packed(value) {
  const bytes = new TextEncoder().encode(JSON.stringify(value));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

function decoded(text) {
  const raw = atob(text.replace(/-/g, "+").replace(/_/g, "/"));
  return JSON.parse(new TextDecoder().decode(Uint8Array.from(raw, letter => letter.charCodeAt(0))));
}

const isGroup = one => Array.isArray(one) && one.length === 2 && typeof one[0] === "string" && one[1] && typeof one[1] === "object" && !Array.isArray(one[1]);
const isState = state => Array.isArray(state?.cases) && state.cases.length >= 1 && state.cases.length <= 2
  && state.cases.every(one => typeof one === "string" || (Array.isArray(one) && one.every(isGroup)));

// The state and the units of a link, or null; it may come from anywhere.
export function unpacked(text) {
  try {
    const value = decoded(text);
    return isState(value.state) ? value : null;
  } catch { return null; }
}
