// IRcom words: the format's own examples, every word and back, distorted and broken light.

#include "base/random.h"
#include "protocols/infrared/ircom.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::protocols;
using cosim::kMicrosecond;
using cosim::Time;

namespace {

/// Half periods by kind, counted from the symbols as text.
int halves_in(const std::string& text) {
    int sum = 0;
    for (const char symbol : text)
        sum += symbol == 'M' ? 10 : 5;
    return sum;
}

}  // namespace

TEST_CASE("check bits and symbols are those of the fact sheet's examples") {
    CHECK(ircom_check(0x00) == 0b00);
    CHECK(ircom_check(0x01) == 0b11);
    CHECK(ircom_check(0x03) == 0b10);
    CHECK(ircom_check(0x07) == 0b01);
    CHECK(ircom_check(0xFF) == 0b00);
    CHECK(ircom_text(ircom_symbols(0xA5)) == "MMSMSMMSMSMM");
    CHECK(ircom_text(ircom_symbols(0x01)) == "MMMMMMMMMSSS");
}

TEST_CASE("every word's edges have the format's number and times, and read back") {
    const IrcomTiming timing = GENERATE(IrcomTiming{}, kIrcomEpuck, kIrcomTam);
    for (int word = 0; word < 256; ++word) {
        CAPTURE(word);
        const auto symbols = ircom_symbols(static_cast<std::uint8_t>(word));
        const std::string text = ircom_text(symbols);
        const auto edges = ircom_edges(symbols, timing);
        const int halves = halves_in(text);
        REQUIRE(edges.size() == static_cast<std::size_t>(halves - halves % 2));
        CHECK(edges.front() == IrcomEdge{0, true});
        CHECK_FALSE(edges.back().lit);
        Time length = -timing.mark;
        for (const char symbol : text)
            length += symbol == 'M' ? 10 * timing.mark : 5 * timing.space;
        if (halves % 2 == 1) length -= text.back() == 'M' ? timing.mark : timing.space;
        CHECK(edges.back().time == length);
        const IrcomReading reading = read_ircom(edges);
        CHECK(reading.ok());
        CHECK(reading.word == word);
        CHECK(reading.end - reading.start == length);
    }
}

TEST_CASE("every word is read from light whose pulses are longer or shorter than its pauses") {
    RandomStream random(7, "distortion");
    for (int word = 0; word < 256; ++word) {
        auto edges = ircom_edges(ircom_symbols(static_cast<std::uint8_t>(word)), kIrcomEpuck);
        const Time longer = static_cast<Time>(random.below(141)) * kMicrosecond - 70 * kMicrosecond;
        for (IrcomEdge& edge : edges)
            if (!edge.lit) edge.time += longer;
        const IrcomReading reading = read_ircom(edges);
        CAPTURE(word, longer, explain(reading));
        CHECK(reading.ok());
        CHECK(reading.word == word);
    }
}

TEST_CASE("faults are named") {
    const auto good = ircom_edges(ircom_symbols(0x5A));
    CHECK(read_ircom({}).fault == IrcomFault::Short);
    auto dark = good;
    for (IrcomEdge& edge : dark)
        edge.lit = !edge.lit;
    CHECK(read_ircom(dark).fault == IrcomFault::NoLight);
    // Cut anywhere it is short; with one edge gone inside, a gap or a symbol is wrong.
    for (std::size_t n = 1; n + 1 < good.size(); ++n) {
        CAPTURE(n);
        const auto cut = read_ircom(std::span(good).first(n));
        CHECK_FALSE(cut.ok());
        auto holed = good;
        holed.erase(holed.begin() + static_cast<std::ptrdiff_t>(n));
        CHECK_FALSE(read_ircom(holed).ok());
    }
    const auto of_symbols = [](unsigned symbols) {
        return read_ircom(ircom_edges(static_cast<std::uint16_t>(symbols)));
    };
    CHECK(of_symbols(ircom_symbols(0x11) | 1U << 11).fault == IrcomFault::Start);
    CHECK(of_symbols(ircom_symbols(0x11) | 1U << 10).fault == IrcomFault::Start);
    for (unsigned symbols = 0; symbols < 1U << 10; ++symbols) {
        const bool fits = (std::popcount(symbols >> 2) + symbols % 4) % 4 == 0;
        CHECK(of_symbols(symbols).fault == (fits ? IrcomFault::None : IrcomFault::Check));
        CHECK(of_symbols(symbols).word == symbols >> 2);
    }
    auto longer = good;
    bool lit = good.back().lit;
    for (int i = 0; i < 3; ++i)
        longer.push_back({longer.back().time + 260 * kMicrosecond, lit = !lit});
    CHECK(read_ircom(longer).fault == IrcomFault::Long);
}

TEST_CASE("a reader cuts random words out of one stream, short pulses between them left out") {
    RandomStream random(11, "stream");
    IrcomReader reader;
    std::vector<int> sent, read;
    const auto keep = [&](const std::optional<IrcomReading>& reading) {
        if (reading && reading->fault != IrcomFault::Short)
            read.push_back(reading->ok() ? reading->word : -1);
    };
    Time now = 0;
    for (int i = 0; i < 300; ++i) {
        const auto word = static_cast<std::uint8_t>(random.below(256));
        sent.push_back(word);
        now += static_cast<Time>(2000 + random.below(5000)) * kMicrosecond;
        for (const IrcomEdge& edge : ircom_edges(ircom_symbols(word), i % 2 == 0 ? kIrcomTam : kIrcomEpuck)) {
            keep(reader.edge(now + edge.time, edge.lit));
            if (random.below(20) == 0) keep(reader.edge(now + edge.time, edge.lit));  // no change
            if (random.below(20) != 0) continue;
            keep(reader.edge(now + edge.time + 3 * kMicrosecond, !edge.lit));
            keep(reader.edge(now + edge.time + 9 * kMicrosecond, edge.lit));
        }
        now += 33 * cosim::kMillisecond;
    }
    keep(reader.until(now));
    CHECK(read == sent);
}

TEST_CASE("any light at all is read without harm") {
    RandomStream random(13, "fuzz");
    int good = 0;
    for (int i = 0; i < 3000; ++i) {
        std::vector<IrcomEdge> edges;
        Time now = 0;
        bool lit = random.below(8) != 0;
        for (auto n = random.below(150); n > 0; --n) {
            const std::uint64_t kind = random.below(10);
            now += static_cast<Time>(kind < 5 ? 260 : kind < 9 ? 520 : random.below(3000)) * kMicrosecond;
            edges.push_back({now, lit});
            lit = !lit;
        }
        const IrcomReading reading = read_ircom(edges);
        CHECK_FALSE(explain(reading).empty());
        CHECK_FALSE(name_of(reading.fault).empty());
        good += reading.ok() ? 1 : 0;
    }
    CHECK(good == 0);
}
