// Texts of others: what would change how the text around them is shown is made visible, and names keep their direction inside.

/**
 * Control characters but line feeds and tabs, characters that reverse the order of others, ends of lines and paragraphs, and
 * halves of characters. Marks of direction stay: honest names in Arabic and Hebrew have them.
 */
const HARMFUL = /(?![\n\t\u061c\u200e\u200f])[\p{Cc}\p{Bidi_Control}\p{Zl}\p{Zp}\p{Cs}]/gu;

/** Letters from right to left, and marks of direction. */
const DIRECTED = /[\u0590-\u08ff\u200e\u200f\ufb1d-\ufdff\ufe70-\ufefe\u{10800}-\u{10fff}\u{1e800}-\u{1efff}]/u;

/** What starts and ends a part of a text with a direction of its own. No name has them after `visible`. */
const [START, END] = ["\u2068", "\u2069"];

/** A text in which harmful characters are written as `\u{202e}`. */
export function visible(text) {
  return text.replaceAll("\r\n", "\n").replace(HARMFUL, (letter) => `\\u{${letter.codePointAt(0).toString(16)}}`);
}

/** A name for the middle of a text: its direction does not go on into the text around it. */
export function isolated(name) {
  return DIRECTED.test(name) ? START + name + END : name;
}

/** A name that is not longer than a label may be. */
export function short(name) {
  const letters = [...name];
  return isolated(letters.length > 24 ? `${letters.slice(0, 23).join("")}…` : name);
}
