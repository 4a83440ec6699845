#include "base/random.h"
#include "cosim/remote/protocol.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

std::span<const std::uint8_t> body_of(const Bytes& bytes) {
    return std::span(bytes).subspan(protocol::kLengthBytes);
}

RadioFrame some_radio_frame() {
    const Bytes octets{0x41, 0x88, 0x00, 0xff};
    return {12, 320 * kMicrosecond, Octets(octets), 26, -90};
}

Packet some_packet() {
    Bytes octets(kMostPacketOctets, 0x45);
    octets.back() = 0xff;
    return {5, 1'090'909'090, Octets(octets)};
}

std::vector<Message> some_messages() {
    UartFrame frame{123456789, 8680555, 0x1a5, 9, 2, 2, 1, 0};
    I2cPhase phase{I2cPhaseKind::Data, 0xc0, 1, -5, 2500000, 7};
    UartFrame damaged{frame};
    damaged.line = kLineInverted | kLineRestsLow;
    damaged.glitch_at = 4'000'000'000;
    damaged.glitch_width = 1;
    CanMessage can{123, {1, 2, 3, 4, 5, 6, 7, 0xff}, (1u << 29) - 1, 0xFFFFFFFF, 256, 255, CanKind::Error};
    can.length = 8;
    can.flags = static_cast<std::uint8_t>(kMostCanError << kCanErrorShift | 0x1f);
    can.tag = can.position = 255;
    return {{1, 0, frame},
            {1, 1, damaged},
            {2, 65535, phase},
            {2, 1, I2cPhase{I2cPhaseKind::Read, 0, 2, 1, 2500000, 0}},  // cosim/i2c/i2c_shared.h
            {2, 1, I2cPhase{I2cPhaseKind::Data, 0xff, kMostI2cAck, 1, 2500000, 0}},
            {kNever, 3, Signal{7, -0.25}},
            {9, 1, some_radio_frame()},
            {9, 1, can},
            {10, 0, some_packet()}};
}

NodeState some_state() {
    return {{{5, 6, std::nullopt}, {kNever, 0, Time{4}}},
            Stop{99, false, "the program exited"},
            7,
            true,
            true,
            123};
}

std::vector<PortEcho> some_echoes() {
    return {{78125000, 5, kNever, true}, {0, 0, 9, false}};
}

/// Every reader on a body that may be anything: it reads or throws CodecError.
int read_all(std::span<const std::uint8_t> body) {
    int read = 0;
    const auto attempt = [&](auto work) {
        try {
            work();
            ++read;
        } catch (const CodecError&) {
        }
    };
    protocol::Grant grant;
    NodeState state;
    std::vector<Message> outbox;
    attempt([&] { protocol::read_hello(body); });
    attempt([&] { protocol::read_ready(body); });
    attempt([&] { protocol::read_grant(body, grant); });
    attempt([&] { protocol::read_done(body, 2, state, outbox); });
    attempt([&] { protocol::read_report(body); });
    attempt([&] { protocol::read_error(body); });
    return read;
}

std::vector<Bytes> whole_messages() {
    std::vector<Bytes> all(6);
    protocol::write_hello(all[0], {"robot0.pic", "{\"kind\": \"pic\"}"});
    protocol::write_ready(all[1], {{{"uart2", PortKind::Uart}, {"world", PortKind::Signals}}, some_state()});
    protocol::write_grant(all[2], {1000, 1234, 1300}, some_messages(), some_echoes());
    protocol::write_done(all[3], {77, 99, 1}, some_state(), some_messages());
    protocol::write_report(all[4], "{}");
    protocol::write_error(all[5], {true, "x.hex: line 3: bad"});
    return all;
}

}  // namespace

TEST_CASE("what is written is read back") {
    const std::vector<Bytes> all = whole_messages();
    CHECK(protocol::read_hello(body_of(all[0])).name == "robot0.pic");
    const protocol::Ready ready = protocol::read_ready(body_of(all[1]));
    REQUIRE(ready.ports.size() == 2);
    CHECK(ready.ports[1].name == "world");
    CHECK(ready.ports[1].kind == PortKind::Signals);
    CHECK(ready.state.ports == some_state().ports);
    protocol::Grant grant;
    protocol::read_grant(body_of(all[2]), grant);
    CHECK(grant.reach == Reach{1000, 1234, 1300});
    CHECK(grant.inbox == some_messages());
    CHECK(grant.echoes == some_echoes());
    NodeState state;
    std::vector<Message> outbox;
    const Advanced advanced = protocol::read_done(body_of(all[3]), 2, state, outbox);
    CHECK(advanced.reached == 77);
    CHECK(advanced.ahead == 99);
    CHECK(advanced.sure == 1);
    CHECK(outbox == some_messages());
    CHECK(state.ports == some_state().ports);
    REQUIRE(state.stop);
    CHECK(state.stop->time == 99);
    CHECK(state.stop->reason == "the program exited");
    CHECK(protocol::read_error(body_of(all[5])).text == "x.hex: line 3: bad");
}

TEST_CASE("the byte order is little-endian everywhere") {
    Bytes bytes;
    ByteWriter writer(bytes);
    writer.u32(0x01020304);
    writer.time(-2);
    CHECK(bytes == Bytes{4, 3, 2, 1, 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff});
}

TEST_CASE("truncated messages are refused at every length") {
    for (const Bytes& bytes : whole_messages()) {
        REQUIRE(read_all(body_of(bytes)) == 1);
        for (std::size_t length = 0; length + protocol::kLengthBytes < bytes.size(); ++length)
            REQUIRE(read_all(body_of(bytes).first(length)) == 0);
        Bytes longer = bytes;
        longer.push_back(0);
        CHECK(read_all(body_of(longer)) == 0);
    }
}

TEST_CASE("damaged and random messages never do more than throw CodecError") {
    RandomStream random(11, "fuzz");
    const std::vector<Bytes> all = whole_messages();
    for (int round = 0; round < 8000; ++round) {
        Bytes bytes = all[random.below(all.size())];
        const std::uint64_t flips = 1 + random.below(6);
        for (std::uint64_t i = 0; i < flips; ++i)
            bytes[protocol::kLengthBytes + random.below(bytes.size() - protocol::kLengthBytes)] =
                static_cast<std::uint8_t>(random.next());
        read_all(body_of(bytes));
    }
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes(random.below(64));
        for (std::uint8_t& byte : bytes)
            byte = static_cast<std::uint8_t>(random.below(4) == 0 ? 255 : random.below(8));
        read_all(bytes);
    }
}

TEST_CASE("huge counts and lengths are refused before memory is taken for them") {
    Bytes bytes;
    ByteWriter writer(bytes);
    writer.u8(static_cast<std::uint8_t>(protocol::Kind::Grant));
    for (int time = 0; time < 3; ++time)
        writer.time(0);
    writer.u32(0xffffffff);
    protocol::Grant grant;
    CHECK_THROWS_WITH(protocol::read_grant(bytes, grant),
                      Catch::Contains("more items than the message can hold"));
    bytes[0] = static_cast<std::uint8_t>(protocol::Kind::Report);
    CHECK_THROWS_AS(protocol::read_report(bytes), CodecError);
}
