"""The workbench as its users meet it: a real server, a real browser."""
