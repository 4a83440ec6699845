#pragma once
// How long Bluetooth takes and whether it works, as drawn numbers.
//
// Source: Couceiro et al., Robotics and Autonomous Systems 62 (2014): a whole exchange between two e-pucks
// (inquiry, recognise by name, link, send, release) took 19.8 +- 4.5 s over 53 messages; of 58 attempts 5
// failed, all because the wanted robot was not found in the inquiry; every packet sent on a link arrived.
//
// Deviations:
// 1. Only the sum is published. The inquiry's share is what the e-puck library asks for, 5 x 1.28 s; the rest
//    is divided among name request, link and release so that mean and deviation of the sum are the published
//    ones: 6.4 + 2.5 + 9.9 + 1.0 s, and 1.2, 4.3, 0.3 s.
// 2. The time until a device answers an inquiry is exponential: one number, from 53 found of 58 within 6.4 s.
// 3. The other times are gamma distributed, which none of them has been shown to be, and independent of one
//    another, of distance, and of other traffic.

#include "base/fields/field.h"
#include "base/fields/json_value.h"
#include "base/random.h"
#include "cosim/core/time.h"

namespace puckloop::bluetooth {

/// Of a drawn time, s.
struct Spread {
    double mean = 1.0;
    double sd = 0.0;  ///< standard deviation, >= 0
};

/// [mean, deviation] in descriptions.
struct SpreadForm {
    static JsonValue write(const Spread& spread);
    static void read(Spread& spread, const JsonValue& from, const std::string& place);
};

struct Times {
    double discovery = 2.611;  ///< 6.4 / ln(58 / 5)
    Spread name{2.5, 1.2};
    Spread link{9.9, 4.3};
    Spread release{1.0, 0.3};
    cosim::Time page_timeout = 5120 * cosim::kMillisecond;  ///< HCI default: 0x2000 slots of 0.625 ms
    cosim::Time latency = 15 * cosim::kMillisecond;  ///< of data on a link: two polls and two processors
    cosim::Time gather = 5 * cosim::kMillisecond;    ///< transparent bytes wait so long for more

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        const auto spread = [](auto one) { return one.in("s").template as<SpreadForm>(); };
        return visit(
            field("discovery_s", &Times::discovery, "mean time until a device answers an inquiry").in("s"),
            spread(field("name_s", &Times::name, "until a device's name is known: mean and deviation")),
            spread(field("link_s", &Times::link, "until a link is there: mean and deviation")),
            spread(field("release_s", &Times::release, "until a link is released: mean and deviation")),
            unlisted(&Times::page_timeout), unlisted(&Times::latency), unlisted(&Times::gather));
    }
};
static_assert(lists_all_fields<Times>);

/// No drawn time is shorter: what was sent before a release is through by then.
inline constexpr cosim::Time kShortest = 50 * cosim::kMillisecond;

/// Exponential with this mean, s; at least kShortest.
cosim::Time draw_exponential(double mean, RandomStream& random);
/// Gamma with this mean and deviation, s; at least kShortest.
cosim::Time draw(const Spread& spread, RandomStream& random);

}  // namespace puckloop::bluetooth
