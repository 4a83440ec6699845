// Packets of the remote serial protocol, whole, cut and damaged.

#include "debug/gdb/rsp_packet.h"

#include <catch2/catch.hpp>

#include <random>

using namespace puckloop::debug;
using Kind = RspEvent::Kind;

namespace {

unsigned draw(std::mt19937& random, std::size_t below) {
    return static_cast<unsigned>(random() % below);
}

std::string random_bytes(std::mt19937& random, std::size_t most) {
    std::string bytes(draw(random, (most + 1)), 0);
    for (char& byte : bytes)
        byte = static_cast<char>(random());
    return bytes;
}

}  // namespace

TEST_CASE("packets of any bytes come through, however they are cut") {
    std::mt19937 random(18);
    for (int round = 0; round < 300; ++round) {
        std::vector<std::string> sent;
        std::string wire;
        for (unsigned i = draw(random, 5); i > 0; --i) {
            sent.push_back(random_bytes(random, 40));
            wire += (draw(random, 2) ? "+" : "") + rsp_packet(sent.back());
        }
        RspReader reader;
        std::vector<std::string> got;
        for (std::size_t at = 0; at < wire.size();) {
            const std::size_t size = std::min<std::size_t>(1 + draw(random, 7), wire.size() - at);
            reader.feed({wire.data() + at, size});
            at += size;
            while (const auto event = reader.next()) {
                REQUIRE(event->kind == Kind::Packet);
                got.push_back(event->data);
            }
        }
        CHECK(got == sent);
    }
}

TEST_CASE("a changed byte never passes for another packet, unless the sum is the same") {
    const std::string wire = rsp_packet("m800100,2");
    std::mt19937 random(19);
    for (std::size_t at = 1; at < wire.size(); ++at) {
        std::string damaged = wire;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << draw(random, 5)));
        if (damaged[at] >= 'A' && damaged[at] <= 'F') continue;  // digits of the sum may be capitals
        RspReader reader;
        reader.feed(damaged);
        while (const auto event = reader.next())
            CHECK(event->kind != Kind::Packet);
    }
}

TEST_CASE("Ctrl-C, acknowledgements and noise between packets") {
    RspReader reader;
    reader.feed(std::string("+\x03-noise$?#3f"));
    const Kind expected[] = {Kind::Interrupt, Kind::Again, Kind::Packet};
    for (const Kind kind : expected) {
        const auto event = reader.next();
        REQUIRE(event);
        CHECK(event->kind == kind);
    }
    CHECK_FALSE(reader.next());
    reader.feed(std::string("$cut$?#3f$g#00$}#7d"));  // cut off, a wrong sum, an escape of nothing
    CHECK(reader.next()->data == "?");
    CHECK(reader.next()->kind == Kind::Damaged);
    CHECK(reader.next()->kind == Kind::Damaged);
    reader.feed("$" + std::string(RspReader::kLongest + 1, 'a') + "#00");
    CHECK(reader.next()->kind == Kind::Damaged);
}

TEST_CASE("random bytes break nothing") {
    std::mt19937 random(20);
    RspReader reader;
    std::size_t events = 0;
    for (int round = 0; round < 2000; ++round) {
        std::string bytes = random_bytes(random, 30);
        for (char& byte : bytes)
            if (draw(random, 6) == 0) byte = "$#}+-\x03"[draw(random, 6)];
        reader.feed(bytes);
        while (reader.next())
            ++events;
        std::string_view text = bytes;
        (void)take_hex(text);
        (void)from_hex(bytes);
    }
    CHECK(events > 0);
    // Whatever came before, a whole packet is read.
    reader.feed(std::string("#00#00") + rsp_packet("OK"));
    std::string last;
    while (const auto event = reader.next())
        last = event->data;
    CHECK(last == "OK");
}

TEST_CASE("numbers of packets") {
    std::string_view text = "80,ffff0";
    CHECK(take_hex(text) == 0x80);
    CHECK(take_char(text, ','));
    CHECK(take_hex(text) == 0xffff0);
    CHECK_FALSE(take_hex(text));
    text = "00000000000000000";  // 17 digits
    CHECK_FALSE(take_hex(text));
    CHECK_FALSE(from_hex("abc"));
    CHECK_FALSE(from_hex("zz"));
    CHECK(to_hex("Az") == "417a");
}
