#include "emu/dspic/machine/sfr_space.h"

namespace puckloop::dspic {

void SfrSpace::describe(std::span<const RegisterInfo> registers) {
    for (const RegisterInfo& info : registers) {
        Word& word = words_[info.address >> 1];
        word.info = &info;
        word.implemented = info.implemented;
        word.behaviour = Behaviour::Unmodelled;
    }
    reset_values();
}

void SfrSpace::claim(std::uint16_t address) {
    words_[address >> 1].behaviour = Behaviour::Modelled;
    find_kind(address);
}

void SfrSpace::find_kind(std::uint16_t address) {
    ++layout_changes_;
    const Word& word = words_[address >> 1];
    const bool modelled = word.behaviour == Behaviour::Modelled || word.behaviour == Behaviour::Stored;
    plain_.kind[address >> 1] = word.read ? word.plain_kind : modelled ? Plain::kAlways : Plain::kNever;
}

void SfrSpace::hook(std::uint16_t address, void* owner, ReadHook read, WriteHook write) {
    Word& word = words_[address >> 1];
    word.owner = owner;
    word.read = read;
    word.write = write;
    word.behaviour = Behaviour::Modelled;
    find_kind(address);
}

void SfrSpace::set_off(std::uint16_t address, bool off) {
    Word& word = words_[address >> 1];
    if (off) {
        if (!off_.emplace(address, word).second) return;
        word.read = word.quiet = [](void*, std::uint16_t) -> std::uint16_t { return 0; };
        word.write = [](void*, std::uint16_t, std::uint16_t, std::uint16_t) {};
        word.behaviour = Behaviour::Modelled;
        word.plain_kind = Plain::kNever;
    } else if (const auto old = off_.find(address); old != off_.end()) {
        word = old->second;
        off_.erase(old);
    }
    find_kind(address);
}

void SfrSpace::reset_values() {
    for (std::size_t i = 0; i < kWords; ++i)
        plain_.value[i] = words_[i].info ? words_[i].info->reset : 0;
}

const RegisterInfo* SfrSpace::find(std::string_view name) const {
    for (const Word& word : words_)
        if (word.info && word.info->name == name) return word.info;
    return nullptr;
}

void SfrSpace::touch(std::uint16_t address, bool write) {
    if (reported_[address >> 1]) return;
    reported_[address >> 1] = true;
    const RegisterInfo* known = info(address);
    if (on_first_touch) on_first_touch(known ? known->name : std::string_view{}, address, write);
}

}  // namespace puckloop::dspic
