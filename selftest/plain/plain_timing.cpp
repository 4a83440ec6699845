#include "selftest/plain/plain_timing.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap::selftest {

namespace {
constexpr double kPeriod = 0.1;          // s
constexpr double kByte = 10.0 / 115200;  // s
constexpr double kTolerance = 0.02;      // of the baud rate, up to which no byte is misread
constexpr double kMisread = 4.0;         // a share of baud error beyond it spoils an edge so often
constexpr double kSlewed = 20.0;         // s, after which a host that slews its clock is right again
constexpr double kStaysBroken = 0.5;     // truncated frames come in bursts
}  // namespace

Arrived FrameSource::next(const Cycle& c) {
    const TimingKnobs& k = knobs_;
    Arrived a{};
    a.robot = robot_;
    robot_ += kPeriod + k.longer + k.jitter * std::abs(chance_.normal());
    double way = c.bytes * kByte + k.i2c_stretch * c.i2c;
    if (c.number % 7 == 6) way += k.limp;
    a.host = (1.0 + k.drift) * a.robot + way + k.sag * a.robot * (a.robot - kSlewed) / 100;
    if (k.batch > 0.0) a.host = std::ceil(a.host / k.batch) * k.batch;
    const double misread = std::max(0.0, std::abs(k.baud_error) - kTolerance) * kMisread;
    const bool garbled = chance_.uniform() < 1.0 - std::pow(1.0 - std::min(misread, 1.0), c.edges);
    a.shifted = chance_.uniform() < k.overrun * c.load;
    broken_ = chance_.uniform() < (broken_ ? kStaysBroken : k.truncated);
    if (k.truncated == 0.0) broken_ = false;
    a.ok = !garbled && !a.shifted && !broken_;
    return a;
}

}  // namespace puckloop::gap::selftest
