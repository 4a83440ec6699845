// A node process for tests: serves toy nodes, or misbehaves on the socket as its argument says.

#include "cosim/remote/node_server.h"
#include "cosim/remote/protocol.h"
#include "toy_nodes.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <unistd.h>

int main(int argc, char** argv) {
    using namespace puckloop::cosim;
    const std::string mode = argc > 1 ? argv[1] : "node";
    if (mode == "garbage") {
        const char text[] = "this is no message at all, whoever reads it";
        if (write(protocol::kDescriptor, text, sizeof text) < 0) return 1;
        pause();
    }
    if (mode == "silent") pause();
    if (mode == "exit") return 5;
    return serve_node(protocol::kDescriptor, toy::make);
}
