// Questions and answers of the domain name system, against octets as programs send them.

#include "protocols/network/dns_message.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::protocols;
using namespace std::string_literals;

namespace {
/// A query as a stub resolver sends it: recursion wanted, one question.
std::string query(const std::string& labels, char type, char additional = 0) {
    return "\x12\x34\x01\0\0\x01\0\0\0\0\0"s + additional + labels + "\0\0"s + type + "\0\1"s;
}
const std::string kRobot = "\6robot0\3lan"s;
/// What dig adds: size 1232, no data.
const std::string kOptRecord = "\0\0\x29\x04\xd0\0\0\0\0\0\0"s;
}  // namespace

TEST_CASE("a question is read with its name and kind", "[dns]") {
    const auto question = decode_dns_question(query(kRobot, 1));
    REQUIRE(question);
    CHECK(question->readable);
    CHECK(question->id == 0x1234);
    CHECK(question->opcode() == 0);
    CHECK(question->name == "robot0.lan");
    CHECK(question->type == kDnsAddress);
    CHECK(question->kind == kDnsInternet);
    CHECK_FALSE(question->extended);
    CHECK(decode_dns_question(query(kRobot, 1, 1) + kOptRecord)->extended);
}

TEST_CASE("answers are what resolvers expect, octet by octet", "[dns]") {
    const auto question = decode_dns_question(query(kRobot, 1));
    const std::string section = kRobot + "\0\0\1\0\1"s;
    CHECK(encode_dns_answer(*question, DnsStatus::Ok, dns_data(0x0a000001)) ==
          "\x12\x34\x85\x80\0\1\0\1\0\0\0\0"s + section + "\xc0\x0c\0\1\0\1\0\0\0\x3c\0\4\x0a\0\0\1"s);
    CHECK(encode_dns_answer(*question, DnsStatus::NoSuchName) ==
          "\x12\x34\x85\x83\0\1\0\0\0\0\0\0"s + section);
    const auto extended = decode_dns_question(query(kRobot, 1, 1) + kOptRecord);
    CHECK(encode_dns_answer(*extended, DnsStatus::Ok) ==
          "\x12\x34\x85\x80\0\1\0\0\0\0\0\1"s + section + kOptRecord);
    CHECK(dns_data("robot0.lan") == kRobot + "\0"s);
}

TEST_CASE("what is no question gets no answer, and a bad one is refused", "[dns]") {
    CHECK_FALSE(decode_dns_question(""));
    CHECK_FALSE(decode_dns_question(query(kRobot, 1).substr(0, 11)));
    std::string answer = query(kRobot, 1);
    answer[2] = '\x81';
    CHECK_FALSE(decode_dns_question(answer));
    const std::string whole = query(kRobot, 1);
    for (std::size_t size = 12; size < whole.size(); ++size) {
        const auto cut = decode_dns_question(whole.substr(0, size));
        REQUIRE(cut);
        CHECK_FALSE(cut->readable);
    }
    // A pointer into the message, a label and a name that are too long.
    CHECK_FALSE(decode_dns_question(query("\xc0\x0c"s, 1))->readable);
    CHECK_FALSE(decode_dns_question(query("\x40"s + std::string(64, 'x'), 1))->readable);
    std::string labels;
    for (int i = 0; i < 5; ++i)
        labels += "\x3f"s + std::string(63, 'x');
    CHECK_FALSE(decode_dns_question(query(labels, 1))->readable);
    CHECK(encode_dns_answer(*decode_dns_question(whole.substr(0, 14)), DnsStatus::BadFormat) ==
          "\x12\x34\x85\x81\0\0\0\0\0\0\0\0"s);
}

TEST_CASE("addresses are asked for backwards", "[dns]") {
    CHECK(address_of_pointer("1.0.0.10.in-addr.arpa") == 0x0a000001u);
    CHECK(address_of_pointer("254.255.0.10.IN-ADDR.ARPA") == 0x0a00fffeu);
    for (const char* wrong : {"1.0.0.in-addr.arpa", "1.0.0.10.2.in-addr.arpa", "256.0.0.10.in-addr.arpa",
                              "1.0.0.x.in-addr.arpa", "robot0", "in-addr.arpa", ".in-addr.arpa", ""})
        CHECK_FALSE(address_of_pointer(wrong));
}
