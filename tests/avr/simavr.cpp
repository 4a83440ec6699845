#include "tests/avr/simavr.h"

#include <stdexcept>

extern "C" {
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
}

namespace puckloop::avr::test {

Simavr::Simavr() : chip_(avr_make_mcu_by_name("atmega1284p")) {
    if (!chip_) throw std::runtime_error("libsimavr has no atmega1284p");
    avr_init(chip_.get());
    chip_->log = LOG_NONE;
    chip_->frequency = 16'000'000;
    chip_->run_cycle_limit = 1;
    chip_->codeend = chip_->flashend;
}
Simavr::~Simavr() = default;

void Simavr::Free::operator()(avr_t* chip) const {
    avr_terminate(chip);
}

void Simavr::set_program(std::uint32_t word_address, std::uint16_t word) {
    chip_->flash[2 * word_address] = static_cast<std::uint8_t>(word);
    chip_->flash[2 * word_address + 1] = static_cast<std::uint8_t>(word >> 8);
}
void Simavr::set_data(std::uint16_t address, std::uint8_t value) {
    chip_->data[address] = value;
}
std::uint8_t Simavr::data(std::uint16_t address) const {
    return chip_->data[address];
}

void Simavr::set_state(const CoreState& state) {
    for (std::size_t i = 0; i < state.r.size(); ++i)
        chip_->data[i] = state.r[i];
    for (std::size_t i = 0; i < 8; ++i)
        chip_->sreg[i] = state.sreg >> i & 1;
    chip_->data[R_SPL] = static_cast<std::uint8_t>(state.sp);
    chip_->data[R_SPH] = static_cast<std::uint8_t>(state.sp >> 8);
    chip_->data[chip_->rampz] = state.rampz;
    chip_->pc = 2u * state.pc;
    chip_->cycle = state.cycle;
    chip_->state = cpu_Running;
}

CoreState Simavr::state() const {
    CoreState state;
    for (std::size_t i = 0; i < state.r.size(); ++i)
        state.r[i] = chip_->data[i];
    for (std::size_t i = 0; i < 8; ++i)
        state.sreg = static_cast<std::uint8_t>(state.sreg | chip_->sreg[i] << i);
    state.sp = static_cast<std::uint16_t>(chip_->data[R_SPL] | chip_->data[R_SPH] << 8);
    state.rampz = chip_->data[chip_->rampz];
    state.pc = static_cast<std::uint16_t>(chip_->pc / 2);
    state.cycle = chip_->cycle;
    return state;
}

void Simavr::step() {
    chip_->pc = avr_run_one(chip_.get());
}

void Simavr::run_to(std::uint32_t address) {
    constexpr avr_cycle_count_t kMost = 400'000'000;
    chip_->pc = 0;
    chip_->cycle = 0;
    chip_->state = cpu_Running;
    while (chip_->pc != address && chip_->cycle < kMost)
        chip_->run(chip_.get());
}

}  // namespace puckloop::avr::test
