// Messages between the conductor and a node's process; the first byte of the body says which.

#include "cosim/core/codec.h"
#include "cosim/remote/protocol.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    using namespace cosim;
    const auto read = [&](auto reader) {
        try {
            reader();
        } catch (const CodecError& error) {
            require(error.what()[0] != '\0', "a refusal with a reason");
        }
    };
    constexpr std::size_t kPorts = 3;
    read([&] { protocol::kind_of(input); });
    read([&] { protocol::read_hello(input); });
    read([&] { protocol::read_ready(input); });
    read([&] {
        protocol::Grant grant;
        protocol::read_grant(input, grant);
    });
    read([&] { protocol::read_wind_up(input); });
    read([&] {
        NodeState state;
        std::vector<Message> outbox;
        protocol::read_done(input, kPorts, state, outbox);
    });
    read([&] { protocol::read_state(input); });
    read([&] { protocol::read_load(input); });
    read([&] { protocol::read_report(input); });
    read([&] { protocol::read_error(input); });
}
