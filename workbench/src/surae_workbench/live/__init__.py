"""Beside the manipulator: streams recorded, shown and judged while the leg is still in the device.

`recorder` takes streams of the Lab Streaming Layer and writes them to disk before anybody
sees them; `trials` keeps a folder of trials and has each judged by a child process (`judge`);
`rehearsal` is a laboratory to practise with, another child process that only speaks LSL; `pages`
shows it all. It reads and commands nothing of a motor: it is not a medical device.
"""
