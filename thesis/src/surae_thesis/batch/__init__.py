"""Recordings of many subjects, each fitted by several models: one resumable table, and figures.

`files` tells whose recording a file is, `work` fits one of them by one model, `table` plans and
keeps them all, and `answers` makes of them what the thesis shows of its subjects (3.2).
"""
