// Packets, discovery and remote commands at one module; the air is the test's own.

#include "host.h"

using namespace puckloop;
using namespace puckloop::xbee;
using namespace puckloop::xbee::test;

namespace {

constexpr std::uint64_t kOther = 0x0013A200408A3107;

MeshFrame from_other(MeshKind kind, XBeeBytes data, std::uint64_t to = 0x0013A200408C04A4) {
    MeshFrame frame;
    frame.kind = kind;
    frame.origin = frame.hop_from = kOther;
    frame.target = to;
    frame.data = std::move(data);
    return frame;
}

}  // namespace

TEST_CASE("a transmit request goes on air, and its fate comes back") {
    Host host;
    host.boot();
    host.say(XBeeTx{.id = 0x47, .to = kOther, .data = {1, 2, 3}});
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    CHECK(host.sent[0].second.target == kOther);
    CHECK(host.sent[0].second.data == XBeeBytes{1, 2, 3});
    CHECK(host.bytes.empty());
    host.fate({host.sent[0].second.sequence, 1, 0x21, 2});
    host.run(50 * kMs);
    CHECK(host.bytes == encode_xbee(XBeeBytes{0x8B, 0x47, 0xFF, 0xFE, 1, 0x21, 2}, XBeeApiMode::Escaped));
    // Once only; and no answer to frame id 0.
    host.fate({host.sent[0].second.sequence, 0, 0, 0});
    host.say(XBeeTx{.id = 0, .to = kXBeeBroadcast, .data = {4}});
    host.run(50 * kMs);
    CHECK(host.sent.size() == 2);
    CHECK(host.sent[1].second.broadcast());
    host.fate({host.sent[1].second.sequence, 0, 0, 0});
    host.run(50 * kMs);
    CHECK(host.said.size() == 1);
    CHECK(host.report()["air"]["delivery_status"] == nlohmann::json{{"00", 1}, {"21", 1}});
}

TEST_CASE("a packet of which nothing is heard again is given up, with status 21") {
    Host host;
    host.boot();
    for (std::uint8_t id = 1; id <= 5; ++id)
        host.say(XBeeTx{.id = id, .to = kOther, .data = {id}});
    host.run(500 * kMs);
    CHECK(host.sent.size() == 4);
    host.run(20'500 * kMs);
    CHECK(host.sent.size() == 5);
    REQUIRE(host.all<XBeeTxStatus>().size() == 4);
    for (const XBeeTxStatus& status : host.all<XBeeTxStatus>())
        CHECK(status.delivery == 0x21);
}

TEST_CASE("more than NP bytes are refused with status 74") {
    Host host;
    host.boot();
    host.say(XBeeTx{.id = 5, .to = kOther, .data = XBeeBytes(74, 1)});
    host.run(200 * kMs);
    CHECK(host.sent.empty());
    REQUIRE(host.all<XBeeTxStatus>().size() == 1);
    CHECK(host.all<XBeeTxStatus>()[0].delivery == 0x74);
    host.say(XBeeTx{.id = 5, .to = kOther, .data = XBeeBytes(73, 1)});
    host.run(200 * kMs);
    CHECK(host.sent.size() == 1);
}

TEST_CASE("data from the air: frame 90 with options, DB the power of the last packet") {
    Host host;
    host.boot();
    host.hear(from_other(MeshKind::Data, {0x0A, 0x19, 0, 0}), -67);
    host.run(100 * kMs);
    CHECK(host.bytes == encode_xbee(encode(XBeeRx{.from = kOther, .options = 1, .data = {0x0A, 0x19, 0, 0}}),
                                    XBeeApiMode::Escaped));
    host.hear(from_other(MeshKind::Data, {7}, kXBeeBroadcast), -40);
    host.run(100 * kMs);
    CHECK(host.all<XBeeRx>()[1].options == 2);
    CHECK(host.ask("DB").value == XBeeBytes{40});
    // Damaged or somebody else's.
    auto octets = encode_mesh(from_other(MeshKind::Data, {1}));
    octets[30] ^= 1;
    host.hear_octets(octets, kMs);
    host.hear(from_other(MeshKind::Data, {1}, kOther + 1));
    host.run(100 * kMs);
    CHECK(host.all<XBeeRx>().size() == 2);
    CHECK(host.report()["air"]["bad_frames"] == nlohmann::json{{"check", 1}});
    CHECK(host.report()["air"]["of_others"] == 1);
}

TEST_CASE("DN finds by name: status 40 with FFFE and the address, or status 1 after NT") {
    Host host;
    host.boot();
    // The TAM's request, byte for byte.
    host.say_bytes(XBeeBytes{0x7E, 0x00, 0x09, 0x08, 0x01, 0x44, 0x4E, 0x43, 0x4F, 0x4F, 0x52, 0x44, 0xED});
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    const MeshFrame request = host.sent[0].second;
    CHECK(request.kind == MeshKind::Discover);
    CHECK(request.broadcast());
    CHECK(request.data == XBeeBytes{0x00, 0x82, 'C', 'O', 'O', 'R', 'D'});
    const auto sequence = request.sequence;
    host.hear(
        from_other(MeshKind::Discovered, {static_cast<std::uint8_t>(sequence >> 8),
                                          static_cast<std::uint8_t>(sequence), 'C', 'O', 'O', 'R', 'D'}));
    host.run(50 * kMs);
    CHECK(host.bytes == encode_xbee(XBeeBytes{0x88, 0x01, 'D', 'N', 0x40, 0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00,
                                              0x40, 0x8A, 0x31, 0x07},
                                    XBeeApiMode::Escaped));
    host.say(XBeeAt{.id = 3, .command = {'D', 'N'}, .value = {'N', 'O'}});
    const Time asked = host.now();
    host.run(20'000 * kMs);
    REQUIRE(host.all<XBeeAtResponse>().size() == 2);
    CHECK(host.all<XBeeAtResponse>()[1].status == kAtError);
    CHECK(host.said.back().first - asked > 13'000 * kMs);
    CHECK(host.said.back().first - asked < 13'050 * kMs);
    CHECK(host.ask("DN").status == kAtError);
}

TEST_CASE("ND: every answer within NT is a frame of its own, later ones are not") {
    Host host;
    host.boot();
    host.ask("NT", {0x00, 0x20});
    host.say(XBeeAt{.id = 1, .command = {'N', 'D'}, .value = {}});
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    const auto sequence = host.sent[0].second.sequence;
    const auto answer = [&](std::uint64_t address, const std::string& name) {
        MeshFrame frame = from_other(MeshKind::Discovered, {static_cast<std::uint8_t>(sequence >> 8),
                                                            static_cast<std::uint8_t>(sequence)});
        frame.origin = address;
        frame.data.insert(frame.data.end(), name.begin(), name.end());
        host.hear(frame);
        host.run(100 * kMs);
    };
    answer(kOther, "COORD");
    answer(kOther + 1, "TAM01");
    const auto answers = host.all<XBeeAtResponse>();
    REQUIRE(answers.size() == 3);  // with NT's
    XBeeBytes value{0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x8A, 0x31, 0x08, 'T',  'A',
                    'M',  '0',  '1',  0,    0xFF, 0xFE, 0x01, 0x00, 0xC1, 0x05, 0x10, 0x1E};
    CHECK(answers[2].value == value);
    CHECK((answers[2].status & 0x0F) == kAtOk);
    host.run(3200 * kMs);
    answer(kOther + 2, "TAM02");
    CHECK(host.all<XBeeAtResponse>().size() == 3);
}

TEST_CASE("asked to show itself: at once by name, at random times within NT else, each seed its own") {
    const auto answers = [](std::uint64_t seed) {
        ModuleOptions options = escaped();
        options.seed = seed;
        Host host(options);
        host.boot();
        std::vector<Time> delays;
        for (int i = 0; i < 40; ++i) {
            const Time asked = host.now();
            host.hear(from_other(MeshKind::Discover, {0x00, 0x20}, kXBeeBroadcast));
            host.run(3300 * kMs);
            REQUIRE(host.sent.size() == static_cast<std::size_t>(i) + 1);
            delays.push_back(host.sent.back().first - asked);
            CHECK(host.sent.back().second.target == kOther);
            CHECK(host.sent.back().second.kind == MeshKind::Discovered);
        }
        return delays;
    };
    const auto delays = answers(1);
    CHECK(*std::max_element(delays.begin(), delays.end()) <= 3201 * kMs);
    CHECK(*std::max_element(delays.begin(), delays.end()) > 2600 * kMs);
    CHECK(*std::min_element(delays.begin(), delays.end()) < 600 * kMs);
    CHECK(answers(1) == delays);
    CHECK(answers(2) != delays);
    Host host;
    host.boot();
    host.hear(from_other(MeshKind::Discover, {0x00, 0x82, 'T', 'A', 'M', '0', '7'}, kXBeeBroadcast));
    host.hear(from_other(MeshKind::Discover, {0x00, 0x82, 'T', 'A', 'M', '0', '8'}, kXBeeBroadcast));
    host.run(20'000 * kMs);
    REQUIRE(host.sent.size() == 1);
    CHECK(host.report()["air"]["answered_discoveries"] == 1);
}

TEST_CASE(
    "remote commands: done for another, answered over the air, 97 at who asked, status 4 if nobody answers") {
    Host host;
    host.boot();
    host.hear(from_other(MeshKind::RemoteAt, {0x01, 0x02, 'R', 'R', 6}));
    host.hear(from_other(MeshKind::RemoteAt, {0x01, 0x02, 'R', 'R'}));
    host.hear(from_other(MeshKind::RemoteAt, {0x01, 0x02, 'Q', 'Q'}));
    host.hear(from_other(MeshKind::RemoteAt, {0x01}));
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 3);
    CHECK(host.sent[1].second.kind == MeshKind::RemoteAtAnswer);
    CHECK(host.sent[1].second.data == XBeeBytes{0, 0, kAtOk, 6});
    CHECK(host.sent[2].second.data == XBeeBytes{0, 0, kAtUnknown});
    host.sent.clear();
    host.say(XBeeRemoteAt{.id = 8, .to = kOther, .options = 2, .command = {'D', '1'}, .value = {5}});
    host.run(50 * kMs);
    REQUIRE(host.sent.size() == 1);
    const auto sequence = host.sent[0].second.sequence;
    CHECK(host.sent[0].second.data == XBeeBytes{8, 2, 'D', '1', 5});
    host.hear(from_other(MeshKind::RemoteAtAnswer,
                         {static_cast<std::uint8_t>(sequence >> 8), static_cast<std::uint8_t>(sequence), 0}));
    host.run(50 * kMs);
    REQUIRE(host.all<XBeeRemoteAtResponse>().size() == 1);
    CHECK(host.all<XBeeRemoteAtResponse>()[0] ==
          XBeeRemoteAtResponse{.id = 8, .from = kOther, .command = {'D', '1'}, .status = 0, .value = {}});
    host.say(XBeeRemoteAt{.id = 9, .to = kOther, .command = {'D', '1'}, .value = {}});
    host.run(11'000 * kMs);
    CHECK(host.all<XBeeRemoteAtResponse>().back().status == kAtNoAnswer);
}

TEST_CASE("AP 0: bytes become packets after RO character times of silence, and come out as they are") {
    ModuleOptions options = escaped();
    options.parameters = {{"AP", 0}, {"DH", 0x0013A200}, {"DL", 0x408A3107}};
    Host host(options);
    host.boot();
    host.say_bytes(XBeeBytes{'h', 'e', 'l'});
    host.run(30 * kMs);
    REQUIRE(host.sent.size() == 1);
    CHECK(host.sent[0].second.data == XBeeBytes{'h', 'e', 'l'});
    CHECK(host.sent[0].second.target == kOther);
    host.fate({host.sent[0].second.sequence, 0, 0, 0});
    host.hear(from_other(MeshKind::Data, {'l', 'o'}));
    host.run(30 * kMs);
    CHECK(host.bytes == XBeeBytes{'l', 'o'});
    // A long stream goes out in packets of NP.
    host.say_bytes(XBeeBytes(100, 'x'));
    for (int i = 0; i < 30; ++i) {
        host.run(10 * kMs);
        for (const auto& [at, frame] : host.sent)
            host.fate({frame.sequence, 0, 0, 0});
    }
    REQUIRE(host.sent.size() == 3);
    CHECK(host.sent[1].second.data.size() == 73);
    CHECK(host.sent[2].second.data.size() == 27);
}
