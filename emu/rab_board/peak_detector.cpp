#include "emu/rab_board/peak_detector.h"

#include <algorithm>
#include <cmath>

namespace puckloop::rab {

PeakDetector::PeakDetector(const PeakDetectorParameters& parameters, double input) : parameters_(parameters) {
    present_.level = present_.input = input;
    before_ = present_;
}

void PeakDetector::set_input(double counts, cosim::Time now) {
    change(counts, present_.reset, now);
}

void PeakDetector::set_reset(bool on, cosim::Time now) {
    change(present_.input, on, now);
}

double PeakDetector::level(cosim::Time now) const {
    return now < present_.since ? level(before_, std::max(now, before_.since)) : level(present_, now);
}

double PeakDetector::level(const Stretch& stretch, cosim::Time now) const {
    const double seconds = cosim::to_seconds(now - stretch.since);
    if (stretch.reset) return stretch.level * std::exp(-seconds / parameters_.reset_time_constant_s);
    if (stretch.level <= stretch.input) return stretch.input;
    return stretch.input +
           (stretch.level - stretch.input) * std::exp(-seconds / parameters_.droop_time_constant_s);
}

void PeakDetector::change(double input, bool reset, cosim::Time now) {
    const double held = level(now);
    before_ = present_;
    present_ = {now, held, input, reset};
}

}  // namespace puckloop::rab
