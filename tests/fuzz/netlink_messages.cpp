// What programs ask the board's kernel by netlink: each input is what one send() hands over.

#include "linuxboard/shim/network/network_stack.h"
#include "tests/fuzz/target.h"

#include <linux/netlink.h>

#include <cerrno>
#include <cstring>

void puckloop::fuzz::run_input(Input input) {
    using namespace linuxboard;
    NetworkStack stack({"10.0.0.1", 24, {{"a", "10.0.0.1"}, {"b", "10.0.0.2"}}}, RandomStream(1, "fuzz"));
    const int asker = stack.open(SocketKind::Netlink);
    std::size_t taken = 0;
    const int error = stack.send(asker, Endpoint{}, text_of(input), taken, 0);
    require(error == 0 || error == EMSGSIZE, "it is taken");
    NetworkStack::Received received;
    for (int result = 0; result != EAGAIN;) {
        result = stack.receive(asker, 65'535, false, received, 0);
        require(result == 0 || result == EAGAIN || result == ENOBUFS, "answers, or none");
        if (result != 0) continue;
        // Whole messages, one behind the other.
        for (std::size_t at = 0; at < received.data.size();) {
            nlmsghdr head{};
            require(at + sizeof head <= received.data.size(), "an answer has a head");
            std::memcpy(&head, received.data.data() + at, sizeof head);
            require(head.nlmsg_len >= sizeof head && at + head.nlmsg_len <= received.data.size(),
                    "an answer is as long as it says");
            at += NLMSG_ALIGN(head.nlmsg_len);
        }
    }
    stack.close(asker, 0);
}
