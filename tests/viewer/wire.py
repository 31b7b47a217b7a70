"""A client of `nocturne view` by the standard library alone: starts the program, speaks HTTP and WebSocket by sockets,
and may break every rule of both. For tests, and for bench/bench_viewer.py."""
import base64
import json
import os
import re
import select
import signal
import socket
import struct
import subprocess
import time

TOKEN = "0123456789abcdef-token"
HEAD = struct.Struct("<BBBBIIHHIffI")


class Closed(Exception):
    """The program has closed the connection; code is that of the close frame, None without one."""

    def __init__(self, code=None, why=""):
        super().__init__("closed: %s %s" % (code, why))
        self.code, self.why = code, why


class Picture:
    def __init__(self, data):
        (self.kind, self.pane, self.codec, self.flags, self.number, self.input, self.width, self.height, self.frames,
         self.error, self.seconds, self.name_size) = HEAD.unpack(data[:32])
        self.body, self.size, self.time = data[32:], len(data), time.monotonic()
        self.moving = bool(self.flags & 1)


LIMIT = 180 # s: what has not come by then does not come; machines that run many tests at once stand still for a while


class Program:
    """`nocturne view` at a free port."""

    def __init__(self, *arguments, program=None, address="127.0.0.1", port=0):
        self.program = program or os.environ["NOC_PROGRAM"]
        self.process = subprocess.Popen(
            ["env", "--default-signal=INT", self.program, "view", *arguments, "--port", str(port), "--address", address,
             "--token", TOKEN],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.link = self.process.stdout.readline().strip()
        found = re.match(r"http://(.*):(\d+)/#token=(.*)$", self.link)
        if not found:
            raise RuntimeError("no link: %r %r" % (self.link, self.process.stderr.read()))
        self.address, self.port = found[1].strip("[]"), int(found[2])

    @property
    def pid(self):
        return self.process.pid

    def memory(self):
        """Resident bytes."""
        with open("/proc/%d/status" % self.pid, encoding="ascii") as file:
            return 1024 * int(re.search(r"VmRSS:\s*(\d+)", file.read())[1])

    def threads(self):
        return len(os.listdir("/proc/%d/task" % self.pid))

    def cpu(self):
        """Seconds of processor that it has used."""
        with open("/proc/%d/stat" % self.pid, encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def rests(self, seconds=2, share=0.05):
        """Waits until it uses next to no processor for so long: when that begins is the machine's business, but what
        goes on rendering never is at rest."""
        end, used = time.monotonic() + LIMIT, []
        while not used or used[-1] > share * seconds:
            assert time.monotonic() < end, "it never rests: %s s of each %g s" % (used, seconds)
            before = self.cpu()
            time.sleep(seconds)
            used.append(round(self.cpu() - before, 3))

    def alive(self):
        return self.process.poll() is None

    def end(self, number=signal.SIGINT, wait=180):
        """Its exit status, and what it said on stderr. Sanitizers on a busy machine end slowly: what does not end
        in that time hangs."""
        if self.alive():
            self.process.send_signal(number)
        try:
            _, said = self.process.communicate(timeout=wait)
        except subprocess.TimeoutExpired:
            self.process.kill()
            _, said = self.process.communicate()
            return "it did not end", said
        return self.process.returncode, said

    def raw(self):
        """A TCP connection."""
        return socket.create_connection((self.address, self.port), timeout=LIMIT)

    def http(self, path="/", method="GET", host=None, headers=(), version="1.1"):
        """(status, headers, body) of a request of its own connection."""
        with self.raw() as s:
            lines = ["%s %s HTTP/%s" % (method, path, version)]
            if host != "":
                lines.append("Host: %s" % (host or "127.0.0.1:%d" % self.port))
            lines += list(headers) + ["Connection: close", "", ""]
            s.sendall("\r\n".join(lines).encode("latin-1"))
            return read_response(s)


def read_response(s):
    data = b""
    try:
        while True:
            piece = s.recv(65536)
            if not piece:
                break
            data += piece
    except (ConnectionResetError, socket.timeout):
        pass
    head, _, body = data.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    status = int(lines[0].split()[1]) if len(lines[0].split()) > 1 else 0
    return status, dict(line.lower().split(": ", 1) for line in lines[1:] if ": " in line), body


def joined(program, **values):
    """A client that has a place: those who have left may hold theirs for a moment."""
    deadline = time.monotonic() + LIMIT
    while True:
        c = Client(program, **values)
        if c.status != 503 or time.monotonic() > deadline:
            assert c.status == 101, c.status
            return c
        c.close()
        time.sleep(0.02)


class Client:
    """A WebSocket. Its messages are masked as those of browsers are, with a mask of zeroes."""

    def __init__(self, program, path=None, host=None, origin="same", protocol="nocturne-1", headers=(), receive=None):
        self.program = program
        self.socket = socket.socket(socket.AF_INET6 if ":" in program.address else socket.AF_INET)
        if receive:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive)
        self.socket.settimeout(LIMIT)
        self.socket.connect((program.address, program.port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)  # as browsers do
        host = "127.0.0.1:%d" % program.port if host is None else host
        lines = ["GET %s HTTP/1.1" % (path or "/ws?token=" + TOKEN), "Host: " + host, "Connection: Upgrade",
                 "Upgrade: websocket", "Sec-WebSocket-Version: 13",
                 "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode()]
        if origin:
            lines.append("Origin: " + ("http://" + host if origin == "same" else origin))
        if protocol:
            lines.append("Sec-WebSocket-Protocol: " + protocol)
        self.socket.sendall(("\r\n".join(lines + list(headers)) + "\r\n\r\n").encode("latin-1"))
        self.buffer, head = b"", b""
        while b"\r\n\r\n" not in head:
            piece = self.socket.recv(4096)
            if not piece:
                break
            head += piece
        head, _, self.buffer = head.partition(b"\r\n\r\n")
        words = head.split(None, 2)
        self.status = int(words[1]) if len(words) > 1 else 0
        self.parts = b""
        self.bytes = 0

    # ---- sending

    def frame(self, payload, opcode=1, final=True, rsv=0):
        n = len(payload)
        head = bytes([(0x80 if final else 0) | rsv << 4 | opcode])
        head += (bytes([0x80 | n]) if n < 126 else struct.pack(">BH", 0x80 | 126, n) if n < 65536 else
                 struct.pack(">BQ", 0x80 | 127, n))
        self.socket.sendall(head + b"\0\0\0\0" + payload)

    def text(self, text):
        self.frame(text.encode() if isinstance(text, str) else text)

    def say(self, t, **values):
        self.text(json.dumps({"t": t, **values}))

    # ---- receiving

    def _read(self, n, deadline):
        while len(self.buffer) < n:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.socket], [], [], left)[0]:
                raise socket.timeout()
            try:
                piece = self.socket.recv(1 << 20)
            except ConnectionError:
                raise Closed() from None
            if not piece:
                raise Closed()
            self.bytes += len(piece)
            self.buffer += piece

    def receive(self, timeout=LIMIT):
        """The next message: a dict of text, a Picture of binary. socket.timeout, or Closed."""
        deadline = time.monotonic() + timeout
        while True:
            self._read(2, deadline)
            n, at = self.buffer[1] & 0x7f, 2
            if n >= 126:
                self._read(10, deadline) if n == 127 else self._read(4, deadline)
                n, at = (struct.unpack(">Q", self.buffer[2:10])[0], 10) if n == 127 else (
                    struct.unpack(">H", self.buffer[2:4])[0], 4)
            self._read(at + n, deadline)
            first, payload, self.buffer = self.buffer[0], self.buffer[at:at + n], self.buffer[at + n:]
            opcode = first & 15
            if opcode == 8:
                raise Closed(struct.unpack(">H", payload[:2])[0] if n >= 2 else None, payload[2:].decode())
            if opcode == 9:
                self.frame(payload, opcode=10)
            if opcode in (9, 10):
                continue
            self.parts += payload
            if opcode:
                self.binary = opcode == 2
            if first & 0x80:
                whole, self.parts = self.parts, b""
                return Picture(whole) if self.binary else json.loads(whole)

    def wait_for(self, wanted, timeout=180, ack=True):
        """The first message for which wanted(message) holds; pictures are acknowledged on the way."""
        deadline = time.monotonic() + timeout
        while True:
            message = self.receive(max(0.001, deadline - time.monotonic()))
            if isinstance(message, Picture) and message.kind == 1 and ack:
                self.say("ack", pane=message.pane, n=message.number)
            if wanted(message):
                return message

    def text_of(self, t, timeout=180):
        return self.wait_for(lambda m: isinstance(m, dict) and m["t"] == t, timeout)

    def picture(self, timeout=180, **values):
        return self.wait_for(lambda m: isinstance(m, Picture) and m.kind == 1 and
                             all(getattr(m, k) == v for k, v in values.items()), timeout)

    def closed(self, timeout=LIMIT):
        """The code with which the program closes, None without a close frame."""
        try:
            while True:
                self.receive(timeout)
        except Closed as e:
            return e.code
        except socket.timeout:
            return "open"

    def close(self):
        self.socket.close()
