// ECAN1 of the 33FJ: buffers in DMA RAM, filters, FIFO, remote frames, and a 30F at the other end of the bus.

#include "base/random.h"
#include "emu/dspic/machine/sfr_space.h"
#include "tests/can/can_reference.h"
#include "tests/dspic/peripherals/can_bus_bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <optional>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using tests::draw_frame;

namespace {

using Words = std::array<int, 8>;

std::string set(unsigned value, unsigned address) {
    return fmt::format("        mov #{:#x}, w0\n        mov w0, {:#x}\n", value & 0xFFFFu, address);
}

// Of ECAN1, by DS70286's addresses: several names share one, and CxCTRL1.WIN chooses.
constexpr unsigned kCtrl1 = 0x400, kFctrl = 0x406, kCfg2 = 0x412, kFen1 = 0x414, kMaskSelect = 0x418;
constexpr unsigned kFull = 0x420, kOverflow = 0x428, kTr01 = 0x430, kPointers = 0x420, kMasks = 0x430,
                   kFilters = 0x440;
constexpr unsigned kRam = 0x7800;
constexpr Cycle kBit = 32;  // 16 quanta of 2 cycles, FCAN = FCY

struct EcanBench {
    CanPins pins;
    Chip chip{dspic33fj256gp710(), pins, ChipOptions{4e6, 0.0}};
    std::map<std::string, std::uint32_t> symbols;

    /// `setup` runs in Configuration mode with window 1, `more` in window 0.
    EcanBench(const std::string& setup, const std::string& more, unsigned fctrl = 0x8000, bool wired = true)
        : pins(wired) {
        std::string source = "        goto main\n        .org 0x200\nmain:\n";
        source += set(0x0C00, kCtrl1) + set(0x03AC, kCfg2) + set(fctrl, kFctrl) + set(0x0C01, kCtrl1) +
                  setup + set(0x0C00, kCtrl1);
        // DMA0 to CxTXD by request 70, DMA1 from CxRXD by request 34; peripheral indirect.
        source += set(70, 0x382) + set(0x442, 0x388) + set(7, 0x38A) + set(0xA020, 0x380);
        source += set(34, 0x38E) + set(0x440, 0x394) + set(7, 0x396) + set(0x8020, 0x38C);
        source += more + "ready:  bra ready\n";
        const Program program = assemble(source, {});
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        for (const auto& [address, word] :
             {std::pair{0xF80006u, 0xFFF8u}, {0xF80008u, 0xFF7Du}, {0xF8000Au, 0xFF7Fu}})
            chip.load_word(address, word);
        symbols = program.symbols;
        chip.power_on();
    }
    Cycle run_to(const std::string& label) {
        chip.set_stops({symbols.at(label)});
        chip.run_until(chip.now() + 100 * cosim::kMillisecond);
        chip.set_stops({});
        REQUIRE(chip.stopped_at().has_value());
        return chip.cycle();
    }
    void go(Cycle cycles) { chip.run_until(chip.clock().time_of(chip.cycle() + cycles)); }
    Words buffer(int number) const {
        Words words{};
        for (std::size_t i = 0; i < 8; ++i)
            words[i] =
                chip.peek_data(static_cast<std::uint16_t>(kRam + 16 * static_cast<unsigned>(number) + 2 * i));
        return words;
    }
    unsigned full() const { return chip.peek("C1BUFPNT1"); }  // CxRXFUL1 in window 0
};

/// DS70185, figure of the message buffer.
Words words_of(const CanFrame& frame, int filter = 0) {
    Words words{};
    const unsigned standard = frame.extended ? frame.id >> 18 : frame.id;
    const unsigned extension = frame.extended ? frame.id & 0x3FFFF : 0;
    words[0] = static_cast<int>(standard << 2 | (frame.extended ? 3u : frame.remote ? 2u : 0u));
    words[1] = static_cast<int>(extension >> 6);
    words[2] = static_cast<int>((extension & 0x3F) << 10 | (frame.extended && frame.remote ? 0x200u : 0u) |
                                frame.length);
    for (std::size_t i = 0; i < 4; ++i)
        words[3 + i] = frame.data[2 * i] | frame.data[2 * i + 1] << 8;
    words[7] = filter << 8;
    return words;
}

std::string load(int buffer, const CanFrame& frame) {
    std::string text;
    const Words words = words_of(frame);
    for (std::size_t i = 0; i < 7; ++i)
        text += set(static_cast<unsigned>(words[i]),
                    static_cast<unsigned>(kRam + 16 * static_cast<unsigned>(buffer) + 2 * i));
    return text;
}

const std::string kTakeAll = set(0x0009, kPointers) + set(1, kFen1);  // filter 0, mask 0: all to buffer 9

}  // namespace

TEST_CASE("ECAN in loopback: a buffer of DMA RAM comes back in another at the frame's end (DS70185)") {
    RandomStream random(5, "ecan");
    for (int i = 0; i < 12; ++i) {
        const CanFrame frame = draw_frame(random);
        const int buffer = static_cast<int>(random.below(8));
        CAPTURE(frame.id, frame.extended, frame.remote, int{frame.length}, buffer);
        const unsigned request = 0x88u << (buffer % 2 ? 8 : 0);  // TXEN, TXREQ
        EcanBench bench(kTakeAll, load(buffer, frame) + set(0x0A00, kCtrl1) +
                                      "        repeat #40\n        nop\n" +
                                      fmt::format("        mov #{:#x}, w0\nasks:   mov w0, {:#x}\n", request,
                                                  kTr01 + 2 * static_cast<unsigned>(buffer / 2)));
        const Cycle asked = bench.run_to("asks") + 1;
        const auto length = static_cast<Cycle>(can_bits(frame)) * kBit;
        bench.chip.run_until(bench.chip.clock().time_of(asked + length - 2));
        CHECK(bench.full() == 0);
        bench.chip.run_until(bench.chip.clock().time_of(asked + length + 4));
        CHECK(bench.full() == 0x0200);
        CHECK(bench.buffer(9) == words_of(frame));
        CHECK((bench.chip.peek("C1INTF") & 3) == 3);
        CHECK((bench.chip.peek("C1RXM0SID") & 0x0808) == 0);  // C1TR01CON: TXREQ is gone
        CHECK((bench.chip.peek("IFS0") & 0x4010) == 0x4010);  // both DMA channels have moved a buffer
        CHECK((bench.chip.peek("IFS2") & 4) == 4);            // C1RXIF
        CHECK((bench.chip.peek("IFS4") & 0x40) == 0x40);      // C1TXIF
        CHECK(bench.pins.to_bus.empty());
        CHECK(bench.chip.report().unmodelled.empty());
    }
}

TEST_CASE("ECAN's filters, masks and pointers put a frame where they should, drawn against the rule") {
    RandomStream random(6, "filters");
    int stored = 0;
    for (int i = 0; i < 12; ++i) {
        std::string setup;
        struct Filter {
            std::uint32_t id;
            bool extended;
            unsigned mask, buffer;
        };
        std::array<Filter, 16> filters{};
        std::array<std::pair<std::uint32_t, bool>, 3> masks{};
        const auto sid = [](std::uint32_t id, bool type) {
            return (id >> 18) << 5 | (type ? 8u : 0u) | (id >> 16 & 3u);
        };
        for (unsigned m = 0; m < 3; ++m) {
            masks[m] = {static_cast<std::uint32_t>(random.below(1u << 29) & random.below(1u << 29)),
                        random.below(2) != 0};
            setup += set(sid(masks[m].first, masks[m].second), kMasks + 4 * m) +
                     set(masks[m].first, kMasks + 4 * m + 2);
        }
        const auto enabled = static_cast<unsigned>(random.below(0x10000));
        std::array<unsigned, 4> pointers{};
        std::array<unsigned, 2> select{};
        for (unsigned f = 0; f < 16; ++f) {
            filters[f] = {static_cast<std::uint32_t>(random.below(1u << 29)), random.below(2) != 0,
                          static_cast<unsigned>(random.below(4)), static_cast<unsigned>(random.below(15))};
            if (f % 5 == 4) filters[f].mask = 3;
            setup += set(sid(filters[f].id, filters[f].extended), kFilters + 4 * f) +
                     set(filters[f].id, kFilters + 4 * f + 2);
            pointers[f / 4] |= filters[f].buffer << 4 * (f % 4);
            select[f / 8] |= filters[f].mask << 2 * (f % 8);
        }
        for (unsigned k = 0; k < 4; ++k)
            setup += set(pointers[k], kPointers + 2 * k);
        setup += set(enabled, kFen1) + set(select[0], kMaskSelect) + set(select[1], kMaskSelect + 2);
        EcanBench bench(setup, set(0x0800, kCtrl1));
        bench.run_to("ready");
        bench.go(20 * kBit);
        unsigned full = 0;
        for (int k = 0; k < 25; ++k) {
            CanFrame frame = draw_frame(random);
            const Filter& near = filters[random.below(16)];
            if (random.below(2)) {
                frame.extended = near.extended;
                frame.id = frame.extended ? near.id : near.id >> 18;
            }
            std::optional<unsigned> hit;
            for (unsigned f = 0; f < 16 && !hit; ++f) {
                if (!(enabled >> f & 1)) continue;
                const auto [cares, type] =
                    filters[f].mask < 3 ? masks[filters[f].mask] : std::pair{0u, false};
                if (type && filters[f].extended != frame.extended) continue;
                const std::uint32_t differs = frame.extended
                                                  ? (frame.id ^ filters[f].id) & cares
                                                  : (frame.id ^ filters[f].id >> 18) & (cares >> 18);
                if (differs == 0) hit = f;
            }
            receive(bench.chip, frame);
            const bool fits = hit && !(full >> filters[*hit].buffer & 1);
            if (fits) {
                full |= 1u << filters[*hit].buffer;
                CHECK(bench.buffer(static_cast<int>(filters[*hit].buffer)) ==
                      words_of(frame, static_cast<int>(*hit)));
                CHECK((bench.chip.peek("C1VEC") >> 8) == *hit);
                ++stored;
            }
            CHECK(bench.full() == full);
            bench.go(200);
        }
    }
    CHECK(stored > 20);
}

TEST_CASE("ECAN's FIFO fills from FSA on, warns when one is left, overflows, and goes on as it is read") {
    // Six buffers, FIFO 2 to 5; filter 0 leads there.
    EcanBench bench(set(0x000F, kPointers) + set(1, kFen1), set(0x0800, kCtrl1), 0x2002);
    bench.run_to("ready");
    bench.go(20 * kBit);
    const auto take = [&](std::uint8_t byte) {
        receive(bench.chip, {.id = 0x123, .length = 1, .data = {byte}});
        bench.go(200);
    };
    CHECK(bench.chip.peek("C1FIFO") == 0x0202);
    take(1);
    CHECK(bench.chip.peek("C1FIFO") == 0x0302);
    take(2);
    CHECK((bench.chip.peek("C1INTF") & 8) == 0);
    take(3);
    CHECK((bench.chip.peek("C1INTF") & 8) == 8);
    take(4);
    CHECK(bench.chip.peek("C1FIFO") == 0x0202);
    CHECK(bench.full() == 0x3C);
    CHECK((bench.chip.peek("C1INTF") & 4) == 0);
    take(5);
    CHECK((bench.chip.peek("C1INTF") & 4) == 4);
    CHECK(bench.chip.peek("C1RXOVF1") == 4);
    for (int i = 0; i < 4; ++i)
        CHECK(bench.buffer(2 + i)[3] == i + 1);
    bench.chip.inside().sfr.write(kFull, 0xFFFB, 0xFFFF);  // buffer 2 is given back
    CHECK(bench.chip.peek("C1FIFO") == 0x0203);
    take(6);
    CHECK(bench.buffer(2)[3] == 6);
    CHECK(bench.chip.peek("C1FIFO") == 0x0303);
    bench.chip.inside().sfr.write(kFull, 0, 0xFFFF);
    CHECK(bench.chip.peek("C1FIFO") == 0x0303);
    bench.chip.inside().sfr.write(kOverflow, 0, 0xFFFF);
    CHECK(bench.chip.peek("C1RXOVF1") == 0);
}

TEST_CASE("ECAN answers a remote frame by itself with RTREN, and sends by priority") {
    const CanFrame low{.id = 0x10, .length = 1, .data = {1}}, high{.id = 0x700, .length = 1, .data = {2}};
    const CanFrame answer{.id = 0x55, .length = 2, .data = {7, 8}};
    // Filter 0, exact on 0x55, points to buffer 2, which sends with RTREN; TXPRI 1 and 3 of buffers 0 and 1.
    EcanBench bench(set(0x55 << 5, kFilters) + set(0xFFE0, kMasks) + set(2, kPointers) + set(1, kFen1),
                    load(0, low) + load(1, high) + load(2, answer) + set(0x0084, kTr01 + 2) +
                        set(0x0800, kCtrl1) + set(0x8B89, kTr01));
    CanBusBench bus({{&bench.chip, &bench.pins}});
    const cosim::Time bit = bench.chip.clock().time_of(1000 * kBit) / 1000;
    bus.peer_joins(0, bit);
    const auto sent = [&] {
        std::vector<CanFrame> frames;
        for (const auto& one : bus.told(0, CanKind::Sent))
            frames.push_back(cosim::frame_in(one.message));
        return frames;
    };
    bus.run_until(500 * bit);
    CHECK(sent() == std::vector{high, low});
    bus.peer_sends(500 * bit, {.id = 0x55, .length = 2});  // data, not a question
    bus.run_until(700 * bit);
    CHECK(sent().size() == 2);
    bus.peer_sends(700 * bit, {.id = 0x55, .remote = true, .length = 2});
    bus.run_until(1000 * bit);
    CHECK(sent() == std::vector{high, low, answer});
}

TEST_CASE("ECAN alone on a bus becomes error passive, saved in the middle of a frame it goes on alike") {
    const CanFrame frame{.id = 0x321, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    const std::string more = load(0, frame) + set(0x0800, kCtrl1) + set(0x0088, kTr01);
    for (const bool wired : {false, true}) {
        CAPTURE(wired);
        EcanBench bench(kTakeAll, more, 0x8000, wired);
        CanBusBench bus({{&bench.chip, &bench.pins}});
        const cosim::Time bit = bench.chip.clock().time_of(1000 * kBit) / 1000;
        bus.run_until(100 * bit);
        std::vector<std::uint8_t> bytes;
        StateWriter writer(bytes);
        bench.chip.state(writer);
        EcanBench again(kTakeAll, more, 0x8000, wired);
        StateReader reader(bytes);
        again.chip.state(reader);
        bus.run_until(4000 * bit);
        for (const auto& one : bus.told(0, CanKind::Error)) {
            again.chip.run_until(one.time);
            again.chip.can_news(1, one.message);
        }
        again.chip.run_until(4000 * bit);
        CHECK((bus.told(0, CanKind::Error).size() > 16) == wired);
        for (const Chip* chip : {&bench.chip, &again.chip}) {
            CHECK(chip->peek("C1EC") == 0x8000);
            CHECK((chip->peek("C1INTF") & 0x1020) == 0x1020);
        }
    }
}
