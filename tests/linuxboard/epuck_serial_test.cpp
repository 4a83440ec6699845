// The e-puck serial records: layout by known bytes, exact inverses by random bytes, plausibility by range.

#include "base/random.h"
#include "protocols/serial/epuck_serial.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::protocols;

TEST_CASE("an actuator record has the bytes of the fact sheet") {
    EpuckActuators a;
    a.left = 500;
    a.right = -500;
    a.ring_leds = 0x05;
    a.other_leds = 0x03;
    const EpuckActuatorBytes expected{0xF4, 0x01, 0x0C, 0xFE, 0, 0, 0x05, 0x03, 0, 0, 0x4E, 0};
    CHECK(encode(a) == expected);
    CHECK(decode_actuators(expected) == a);
}

TEST_CASE("a sensor record has the offsets of the fact sheet") {
    EpuckSensorBytes bytes{};
    bytes[24] = 1;
    for (std::size_t i = 40; i < 56; i += 2)
        bytes[i] = 0xD8, bytes[i + 1] = 0x0E;
    EpuckSensors s = decode_sensors(bytes);
    CHECK(s.battery_ok == 1);
    CHECK(std::all_of(s.light.begin(), s.light.end(), [](int v) { return v == 3800; }));
    CHECK(why_implausible(s).empty());

    s = EpuckSensors{};
    s.proximity[0] = 0x0102;
    s.proximity[7] = -2;
    s.ircom_data = 0x77;
    s.ircom_bearing = 1.0F;
    bytes = encode(s);
    CHECK(bytes[8] == 0x02);
    CHECK(bytes[9] == 0x01);
    CHECK(bytes[22] == 0xFE);
    CHECK(bytes[23] == 0xFF);
    CHECK(bytes[60] == 0x77);
    CHECK(bytes[70] == 0x80);
    CHECK(bytes[71] == 0x3F);
}

TEST_CASE("decoding and encoding are exact inverses for any bytes") {
    RandomStream random(1, "epuck_serial");
    for (int round = 0; round < 2000; ++round) {
        EpuckSensorBytes s{};
        EpuckActuatorBytes a{};
        EpuckConfigurationBytes c{};
        for (auto& byte : s)
            byte = static_cast<std::uint8_t>(random.below(256));
        for (auto& byte : a)
            byte = static_cast<std::uint8_t>(random.below(256));
        for (auto& byte : c)
            byte = static_cast<std::uint8_t>(random.below(256));
        REQUIRE(encode(decode_sensors(s)) == s);
        REQUIRE(encode(decode_actuators(a)) == a);
        REQUIRE(encode(decode_configuration(c)) == c);
        static_cast<void>(why_implausible(decode_sensors(s)));  // any bytes may be asked about
    }
}

TEST_CASE("random sensor records are refused, shifted ones mostly") {
    RandomStream random(2, "plausibility");
    int random_accepted = 0;
    int shifted_accepted = 0;
    int shifted = 0;
    for (int round = 0; round < 500; ++round) {
        EpuckSensors s;
        s.battery_ok = 1;
        for (auto& value : s.proximity)
            value = static_cast<std::int16_t>(static_cast<int>(random.below(1000)) - 5);
        for (auto& value : s.light)
            value = static_cast<std::int16_t>(3000 + random.below(1000));
        REQUIRE(why_implausible(s).empty());
        const EpuckSensorBytes good = encode(s);
        for (std::size_t shift = 1; shift < good.size(); ++shift, ++shifted) {
            EpuckSensorBytes bytes = good;  // the stream repeats the record
            std::rotate(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(shift), bytes.end());
            shifted_accepted += why_implausible(decode_sensors(bytes)).empty();
        }
        EpuckSensorBytes noise{};
        for (auto& byte : noise)
            byte = static_cast<std::uint8_t>(random.below(256));
        random_accepted += why_implausible(decode_sensors(noise)).empty();
    }
    CHECK(random_accepted == 0);
    // Shifts by whole fields can look right (measured: 17 %); length and timing have to show those.
    CHECK(shifted == 500 * 71);
    CHECK(shifted_accepted < shifted / 5);
}
