import assert from "node:assert/strict";
import { test } from "node:test";

import { change, draft, loadDraft } from "./js/core/draft.js";
import { changeOf } from "./js/ui/settings.js";

const height = { path: ["knowledge", "height_cm"] };
const foot = { path: ["knowledge", "foot_mm"] };

test("of two edits within a second, each keeps what the other said", async () => {
  let kept = { knowledge: { geometry_sd_percent: 3 } };
  globalThis.document = { querySelector: () => ({ content: "token" }) };
  globalThis.fetch = async (_, { body }) => {
    await new Promise((resolve) => setTimeout(resolve, 5));
    if (body) kept = { ...kept, ...JSON.parse(body).change };
    return { ok: true, status: 200, json: async () => ({ draft: kept }) };
  };
  await loadDraft();
  const both = [[height, 182], [foot, 271]].map(([one, value]) => change((now) => changeOf(one, value, now), "edit"));
  await Promise.all(both);
  assert.deepEqual(draft().knowledge, { geometry_sd_percent: 3, height_cm: 182, foot_mm: 271 });
});
