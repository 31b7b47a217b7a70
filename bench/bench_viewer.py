#!/usr/bin/env python3
"""bench_viewer.py PROGRAM [--inputs N] [--size WxH] [--long SECONDS] [--crowd N] [INPUT...]: what a client of
`nocturne view` gets: seconds from an input to the picture that shows it, pictures a second and their resolution while
it moves, the way to rest, and bandwidth. --crowd tells the memory without clients, with 1 and with N, --long whether
memory grows while inputs, edits and new connections go on for so long.

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
    """How long until the whole picture is there, and the first without loss, and how fast it becomes exact."""
    start, before, whole, lossless, last, count = time.monotonic(), client.bytes, None, None, None, 0
    while time.monotonic() - start < seconds:
        try:
            m = client.picture(timeout=max(0.001, start + seconds - time.monotonic()))
        except OSError:
            break
        if m.moving or (m.width, m.height) != (width, height):
            continue
        whole = whole or m.time - start
        lossless = lossless or (m.codec == 1 and m.time - start)
        last, count = m, count + 1
    if last:
        print("  at rest       whole after %.2f s, without loss %s; after %.0f s %d frames (%.2f a second), "
              "%d pictures (%.2f a second), error %.1f %%, %.2f Mbit/s"
              % (whole, "after %.2f s" % lossless if lossless else "not yet", seconds, last.frames,
                 last.frames / seconds, count, count / seconds, 100 * last.error,
                 8e-6 * (client.bytes - before) / seconds))


def settle(program):
    """Until the city is there, and all clients have left: bytes then."""
    Client(program).text_of("welcome", timeout=3600)
    threads, same = program.threads(), 0
    while same < 10: # sessions end when their frame does
        time.sleep(0.2)
        now = program.threads()
        threads, same = now, same + 1 if now == threads else 0
    return program.memory()


def crowd(program, count, width, height):
    before = settle(program)
    most, resting = [], []

    def look(barrier): # each reads for itself: who does not is dropped
        c = begin(program, width, height)
        for _ in range(10):
            n = move(c, turn=[0.01, 0], seconds=0.05)
            c.wait_for(lambda m: is_picture(m) and m.input >= n, timeout=300)
            most.append(program.memory())
        c.wait_for(lambda m: is_picture(m) and (m.width, m.height) == (width, height), timeout=600)
        most.append(program.memory())
        c.wait_for(lambda m: is_picture(m) and m.codec == 1, timeout=600)
        arrived.append(1)
        while len(arrived) < barrier:
            try:
                c.picture(timeout=1)
            except OSError:
                pass
        resting.append(program.memory())
        gone.append(1)
        while len(gone) < barrier: # none is less while others look
            try:
                c.picture(timeout=0.1)
            except OSError:
                pass
        c.close()

    told = []
    for number in 1, count:
        most, resting, arrived, gone = [], [], [], []
        threads = [threading.Thread(target=look, args=(number,)) for _ in range(number)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        told.append((max(most), max(resting), settle(program)))
    print("  memory        without clients %.0f MB" % (1e-6 * before))
    for number, (peak, still, after) in zip((1, count), told):
        print("                with %d at most %.0f MB, %.0f MB at rest, %.0f MB after they have left"
              % (number, 1e-6 * peak, 1e-6 * still, 1e-6 * after))


def long(program, seconds, width, height):
    """Inputs as they are shown, edits, layouts, questions and new connections; memory in each tenth of that time, and
    after the client has left."""
    empty, i, every = settle(program), 0, seconds / 10
    client, start = begin(program, width, height), time.monotonic()
    told = []
    for tenth in range(10):
        found = []
        while time.monotonic() - start < (tenth + 1) * every:
            i += 1
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
            found.append(program.memory())
        told.append((statistics.median(found), max(found)))
        print("  until %.1f min, %d inputs: %.0f MB, at most %.0f MB"
              % ((tenth + 1) * every / 60, i, 1e-6 * told[-1][0], 1e-6 * told[-1][1]), flush=True)
    client.close()
    print("  memory without clients %.0f MB, after the client has left %.0f MB"
          % (1e-6 * empty, 1e-6 * settle(program)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("input", nargs="*", default=["builtin:city"])
    parser.add_argument("--inputs", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--long", type=float, default=0)
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
