"""listen.py: listens on 127.0.0.1, prints the port, and a line a connection."""
import socket

server = socket.create_server(("127.0.0.1", 0))
print(server.getsockname()[1], flush=True)
while True:
    server.accept()[0].close()
    print("connection", flush=True)
