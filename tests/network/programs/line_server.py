# Answers each line of each client, the first client's end with a word more.
import socketserver


class Talk(socketserver.StreamRequestHandler):
    def handle(self):
        for line in self.rfile:
            print("got", line.decode().strip(), flush=True)
            self.wfile.write(b"you said " + line)
        self.wfile.write(b"bye\n")


socketserver.ThreadingTCPServer.allow_reuse_address = True
socketserver.ThreadingTCPServer(("", 7000), Talk).serve_forever()
