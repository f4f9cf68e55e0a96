"""The workbench: a local web application over one project folder, `surae serve`."""

#: Folders of files that pages use; reports have the library of plots too.
STATIC: list[str | tuple[str, str]] = [
    ("surae_workbench.web", "static"),
    ("surae.report", "static"),
]
