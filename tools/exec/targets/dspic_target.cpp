#include "tools/exec/targets/dspic_target.h"

#include <algorithm>

namespace puckloop::exec {

void DspicTarget::build(PinTap& tap) {
    chip_ = std::make_unique<dspic::Chip>(device_, tap, options_.chip);
    chip_->set_skipping(options_.skip_idle);
    tap.use_clock(chip_->clock());
}

void DspicTarget::load(const image::Image& image) {
    chip_->load(image);
    chip_->power_on();
}

void DspicTarget::run_until(cosim::Time until) {
    while (chip_->now() < until) {
        // A phase that begins in this step is answered in a later one: no answer can be due within it.
        cosim::Time step = std::min(until, chip_->now() + pic::EmptyBus::kStep);
        for (const pic::EmptyBus& bus : buses_)
            step = std::min(step, std::max(bus.due(), chip_->now()));
        if (step > chip_->now()) chip_->run_until(step);
        if (chip_->stopped_at()) break;
        for (int unit = 1; unit <= 2; ++unit) {
            pic::EmptyBus& bus = buses_[static_cast<std::size_t>(unit - 1)];
            if (bus.due() <= step) chip_->i2c_answer(unit, bus.take());
        }
    }
    passed(chip_->cycle());
}

}  // namespace puckloop::exec
