#!/usr/bin/env python3
"""bench_viewer.py PROGRAM [--inputs N] [--size WxH] [--long N] [--crowd N] [INPUT...]: what a client of `nocturne view`
gets: seconds from an input to the picture that shows it, pictures a second and their resolution while it moves, the way
to rest, bandwidth and memory. --long does N inputs, edits and new connections and tells whether memory grows.

The hand is one that goes on: each input is sent when the picture of the one before it has come (latency), then 60 a
second whatever comes back (as a page does). Shares of a frame's own time, which the program tells with each picture,
say what the machine's load does not change."""
import argparse
import os
import statistics
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "viewer"))
from wire import Client, Picture, Program  # noqa: E402


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def is_picture(message):
    return isinstance(message, Picture) and message.kind == 1


def begin(program, width, height):
    client = Client(program)
    client.say("hello", width=width, height=height)
    client.text_of("welcome", timeout=3600)
    client.picture(timeout=600)
    client.n = 0
    return client


def move(client, **values):
    client.n += 1
    client.say("input", n=client.n, **values)
    return client.n


def latency(client, count):
    """One input after the other: seconds to its picture, and beside the frame's own."""
    whole, own, sizes = [], [], []
    for _ in range(count):
        start = time.monotonic()
        n = move(client, seconds=0.03, turn=[0.004, 0], keys=["forward"])
        picture = client.wait_for(lambda m: is_picture(m) and m.input >= n, timeout=120)
        whole.append(picture.time - start)
        own.append(picture.seconds)
        sizes.append((picture.width, picture.height))
    print("  one by one    median %.0f ms, 95th percentile %.0f ms; beside the frame's own time %.0f ms and %.0f ms; %s"
          % (1e3 * statistics.median(whole), 1e3 * percentile(whole, 0.95),
             1e3 * statistics.median(a - b for a, b in zip(whole, own)),
             1e3 * percentile([a - b for a, b in zip(whole, own)], 0.95), "%d x %d" % statistics.mode(sizes)))


def stream(client, seconds):
    """60 inputs a second, as a page sends them."""
    sent, whole, sizes, before = {}, [], [], client.bytes
    start = at = time.monotonic()
    pictures, behind = 0, []
    while time.monotonic() - start < seconds:
        if time.monotonic() >= at:
            at += 1 / 60
            n = move(client, seconds=1 / 60, turn=[0.002, 0], keys=["forward" if int(at) % 2 else "back"])
            sent[n] = time.monotonic()
        try:
            m = client.receive(max(0.0005, at - time.monotonic()))
        except OSError:
            continue
        if not is_picture(m):
            continue
        client.say("ack", pane=m.pane, n=m.number)
        pictures += 1
        sizes.append((m.width, m.height))
        if m.input in sent:
            whole.append(m.time - sent[m.input])
            behind.append((m.time - sent[m.input]) / max(m.seconds, 1e-4))
    spent = time.monotonic() - start
    print("  60 a second   %.1f pictures/s at %d x %d, input to picture median %.0f ms, 95th percentile %.0f ms, %.1f "
          "frames' own time; %.2f Mbit/s"
          % ((pictures / spent,) + statistics.mode(sizes) +
             (1e3 * statistics.median(whole), 1e3 * percentile(whole, 0.95), statistics.median(behind),
              8e-6 * (client.bytes - before) / spent)))


def rest(client, seconds, width, height):
    """How long until the whole picture is there, and how fast it becomes exact."""
    start, before, first, last, count = time.monotonic(), client.bytes, None, None, 0
    while time.monotonic() - start < seconds:
        try:
            m = client.picture(timeout=max(0.001, start + seconds - time.monotonic()))
        except OSError:
            break
        if not m.moving and (m.width, m.height) == (width, height):
            first = first or m.time - start
            last, count = m, count + 1
    if last:
        print("  at rest       whole after %.2f s; after %.0f s %d frames (%.2f a second), %d pictures, error %.1f %%, "
              "%.2f Mbit/s"
              % (first, seconds, last.frames, last.frames / seconds, count, 100 * last.error,
                 8e-6 * (client.bytes - before) / seconds))


def crowd(program, count, width, height):
    before = program.memory()
    most = []

    def look(): # each reads for itself: who does not is dropped
        c = begin(program, width, height)
        for _ in range(10):
            n = move(c, turn=[0.01, 0], seconds=0.05)
            c.wait_for(lambda m: is_picture(m) and m.input >= n, timeout=300)
        c.wait_for(lambda m: is_picture(m) and (m.width, m.height) == (width, height), timeout=600)
        most.append(program.memory()) # the whole picture of each is where most memory is
        while len(most) < wanted:
            try:
                c.picture(timeout=1)
            except OSError:
                pass
        c.close()

    def meet(number):
        threads = [threading.Thread(target=look) for _ in range(number)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return max(most)

    wanted = 1
    one = meet(1)
    most.clear()
    wanted = count
    many = meet(count)
    time.sleep(2)
    print("  memory        without clients %.0f MB, with 1 %.0f MB, with %d %.0f MB"
          % (1e-6 * before, 1e-6 * one, count, 1e-6 * many))
    print("                after they have left %.0f MB" % (1e-6 * program.memory()))


def long(program, inputs, width, height):
    """Inputs at full rate, edits, layouts, questions and new connections."""
    client, told = begin(program, width, height), []
    start = time.monotonic()
    for i in range(inputs):
        move(client, turn=[0.01, 0], seconds=0.05, keys=["forward" if i % 40 < 20 else "back"])
        client.wait_for(lambda m, n=client.n: is_picture(m) and m.input >= n, timeout=300)
        if i % 20 == 10:
            client.say("world", name="window-lit", value="%.1f" % (0.1 + 0.1 * (i // 20 % 9)))
        if i % 50 == 25:
            client.say("set", name="method", value=("restir", "ris", "is")[i // 50 % 3])
        if i % 100 == 50:
            client.say("ask", id=i, what="pixel", pane=0, x=0.5, y=0.9)
        if i % 200 == 199:
            client.say("layout", name=("divider", "methods", "difference", "single")[i // 200 % 4])
        if i % 250 == 249:
            client.close()
            client = begin(program, width, height)
        if i % (inputs // 10) == inputs // 10 - 1:
            told.append(1e-6 * program.memory())
    client.close()
    print("  %d inputs in %.0f s: memory at each tenth of them %s MB"
          % (inputs, time.monotonic() - start, ", ".join("%.0f" % x for x in told)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("input", nargs="*", default=["builtin:city"])
    parser.add_argument("--inputs", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--long", type=int, default=0)
    parser.add_argument("--crowd", type=int, default=0)
    parser.add_argument("--threads", default="2")
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    program = Program(*args.input, "--threads", args.threads, "--clients", "16", program=args.program)
    print("%s at %s, load of the machine %.1f" % (" ".join(args.input), args.size, os.getloadavg()[0]))
    try:
        if args.crowd:
            crowd(program, args.crowd, width, height)
        if args.long:
            long(program, args.long, width, height)
        if not args.crowd and not args.long:
            client = begin(program, width, height)
            latency(client, args.inputs)
            stream(client, args.seconds)
            rest(client, 2 * args.seconds, width, height)
            client.close()
    finally:
        print("  load of the machine at the end %.1f" % os.getloadavg()[0])
        program.end()


main()
