"""The thesis's results computed again: each claim beside ours, with a verdict.

A section (`chapter.Section`) computes findings (`claims.Finding`), figures and tables from a
`chapter.Context`; `registry.SECTIONS` names them. `jobs` and `fits` compute what takes long, so
that a stopped run goes on; `output` writes the folder.
"""
