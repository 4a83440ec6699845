// Every error of one and of two chips in range-and-bearing frames, met by the real decoders: our firmware's
// always, the original's where its image is at hand. And chips whose edges jitter or whose rate is off.

#include "base/random.h"
#include "protocols/infrared/rab_frame.h"
#include "tests/framing/rab_errors_run.h"
#include "tests/framing/table.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <utility>

using namespace puckloop;
using namespace puckloop::framing;
using protocols::encode_rab;

namespace {

std::string inverted(std::string chips, std::initializer_list<std::size_t> places) {
    for (const std::size_t place : places)
        chips[place] = chips[place] == '1' ? '0' : '1';
    return chips;
}

std::vector<std::string> all_single(const std::string& chips) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < chips.size(); ++i)
        texts.push_back(inverted(chips, {i}));
    return texts;
}

std::vector<std::string> all_double(const std::string& chips) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < chips.size(); ++i)
        for (std::size_t j = i + 1; j < chips.size(); ++j)
            texts.push_back(inverted(chips, {i, j}));
    return texts;
}

struct Tally {
    int cases = 0, found = 0, right = 0, wrong = 0, next_lost = 0, second_lost = 0;
};

Tally count(const std::vector<RabOutcome>& outcomes) {
    Tally tally;
    for (const RabOutcome& one : outcomes) {
        ++tally.cases;
        tally.right += one.accepted_right;
        tally.wrong += one.accepted_wrong;
        tally.found += !one.accepted_right && !one.accepted_wrong;
        tally.next_lost += one.next_lost;
        tally.second_lost += one.second_lost;
    }
    return tally;
}

constexpr const char* kColumns = "firmware,bits,payload,chips inverted,cases,found,accepted as sent,accepted "
                                 "wrong,next frame lost,second lost";

void add(Table& table, const RabReceiver& receiver, int size, std::uint32_t payload, int inverted,
         const Tally& t) {
    table.add(fmt::format("{},{},{:X},{},{},{},{},{},{},{}", receiver.name, size, payload, inverted, t.cases,
                          t.found, t.right, t.wrong, t.next_lost, t.second_lost));
}

std::uint32_t draw(RandomStream& random, int size) {
    return static_cast<std::uint32_t>(random.next() >> 32) >> (32 - size);
}

}  // namespace

TEST_CASE("rab errors: inverted chips drawn at random, our firmware") {
    RandomStream random(61, "rab errors");
    for (const int size : {8, 16, 24, 32}) {
        const std::uint32_t payload = draw(random, size);
        const std::string chips = encode_rab(size, payload);
        std::vector<std::string> texts;
        for (int i = 0; i < 24; ++i) {
            const std::size_t first = random.below(chips.size()), second = random.below(chips.size());
            texts.push_back(i % 4 == 0 || first == second ? inverted(chips, {first})
                                                          : inverted(chips, {first, second}));
        }
        const Tally tally = count(send_wrong_frames(own_rab_receiver(), size, payload, texts, 62));
        INFO("size " << size << " payload " << payload);
        CHECK(tally.wrong == 0);
        CHECK(tally.next_lost == 0);
        CHECK(tally.second_lost == 0);
    }
}

TEST_CASE("rab errors: all errors of one and two chips", "[.slow]") {
    RandomStream random(63, "rab errors");
    Table table("rab_errors.csv", kColumns);
    for (const RabReceiver& receiver : rab_receivers()) {
        const bool own = receiver.name == own_rab_receiver().name;
        // The longer frames on ours only: half a minute each.
        for (const int size : {8, 8, 16, 16, 24, 32}) {
            if (!own && size > 16) continue;
            const std::uint32_t payload = draw(random, size);
            const std::string chips = encode_rab(size, payload);
            const Tally one = count(send_wrong_frames(receiver, size, payload, all_single(chips), 64));
            const Tally two = count(send_wrong_frames(receiver, size, payload, all_double(chips), 65));
            add(table, receiver, size, payload, 1, one);
            add(table, receiver, size, payload, 2, two);
            INFO(receiver.name << " size " << size << " payload " << payload);
            CHECK(one.wrong == 0);
            CHECK(two.wrong == 0);
            if (!own) continue;
            CHECK(one.next_lost + two.next_lost == 0);
            CHECK(one.second_lost + two.second_lost == 0);
        }
    }
}

TEST_CASE(
    "rab jitter: our firmware takes every frame below the edge, whatever the sender's rate within 6 %") {
    for (const auto& [jitter, longer] :
         {std::pair{0.0, 1.0}, {0.1, 1.0}, {0.2, 1.0}, {0.0, 0.94}, {0.0, 1.06}}) {
        const Delivery delivery = send_jittered(own_rab_receiver(), 32, jitter, longer, 12, 71);
        INFO("jitter " << jitter << " longer " << longer);
        CHECK(delivery.right == delivery.sent);
        CHECK(delivery.wrong == 0);
    }
}

TEST_CASE("rab jitter: where frames begin to be lost", "[.slow]") {
    Table table("rab_jitter.csv",
                "firmware,bits,edges displaced by up to +- chips,chips longer by %,sent,lost,wrong");
    for (const RabReceiver& receiver : rab_receivers()) {
        const bool own = receiver.name == own_rab_receiver().name;
        const auto row = [&](int size, double jitter, double percent) {
            const Delivery d = send_jittered(receiver, size, jitter, 1 + percent / 100, 40, 72);
            table.add(fmt::format("{},{},{:.2f},{:.2f},{},{},{}", receiver.name, size, jitter, percent,
                                  d.sent, d.sent - d.right, d.wrong));
            INFO(receiver.name << " bits " << size << " jitter " << jitter << " longer by " << percent
                               << " %");
            if (own && jitter < 0.205 && std::abs(percent) < 6.5) CHECK(d.right == d.sent);
            if (own) CHECK(d.wrong == 0);
            if (!own && jitter == 0 && percent == 0) CHECK(d.right >= d.sent * 4 / 5);
            if (!own && std::abs(percent) > 2.5) CHECK(d.right == 0);
        };
        for (const int size : {16, 32}) {
            for (double jitter = 0; jitter < 0.51; jitter += 0.05)
                row(size, jitter, 0);
            for (double jitter = 0.21; own && jitter < 0.265; jitter += 0.01)
                row(size, jitter, 0);
            for (const double percent : {0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0}) {
                if (!own && percent > 4) continue;
                row(size, 0, percent);
                row(size, 0, -percent);
            }
        }
    }
}
