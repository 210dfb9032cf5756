// What was done: undo, redo, and the state as a link.

export function makeHistory(changed) {
  let done = [], undone = [], now = null;
  const copy = state => JSON.parse(JSON.stringify(state));
  return {
    begin(state) { done = []; undone = []; now = JSON.stringify(state); changed(false, false); },
    // Keep a state; drags and letters in between are one step.
    commit(state) {
      const text = JSON.stringify(state);
      if (text === now) return false;
      done.push(now);
      if (done.length > 200) done.shift();
      undone = [];
      now = text;
      changed(true, false);
      return true;
    },
    undo() { return this.step(done, undone); },
    redo() { return this.step(undone, done); },
    step(from, to) {
      if (!from.length) return null;
      to.push(now);
      now = from.pop();
      changed(done.length > 0, undone.length > 0);
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

// A state with all its groups: a link may come from anywhere.
export function tidied({ columns, loading }) {
  const group = value => value && typeof value === "object" && !Array.isArray(value) ? value : {};
  return { loading, columns: columns.map((column, i) => {
    if ("case" in column) return { name: String(column.name ?? "AB"[i]), case: String(column.case) };
    const { section, concrete, bars, ties, column: frame, footing } = column;
    return { name: String(column.name ?? "AB"[i]), section: { ...group(section), shape: String(section?.shape ?? "rectangle") }, concrete: group(concrete), bars: group(bars), ties: group(ties), column: group(frame), ...(footing ? { footing: group(footing) } : {}) };
  }) };
}

function decoded(text) {
  const raw = atob(text.replace(/-/g, "+").replace(/_/g, "/"));
  return JSON.parse(new TextDecoder().decode(Uint8Array.from(raw, letter => letter.charCodeAt(0))));
}

// The frame of a link, or null.
export function unpackedFrame(text) {
  try {
    const value = decoded(text), { storeys, bays } = value.frame;
    return Array.isArray(bays) && Array.isArray(storeys) && storeys.length && storeys.every(one => one && typeof one === "object") ? value : null;
  } catch { return null; }
}

export function unpacked(text) {
  try {
    const value = decoded(text);
    const right = value && Array.isArray(value.state?.columns) && value.state.columns.length >= 1 &&
      value.state.columns.length <= 2 && value.state.columns.every(one => one && typeof one === "object") &&
      value.state.loading && typeof value.state.loading === "object";
    return right ? { ...value, state: tidied(value.state) } : null;
  } catch { return null; }
}
