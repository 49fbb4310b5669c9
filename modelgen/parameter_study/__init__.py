"""Sweeps: a scene run many times with other numbers, its outcomes in a table.

Takes a library and the numbers that vary; gives a table with a row for each run, its file, and its picture.
"""
