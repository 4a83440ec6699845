// Exchanges by Bluetooth as robots report them: read, summarised, and made by emulated boards in short runs.
// All draws follow Catch's seed (--rng-seed).

#include "reproductions/ears_radio.h"
#include "reproductions/ellipse.h"
#include "reproductions/exchange_boards.h"

#include "base/error.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

std::string firmware(const char* file) {
    return std::string(PUCKLOOP_SOURCE) + "/firmware/" + file;
}

/// A robot's report of an exchange that took `total` ms, its last line at `ended`.
void report(std::vector<RobotLine>& lines, double ended, int total) {
    lines.push_back({ended - 0.03, "named e-puck_1234 in 2400 ms"});
    lines.push_back({ended - 0.02, "linked in 9800 ms"});
    lines.push_back({ended - 0.01, "answered"});
    lines.push_back({ended, "released in 1000 ms"});
    lines.push_back({ended, "exchange " + std::to_string(total) + " ms"});
}

}  // namespace

TEST_CASE("exchanges are read from what a robot reports, whole and failed ones", "[bluetooth]") {
    std::vector<RobotLine> lines{{1.0, "walks"}, {1.5, "linked in ms"}, {1.6, "exchange x ms"}};
    report(lines, 21.0, 20100);
    lines.push_back({30.0, "nobody found"});
    lines.push_back({40.0, "named e-puck_7 in 1 ms"});
    lines.push_back({50.0, "not linked"});
    lines.push_back({60.0, "no answer"});
    lines.push_back({61.0, "exchange 19000 ms"});
    lines.push_back({70.0, "linked in 1 ms"});  // still under way
    const auto read = read_exchanges(lines);
    REQUIRE(read.size() == 4);
    CHECK(read[0].succeeded());
    CHECK(*read[0].total == Approx(20.1));
    CHECK(*read[0].name == Approx(2.4));
    CHECK(*read[0].link == Approx(9.8));
    CHECK(*read[0].release == Approx(1.0));
    CHECK(read[0].seconds == 21.0);
    CHECK(read[1].failure == "nobody found");
    CHECK_FALSE(read[1].name);
    CHECK(read[2].failure == "not linked");
    CHECK(read[2].name);
    CHECK_FALSE(read[3].succeeded());
    CHECK(read[3].total);
    const ExchangeTimes times = times_of(read);
    CHECK(times.attempts == 4);
    CHECK(times.not_found == 1);
    CHECK(times.failed_later == 2);
    CHECK(times.totals == std::vector{20.1});
    CHECK(exchanges_csv(read).find("\n1,30.000,nobody found,,,,\n") != std::string::npos);
}

TEST_CASE("mean, deviation, quantiles and interval are those of the values", "[bluetooth]") {
    std::mt19937 random(Catch::rngSeed());
    std::normal_distribution<double> drawn(19.8, 4.5);
    ExchangeTimes times;
    double sum = 0.0;
    for (int i = 0; i < 1001; ++i) {
        times.totals.push_back(drawn(random));
        sum += times.totals.back();
    }
    const auto values = times.totals;
    times.attempts = 1100;
    times.not_found = 99;
    summarise(times);
    CHECK(times.mean == Approx(sum / 1001));
    double squares = 0.0;
    for (const double value : values)
        squares += (value - sum / 1001) * (value - sum / 1001);
    CHECK(times.sd == Approx(std::sqrt(squares / 1000)));
    CHECK(times.standard_error == Approx(times.sd / std::sqrt(1001.0)));
    CHECK(times.quantile(0) == *std::min_element(values.begin(), values.end()));
    CHECK(times.quantile(1) == *std::max_element(values.begin(), values.end()));
    CHECK(std::count_if(values.begin(), values.end(), [&](double v) { return v < times.quantile(0.5); }) ==
          500);
    CHECK(times.failed_percent() == Approx(9));
    // Wilson 1927: 5 of 58 lies between 3.74 and 18.64 %.
    CHECK(share_interval(5, 58).low == Approx(0.0374).margin(0.0001));
    CHECK(share_interval(5, 58).high == Approx(0.1864).margin(0.0001));
    CHECK(share_interval(0, 10).low == 0.0);
    const std::string svg = exchange_picture(times, "drawn");
    CHECK(svg.ends_with("</svg>\n"));
    CHECK(svg.find("published: 58 attempts, 19.8 +- 4.5 s, 8.6 % failed") != std::string::npos);
}

TEST_CASE("the walk's time leaves the radio's pauses out", "[bluetooth]") {
    std::vector<RobotLine> lines{{2.0, "walks"}, {5.0, "hears 80"}};
    report(lines, 25.0, 20000);
    lines.push_back({25.0, "walks"});
    lines.push_back({31.0, "hears 61"});
    lines.push_back({37.4, "nobody found"});
    lines.push_back({37.4, "walks"});
    const std::vector<RobotLine> twice = lines;
    lines.push_back({90.0, "hears 99"});
    const EarsRadio ears = read_walk(lines, 20.0, 100.0);
    REQUIRE(ears.attempts.size() == 2);
    CHECK(ears.attempts[0].walked == Approx(3));
    CHECK(ears.attempts[0].volume == 80);
    CHECK(ears.attempts[0].exchange.succeeded());
    CHECK(ears.attempts[1].walked == Approx(9));
    CHECK(ears.attempts[1].heard.seconds == 31.0);
    CHECK(ears.attempts[1].exchange.failure == "nobody found");
    CHECK(ears.walked == Approx(20));
    CHECK(ears.lasted == Approx(48.4));
    CHECK(read_walk(twice, 20.0, 40.0).walked == Approx(11.6));
    CHECK(read_walk(twice, 8.0, 100.0).attempts.size() == 1);
    lines.resize(2);
    lines.push_back({6.0, "walks"});
    CHECK_THROWS_AS(read_walk(lines, 20.0, 100.0), RunError);
}

TEST_CASE("two boards exchange words again and again, as long as modules take", "[bluetooth]") {
    const auto exchanges = exchange_on_boards(
        {firmware("bluetooth/talk.hex"), tests::scratch_path("exchanges"), 2, Catch::rngSeed()});
    REQUIRE(exchanges.size() == 2);
    for (const ReportedExchange& one : exchanges) {
        CAPTURE(one.failure, one.seconds);
        if (one.failure == "nobody found") continue;
        CHECK(one.succeeded());
        REQUIRE(one.total);
        // Inquiry 6.4 s; what is neither inquiry, name, link nor release is bytes on lines and the air.
        const double rest = *one.total - 6.4 - *one.name - *one.link - *one.release;
        CHECK(rest > 0.03);
        CHECK(rest < 0.2);
    }
    CHECK_THROWS_AS(exchange_on_boards({firmware("sound/sound.hex"), tests::scratch_path("silent"), 1, 1}),
                    RunError);
}

TEST_CASE("a walker hears its caller and sends it word by Bluetooth", "[bluetooth][sound]") {
    SoundOptions options;
    options.walker = firmware("ears/ears.hex");
    options.folder = tests::scratch_path("radio");
    options.seed = Catch::rngSeed();
    options.walk_s = 8;
    const EarsRadio ears = ears_with_radio(options);
    CHECK(ears.walked == Approx(8).margin(6));
    REQUIRE(ears.attempts.size() >= 1);
    CHECK(ears.attempts.size() <= 6);
    int arrived = 0;
    for (const RadioAttempt& one : ears.attempts) {
        CAPTURE(one.heard.seconds, one.heard.x, one.heard.y, one.volume, one.exchange.failure);
        CHECK(one.volume >= 60);  // whole counts of a mean beyond it
        CHECK(std::max(std::abs(one.heard.x), std::abs(one.heard.y)) < 0.27);
        arrived += one.exchange.succeeded() ? 1 : 0;
        if (!one.exchange.succeeded()) CHECK(one.exchange.failure == "nobody found");
    }
    CHECK(ears.messages == arrived);
    // It stands while it sends.
    const auto& first = ears.attempts.front();
    for (const auto& point : ears.path)
        if (point.seconds > first.heard.seconds + 0.2 && point.seconds < first.exchange.seconds)
            CHECK(std::hypot(point.x - first.heard.x, point.y - first.heard.y) < 0.006);
}

namespace {

/// Within three standard errors of what was published, both sides' own; failures as often as there.
void check_as_published(const ExchangeTimes& times) {
    CAPTURE(times.attempts, times.not_found, times.mean, times.sd, times.standard_error);
    const double error = std::hypot(times.standard_error, kPublishedSd / std::sqrt(53.0));
    CHECK(std::abs(times.mean - kPublishedMean) < 3 * error);
    CHECK(times.sd > 0.7 * kPublishedSd);
    CHECK(times.sd < 1.4 * kPublishedSd);
    CHECK(times.failed_later == 0);
    const Interval ours = share_interval(times.not_found, times.attempts),
                   theirs = share_interval(kPublishedNotFound, kPublishedAttempts);
    CHECK(ours.low < theirs.high);
    CHECK(theirs.low < ours.high);
}

}  // namespace

TEST_CASE("as many exchanges between two boards as five publications have", "[.sweep]") {
    const auto exchanges =
        exchange_on_boards({firmware("bluetooth/talk.hex"), tests::scratch_path("many_exchanges"),
                            5 * kPublishedAttempts, Catch::rngSeed()});
    REQUIRE(exchanges.size() == 5 * kPublishedAttempts);
    check_as_published(times_of(exchanges));
}

TEST_CASE("six minutes of a walk with ears and radio", "[.sweep]") {
    SoundOptions options;
    options.walker = firmware("ears/ears.hex");
    options.folder = tests::scratch_path("long_radio");
    options.seed = Catch::rngSeed();
    const EarsRadio ears = ears_with_radio(options);
    CHECK(ears.walked == Approx(360).margin(6));
    std::vector<ReportedExchange> exchanges;
    std::vector<std::pair<double, double>> places;
    for (const RadioAttempt& one : ears.attempts) {
        exchanges.push_back(one.exchange);
        places.emplace_back(one.heard.x, one.heard.y);
    }
    const ExchangeTimes times = times_of(exchanges);
    check_as_published(times);
    CHECK(ears.messages == static_cast<int>(times.totals.size()));
    CHECK(times.attempts > 40);  // published 58, Webots 65; at most one for each call
    CHECK(times.attempts <= 100);
    const auto fit = fit_ellipse(places);
    REQUIRE(fit);
    CHECK(fit->area() < 0.36);
}
