# Asks for names by every way there is, and prints what came of it and how long it took.
import socket
import time

start = time.monotonic()

def ask(what, call):
    begin = time.monotonic()
    try:
        result = call()
    except OSError as error:
        result = f"{type(error).__name__} {error.args[0]}"
    print(f"{begin - start:.1f} {what} {result} after {time.monotonic() - begin:.1f}", flush=True)


ask("own", lambda: socket.gethostbyname(socket.gethostname()))
ask("number", lambda: socket.getaddrinfo("10.0.0.254", 7, type=socket.SOCK_STREAM)[0][4])
print("hosts", open("/etc/hosts").read().count("server"), flush=True)
for _ in range(3):
    ask("server", lambda: socket.getaddrinfo("server", 7, type=socket.SOCK_STREAM)[0][4])
ask("server", lambda: socket.gethostbyname("server"))
ask("nobody", lambda: socket.gethostbyname("nobody"))
