// Garbage and floods on a module's serial line and from the air: counted, and nothing hangs.

#include "host.h"

#include "base/random.h"

using namespace puckloop;
using namespace puckloop::xbee;
using namespace puckloop::xbee::test;

TEST_CASE("bad frames are counted by kind, and the next good one is answered") {
    Host host;
    host.boot();
    host.say_bytes(
        XBeeBytes{0x01, 0x02, 0x7E, 0x00, 0x04, 0x08, 0x7E, 0x00, 0x04, 0x08, 0x01, 0x4E, 0x49, 0x00});
    CHECK(host.ask("NI").status == kAtOk);
    host.say_bytes(XBeeBytes{0x7E, 0xFF, 0xFF});
    CHECK(host.ask("NI").status == kAtOk);
    host.say_bytes(encode_xbee(XBeeBytes{0x55, 1, 2}, XBeeApiMode::Escaped));
    CHECK(host.ask("NI").status == kAtOk);
    const auto uart = host.report()["uart"];
    CHECK(uart["bad_frames"] == nlohmann::json{{"noise", 1}, {"restart", 1}, {"check", 1}, {"length", 1}});
    CHECK(uart["unknown_frames"] == 1);
    CHECK(uart["between_frames"] == 2);
}

TEST_CASE("garbage of any kind and length: the next command is answered") {
    RandomStream random(8, "garbage");
    for (int round = 0; round < 40; ++round) {
        Host host;
        host.boot();
        XBeeBytes garbage(1 + random.below(2000));
        const std::uint64_t delimiters = random.below(4);
        for (std::uint8_t& byte : garbage) {
            byte = static_cast<std::uint8_t>(random.below(256));
            if (byte == 0x7E && delimiters == 0) byte = 0;
            if (random.below(20) < delimiters) byte = 0x7E;
        }
        host.say_bytes(garbage);
        host.run(2200 * kMs);
        host.reader = XBeeReader(XBeeApiMode::Escaped);
        const std::size_t before = host.all<XBeeAtResponse>().size();
        host.say(XBeeAt{.id = 9, .command = {'N', 'I'}, .value = {}});
        host.run(100 * kMs);
        CHECK(host.all<XBeeAtResponse>().size() == before + 1);
        CHECK(host.report()["uart"]["overflow"] == 0);
    }
}

TEST_CASE("another baud rate: framing errors or bad frames, no answer, and back to work") {
    Host host;
    host.boot();
    const auto bytes =
        encode_xbee(encode(XBeeAt{.id = 1, .command = {'N', 'I'}, .value = {}}), XBeeApiMode::Escaped);
    host.say_bytes(bytes, 208 * kUs);
    host.run(100 * kMs);
    CHECK(host.said.empty());
    CHECK(host.node.module().counts().framing_errors > 0);
    host.say_bytes(XBeeBytes{0, 0}, kBit);
    host.run(100 * kMs);
    CHECK(host.ask("NI").status == kAtOk);
    CHECK_FALSE(host.report().contains("warnings"));

    Host fast;  // twelve times too fast: whole characters pass within a bit
    fast.boot();
    fast.say_bytes(XBeeBytes(1000, 0), kBit / 12);
    fast.run(100 * kMs);
    CHECK(fast.report()["uart"]["between_frames"].get<int>() +
              fast.report()["uart"]["framing_errors"].get<int>() >
          50);
    CHECK_THAT(fast.report()["warnings"][0].get<std::string>(),
               Catch::Contains("no API frame (expected the rate of BD = 3"));
}

TEST_CASE("a flood of packets: four are under way, CTS rises at FT, the buffer overflows, all is counted") {
    Host host;
    host.boot();
    for (int i = 0; i < 40; ++i)
        host.say(XBeeTx{.id = 1, .to = kXBeeBroadcast, .data = XBeeBytes(20, 'f')});
    host.run(2000 * kMs);
    CHECK(host.sent.size() == 4);
    CHECK(host.cts == std::vector<double>{1.0});
    const auto full = host.report()["uart"];
    CHECK(full["overflow"].get<int>() > 300);
    // The network gets rid of them one by one.
    std::size_t done = 0;
    for (int i = 0; i < 200; ++i) {
        if (done < host.sent.size()) host.fate({host.sent[done++].second.sequence, 0, 0, 0});
        host.run(20 * kMs);
    }
    CHECK(done == host.sent.size());
    CHECK(done < 40);
    CHECK(host.cts.back() == 0.0);
    CHECK(host.all<XBeeTxStatus>().size() == done);
    host.say_bytes(XBeeBytes(3, 0x7E));
    CHECK(host.ask("NI").status == kAtOk);
}

TEST_CASE("a flood from the air: what the serial transmit buffer cannot hold is dropped and counted") {
    Host host;
    host.boot();
    MeshFrame frame;
    frame.origin = 0x0013A200408A3107;
    frame.data.assign(60, 'a');
    for (int i = 0; i < 50; ++i) {
        host.hear(frame);
        host.run(3 * kMs);
    }
    host.run(2000 * kMs);
    const auto report = host.report();
    CHECK(report["uart"]["dropped_out"].get<std::size_t>() + host.all<XBeeRx>().size() == 50);
    CHECK(report["uart"]["dropped_out"].get<int>() > 30);
}

TEST_CASE("RTS holds DOUT back only with D6 = 1") {
    Host host;
    host.boot();
    host.pin(2, 1.0);
    CHECK(host.ask("NI").status == kAtOk);
    host.pin(2, 0.0);
    host.ask("D6", {1});
    host.pin(2, 1.0);
    host.run(20 * kMs);
    host.say(XBeeAt{.id = 1, .command = {'N', 'I'}, .value = {}});
    const std::size_t before = host.said.size();
    host.run(200 * kMs);
    CHECK(host.said.size() == before);
    host.pin(2, 0.0);
    host.run(200 * kMs);
    CHECK(host.said.size() == before + 1);
}

TEST_CASE("random bytes, frames, pins and air: no promise broken, the same however time is granted") {
    const auto life = [](std::uint64_t seed, Time step) {
        Host host;
        RandomStream random(seed, "life");
        for (int round = 0; round < 150; ++round) {
            XBeeBytes data(1 + random.below(12));
            for (std::uint8_t& byte : data)
                byte = static_cast<std::uint8_t>(random.next());
            constexpr std::array<const char*, 19> kCommands{"BD", "AP", "RO", "WR", "RE", "FR", "AC",
                                                            "ND", "DN", "NI", "D6", "FT", "CH", "NT",
                                                            "GT", "SM", "SP", "ST", "ID"};
            const char* command = kCommands[random.below(kCommands.size())];
            switch (random.below(9)) {
            case 8: {
                const std::string text = random.below(2) == 0 ? "+++" : std::string("AT") + command + "\r";
                host.say_bytes(XBeeBytes(text.begin(), text.end()));
                if (random.below(2) == 0) host.run(1100 * kMs, step);
                break;
            }
            case 0: {
                constexpr std::array<Time, 5> kBits{kBit, kBit, 9 * kUs, 208 * kUs, 833 * kUs};
                host.say_bytes(data, kBits[random.below(kBits.size())]);
                break;
            }
            case 1:
                host.say_bytes(encode_xbee(data, XBeeApiMode::Escaped));
                break;
            case 2:
            case 3:
                data.resize(random.below(3));
                host.say(XBeeAt{.id = static_cast<std::uint8_t>(random.below(3)),
                                .command = {command[0], command[1]},
                                .value = data},
                         random.below(2) == 0 ? XBeeApiMode::Escaped : XBeeApiMode::Plain);
                break;
            case 4:
                host.say(XBeeTx{.id = 1, .to = random.next(), .data = data});
                break;
            case 5: {
                MeshFrame frame;
                frame.kind = static_cast<MeshKind>(random.below(8));
                frame.target = random.below(2) == 0 ? kXBeeBroadcast : 0x0013A200408C04A4;
                frame.sequence = static_cast<std::uint16_t>(random.below(4));
                frame.data = data;
                host.hear(frame);
                break;
            }
            case 6:
                host.hear_octets(data, random.below(2) == 0 ? 0 : kMs);
                host.fate({static_cast<std::uint16_t>(random.below(8)), 0, 0, 0});
                break;
            default:
                host.pin(static_cast<std::uint16_t>(random.below(6)), random.below(3) == 0 ? 1.0 : 0.0);
            }
            host.reader = XBeeReader(XBeeApiMode::Plain);
            host.run(static_cast<Time>(random.below(60'000)) * kUs, step);
        }
        return std::tuple(host.bytes, host.starts, host.sent.size(), host.report().dump());
    };
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const auto whole = life(seed, cosim::kNever);
        CHECK(life(seed, 700 * kUs) == whole);
    }
}

TEST_CASE("a sender slower than the module's receiver: characters count from when their frame is known") {
    ModuleOptions options = escaped();
    options.parameters = {{"AP", 0}, {"BD", 4}, {"RO", 0}};
    Host host(options);
    host.boot();
    const Time begun = host.now();
    host.say_bytes(XBeeBytes(20, 0xFF));  // 9600 baud against 19200: whole characters within half a frame
    host.run(2000 * kMs, 100 * kUs);
    REQUIRE(host.sent.size() >= 4);
    // The first frame comes in when its stop bit begins; nothing that it causes leaves before the lookahead.
    CHECK(host.sent.front().first >= begun + 9 * kBit + options.processing);
    CHECK(host.node.module().counts().bytes_in + host.node.module().counts().framing_errors >= 20);
}

TEST_CASE("a module that is reset while CTS is high lowers it when it is up again") {
    Host host;
    host.boot();
    for (int i = 0; i < 40; ++i)
        host.say(XBeeTx{.id = 1, .to = kXBeeBroadcast, .data = XBeeBytes(20, 'f')});
    host.run(2000 * kMs);
    REQUIRE(host.cts == std::vector<double>{1.0});
    host.pin(1, 1.0);
    host.run(10 * kMs);
    host.pin(1, 0.0);
    host.run(1500 * kMs);
    CHECK(host.cts == std::vector<double>{1.0, 0.0});
}

TEST_CASE("a module that processes slowly falls asleep no sooner than its lookahead") {
    ModuleOptions options = escaped();
    options.processing = 20 * kMs;
    options.parameters = {{"AP", 2}, {"BD", 3}, {"ID", 0x01B5}, {"SM", 4}, {"ST", 1}, {"SP", 0x20}};
    Host host(options);
    RandomStream random(4, "slow");
    host.run(200 * kMs);
    for (int i = 0; i < 200; ++i) {
        MeshFrame frame;
        frame.target = kXBeeBroadcast;
        frame.sequence = static_cast<std::uint16_t>(i);
        host.hear(frame);
        host.run(1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(60 * kMs))),
                 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(9 * kMs))));
    }
    CHECK(host.report()["sleeps"].get<int>() > 0);
}
