// Elements of the page.

/**
 * An element with attributes and children. A function as `onNAME` listens to the event NAME. A style is set by its properties, because
 * the policy of the page allows none in attributes.
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (typeof value === "function") made.addEventListener(name.slice(2), value);
    else if (name === "style") made.style.cssText = value;
    else if (value === true) made.setAttribute(name, "");
    else made.setAttribute(name, String(value));
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

let ids = 0;

/** An identity that no other element has. */
export function identity(stem) {
  ids += 1;
  return `${stem}-${ids}`;
}

/** A labelled choice. `options` are pairs of a value and a text. */
export function choice(label, options, value, onchange) {
  const id = identity("choice");
  const select = element("select", { id, onchange: () => onchange(select.value) },
    options.map(([key, text]) => element("option", { value: key, selected: key === value }, text)));
  return element("div", { class: "field" }, element("label", { for: id }, label), select);
}

/** A labelled choice, with a field that leaves those options that `matching` finds for its words. */
export function searchedChoice(label, optionsFor, onchange) {
  const made = choice(label, optionsFor(""), "", onchange);
  const select = made.querySelector("select");
  const id = identity("search");
  const count = element("output", { for: id, class: "faint" });
  const search = element("input", { id, type: "search", oninput: () => {
    const options = optionsFor(search.value);
    select.replaceChildren(...options.map(([key, text]) => element("option", { value: key }, text)));
    const matches = options.filter(([key]) => key !== "");
    count.textContent = search.value.trim() ? `${matches.length} found` : "";
    select.value = search.value.trim() && matches.length > 0 ? matches[0][0] : "";
    onchange(select.value);
  } });
  return [element("div", { class: "field" }, element("label", { for: id }, `Search ${label.toLowerCase()}`), search, count), made];
}

/** A labelled box to tick. */
export function tick(label, checked, onchange) {
  const id = identity("tick");
  const box = element("input", { type: "checkbox", id, checked, onchange: () => onchange(box.checked) });
  return element("div", { class: "tick" }, box, element("label", { for: id }, label));
}

/** A section of the page with a heading. */
export function section(id, title, ...children) {
  return element("section", { id, "aria-labelledby": `${id}-title` }, element("h2", { id: `${id}-title` }, title), children);
}
