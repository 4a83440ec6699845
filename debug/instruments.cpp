#include "debug/instruments.h"

namespace puckloop::debug {

bool Instruments::instruction(std::uint32_t pc, std::uint64_t cycle) {
    for (chip::Instrument* instrument : all_)
        if (!instrument->instruction(pc, cycle)) return false;
    return true;
}
void Instruments::interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) {
    for (chip::Instrument* instrument : all_)
        instrument->interrupt(vector, pc, cycle);
}
void Instruments::reset(std::uint64_t cycle) {
    for (chip::Instrument* instrument : all_)
        instrument->reset(cycle);
}
void Instruments::access(std::uint16_t address, int bytes, bool write) {
    for (chip::Instrument* instrument : all_)
        instrument->access(address, bytes, write);
}

}  // namespace puckloop::debug
