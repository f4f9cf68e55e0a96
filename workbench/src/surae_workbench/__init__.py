"""surae in the browser, on `surae.api` alone: the workbench, and trials judged as measured."""
