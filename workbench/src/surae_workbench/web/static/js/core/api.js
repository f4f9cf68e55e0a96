// Requests to the server; what it refuses becomes an Error with its own one line.

import { _ } from "./words.js";

const token = () => document.querySelector('meta[name="csrf-token"]').content;

export class Refusal extends Error {
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

async function answer(url, options) {
  try {
    return await fetch(url, { credentials: "same-origin", ...options });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Refusal(_("the server does not answer; is surae still running?"), 0);
  }
}

async function checked(response) {
  if (response.ok) return response;
  let line = _("the server refused ({status})", { status: response.status });
  try {
    line = (await response.json()).error ?? line;
  } catch {
    // Not JSON: the status has to do.
  }
  throw new Refusal(line, response.status);
}

async function send(method, url, body, raw = false) {
  const headers = { "X-CSRF-Token": token() };
  if (!raw) headers["Content-Type"] = "application/json";
  const response = await checked(
    await answer(url, { method, headers, body: raw ? body : JSON.stringify(body ?? {}) }),
  );
  return response.status === 204 ? null : response.json();
}

export const get = async (url, signal) => (await checked(await answer(url, { signal }))).json();
export const post = (url, body) => send("POST", url, body);
export const patch = (url, body) => send("PATCH", url, body);
export const remove = (url) => send("DELETE", url);
export const upload = (url, file) => send("POST", url, file, true);

/** Fetch a file and hand it to the browser's downloads; waits until it is made. */
export async function download(url, name, body = null) {
  const headers = { "X-CSRF-Token": token(), "Content-Type": "application/json" };
  const options = body ? { method: "POST", headers, body: JSON.stringify(body) } : {};
  const response = await checked(await answer(url, options));
  const match = /filename="?([^";]+)"?/.exec(response.headers.get("content-disposition") ?? "");
  const address = URL.createObjectURL(await response.blob());
  const link = document.createElement("a");
  link.href = address;
  link.download = match?.[1] ?? name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** A query string of what is not null. */
export function query(values) {
  const given = Object.entries(values).filter(([, value]) => value !== null && value !== undefined && value !== "");
  return given.length ? `?${new URLSearchParams(given)}` : "";
}
