#!/usr/bin/env python3
"""A helper that was taken over: sends what the file "says" in its folder tells, a Python expression of records, and
never ends by itself."""
import socket
import struct
import time

LOG, LAMP, END = 32, 34, 41 # remote.h


def text(t):
    return struct.pack("<I", len(t)) + t.encode() + b"\0"


def record(kind, content):
    return struct.pack("<III", kind, 0, len(content)) + content


def end(status):
    return record(END, struct.pack("<i?3xQQ", status, False, 0, 0) + text("map"))


def log(level, message):
    return record(LOG, struct.pack("<i", level) + text(message))


s = socket.socket(fileno=3)
s.recv(1 << 16)
try:
    s.sendall(eval(open("says").read()))
    time.sleep(1000)
except OSError: # nobody listens any more
    pass
