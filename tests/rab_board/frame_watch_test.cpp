#include "emu/rab_board/frame_watch.h"

#include "protocols/infrared/rab_frame.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop;
using cosim::Time;
using protocols::encode_rab;

namespace {

constexpr Time kChip = 98'090 * cosim::kNanosecond;
constexpr std::uint16_t kAll = 0x0FFF;

struct Watched {
    rab::FrameWatch watch;
    std::vector<rab::EmittedFrame> frames;
    std::size_t irregular_chips = 0;
    Time now = cosim::kMillisecond;
    std::uint16_t on = 0;

    Watched() {
        watch.on_frame = [this](const rab::EmittedFrame& frame) { frames.push_back(frame); };
        watch.on_irregular = [this](Time, Time, std::size_t chips) { irregular_chips = chips; };
    }
    void chip(std::uint16_t mask, Time length = kChip) {
        if (mask != on) watch.change(mask, now);
        on = mask;
        now += length;
    }
    void frame(const std::string& chips, std::uint16_t mask = kAll) {
        for (const char c : chips)
            chip(c == '1' ? mask : std::uint16_t{0});
    }
    void silence() {
        chip(0, 10 * kChip);
        watch.settle(now);
    }
};

}  // namespace

TEST_CASE("frames of every size are reported with payload and emitters") {
    for (const int size : protocols::kRabSizes)
        for (const std::uint32_t payload : {0x00u, 0x5Au, 0xFFu}) {
            Watched w;
            w.frame(encode_rab(size, payload), 0x0421);
            w.silence();
            REQUIRE(w.frames.size() == 1);
            CHECK(w.frames[0].size == size);
            CHECK(w.frames[0].payloads == std::map<std::uint32_t, std::uint16_t>{{payload, 0x0421}});
            CHECK(w.frames[0].start == cosim::kMillisecond);
            CHECK(w.watch.frames() == 1);
            CHECK(w.watch.irregular() == 0);
        }
}

TEST_CASE("queued frames follow each other after one chip of silence") {
    Watched w;
    for (const std::uint32_t payload : {0x1234u, 0xFFFFu, 0x0000u, 0xA5C3u}) {
        w.frame(encode_rab(16, payload));
        w.chip(0);
    }
    w.silence();
    REQUIRE(w.frames.size() == 4);
    CHECK(w.frames[3].payloads.count(0xA5C3) == 1);
    CHECK(w.frames[3].start == Approx(cosim::kMillisecond + 3 * 47 * kChip).epsilon(1e-3));
}

TEST_CASE("emitters may carry different payloads") {
    Watched w;
    const std::string a = encode_rab(16, 0x1111), b = encode_rab(16, 0xABCD);
    for (std::size_t i = 0; i < a.size(); ++i)
        w.chip(static_cast<std::uint16_t>((a[i] == '1' ? 0x0001 : 0) | (b[i] == '1' ? 0x0030 : 0)));
    w.silence();
    REQUIRE(w.frames.size() == 1);
    CHECK(w.frames[0].payloads == std::map<std::uint32_t, std::uint16_t>{{0x1111, 0x0001}, {0xABCD, 0x0030}});
}

TEST_CASE("a chip that was stretched, a cut frame and plain light are irregular") {
    Watched w;
    const std::string chips = encode_rab(16, 0x1234);
    const std::size_t stretched = chips.find('1', 20);
    for (std::size_t i = 0; i < chips.size(); ++i)
        w.chip(chips[i] == '1' ? kAll : std::uint16_t{0}, i == stretched ? 9 * kChip : kChip);
    w.silence();
    CHECK(w.frames.empty());
    CHECK(w.watch.irregular() == 1);
    w.frame(chips.substr(0, 25));
    w.silence();
    CHECK(w.watch.irregular() == 2);
    w.chip(kAll, cosim::kSecond);
    w.silence();
    CHECK(w.watch.irregular() == 3);
    w.frame(chips);
    w.silence();
    CHECK(w.watch.frames() == 1);
}
