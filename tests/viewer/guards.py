"""Who may have anything from `nocturne view`: HTTP, the handshake, broken messages, rates, clients that do not read.
After each of these the program is there for others."""
import json
import os
import random
import socket
import subprocess
import sys
import tempfile
import time

import tap
from wire import LIMIT, TOKEN, Client, Closed, Picture, Program, joined

SCENE = "builtin:single"
TRACK = """<?xml version='1.0'?><gpx version='1.1' xmlns='http://www.topografix.com/GPX/1/1'><trk><name>a</name><trkseg>
<trkpt lat='48.754461' lon='11.421681'><time>2026-11-22T22:00:00Z</time></trkpt>
<trkpt lat='48.754450' lon='11.422224'><time>2026-11-22T22:00:10Z</time></trkpt></trkseg></trk></gpx>"""


def check_alive(p):
    """Another client is served."""
    c = joined(p)
    c.say("hello", width=64, height=36)
    c.text_of("welcome")
    picture = c.picture()
    assert picture.width <= 64 and picture.body[:2] in (b"\xff\xd8", b"\x89P"), picture.body[:4]
    c.close()


# ---- HTTP

def test_the_page_is_served_and_fenced(p):
    status, headers, body = p.http("/")
    assert status == 200 and b"<html" in body.lower() or b"<!doctype" in body.lower(), (status, body[:80])
    rules = headers["content-security-policy"]
    for rule in "default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "base-uri 'none'":
        assert rule in rules, rules
    assert "unsafe" not in rules and "*" not in rules, rules
    assert headers["x-content-type-options"] == "nosniff" and headers["cache-control"] == "no-store"
    assert headers["referrer-policy"] == "no-referrer"
    assert p.http("/index.html")[2] == body


def test_no_path_reaches_a_file(p):
    for path in ("/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..%2f..%2fetc/passwd", "//etc/passwd",
                 "/./../etc/passwd", "/etc/passwd", "/index.html/../../etc/passwd", "/page.c", "/index.html%00.png",
                 "/.", "/..", "/%", "/index.html/", "/INDEX.HTML", "/cgi-bin/", "/ws", "/serverstatus"):
        status, _, body = p.http(path)
        assert status in (0, 400, 403, 404) or (status == 200 and b"<title>Nocturne" in body), (path, status)
        assert b"root:" not in body and status != 500, (path, status, body[:100])
    assert p.http("/nothing")[0] == 404 and p.http("/etc/passwd")[0] == 404


def test_other_methods_are_refused(p):
    for method in "POST", "PUT", "DELETE", "OPTIONS", "BREW":
        status, _, body = p.http("/", method=method, headers=["Content-Length: 0"])
        assert status != 200, (method, status, body[:60])


def test_only_our_names_are_hosts(p):
    good = ["127.0.0.1:%d" % p.port, "localhost:%d" % p.port, "localhost", "LOCALHOST:1", "[::1]:9000", "127.1.2.3"]
    bad = ["evil.example", "evil.example:%d" % p.port, "127.0.0.1.evil.example", "localhost.evil.example", "10.0.0.1",
           "127.0.0.1@evil.example", "[::2]", "[::1]x", "0.0.0.0", "127.0.0.1:80:80", "localhost:x", "[::1", ":80", "-",
           "a" * 290, "127.0.0.1,evil.example"]
    for host in good:
        assert p.http("/", host=host)[0] == 200, host
    for host in bad:
        assert p.http("/", host=host)[0] in (0, 400, 403), host
        assert Client(p, host=host).status != 101, host
    assert p.http("/", host="")[0] in (0, 400, 403)


def test_slow_and_idle_connections_end(p):
    """Who says half a request is not waited for, and many of them do not keep others out."""
    start = time.monotonic()
    sockets = [p.raw() for _ in range(60)]
    for s in sockets:
        try:
            s.sendall(b"GET / HTTP/1.1\r\nHost: 127")
        except ConnectionError: # it is closed already, for those who came later
            pass
    for s in sockets:
        try:
            while s.recv(100):
                pass
        except ConnectionError:
            pass
        s.close()
    assert time.monotonic() - start < LIMIT
    check_alive(p)


def is_open(s):
    """Nothing has come over that socket, not its end either."""
    s.setblocking(False)
    try:
        return bool(s.recv(1))
    except BlockingIOError:
        return True
    except ConnectionError:
        return False


def test_silent_connections_keep_nobody_out(p):
    """The oldest are closed for those who come, so nobody waits until they time out."""
    for begin in b"", b"GET / HTTP/1.1\r\nHost: 127":
        sockets = [p.raw() for _ in range(200)]
        for s in sockets:
            try:
                s.sendall(begin)
            except ConnectionError: # it is closed already
                pass
        assert p.http("/")[0] == 200
        c = joined(p)
        assert is_open(sockets[-1]), "who came last was closed before the page came"
        assert not is_open(sockets[0])
        c.close()
        for s in sockets:
            s.close()


def test_strange_requests_harm_nobody(p):
    randomly = random.Random(1)
    for request in (b"\0\0\0\0\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
                    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\n"
                    b"HTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n\r\n",
                    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
                    b"GET /" + b"a" * 100000 + b" HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\nA: " + b"b" * 100000,
                    b"GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
                    bytes(randomly.randrange(256) for _ in range(5000))):
        s = p.raw()
        try:
            s.sendall(request)
            s.shutdown(socket.SHUT_WR)
            data = b"".join(iter(lambda s=s: s.recv(65536), b""))
            assert b" 101 " not in data[:40], data[:100]
        except OSError as error:  # it closed first
            assert not isinstance(error, TimeoutError), request[:40]
        s.close()
    check_alive(p)


# ---- the handshake

def test_the_token_is_asked_for(p):
    same = "/ws?token=" + TOKEN
    for path in ("/ws", "/ws?", "/ws?token=", "/ws?token=" + TOKEN[:-1], same + "x", "/ws?token=" + TOKEN[::-1],
                 "/ws?Token=" + TOKEN, "/ws?x=token=" + TOKEN, "/ws?token=" + "a" * 2000, "/ws?token=%00" + TOKEN,
                 "/ws?token=" + TOKEN + TOKEN):
        assert Client(p, path=path).status != 101, path
    for path in "/?token=" + TOKEN, "/wss?token=" + TOKEN, "/index.html?token=" + TOKEN:
        assert Client(p, path=path).status == 404, path
    joined(p, path=same).close()


def test_other_sites_are_refused(p):
    for origin in (None, "http://evil.example", "http://evil.example:%d" % p.port, "null", "file://",
                   "http://localhost:%d" % p.port, "http://127.0.0.1:%d" % (p.port + 1), "http://127.0.0.1",
                   "http://127.0.0.1:%d.evil.example" % p.port, "127.0.0.1:%d" % p.port):
        assert Client(p, origin=origin).status == 403, origin
    joined(p, origin="same").close()
    joined(p, host="localhost:%d" % p.port).close()


def test_the_subprotocol_is_asked_for(p):
    for protocol in None, "nocturne-2", "http", "chat, nocturne-1x":
        assert Client(p, protocol=protocol).status != 101, protocol


def test_there_are_so_many_clients(p):
    clients = [joined(p) for _ in range(4)]
    assert Client(p).status == 503
    clients[0].close()
    joined(p).close()
    for c in clients[1:]:
        c.close()
    check_alive(p)


@tap.slow
def test_idle_clients_keep_nobody_out(p):
    """They answer pings, say that they do, and nothing else. Who is at work keeps its place."""
    q = Program(SCENE, "--clients", "3")
    working, idle = joined(q), [joined(q), joined(q)]
    working.say("hello", width=64, height=36)
    new, n, end = None, 0, time.monotonic() + LIMIT
    while not new or new.status == 503:
        assert time.monotonic() < end, "nobody came in"
        time.sleep(0.1)
        n += 1
        working.say("input", n=n)
        for c in idle:
            c.frame(b"", opcode=9)
            c.frame(b"", opcode=10)
        new = Client(q)
    assert new.status == 101, new.status
    assert idle[0].closed() == 4000, "the one that was idle longest"
    new.say("hello", width=64, height=36)
    new.picture()
    working.say("input", n=n + 1)
    working.wait_for(lambda m: isinstance(m, Picture) and m.input == n + 1)
    idle[1].say("hello", width=64, height=36)
    idle[1].picture()
    q.end()


# ---- messages

def test_broken_messages_close_that_client(p):
    other = joined(p)
    other.say("hello", width=64, height=36)
    other.picture()
    deep = '{"t":"hello","x":' + "[" * 10000 + "]" * 10000 + "}"
    policy = 1008
    for text, code in ((b"", policy), (b"x", policy), (b"[]", policy), (b"null", policy), (b"{}", policy),
                       (b'{"t":"nothing"}', policy), (b'{"t":"hello"}', policy), (deep.encode(), policy),
                       (b'{"t":"hello","width":1e99,"height":1}', policy),
                       (b'{"t":"ask","id":0,"what":"files"}', policy),
                       (b'{"t":"ask","id":0,"what":"find","text":7}', policy),
                       (b'{"t":"ask","id":0,"what":"find","text":"' + b"a" * 5000 + b'"}', policy),
                       (b'{"t":"ask","id":0,"what":"name","at":[1e99,0]}', policy),
                       (b'{"t":"jump","n":1,"place":[0,0,1e99]}', policy),
                       (b'{"t":"set","name":"' + b"a" * 5000 + b'","value":""}', policy),
                       (b'{"t":"watch","on":true,"x":"' + b"a" * 40000 + b'"}', 1009),
                       (b'{"t":"watch","on":true,"x":"\xff"}', 1007), (b"\xed\xa0\x80", 1007), (b"\xc0\x80", 1007)):
        c = joined(p)
        if code == 1007: # libwebsockets closes by itself, and without a code where a message is still on its way
            c.text_of("welcome")
        c.text(text)
        got = c.closed()
        assert got == code or (got is None and len(text) > 4096), (text[:60], got) # what is unread resets it
        c.close()
    other.say("input", n=1, turn=[0.1, 0])
    other.wait_for(lambda m: isinstance(m, Picture) and m.input == 1)
    other.close()


def test_binary_and_broken_frames_close_it(p):
    def frames(*what):
        c = joined(p)
        try:
            for values in what:
                c.frame(**values)
            code = c.closed()
        except (ConnectionError, BrokenPipeError):
            code = None
        c.close()
        assert code != "open", what
        return code

    assert frames({"payload": b"\0\1\2", "opcode": 2}) == 1003
    frames({"payload": b"{}", "opcode": 3})
    frames({"payload": b"{}", "rsv": 4})
    frames({"payload": b"a" * 126, "opcode": 9})       # a ping may have 125
    frames({"payload": b"abc", "opcode": 0})           # goes on with what never began
    frames({"payload": b"{", "final": False}, {"payload": b"}", "opcode": 1})
    check_alive(p)


def test_pieces_are_one_message(p):
    c = joined(p)
    text = b'{"t":"hello","width":64,"height":36}'
    for i, byte in enumerate(text):
        c.frame(bytes([byte]), opcode=0 if i else 1, final=i + 1 == len(text))
        if i % 10 == 0:
            c.frame(b"", opcode=9)
    c.picture()
    c.close()
    c = joined(p)
    try:
        c.frame(b'{"t":"watch","on":true,"x":"', final=False)
        for _ in range(60):
            c.frame(b"a" * 1000, opcode=0, final=False) # never ends
        code = c.closed()
    except (ConnectionError, BrokenPipeError):
        code = None
    assert code in (1009, None), code
    c.close()


def test_a_frame_of_16_exabytes(p):
    c = joined(p)
    before = p.memory()
    c.socket.sendall(b"\x81\xff" + b"\xff" * 8 + b"\0\0\0\0" + b"a" * 100)
    code = c.closed(10)
    assert code != "open" or p.memory() - before < 20e6, code
    c.close()
    check_alive(p)


def test_pings_and_pongs_are_counted(p):
    for payload in b"", b"a" * 100:
        for opcode in 9, 10:
            c, code = joined(p), "open"
            end = time.monotonic() + LIMIT
            try:
                c.socket.settimeout(0.5)
                frames = (bytes([0x80 | opcode, 0x80 | len(payload)]) + b"\0\0\0\0" + payload) * 1000
                while time.monotonic() < end:
                    try:
                        c.socket.sendall(frames)
                    except TimeoutError:
                        pass
            except OSError:
                code = None
            c.close()
            assert code != "open", (opcode, len(payload))
    c = joined(p) # a browser's are taken
    c.say("hello", width=64, height=36)
    for _ in range(100):
        c.frame(b"x", opcode=9)
        c.frame(b"x", opcode=10)
    c.picture()
    c.close()
    check_alive(p)


def test_a_body_is_no_request(p):
    inner = b"GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n"
    for head in b"Content-Length: %d" % len(inner), b"Transfer-Encoding: chunked":
        with p.raw() as s:
            s.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n" + head + b"\r\n\r\n" + inner)
            data = b""
            try:
                data = b"".join(iter(lambda s=s: s.recv(65536), b""))
            except ConnectionError: # it closes on what it does not read
                pass
        assert data.count(b"HTTP/1.1 ") <= 1 and b" 200 " not in data[:20], data[:300]
    assert Client(p, headers=["Content-Length: 5"]).status != 101
    check_alive(p)


def test_frames_without_a_mask_harm_nobody(p):
    """libwebsockets takes them: masks are for proxies in between."""
    c = joined(p)
    c.socket.sendall(b"\x81\x05hello" + b"\x81\x7e\xff\xff" + b"{" * 65535)
    assert c.closed() != "open"
    c.close()
    check_alive(p)


def test_the_terminal_stays_quiet(p):
    """What cameras cannot be is told to that client alone."""
    q = Program(SCENE)
    c = Client(q)
    c.say("hello", width=64, height=36)
    c.text_of("welcome")
    for eye, target in (([0, 0, 1], [0, 0, 1 + 1e-10]), ([1e7, 0, 1], [0, 0, 1]), ([0, 0, 1], [0, -1e7, 1]),
                        ([5e6, 0, 1], [5e6, 1, 1])):
        for _ in range(30):
            c.say("camera", eye=eye, target=target, fov=50)
        note = c.wait_for(lambda m: isinstance(m, dict) and m["t"] == "note")
        assert note["level"] == "error" and "looks nowhere" in note["text"], note
    for i in range(300):
        c.say("navigate", mode=("walk", "fly")[i % 2])
    c.say("camera", eye=[0, 0, 1], target=[1, 0, 1], fov=50, n=7)
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == 7)
    status, said = q.end()
    assert status == 130 and len(said.splitlines()) <= 25 and "looks" not in said and "camera" not in said, said[:2000]


def test_rates_are_held(p):
    def flood(count, make):
        c = joined(p)
        try:
            for i in range(count):
                c.text(make(i))
            code = c.closed()
        except (ConnectionError, BrokenPipeError):
            code = None
        c.close()
        return code

    # an inputs' worth is taken: 60 a second for 10 s, at once
    c = joined(p)
    c.say("hello", width=64, height=36)
    for i in range(600):
        c.say("input", n=i + 1)
    c.wait_for(lambda m: isinstance(m, Picture) and m.input == 600)
    c.close()
    assert flood(20000, lambda i: '{"t":"input","n":%d}' % i) in (1008, None)
    assert flood(100, lambda i: '{"t":"watch","on":true,"x":"%s"}' % ("a" * 30000)) in (1008, None)
    c = joined(p) # pieces without a byte are no way around it
    try:
        c.frame(b"{", final=False)
        for _ in range(20000):
            c.frame(b"", opcode=0, final=False)
        code = c.closed()
    except (ConnectionError, BrokenPipeError):
        code = None
    assert code in (1008, None), code
    check_alive(p)


@tap.slow
def test_who_does_not_read_holds_no_memory(p):
    """It is sent one picture, and then none; and is dropped after a while."""
    c = joined(p, receive=4096)
    c.say("hello", width=1280, height=720)
    c.picture(width=1280, moving=False) # it has all that a picture takes
    before, start, n = p.memory(), time.monotonic(), 0
    dropped = False
    while time.monotonic() - start < LIMIT and not dropped:
        n += 1
        try:
            c.say("input", n=n, turn=[0.01, 0], seconds=0.05)
            c.say("ask", id=n % 8, what="pixel", x=0.5, y=0.5)
            for pane in range(6):
                c.say("ack", pane=pane, n=n) # it says that it has seen what it never read
        except (ConnectionError, BrokenPipeError):
            dropped = True
        time.sleep(0.05)
    assert dropped, "after %.0f s it is still there" % (time.monotonic() - start)
    grown = p.memory() - before
    assert grown < 40e6, "%.1f MB more" % (grown / 1e6)
    c.close()
    check_alive(p)


@tap.slow
def test_nothing_is_rendered_for_nobody(p):
    """Hidden, or not acknowledged, or at rest: no processor time."""
    p.rests() # without clients
    c = joined(p)
    c.say("hello", width=640, height=360)
    c.say("set", name="frames", value="0") # without end
    c.text_of("welcome")
    c.picture()
    c.say("watch", on=False)
    p.rests()
    c.say("watch", on=True)
    c.picture()
    c.wait_for(lambda m: isinstance(m, Picture), ack=False)
    p.rests() # nobody looks 5 s later
    c.close()


def stands(c):
    """Waits until the world of a client that does not look is the same for a second and more."""
    versions, end, step = [], time.monotonic() + LIMIT, 1
    while len(versions) < 2 or versions[-1] != versions[-2]:
        assert time.monotonic() < end, versions
        time.sleep(1.5)
        step += 1
        c.say("set", n=step, name="seed", value=str(step)) # a state answers it
        state = c.wait_for(lambda m, n=step: isinstance(m, dict) and m["t"] == "state" and m["input"] >= n)
        versions.append(state["world"]["version"])


def test_cars_wait_for_who_looks(p):
    """Each of their moves is an edit of the scene, and numbered."""
    with tempfile.NamedTemporaryFile("w", suffix=".gpx") as file:
        file.write(TRACK)
        file.flush()
        q = Program(os.path.join(os.environ["NOC_SOURCE"], "tests/cli/city.gml"), file.name, "--threads", "2")
        hidden, c = Client(q), Client(q)
        for one in hidden, c:
            one.say("hello", width=64, height=36)
            assert one.text_of("welcome")["scene"]["cars"] == 1
    try:
        hidden.say("watch", on=False)
        c.say("world", name="traffic-drive", value="on")
        worlds = set()
        while len(worlds) < 4: # they drive while one looks
            worlds.add(c.text_of("stats")["world"])
        c.say("watch", on=False)
        stands(hidden)
        c.say("watch", on=True)
        while len(worlds) < 8:
            worlds.add(c.text_of("stats")["world"])
        c.close()
        stands(hidden)
    finally:
        q.end()


def main():
    module = sys.modules[__name__]
    p = Program(SCENE, "--clients", "4", "--threads", "2")
    try:
        tap.run(tap.tests_of(module), p)
    finally:
        status, said = p.end()
        print("# ended with %s: %s" % (status, said[-2000:]))
        if status != 130:
            sys.exit(1)


main()
