#include "emu/radio/medium.h"

#include "base/random.h"
#include "emu/radio/control.h"
#include "protocols/radio/mesh_frame.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::radio;

TEST_CASE("power falls to the sensitivity at the range, and agrees with free space close by") {
    const Propagation air;
    CHECK(air.received_dbm(kFullPowerDbm, 30.0) == Approx(-92.0));
    // Friis at 1 m: 20 log10(4 pi / lambda), lambda = c / 2.405 GHz.
    const double friis = 20 * std::log10(4 * 3.14159265 * 2.405e9 / 299792458.0);
    CHECK(air.received_dbm(kFullPowerDbm, 1.0) == Approx(kFullPowerDbm - friis).margin(2.0));
    CHECK(air.received_dbm(-7.0, 30.0) == Approx(-92.0 - 7.0 - 1.42));
    CHECK(air.frame_loss(-92.0) == Approx(0.01));
    CHECK(air.frame_loss(-91.0) == Approx(0.001));
    CHECK(air.frame_loss(-92.1) == 1.0);
    Propagation noisy;
    noisy.loss = 0.3;
    CHECK(noisy.frame_loss(-40.0) == Approx(0.3));
}

TEST_CASE("what keeps a frame from a receiver") {
    // 0 and 1 close together, 2 at 20 m, 3 beyond the range.
    Medium medium({}, {{0, 0, 0}, {1, 0, 0}, {20, 0, 0}, {40, 0, 0}});
    const Transmission from0{1, 0, 12, 1.42, 1000, 2000, 0};
    medium.add(from0);
    CHECK(medium.fate(from0, 1) == Fate::Read);
    CHECK(medium.fate(from0, 2) == Fate::Read);
    CHECK(medium.fate(from0, 3) == Fate::Weak);
    CHECK(medium.busy(1, 12, -60, 1500));
    CHECK_FALSE(medium.busy(1, 13, -60, 1500));
    CHECK_FALSE(medium.busy(1, 12, -60, 2000));
    CHECK_FALSE(medium.busy(2, 12, -60, 1500));
    // Station 3 sends as well: too weak to harm 1, as strong as 0 at 2.
    medium.add({2, 3, 12, 1.42, 1500, 2500, 0});
    CHECK(medium.fate(from0, 1) == Fate::Read);
    CHECK(medium.fate(from0, 2) == Fate::Collision);
    medium.add({3, 1, 12, 1.42, 1999, 2500, 0});
    CHECK(medium.fate(from0, 1) == Fate::Sending);
    CHECK(medium.own_until(1, 0, 3000) == 2500);
    CHECK(medium.own_until(1, 0, 1999) == 0);
    medium.forget_before(2600);
    CHECK_FALSE(medium.busy(1, 12, -200, 1500));
}

TEST_CASE("FCS and mesh frames go to octets and back") {
    // The example of IEEE 802.15.4-2006, section 7.2.1.9: an acknowledgement.
    const std::vector<std::uint8_t> example{0x02, 0x00, 0x6A};
    CHECK(protocols::fcs_of(example) == 0x79E4);
    RandomStream random(5, "mesh");
    for (int round = 0; round < 500; ++round) {
        protocols::MeshFrame frame;
        frame.pan = static_cast<std::uint16_t>(random.next());
        frame.hop_to = random.next();
        frame.hop_from = random.next();
        frame.mac_sequence = static_cast<std::uint8_t>(random.next());
        frame.asks_ack = random.below(2) == 1;
        frame.kind = static_cast<protocols::MeshKind>(random.below(8));
        frame.options = static_cast<std::uint8_t>(random.next());
        frame.radius = static_cast<std::uint8_t>(random.next());
        frame.hops = static_cast<std::uint8_t>(random.next());
        frame.sequence = static_cast<std::uint16_t>(random.next());
        frame.origin = random.next();
        frame.target = random.next();
        frame.data.resize(random.below(protocols::kMostMeshData + 1));
        for (std::uint8_t& octet : frame.data)
            octet = static_cast<std::uint8_t>(random.next());
        auto octets = protocols::encode_mesh(frame);
        REQUIRE(octets.size() == protocols::kMeshOverhead + frame.data.size());
        const auto reading = protocols::decode_mesh(octets);
        REQUIRE(reading.fault == protocols::MeshFault::None);
        CHECK(reading.frame == frame);
        // Any single flipped bit is found; anything else never does more than fail.
        octets[random.below(octets.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
        CHECK(protocols::decode_mesh(octets).fault == protocols::MeshFault::Check);
        octets.resize(random.below(octets.size()));
        CHECK(protocols::decode_mesh(octets).fault != protocols::MeshFault::None);
    }
}

TEST_CASE("words between module and network layer, and octets that are none") {
    RadioSettings settings;
    settings.on = true;
    settings.channel = 26;
    settings.pan = 0x1B2;
    settings.address = 0x0013A200408C04A4;
    settings.dbm = -7;
    settings.cca = 60;
    CHECK(decode_settings(encode(settings)) == settings);
    const RadioOutcome outcome{0x1234, 2, kNoRoute, kRouteDiscovered};
    CHECK(decode_outcome(encode(outcome)) == outcome);
    CHECK_FALSE(decode_outcome(encode(settings)));
    CHECK_FALSE(decode_settings(encode(outcome)));
    settings.channel = 27;
    CHECK_FALSE(decode_settings(encode(settings)));
    RandomStream random(6, "control");
    for (int round = 0; round < 2000; ++round) {
        std::vector<std::uint8_t> octets(random.below(24));
        for (std::uint8_t& octet : octets)
            octet = static_cast<std::uint8_t>(random.below(3) == 0 ? 'S' : random.next());
        decode_settings(octets);
        decode_outcome(octets);
    }
}
