// Questions to a board's resolver, and its answers.

#include "linuxboard/shim/network/name_server.h"
#include "protocols/network/dns_message.h"
#include "tests/fuzz/target.h"

#include <string>

void puckloop::fuzz::run_input(Input input) {
    using namespace protocols;
    static const linuxboard::NameServer kServer(
        {"10.0.0.1", 24, {{"robot0", "10.0.0.1"}, {"b", "10.0.0.2"}}});
    const std::string datagram(input.begin(), input.end());
    const auto question = decode_dns_question(datagram);
    const auto answer = kServer.answer(datagram);
    require(question.has_value() == answer.has_value(), "a question is answered, and nothing else is");
    if (!answer) return;
    constexpr std::size_t kHeader = 12, kMost = 512;
    require(answer->datagram.size() >= kHeader && answer->datagram.size() <= kMost, "an answer fits");
    require(!decode_dns_question(answer->datagram), "an answer is no question");
    require(answer->datagram.substr(0, 2) == datagram.substr(0, 2), "an answer has its question's number");
    if (question->readable)
        require(datagram.substr(kHeader, question->section.size()) == question->section,
                "an answer repeats its question");
}
