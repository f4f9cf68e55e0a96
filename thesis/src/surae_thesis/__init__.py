"""The thesis's results computed again: each claim beside ours, with a verdict.

Built on what `surae` and its packages make public, and on nothing else. A claim is a row of data
(`claims.Claim`) with one judge; a section (`section.Section`) computes what its claims look at,
figures and tables, and keeps what takes long, so that a stopped run goes on. `writers` write the
folder.
"""
