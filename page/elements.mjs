// Elements of the page.

export const at = (id) => document.getElementById(id);

/** A text with symbols such as `L_n` and `L_z′`, whose indices are set below the line. */
export function typeset(text) {
  return text.split(/(?<=\b[A-Za-z])_(\w+′?)/).map((part, index) => (index % 2 === 1 ? element("sub", { textContent: part }) : part));
}

/** A new element with properties and children. */
export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}
