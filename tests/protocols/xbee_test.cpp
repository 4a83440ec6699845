// XBee API frames: the bytes that the real TAM firmware and its coordinator send, every fault, random frames.
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"

#include <catch2/catch.hpp>

#include <array>
#include <random>

using namespace puckloop::protocols;

namespace {

using Bytes = XBeeBytes;

std::vector<XBeeReading> read(XBeeReader& reader, const Bytes& line) {
    std::vector<XBeeReading> readings;
    for (const std::uint8_t byte : line)
        if (const auto reading = reader.take(byte)) readings.push_back(*reading);
    if (const auto rest = reader.end()) readings.push_back(*rest);
    return readings;
}

std::vector<XBeeReading> read(const Bytes& line, XBeeApiMode mode = XBeeApiMode::Escaped) {
    XBeeReader reader(mode);
    return read(reader, line);
}

/// TAM fact sheet, section 7: the first report of a booth, 3795 mV, nobody inside.
const Bytes kHeartbeat{0x7E, 0x00, 0x16, 0x10, 0x01, 0x00, 0x7D, 0x33, 0xA2, 0x00, 0x40, 0x8C, 0x04, 0xA4,
                       0xFF, 0xFE, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xD3, 0x0E, 0x00, 0xE7};
const XBeeTx kHeartbeatMessage{.to = 0x0013A200408C04A4,
                               .data = {0x00, 0x00, 0x00, 0x00, 0x00, 0xD3, 0x0E, 0x00}};

}  // namespace

TEST_CASE("an XBee frame has the bytes of the TAM fact sheet") {
    CHECK(encode_xbee(encode(kHeartbeatMessage), XBeeApiMode::Escaped) == kHeartbeat);
    CHECK(encode_xbee(encode(XBeeAt{.command = {'N', 'T'}, .value = {}}), XBeeApiMode::Escaped) ==
          Bytes{0x7E, 0x00, 0x04, 0x08, 0x01, 0x4E, 0x54, 0x54});
    CHECK(encode_xbee(encode(XBeeAt{.command = {'D', 'N'}, .value = {'C', 'O', 'O', 'R', 'D'}}),
                      XBeeApiMode::Escaped) ==
          Bytes{0x7E, 0x00, 0x09, 0x08, 0x01, 0x44, 0x4E, 0x43, 0x4F, 0x4F, 0x52, 0x44, 0xED});
    const auto readings = read(kHeartbeat);
    REQUIRE(readings.size() == 1);
    CHECK(readings[0].ok());
    CHECK(readings[0].at == kHeartbeat.size() - 1);
    CHECK(std::get<XBeeTx>(decode_xbee(readings[0].data)) == kHeartbeatMessage);
}

TEST_CASE("an XBee receiver names what is wrong and goes on behind it") {
    const Bytes good{0x7E, 0x00, 0x02, 0x8A, 0x00, 0x75};
    const auto faults = [&](Bytes line, XBeeApiMode mode = XBeeApiMode::Escaped) {
        line.insert(line.end(), good.begin(), good.end());
        std::vector<XBeeFault> found;
        for (const XBeeReading& reading : read(line, mode))
            found.push_back(reading.fault);
        return found;
    };
    using enum XBeeFault;
    CHECK(faults({}) == std::vector{None});
    CHECK(faults({0x00, 0x55}) == std::vector{Noise, None});
    CHECK(faults({0x7E, 0x00, 0x02, 0x8A}) == std::vector{Restart, None});
    CHECK(faults({0x7E, 0x00, 0x00}) == std::vector{Length, None});
    CHECK(faults({0x7E, 0x01, 0x01}) == std::vector{Length, None});
    CHECK(faults({0x7E, 0x00, 0x02, 0x8A, 0x00, 0x74}) == std::vector{Check, None});
    // Without escapes a start delimiter is a byte as any other.
    CHECK(faults({0x7E, 0x00, 0x02, 0x8A, 0x7E, 0xF7}, XBeeApiMode::Plain) == std::vector{None, None});
    const auto cut = read({0x7E, 0x00, 0x02, 0x8A, 0x7D});
    REQUIRE(cut.size() == 1);
    CHECK(cut[0].fault == Short);
    CHECK(explain(cut[0]) == "short: the bytes end at byte 4, inside the frame");
    CHECK(explain(read({0x7E, 0x00, 0x02, 0x8A, 0x00, 0x74})[0]) ==
          "check: 74 up to byte 5, and the data needs 75");
}

TEST_CASE("XBee frames of random data come back as they were, in both modes and in one line") {
    std::mt19937_64 random(1);
    for (const XBeeApiMode mode : {XBeeApiMode::Plain, XBeeApiMode::Escaped}) {
        std::vector<Bytes> sent;
        Bytes line;
        for (int frame = 0; frame < 500; ++frame) {
            Bytes data(1 + random() % 120);
            for (std::uint8_t& byte : data)  // many of them to be escaped
                byte = random() % 3 ? static_cast<std::uint8_t>(random())
                                    : std::array<std::uint8_t, 4>{0x7E, 0x7D, 0x11, 0x13}[random() % 4];
            const Bytes bytes = encode_xbee(data, mode);
            line.insert(line.end(), bytes.begin(), bytes.end());
            sent.push_back(data);
            CHECK(encode(decode_xbee(data)) == data);
        }
        const auto readings = read(line, mode);
        REQUIRE(readings.size() == sent.size());
        for (std::size_t i = 0; i < sent.size(); ++i) {
            CHECK(readings[i].ok());
            CHECK(readings[i].data == sent[i]);
        }
    }
}

TEST_CASE("an XBee receiver survives any bytes and finds the frame behind them") {
    std::mt19937_64 random(2);
    for (int round = 0; round < 300; ++round) {
        Bytes line(random() % 400);
        for (std::uint8_t& byte : line)
            byte = random() % 8 ? static_cast<std::uint8_t>(random()) : kXBeeStart;
        XBeeReader reader(XBeeApiMode::Escaped);
        std::size_t bytes_read = 0;
        for (const std::uint8_t byte : line) {
            if (const auto reading = reader.take(byte)) {
                CHECK(reading->data.size() <= 256);
                CHECK(reading->at == bytes_read);
            }
            ++bytes_read;
        }
        const auto readings = read(reader, kHeartbeat);
        REQUIRE(!readings.empty());
        CHECK(readings.back().ok());
    }
}
