// Messages in the reader's language: those of the catalogue that the page brings along.

const page = globalThis.document;
export const language = page?.documentElement.lang || "en";
const messages = JSON.parse(page?.getElementById("messages")?.textContent || "{}");
const plural = new Intl.PluralRules(language);
const POINT = new Intl.NumberFormat(language).format(1.5)[1];

/** A number, or several in a text without words, as they are written here. */
export const decimal = (text) => text.replaceAll(".", POINT);

const filled = (text, given) => text.replace(/\{(\w+)(?::[^}]*)?\}/g, (all, key) => given[key] ?? all);

/** A message, filled in; what the catalogue does not have stays as it is, and nothing is no text. */
export const _ = (message, given = {}) => (message ? filled(messages[message] ?? message, given) : "");

/** What the server says in one word, marked for the catalogue. */
const N_ = (message) => message;
export const WORDS = [
  N_("adequate"), N_("doubtful"), N_("inadequate"), N_("converged"), N_("not converged"), N_("failed"), N_("error"), N_("warning"), N_("info"),
  N_("queued"), N_("running"), N_("done"), N_("cancelled"), N_("interrupted"), N_("fit"), N_("session"), N_("design"), N_("study"), N_("profile"),
  N_("passive"), N_("active"), N_("maximal"), N_("empty device"), N_("one muscle at a time"), N_("unknown"), N_("left"), N_("right"), N_("healthy"), N_("patient"), N_("raw"), N_("envelope"),
  N_("recording"), N_("being judged"), N_("broken off"), N_("judged"), N_("maximum"), N_("tibialis anterior"), N_("none"),
];

/** The message for so many; {n} in it is their number. */
export function many(one, several, n, given = {}) {
  const forms = messages[one] ?? [one, several];
  return filled(forms[plural.select(n) === "one" ? 0 : 1], { ...given, n: n.toLocaleString(language) });
}

/** Have a list of languages change that of all pages in this browser. */
export const chooseLanguage = (list) =>
  list.addEventListener("change", () => {
    document.cookie = `surae-language=${list.value}; path=/; max-age=31536000; samesite=strict`;
    location.reload();
  });

/** What the server says: a message and what fills it in, names of the catalogue and other messages translated, too. */
export const said = ({ message, text, given }) =>
  _(message || text, Object.fromEntries(Object.entries(given ?? {}).map(([key, value]) => [key, value?.message ? said(value) : /^[-−]?\d/.test(value) ? decimal(String(value)) : _(value)])));
